#!/usr/bin/env python3
"""Renders a built-in scene with Mitsuba 3 (`direct`, spectral) and with this project from the same XML file, and compares.

    python3 tests/peers/mitsuba_direct.py [--scene cornell-box] [--spp 1024] [--size 512] [--work DIR]

Mitsuba is installed from PyPI into a virtual environment under the work folder. Reported, and checked with an exit status
of 1: the mean ΔE00 over pixels that are not on edges (0.5 at most), and the ratio of the pictures' total luminance (0.5 %
at most). A pixel is on an edge where this project's picture differs from one of its eight neighbours by more than 10 % in
luminance or by more than 0.02 in chromaticity x or y.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import venv

ROOT = pathlib.Path(__file__).resolve().parents[2]


def environment(folder: pathlib.Path) -> pathlib.Path:
    python = folder / "venv" / "bin" / "python"
    if not python.exists():
        venv.create(folder / "venv", with_pip=True)
    needed = ["mitsuba==3.9.1", "numpy", "colour-science==0.4.7", "scipy"]
    subprocess.run([python, "-m", "pip", "install", "-q", *needed], check=True)
    return python


def spectral(*arguments: object) -> None:
    command = ["cargo", "run", "-q", "--release", "--", *map(str, arguments)]
    subprocess.run(command, cwd=ROOT, check=True)


def outer(args: argparse.Namespace) -> int:
    work = args.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    python = environment(work)
    spectral("scene", args.scene, "--export", work / "scene")
    spectral("render", work / "scene" / f"{args.scene}.xml", "--size", f"{args.size}x{args.size}",
             "--spp", args.own_spp, "--threshold", "0.1", "--out", work)
    inner = [python, __file__, "--inner", "--scene", args.scene, "--spp", args.spp, "--size", args.size, "--work", work]
    return subprocess.run(list(map(str, inner))).returncode


def inner(args: argparse.Namespace) -> int:
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_spectral")
    scene = mi.load_file(str(args.work / "scene" / f"{args.scene}.xml"), resolution=str(args.size))
    image, step = None, 64
    for seed in range(max(1, args.spp // step)):
        part = np.array(mi.render(scene, spp=step, seed=seed), dtype=np.float64)[:, :, :3]
        image = part if image is None else image + part
    theirs = image / max(1, args.spp // step)
    own = next(args.work.glob(f"{args.scene}-interval.exr"))
    # Channels come in the file's order: take R, G, B by name.
    bitmap = mi.Bitmap(str(own))
    names = [field.name for field in bitmap.struct_()]
    data = np.array(bitmap, dtype=np.float64)
    ours = np.stack([data[:, :, names.index(c)] for c in "RGB"], axis=2)
    report = compare(ours, theirs)
    report |= {"scene": args.scene, "spp": args.spp, "mitsuba": mi.__version__}
    print(json.dumps(report))
    return 0 if report["mean_delta_e00_off_edges"] < 0.5 and abs(report["luminance_ratio"] - 1) < 0.005 else 1


def compare(ours, theirs) -> dict:
    import colour
    import numpy as np

    matrix = np.array(colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ)
    xyz = [picture @ matrix.T for picture in (ours, theirs)]
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    lab = [colour.XYZ_to_Lab(np.maximum(v, 0), white) for v in xyz]
    delta = colour.difference.delta_E_CIE2000(lab[0], lab[1])
    luminance = xyz[0][:, :, 1]
    chromaticity = xyz[0] / np.maximum(xyz[0].sum(axis=2, keepdims=True), 1e-6)
    edge = np.zeros(luminance.shape, dtype=bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            other = np.roll(luminance, (dy, dx), axis=(0, 1))
            edge |= np.abs(other - luminance) > 0.1 * np.maximum(np.maximum(other, luminance), 1e-6)
            moved = np.roll(chromaticity, (dy, dx), axis=(0, 1))
            edge |= (np.abs(moved - chromaticity)[:, :, :2] > 0.02).any(axis=2)
    edge[[0, -1], :] = edge[:, [0, -1]] = True
    inside = delta[~edge]
    return {
        "mean_delta_e00_off_edges": float(inside.mean()),
        "p95_delta_e00_off_edges": float(np.percentile(inside, 95)),
        "max_delta_e00_off_edges": float(inside.max()),
        "mean_delta_e00_all": float(delta.mean()),
        "p95_delta_e00_all": float(np.percentile(delta, 95)),
        "edge_share": float(edge.mean()),
        "luminance_ratio": float(xyz[0][:, :, 1].sum() / xyz[1][:, :, 1].sum()),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="cornell-box")
    parser.add_argument("--spp", type=int, default=1024, help="Mitsuba's samples per pixel")
    parser.add_argument("--own-spp", type=int, default=16, help="this project's camera rays per pixel")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "peers")
    parser.add_argument("--inner", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    return inner(args) if args.inner else outer(args)


if __name__ == "__main__":
    sys.exit(main())
