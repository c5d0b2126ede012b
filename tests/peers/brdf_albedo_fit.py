"""The albedo of the balanced model of the Ward family (isotropic), by quadrature, and a polynomial fit of it.

Prints the coefficients in `spectral-core/src/brdf/fit.rs`, and the largest error over a grid that isn't the fit's.

With slopes s of the half vector, y = |s|/alpha, t = tan(theta), psi the azimuth between s and the view:
    albedo = int_0^1/2 dpsi 2 int 2 y exp(-y^2) (w(s) + w(-s))/2 dy
    w(s) = 2 - (1 + alpha^2 y^2)/(1 + alpha y t cos(psi)) where that reflects above the horizon, else 0.
The quadrature is in x = alpha t and alpha; the fit in q = 1 - sqrt(m/(x + m)), m = 1/2, and alpha in [0, 1], by Chebyshev
polynomials: towards grazing incidence the loss goes like (1 - p) log(1 - p), p = x/(x + m), which the root makes smooth.

Run: python brdf_albedo_fit.py [degree_q degree_alpha]
"""
import sys

import numpy as np
from numpy.polynomial import chebyshev

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
NODES, WEIGHTS = (NODES + 1) / 2, WEIGHTS / 2
MIDDLE = 0.5


def loss(x, alpha):
    """1 - albedo for x = alpha tan(theta)."""
    # The sine of the azimuth from the perpendicular, graded towards it.
    grade = np.log(2 + x)
    turn = np.expm1(grade * NODES) / np.expm1(grade)
    weight = WEIGHTS * grade * np.exp(grade * NODES) / np.expm1(grade)
    c = x * np.sin(turn * np.pi / 2)  # alpha tan(theta) cos(azimuth)
    root = np.hypot(c, alpha)
    first = 1 / (c + root)  # below which both reflect above the horizon
    if alpha > 0:
        last = np.minimum((c + root) / alpha**2, 8.0)
    else:
        last = np.full_like(c, 8.0)
    first = np.minimum(first, last)
    total = 0.0
    # First piece, then the second in three to resolve the tail.
    pieces = [(0 * first, first)]
    cuts = [first + (last - first) * f for f in (0, 0.15, 0.45, 1)]
    pieces += list(zip(cuts[:-1], cuts[1:]))
    for low, high in pieces:
        y = low[:, None] + (high - low)[:, None] * NODES
        both = 0
        for sign in (1, -1):
            rise = 1 + sign * c[:, None] * y
            with np.errstate(divide="ignore", invalid="ignore"):
                w = 2 - (1 + alpha**2 * y**2) / rise
            both = both + np.where((rise > 0) & (w > 0), w, 0)
        inner = (2 * y * np.exp(-y * y) * both / 2) @ WEIGHTS * (high - low)
        total += weight @ inner
    return 1 - total


def grid(qs, alphas):
    return np.array([[loss(MIDDLE * ((1 - q) ** -2 - 1), a) for a in alphas] for q in qs])


def basis(points, degree):
    return chebyshev.chebvander(2 * points - 1, degree)


def chebyshev_points(count):
    return (1 - np.cos(np.pi * (np.arange(count) + 0.5) / count)) / 2


def main():
    dq, da = (int(v) for v in sys.argv[1:3]) if len(sys.argv) > 2 else (16, 9)
    q, a = chebyshev_points(160), chebyshev_points(50)
    coefficients = np.linalg.pinv(basis(q, dq)) @ grid(q, a) @ np.linalg.pinv(basis(a, da)).T
    q = np.concatenate([np.linspace(0, 0.999, 331), 1 - np.logspace(-3, -5, 20)])
    a = np.concatenate([np.linspace(1e-3, 1, 83), [1e-6, 1e-4]])
    truth = grid(q, a)
    error = np.abs(basis(q, dq) @ coefficients @ basis(a, da).T - truth)
    i, j = np.unravel_index(error.argmax(), error.shape)
    for row in coefficients:
        print("    [" + ", ".join(f"{c:.7e}" for c in row) + "],")
    print("loss from", truth.min(), "to", truth.max(), file=sys.stderr)
    print("largest error", error.max(), "at q, alpha", q[i], a[j], file=sys.stderr)


if __name__ == "__main__":
    main()
