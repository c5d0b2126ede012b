#!/usr/bin/env python3
"""Time that a caustic takes: the Cornell box with a glass sphere by this project, by Radiance's photon map and by Mitsuba 3, in turns.

    python3 tests/peers/glass_time.py [--truth PICTURE.exr ...] [--weights N ...] [--truth-seconds S] [--truth-spp N] [--rounds 5]
                                      [--size 256] [--threads N] [--program target/release/spectral] [--work DIR]
                                      [--skip radiance,mitsuba] [--path-spp N] [--mitsuba-spp N[,N]] [--json FILE]

To be run with a Python that has Mitsuba, NumPy, SciPy, colour-science and pyradiance (whose programs Radiance is). The truth is the weighted mean of linear sRGB
pictures of the same size; without any, `cargo run -p spectral-tests --bin caustic_truth` makes one: caustics by light tracing,
all other light by path tracing. In each round every contender renders once, each as a process of its own
from start to picture on disk, seeded by the round. Radiance throws photons anew each time and then gathers them, in RGB (paints as the linear sRGB
of their colour under D65); its lamp is an ordinary light, which reflects nothing, and the sphere a dielectric. Its time is that of both
programs. Mitsuba's time holds the start of Python and the import, and once more without them in the column "render".
Wall-clock and processor times are medians over rounds, differences of colour and luminance are means; ΔE00 is over all pixels.

Exit status 1 if a photon map of this project misses a 95th percentile of 5 over all pixels, or the truth's luminance by 1 %.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np

from cornell_time import Mitsuba, Own, Radiance, in_turns, lamp, measured, read_exr
from mitsuba_direct import ROOT
from verify_radiance import binaries

SCENE = "cornell-box-glass"
OWN = [["--accuracy", "0.1", "--spp", "1"], ["--accuracy", "0.1", "--spp", "4"]]
# Global and caustic photons, photons of an estimate, the final gather, camera rays a pixel: the fastest found by trial near a 95th percentile of 10,
# and below 5.
RADIANCE = [(10_000, 50_000, 50, "-aa 0 -ad 8", 1), (20_000, 100_000, 50, "-aa .3 -ar 16 -ad 128", 1)]


class PhotonMap(Radiance):
    """Radiance's: direct light by shadow rays, caustics from their own map, all other light by a gather of the global map."""

    def __init__(self, args, home, settings):
        self.settings = settings
        super().__init__(args, home, None, "")
        everywhere, caustic, near, gather, spp = settings
        self.name = f"Radiance photon map, {everywhere} + {caustic} photons, {near} nearest, {gather}, {spp} spp"

    def material(self, bsdf, base):
        if bsdf.get("type") != "dielectric":
            return super().material(bsdf, base)
        index = next(number.get("value") for number in bsdf.findall("float") if number.get("name") == "int_ior")
        defaults = ElementTree.parse(self.args.scene).getroot().findall("default")
        index = {f"${default.get('name')}": default.get("value") for default in defaults}.get(index, index)
        return f"void dielectric {bsdf.get('id')} 0 0 5 1 1 1 {index} 0\n"

    def shape(self, shape, base):
        if shape.get("type") == "sphere":
            middle, radius = shape.find("point").get("value"), shape.find("float").get("value")
            return f"{shape.find('ref').get('id')} sphere {shape.get('id')} 0 0 4 {middle} {radius}\n"
        if shape.get("type") == "obj":
            return super().shape(shape, base)
        # An illum would reflect, but no photons come from it.
        self.radiance = float(shape.find("emitter/spectrum/float").get("value"))
        numbers = lamp(shape).split("polygon light ")[1]
        return f"void light lamp 0 0 3 {self.radiance:g} {self.radiance:g} {self.radiance:g}\nlamp polygon light {numbers}"

    def render(self, seed):
        args, (everywhere, caustic, near, gather, spp) = self.args, self.settings
        threads, size = args.threads or os.cpu_count(), str(args.size)
        octree, out = self.folder / "scene.oct", self.folder / "picture.float"
        maps = [self.folder / "global.pm", self.folder / "caustic.pm"]
        throw = [self.home / "bin" / "mkpmap", "-fo+", "-n", threads, "-apr", seed + 1, "-apg", maps[0], everywhere,
                 "-apc", maps[1], caustic, octree]
        rays = [self.home / "bin" / "vwrays", "-ff", "-x", size, "-y", size, "-c", spp, "-pj", "1", *self.view]
        trace = [self.home / "bin" / "rtrace", "-w-", "-h", "-fff", "-n", threads, "-dj", "0.7", "-ds", "0.1", "-dt", "0",
                 "-lw", "1e-4", "-lr", "8", "-ab", "1", "-as", "0", *gather.split(), "-ap", maps[0], near,
                 "-ap", maps[1], near, octree]
        line = " ".join(map(str, throw)) + " && " + " ".join(map(str, rays)) + " | " + " ".join(map(str, trace)) + f" > {out}"
        _, wall, cpu = measured(["/bin/sh", "-c", line], env=self.environment)
        data = np.fromfile(out, dtype=np.float32).astype(float).reshape(args.size, args.size, spp, 3).mean(axis=2)
        return data, wall, cpu, wall


def truth(args):
    """The weighted mean of the pictures given; without any, one is made."""
    pictures = args.truth
    if not pictures:
        pictures = [args.work / "truth.exr"]
        subprocess.run(["cargo", "run", "-q", "--release", "-p", "spectral-tests", "--bin", "caustic_truth", "--", SCENE,
                        str(pictures[0]), "--size", f"{args.size}x{args.size}", "--seconds", str(args.truth_seconds),
                        "--samples", str(args.truth_spp)], cwd=ROOT, check=True)
    weights = args.weights or [1] * len(pictures)
    assert len(weights) == len(pictures), "a weight for each picture"
    mean = sum(weight * read_exr(path) for weight, path in zip(weights, pictures)) / sum(weights)
    assert mean.shape == (args.size, args.size, 3), mean.shape
    return mean


def contenders(args):
    own = [Own(args, ["--renderer", "photon-map", *options]) for options in OWN]
    own += [Own(args, ["--renderer", "path", "--spp", str(args.path_spp)])]
    if "radiance" not in args.skip:
        home = binaries(sys.executable)
        own += [PhotonMap(args, home, settings) for settings in RADIANCE]
    if "mitsuba" not in args.skip:
        for spp in args.mitsuba_spp.split(","):
            args.mitsuba_spp = int(spp)
            own.append(Mitsuba(argparse.Namespace(**vars(args))))
    return own


def summary(contender, runs):
    keys = ["mean_delta_e00_all", "p95_delta_e00_all", "luminance_ratio"]
    row = {"name": contender.name}
    row |= {key: statistics.median(run[key] for run in runs) for key in ("wall", "cpu", "render")}
    row["wall_range"] = [min(run["wall"] for run in runs), max(run["wall"] for run in runs)]
    row |= {key: statistics.fmean(run[key] for run in runs) for key in keys}
    # NaN fails too.
    passed = row["p95_delta_e00_all"] <= 5 and abs(row["luminance_ratio"] - 1) <= 0.01
    row["passed"] = passed if "photon-map" in contender.name else None
    return row


def table(rows):
    width = max(len(row["name"]) for row in rows)
    print(f"{'':{width}} {'wall s':>8} {'(least–most)':>15} {'CPU s':>8} {'render':>8} | {'ΔE00':>6} {'p95':>6} | luminance")
    for row in rows:
        spread = "({:.2f}–{:.2f})".format(*row["wall_range"])
        print(f"{row['name']:{width}} {row['wall']:8.3f} {spread:>15} {row['cpu']:8.3f} {row['render']:8.3f} | "
              f"{row['mean_delta_e00_all']:6.2f} {row['p95_delta_e00_all']:6.2f} | {100 * (row['luminance_ratio'] - 1):+.2f} %"
              + {True: "  ok", False: "  MISSED", None: ""}[row["passed"]])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--truth", type=pathlib.Path, nargs="*", default=[], help="true pictures, linear sRGB, OpenEXR")
    parser.add_argument("--weights", type=float, nargs="*", help="how much each counts")
    parser.add_argument("--truth-seconds", type=float, default=120, help="of light tracing, if there are none")
    parser.add_argument("--truth-spp", type=int, default=4096, help="of path tracing, if there are none")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--threads", type=int, default=0, help="threads of each; 0: all cores")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "spectral")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "peers" / "glass-time")
    parser.add_argument("--skip", default="", help="contenders to leave out: radiance, mitsuba")
    parser.add_argument("--path-spp", type=int, default=64)
    parser.add_argument("--mitsuba-spp", default="256")
    parser.add_argument("--mitsuba-variant", default="llvm_ad_spectral")
    parser.add_argument("--radiance-spp", type=int, default=1, help=argparse.SUPPRESS)
    parser.add_argument("--json", type=pathlib.Path, help="a file for the figures")
    args = parser.parse_args()
    args.work, args.skip = args.work.resolve(), args.skip.split(",")
    args.work.mkdir(parents=True, exist_ok=True)
    args.program = args.program.resolve()
    measured([args.program, "scene", SCENE, "--export", args.work / "scene"])
    args.scene = args.work / "scene" / f"{SCENE}.xml"

    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    true = truth(args)
    entries = contenders(args)
    return in_turns(args, entries, true, (summary, table))


if __name__ == "__main__":
    sys.exit(main())
