#!/usr/bin/env python3
"""Time that a picture of the Cornell box with all interreflections takes: this project, Radiance and Mitsuba 3, in turns.

    python3 tests/peers/cornell_time.py --truth PICTURE.exr [--rounds 5] [--size 256] [--threads N] [--program target/release/spectral]
                                        [--work DIR] [--skip radiance,mitsuba] [--path-spp N] [--mitsuba-spp N] [--json FILE]

To be run with a Python that has Mitsuba, NumPy, SciPy, colour-science and pyradiance (whose programs Radiance is). The truth is a linear sRGB
picture of the same size, e.g. by `spectral render cornell-box --renderer path --size 256x256 --spp 3072`. In each round every
contender renders once, each as a process of its own from start to picture on disk, seeded by the round; Radiance from the octree of the
same geometry, with an empty ambient cache, in RGB (paints as the linear sRGB of their colour under D65) and in bands of equal
width, which are turned into colours outside the time. Radiance's lamp
is an illum, so that it reflects light; what it emits is added to its pixels afterwards.
Mitsuba's time holds the start of Python and the import too, and once more without them in the column "render". Wall-clock and processor time are
medians over rounds, differences of colour and luminance are means. Edges are those of the truth, as `mitsuba_direct.py` has them.

Exit status 1 if a radiosity picture misses a mean ΔE00 of 1.5 outside edges, or if any of this project's misses the truth's luminance by 1 %.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

import numpy as np

from mitsuba_direct import ROOT, compare
from mitsuba_path import FLAT_LUMINANCE
from verify_radiance import binaries

RADIOSITY = [
    ["--accuracy", "0.1", "--spectra", "uniform:24", "--spp", "1"],
    ["--accuracy", "0.1", "--spectra", "uniform:24", "--spp", "4"],
    ["--accuracy", "0.02", "--spectra", "uniform:81", "--spp", "4"],
]
# The first two were found by trial to stay under 1.5 in RGB; the last is finer than that needs, and takes minutes.
COARSE = "-ab 4 -aa .5 -ad 32 -as 0 -ar 8"
FINER = "-ab 5 -aa .4 -ad 64 -as 0 -ar 8"
USUAL = "-ab 3 -aa .15 -ad 256 -as 0 -ar 16"
# Soft shadows without bands: the lamp in small parts, a random place in each.
DIRECT = ["-dj", "0.7", "-ds", "0.1", "-dt", "0", "-lw", "1e-3", "-lr", "8"]
BANDS = (380.0, 740.0, 18)
RADIANCE = [(None, COARSE), (None, FINER), (BANDS, FINER)]
WORKER = """
import sys, time, drjit, mitsuba as mi, numpy as np
scene, variant, size, spp, seed, threads, out = sys.argv[1:]
mi.set_variant(variant)
if int(threads): drjit.set_thread_count(int(threads))
start = time.perf_counter()
picture = mi.render(mi.load_file(scene, resolution=size), integrator=mi.load_dict({"type": "path", "max_depth": -1}),
                    spp=int(spp), seed=int(seed))
np.save(out, np.array(picture, dtype=np.float32)[:, :, :3])
print(time.perf_counter() - start)
"""


def measured(command, **options):
    """Runs a pipeline's last process to its end; its output, wall-clock seconds and processor seconds (with all it starts)."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(list(map(str, command)), capture_output=True, **options)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr.decode(errors='replace')}")
    return done.stdout, wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read_exr(path):
    import mitsuba as mi

    bitmap = mi.Bitmap(str(path))
    # Channels come in the file's order: take R, G, B by name.
    names = [field.name for field in bitmap.struct_()]
    data = np.array(bitmap, dtype=np.float64)
    return np.stack([data[:, :, names.index(c)] for c in "RGB"], axis=2)


class Own:
    def __init__(self, args, options):
        self.args, self.options = args, options
        self.radiosity = options[1] == "radiosity"
        self.name = "own " + " ".join(options[1:]).replace("--", "")

    def render(self, seed):
        args = self.args
        command = [args.program, "render", args.scene, *self.options, "--size", f"{args.size}x{args.size}", "--seed", seed,
                   "--json", "--out", args.work]
        command += ["--threads", args.threads] if args.threads else []
        out, wall, cpu = measured(command)
        report = json.loads(out)
        (picture,) = (f for f in report["files"] if f.endswith(".exr") and "variance" not in f)
        return read_exr(picture), wall, cpu, report["preparation_seconds"] + report["seconds"]


class Mitsuba:
    radiosity = False

    def __init__(self, args):
        self.args, self.name = args, f"Mitsuba path {args.mitsuba_variant} {args.mitsuba_spp} spp"

    def render(self, seed):
        args, picture = self.args, self.args.work / "mitsuba.npy"
        command = [sys.executable, "-c", WORKER, args.scene, args.mitsuba_variant, args.size, args.mitsuba_spp, seed,
                   args.threads, picture]
        out, wall, cpu = measured(command)
        return np.load(picture).astype(float) / FLAT_LUMINANCE, wall, cpu, float(out.split()[-1])


def standard_observer(wavelengths):
    """XYZ weights of radiance at the wavelengths, per nm, with Y of D65 times 1 equal to 1; and D65."""
    import colour

    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    fine = np.arange(360.0, 831.0)
    d65 = colour.SDS_ILLUMINANTS["D65"]
    d65 = np.interp(fine, d65.wavelengths, d65.values, 0, 0)
    xyz = np.stack([np.interp(fine, cmfs.wavelengths, cmfs.values[:, k]) for k in range(3)], axis=1)
    weights = xyz * (d65 / (xyz[:, 1] @ d65))[:, None]
    return np.stack([np.interp(wavelengths, fine, weights[:, k], 0, 0) for k in range(3)], axis=1)


class Radiance:
    """The same box by rtrace with an ambient cache, in RGB or in `bands` of equal width relative to D65."""

    radiosity = False

    def __init__(self, args, home, bands, ambient):
        self.args, self.home, self.bands, self.ambient = args, home, bands, ambient.split()
        self.name = f"Radiance {'%d bands' % bands[2] if bands else 'RGB'} {ambient} {args.radiance_spp} spp"
        self.folder = args.work / f"radiance-{bands[2] if bands else 'rgb'}"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.environment = dict(os.environ, RAYPATH=f"{home / 'lib'}:.")
        if bands:
            low, high, count = bands
            self.fine = np.arange(low, high) + 0.5
            self.share = np.repeat(np.arange(count), int((high - low) / count))
        else:
            self.fine = np.arange(360.0, 831.0)
        self.to_xyz = standard_observer(self.fine)
        self.prepare()

    def paint(self, name, wavelengths, values):
        """A diffuse material; Radiance's three components are taken as linear sRGB, which they are if lamp and paints are."""
        import colour

        reflectance = np.interp(self.fine, wavelengths, values, 0, 0)
        if self.bands:
            weight = self.to_xyz.sum(axis=1)
            means = np.bincount(self.share, weight * reflectance) / np.bincount(self.share, weight)
            numbers = " ".join(f"{v:.6g}" for v in means)
            return (f"void spectrum {name}_s 0 0 {2 + len(means)} {self.bands[0]:g} {self.bands[1]:g} {numbers}\n"
                    f"{name}_s plastic {name} 0 0 5 1 1 1 0 0\n")
        matrix = np.array(colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB)
        white, rgb = matrix @ self.to_xyz.sum(axis=0), matrix @ (self.to_xyz.T @ reflectance)
        numbers = " ".join(f"{v:.6g}" for v in np.maximum(rgb / white, 0))
        return f"void plastic {name} 0 0 5 {numbers} 0 0\n"

    def prepare(self):
        """Writes scene.rad and the view from the exported XML file, and makes the octree."""
        root = ElementTree.parse(self.args.scene).getroot()
        base, text = self.args.scene.parent, ""
        for bsdf in root.findall("bsdf"):
            text += self.material(bsdf, base)
        for shape in root.findall("shape"):
            text += self.shape(shape, base)
        (self.folder / "scene.rad").write_text(text)
        with open(self.folder / "scene.oct", "wb") as out:
            subprocess.run([self.home / "bin" / "oconv", self.folder / "scene.rad"], stdout=out, check=True, env=self.environment)
        sensor = root.find("sensor")
        look = sensor.find("transform/lookat")
        origin, target = (np.array(look.get(k).split(), dtype=float) for k in ("origin", "target"))
        angle = sensor.find("float").get("value")
        self.view = ["-vtv", "-vp", *origin, "-vd", *(target - origin), "-vu", *look.get("up").split(), "-vh", angle, "-vv", angle]

    def material(self, bsdf, base):
        table = np.loadtxt(base / bsdf.find("spectrum").get("filename"))
        return self.paint(bsdf.get("id"), table[:, 0], table[:, 1])

    def shape(self, shape, base):
        if shape.get("type") == "obj":
            return polygons(base / shape.find("string").get("value"), shape.find("ref").get("id"), shape.get("id"))
        self.radiance = float(shape.find("emitter/spectrum/float").get("value"))
        return lamp(shape)

    def render(self, seed):
        args, cache = self.args, self.folder / "ambient.cache"
        cache.unlink(missing_ok=True)
        size, spp, out = str(args.size), args.radiance_spp, self.folder / "picture.float"
        rays = [self.home / "bin" / "vwrays", "-ff", "-x", size, "-y", size, "-c", spp, "-pj", "1", *self.view]
        trace = [self.home / "bin" / "rtrace", "-w-", "-h", "-fff", "-n", args.threads or os.cpu_count(),
                 *(["-cs", self.bands[2], "-cw", self.bands[0], self.bands[1], "-co+"] if self.bands else []),
                 *DIRECT, *self.ambient, "-af", cache, self.folder / "scene.oct"]
        pipeline = f"{' '.join(map(str, rays))} | {' '.join(map(str, trace))} > {out}"
        _, wall, cpu = measured(["/bin/sh", "-c", pipeline], env=self.environment)
        data = np.fromfile(out, dtype=np.float32).astype(float).reshape(args.size, args.size, spp, -1).mean(axis=2)
        picture = self.linear_srgb(data)
        picture[args.lamp] += self.radiance
        return picture, wall, cpu, wall

    def linear_srgb(self, data):
        import colour

        if not self.bands:
            return data
        assert data.shape[2] == self.bands[2], data.shape
        weights = np.stack([np.bincount(self.share, self.to_xyz[:, k]) for k in range(3)], axis=1)
        matrix = np.array(colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB)
        # rtrace writes bands from long to short wavelengths, as red comes before blue.
        return data[:, :, ::-1] @ weights @ matrix.T


def polygons(path, material, name):
    """The faces of an OBJ file with positions only."""
    points, text = [], ""
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append(rest)
        elif word == "f":
            corners = [points[int(re.match(r"\d+", r)[0]) - 1] for r in rest]
            text += f"{material} polygon {name}_{len(text)} 0 0 {3 * len(corners)} {' '.join(sum(corners, []))}\n"
    return text


def lamp(shape):
    """The rectangle of the light: x and y from -1 to 1, turned about x by 90° so that it shines down, scaled and moved.

    Radiance's lights reflect nothing: an illum does, at the price of looking dark (its light is added to the picture afterwards).
    """
    rotate, scale, move = (shape.find("transform")[k] for k in range(3))
    assert (rotate.get("x"), rotate.get("angle")) == ("1", "90") and shape.get("type") == "rectangle"
    x, z = float(scale.get("x")), float(scale.get("z"))
    cx, cy, cz = (float(move.get(k)) for k in "xyz")
    corners = [(cx - x, cy, cz - z), (cx + x, cy, cz - z), (cx + x, cy, cz + z), (cx - x, cy, cz + z)]
    numbers = " ".join(f"{v:g}" for corner in corners for v in corner)
    radiance = shape.find("emitter/spectrum/float").get("value")
    return ("void plastic lamp_paint 0 0 5 0.78 0.78 0.78 0 0\n"
            f"void illum lamp 1 lamp_paint 0 3 {radiance} {radiance} {radiance}\nlamp polygon light 0 0 12 {numbers}\n")


def contenders(args):
    own = [Own(args, ["--renderer", "radiosity", *options]) for options in RADIOSITY]
    own += [Own(args, ["--renderer", "path", "--spp", str(args.path_spp)])]
    if "radiance" not in args.skip:
        home = binaries(sys.executable)
        own += [Radiance(args, home, *settings) for settings in RADIANCE]
        own += [Radiance(args, home, None, USUAL)] if args.usual else []
    if "mitsuba" not in args.skip:
        own += [Mitsuba(args)]
    return own


def summary(contender, runs):
    keys = ["mean_delta_e00_off_edges", "p95_delta_e00_off_edges", "mean_delta_e00_all", "p95_delta_e00_all", "luminance_ratio"]
    row = {"name": contender.name}
    row |= {key: statistics.median(run[key] for run in runs) for key in ("wall", "cpu", "render")}
    row["wall_range"] = [min(run["wall"] for run in runs), max(run["wall"] for run in runs)]
    row |= {key: statistics.fmean(run[key] for run in runs) for key in keys}
    # NaN fails too.
    luminous = not isinstance(contender, Own) or abs(row["luminance_ratio"] - 1) <= 0.01
    close = not contender.radiosity or row["mean_delta_e00_off_edges"] <= 1.5
    row["passed"] = (luminous and close) if isinstance(contender, Own) else None
    return row


def table(rows):
    width = max(len(row["name"]) for row in rows)
    head = f"{'':{width}} {'wall s':>8} {'(least–most)':>15} {'CPU s':>8} {'render':>8} | {'ΔE00':>6} {'p95':>6} | {'all':>6} {'p95':>6} | luminance"
    print(head)
    for row in rows:
        spread = "({:.2f}–{:.2f})".format(*row["wall_range"])
        print(f"{row['name']:{width}} {row['wall']:8.3f} {spread:>15} {row['cpu']:8.3f} {row['render']:8.3f} | "
              f"{row['mean_delta_e00_off_edges']:6.2f} {row['p95_delta_e00_off_edges']:6.2f} | "
              f"{row['mean_delta_e00_all']:6.2f} {row['p95_delta_e00_all']:6.2f} | {100 * (row['luminance_ratio'] - 1):+.2f} %"
              + {True: "  ok", False: "  MISSED", None: ""}[row["passed"]])


def in_turns(args, entries, truth, how):
    """Renders with all contenders round by round, compares with the truth, and writes the table and the figures; the exit code."""
    import mitsuba as mi

    summary, table = how
    runs = [[] for _ in entries]
    for seed in range(args.rounds):
        for entry, results in zip(entries, runs):
            picture, wall, cpu, render = entry.render(seed)
            # The truth first: edges are its own. Its luminance is then the numerator.
            result = compare(truth, picture)
            result["luminance_ratio"] = 1 / result["luminance_ratio"]
            results.append(result | {"wall": wall, "cpu": cpu, "render": render})
            print(f"round {seed}: {entry.name}: {wall:.2f} s, p95 {result['p95_delta_e00_all']:.2f}", file=sys.stderr)
    rows = [summary(entry, results) for entry, results in zip(entries, runs)]
    table(rows)
    report = json.dumps({"rounds": args.rounds, "size": args.size, "threads": args.threads or os.cpu_count(),
                         "mitsuba": mi.__version__, "rows": rows}, indent=1, ensure_ascii=False)
    if args.json:
        args.json.write_text(report + "\n")
    else:
        print(report)
    return 0 if all(row["passed"] is not False for row in rows) else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", type=pathlib.Path, required=True, help="the true picture, linear sRGB, OpenEXR")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--threads", type=int, default=0, help="threads of each; 0: all cores")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "spectral")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "peers" / "cornell-time")
    parser.add_argument("--skip", default="", help="contenders to leave out: radiance, mitsuba")
    parser.add_argument("--path-spp", type=int, default=84)
    parser.add_argument("--mitsuba-spp", type=int, default=384)
    parser.add_argument("--mitsuba-variant", default="scalar_spectral")
    parser.add_argument("--usual", action="store_true", help="Radiance with -aa .15 -ad 256 too, which takes long")
    parser.add_argument("--radiance-spp", type=int, default=1)
    parser.add_argument("--json", type=pathlib.Path, help="a file for the figures")
    args = parser.parse_args()
    args.work, args.skip = args.work.resolve(), args.skip.split(",")
    args.work.mkdir(parents=True, exist_ok=True)
    args.program = args.program.resolve()
    measured([args.program, "scene", "cornell-box", "--export", args.work / "scene"])
    args.scene = args.work / "scene" / "cornell-box.xml"

    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    truth = read_exr(args.truth)
    assert truth.shape == (args.size, args.size, 3), truth.shape
    args.lamp = truth.mean(axis=2) > 0.5 * truth.max()
    entries = contenders(args)
    return in_turns(args, entries, truth, (summary, table))


if __name__ == "__main__":
    sys.exit(main())
