#!/usr/bin/env python3
"""Writes tests/data/factor_*.csv: configuration factors to more digits than `f64` has, at receivers that are hard to compute.

    python3 tests/peers/factor_reference.py            (needs numpy and mpmath)

Each row holds coordinates that are exact in the precision it names and the factor of exactly these, with normals taken as directions
of length one: contour integrals in 90 decimal digits, which outlast every cancellation. The disk's is taken in the disk's
own coordinates, with the elementary integral of n.(x cross x') / x^2 over the angle in the disk; the sphere's over its circle of tangency; the
polygon's is Lambert's sum over the polygon cut at the horizon. The check of the contour integrals themselves, by area and solid angle, is
in `factor_quadrature.rs`.
"""

import pathlib

import mpmath as mp
import numpy as np

mp.mp.dps = 90
mpf = mp.mpf
DATA = pathlib.Path(__file__).resolve().parents[1] / "data"
SEED = 20_101_952


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = mp.sqrt(dot(a, a))
    return [x / length for x in a]


def exact(v):
    return [mpf(float(x)) for x in v]


def angle(a, b, n):
    """The signed angle from a to b about n."""
    return mp.atan2(dot(cross(a, b), n), dot(a, b))


def disk(centre, normal, radius, position, receiver):
    centre, normal, position, receiver = map(exact, (centre, normal, position, receiver))
    r = mpf(float(radius))
    normal, receiver = unit(normal), unit(receiver)
    d = [a - b for a, b in zip(centre, position)]
    h = -dot(d, normal)
    if h <= 0:
        return mpf(0)
    q = [a + h * b for a, b in zip(d, normal)]
    rho = mp.sqrt(dot(q, q))
    if rho > 0:
        e = [x / rho for x in q]
    else:
        e = unit(cross(normal, [mpf(1), 0, 0] if abs(normal[0]) < 0.9 else [0, mpf(1), 0]))
    z = [-x for x in normal]
    nx, ny, nz = dot(receiver, e), dot(receiver, cross(z, e)), dot(receiver, z)
    s, g = h * nz + rho * nx, mp.hypot(nx, ny)
    if s + r * g <= 0:
        return mpf(0)
    # x = (rho + r cos f, r sin f, h): n.(x cross x') = c0 + c1 cos f + c2 sin f, x^2 = b + a cos f.
    c0, c1, c2 = nz * r * r, nz * r * rho - nx * h * r, -ny * h * r
    b, a = h * h + rho * rho + r * r, 2 * rho * r
    root = mp.sqrt(b * b - a * a)
    if s - r * g >= 0:
        j0 = 2 * mp.pi / root
        j1 = (2 * mp.pi - b * j0) / a if a > 0 else mpf(0)
        return (c0 * j0 + c1 * j1) / (2 * mp.pi)

    def integral(f):
        turns = mp.floor((f + mp.pi) / (2 * mp.pi))
        f0 = f - 2 * mp.pi * turns
        i0 = 2 / root * (mp.atan2(mp.sqrt((b - a) / (b + a)) * mp.sin(f0 / 2), mp.cos(f0 / 2)) + mp.pi * turns)
        if a > 0:
            return c0 * i0 + c1 * (f - b * i0) / a - c2 * mp.log(b + a * mp.cos(f)) / a
        return c0 * i0 + (c1 * mp.sin(f) - c2 * mp.cos(f)) / b

    middle, width = mp.atan2(ny, nx), mp.acos(-s / (r * g))
    first, last = middle - width, middle + width
    x = lambda f: [rho + r * mp.cos(f), r * mp.sin(f), h]
    return (integral(last) - integral(first) + angle(x(last), x(first), [nx, ny, nz])) / (2 * mp.pi)


def sphere(centre, radius, position, receiver):
    centre, position, receiver = map(exact, (centre, position, receiver))
    r, receiver = mpf(float(radius)), unit(exact(receiver))
    d = [a - b for a, b in zip(centre, position)]
    d2, s = dot(d, d), dot(d, receiver)
    if d2 < r * r:
        return mpf(1)
    length = mp.sqrt(d2)
    if abs(s) >= r:
        return max(r * r * s / (d2 * length), mpf(0))
    # Directions to the circle of tangency: cos a along the axis, sin a (cos f, sin f) across; n = (sin t, 0, cos t).
    cos_t, sin_a, cos_a = s / length, r / length, mp.sqrt(d2 - r * r) / length
    sin_t = mp.sqrt(1 - cos_t * cos_t)
    w = mp.acos(-cos_t * cos_a / (sin_a * sin_t))
    arc = 2 * w * sin_a * sin_a * cos_t - 2 * mp.sin(w) * sin_a * cos_a * sin_t
    x = lambda f: [sin_a * mp.cos(f), sin_a * mp.sin(f), cos_a]
    return (arc + angle(x(w), x(-w), [sin_t, mpf(0), cos_t])) / (2 * mp.pi)


def polygon(position, receiver, corners):
    position, receiver = exact(position), unit(exact(receiver))
    seen = [[x - y for x, y in zip(exact(c), position)] for c in corners]
    heights = [dot(x, receiver) for x in seen]
    cut = []
    for i, (a, ha) in enumerate(zip(seen, heights)):
        b, hb = seen[(i + 1) % len(seen)], heights[(i + 1) % len(seen)]
        if ha > 0:
            cut.append(a)
        if (ha > 0) != (hb > 0):
            cut.append([x + (y - x) * (ha / (ha - hb)) for x, y in zip(a, b)])
    total = mpf(0)
    for a, b in zip(cut, cut[1:] + cut[:1]):
        across = cross(a, b)
        sine = mp.sqrt(dot(across, across))
        if sine > 0:
            total += mp.atan2(sine, dot(a, b)) * dot(across, receiver) / sine
    return abs(total) / (2 * mp.pi)


def normalized(v, kind):
    """The vector that the crate's normalisation leaves unchanged."""
    v = np.array(v, dtype=kind)
    for _ in range(20):
        largest = np.max(np.abs(v))
        if not largest > 0:
            return None
        b = (v / largest).astype(kind)
        w = (b / np.sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2])).astype(kind)
        if np.array_equal(w, v):
            return w
        v = w
    return None


def rotation(rng):
    if rng.random() < 0.3:
        return np.eye(3)
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q if np.linalg.det(q) > 0 else -q


def magnitude(rng, low, high):
    return 10 ** rng.uniform(low, high)


def disk_case(rng, family, kind):
    double = kind == np.float64
    r = 1.0 if rng.random() < 0.3 else magnitude(rng, -2, 2)
    span = 1 if family == "generic" else 6
    h = r * magnitude(rng, -span, span)
    offsets = [
        0.0,
        r,
        r * (1 + rng.choice([-1, 1]) * magnitude(rng, -14 if double else -6, -1)),
        r * rng.uniform(0, 1),
        r * magnitude(rng, -span, span),
        r + h * rng.uniform(-1, 1),
    ]
    rho = offsets[rng.integers(len(offsets))]
    if family == "contact":
        h = r * magnitude(rng, -6, -1)
    if family == "far":
        h = r * magnitude(rng, 0, 6)
    phi = rng.uniform(0, 2 * np.pi) if rng.random() < 0.6 else 0.0
    p = np.array([rho * np.cos(phi), rho * np.sin(phi), h])
    n = rng.normal(size=3)
    if family == "grazing":
        t, f = magnitude(rng, -8 if double else -4, -0.5), rng.uniform(0, 2 * np.pi)
        n = np.array([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t) * rng.choice([-1, 1], p=[0.2, 0.8])])
    if family in ("sliver", "contact", "far", "through") and rng.random() < 0.85:
        # The horizon through one point of the disk, or through two of the rim as close as may be.
        f = rng.uniform(0, 2 * np.pi)
        rim = lambda f: np.array([r * np.cos(f), r * np.sin(f), 0])
        if family == "through":
            n = np.cross(rim(f) * rng.uniform(0, 1) - p, rng.normal(size=3))
        else:
            n = np.cross(rim(f) - p, rim(f + magnitude(rng, -12 if double else -5, 0) * rng.choice([-1, 1])) - p)
        n = n * rng.choice([-1, 1])
    q = rotation(rng)
    centre = rng.normal(size=3) * r * rng.choice([0, 1], p=[0.7, 0.3])
    receiver, normal = normalized(q @ n, kind), normalized(q @ [0, 0, 1.0], kind)
    if receiver is None or normal is None:
        return None
    centre, position, r = centre.astype(kind), (q @ p + centre).astype(kind), kind(r)
    return [*centre, *normal, r, *position, *receiver], disk(centre, normal, r, position, receiver)


def sphere_case(rng, family, kind):
    double = kind == np.float64
    r = magnitude(rng, -2, 2)
    gap = r * magnitude(rng, -9 if double else -5, 6)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    distance = r + gap
    n = rng.normal(size=3)
    if family == "tangent":
        across = np.cross(direction, rng.normal(size=3))
        x = r / distance * rng.choice([-1, 1]) * (1 + magnitude(rng, -12 if double else -5, 0) * rng.choice([-1, 1]))
        x = x if abs(x) <= 1 else rng.uniform(-1, 1)
        n = x * direction + np.sqrt(1 - x * x) * across / np.linalg.norm(across)
    position = (rng.normal(size=3) * r * rng.choice([0, 1])).astype(kind)
    centre, r, receiver = (position + direction * distance).astype(kind), kind(r), normalized(n, kind)
    if receiver is None:
        return None
    return [*centre, r, *position, *receiver], sphere(centre, r, position, receiver)


def polygon_case(rng, family, kind):
    double = kind == np.float64
    count = 3 if rng.random() < 0.6 else 4
    if count == 3:
        flat = np.array([[rng.normal(), rng.normal(), 0] for _ in range(3)])
    else:
        a, b = rng.uniform(0.2, 2, 2)
        flat = np.array([[-a, -b, 0], [a, -b, 0], [a, b, 0], [-a, b, 0]])
        flat[:, :2] += rng.normal(size=2)
    if family == "thin":
        flat[:, 1] *= magnitude(rng, -6 if double else -3, -1)
    p = np.array([rng.normal(), rng.normal(), 1]) * magnitude(rng, -0.5, 0.5)
    if family == "far":
        p = rng.normal(size=3) * magnitude(rng, 0, 6)
    if family == "edge-on":
        p = np.array([*(rng.normal(size=2) * magnitude(rng, 0.3, 3)), magnitude(rng, -9 if double else -5, -1)])
    if family == "contact":
        p = rng.dirichlet(np.ones(count)) @ flat + np.array([0, 0, magnitude(rng, -6 if double else -3, -1)])
    if family == "edge":
        i, t = rng.integers(count), rng.choice([0, rng.uniform(0, 1)])
        p = flat[i] * (1 - t) + flat[(i + 1) % count] * t
        p = p + np.array([*rng.normal(size=2), abs(rng.normal())]) * magnitude(rng, -5 if double else -3, -1)
    n = rng.normal(size=3)
    if family == "sliver" or (family != "generic" and rng.random() < 0.5):
        i = rng.integers(count)
        other = flat[(i + 1) % count] + rng.normal(size=3) * [1, 1, 0] * magnitude(rng, -12 if double else -5, 0)
        n = np.cross(flat[i] - p, other - p) * rng.choice([-1, 1])
    q, size = rotation(rng), magnitude(rng, -2, 2)
    shift = rng.normal(size=3) * size * rng.choice([0, 1])
    corners, position = ((q @ flat.T).T * size + shift).astype(kind), (q @ p * size + shift).astype(kind)
    receiver = normalized(q @ n, kind)
    if receiver is None:
        return None
    return [*position, *receiver, *corners.ravel()], polygon(position, receiver, corners)


SETS = {
    "disk": (disk_case, ["generic", "extreme", "grazing", "sliver", "contact", "far", "through"], 40, "c N r p n"),
    "sphere": (sphere_case, ["generic", "tangent"], 40, "c r p n"),
    "polygon": (polygon_case, ["generic", "far", "edge-on", "contact", "sliver", "thin", "edge"], 20, "p n corners..."),
}


def main():
    DATA.mkdir(exist_ok=True)
    for index, (name, (case, families, count, columns)) in enumerate(SETS.items()):
        rng = np.random.default_rng([SEED, index])
        with open(DATA / f"factor_{name}.csv", "w", encoding="utf-8", newline="\n") as out:
            print("# Configuration factors in 90-digit arithmetic, written by tests/peers/factor_reference.py.", file=out)
            print(f"# precision, family, {', '.join(columns.split())}, factor: three columns a vector.", file=out)
            for kind, smallest in ((np.float64, mpf(10) ** -60), (np.float32, mpf(10) ** -20)):
                for family in families:
                    rows = zeros = 0
                    while rows < count:
                        made = case(rng, family, kind)
                        if made is None or (made[1] != 0 and made[1] < smallest):
                            continue
                        if made[1] == 0 and zeros == 2:
                            continue
                        zeros += made[1] == 0
                        rows += 1
                        cells = [repr(float(x)) for x in made[0]] + [mp.nstr(made[1], 20, min_fixed=0, max_fixed=0)]
                        print("f64" if kind == np.float64 else "f32", family, *cells, sep=",", file=out)


if __name__ == "__main__":
    main()
