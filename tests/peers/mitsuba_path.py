#!/usr/bin/env python3
"""Renders a built-in scene with all interreflections by Mitsuba 3 (`path`, scalar_spectral) and by this project's path tracer from
the same XML file, in turns, and compares pictures and speed.

    python3 tests/peers/mitsuba_path.py [--scene cornell-box] [--spp 1024] [--rounds 4] [--size 128] [--threads N]
                                        [--python PYTHON] [--program target/release/spectral] [--work DIR]

Mitsuba is installed from PyPI into a virtual environment under the work folder, unless `--python` names one that has it. Its Y of a flat
radiance is 1.001 (its ∫ȳ is a sum at 5 nm over 360–830 nm), so that its luminance is divided by that. Reported, and checked with an
exit status of 1: the mean ΔE00 over pixels that are not on edges (1 at most), the ratio of the pictures' total luminance (within
1 %), and whether it is within four standard errors of 1, which are made of the differences between rounds.
"""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import time

from mitsuba_direct import ROOT, compare, environment, spectral

FLAT_LUMINANCE = 1.001


def outer(args: argparse.Namespace) -> int:
    work = args.work.resolve()
    work.mkdir(parents=True, exist_ok=True)
    python = args.python or environment(work)
    if args.program is None:
        spectral("scene", args.scene, "--export", work / "scene")
        args.program = ROOT / "target" / "release" / "spectral"
    else:
        subprocess.run([args.program, "scene", args.scene, "--export", work / "scene"], check=True, stdout=subprocess.DEVNULL)
    inner = [python, __file__, "--inner", "--program", args.program.resolve(), "--work", work]
    for name in ("scene", "spp", "rounds", "size", "threads"):
        inner += [f"--{name}", getattr(args, name)]
    return subprocess.run(list(map(str, inner))).returncode


def own_round(args: argparse.Namespace, seed: int):
    import mitsuba as mi
    import numpy as np

    command = [args.program, "render", args.work / "scene" / f"{args.scene}.xml", "--renderer", "path", "--json",
               "--size", f"{args.size}x{args.size}", "--spp", args.spp // args.rounds, "--seed", seed, "--out", args.work]
    if args.threads:
        command += ["--threads", args.threads]
    report = json.loads(subprocess.run(list(map(str, command)), check=True, capture_output=True).stdout)
    bitmap = mi.Bitmap(str(args.work / f"{args.scene}-path-uniform81.exr"))
    # Channels come in the file's order: take R, G, B by name.
    names = [field.name for field in bitmap.struct_()]
    data = np.array(bitmap, dtype=np.float64)
    return np.stack([data[:, :, names.index(c)] for c in "RGB"], axis=2), report


def children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def luminance(picture):
    import numpy as np

    return picture @ np.array([0.2126, 0.7152, 0.0722])


def relative_error(totals) -> float:
    import numpy as np

    return float(np.std(totals, ddof=1) / np.sqrt(len(totals)) / np.mean(totals))


def inner(args: argparse.Namespace) -> int:
    import drjit
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_spectral")
    if args.threads:
        drjit.set_thread_count(args.threads)
    scene = mi.load_file(str(args.work / "scene" / f"{args.scene}.xml"), resolution=str(args.size))
    integrator = mi.load_dict({"type": "path", "max_depth": -1})
    ours, theirs, seconds, cpu, rays = [], [], [0.0, 0.0], [0.0, 0.0], 0
    for seed in range(args.rounds):
        start = children()
        picture, report = own_round(args, seed)
        cpu[0] += children() - start
        ours.append(picture)
        seconds[0] += report["seconds"]
        rays += report["rays"]
        start, cpu_start = time.perf_counter(), time.process_time()
        picture = mi.render(scene, integrator=integrator, spp=args.spp // args.rounds, seed=seed)
        theirs.append(np.array(picture, dtype=np.float64)[:, :, :3] / FLAT_LUMINANCE)
        seconds[1] += time.perf_counter() - start
        cpu[1] += time.process_time() - cpu_start
    totals = [[luminance(p).sum() for p in pictures] for pictures in (ours, theirs)]
    errors = [relative_error(t) for t in totals]
    report = compare(np.mean(ours, axis=0), np.mean(theirs, axis=0))
    noise = [float(np.mean(np.std([luminance(p) for p in pictures], axis=0, ddof=1)) / np.sqrt(args.rounds))
             for pictures in (ours, theirs)]
    samples = args.size * args.size * args.spp
    report |= {
        "scene": args.scene, "spp": args.spp, "size": args.size, "mitsuba": mi.__version__,
        "luminance_ratio_standard_error": float(np.hypot(*errors)),
        "pixel_standard_error": noise,
        "million_samples_per_second": [samples / s / 1e6 for s in seconds],
        # Of processor time: what else the machine does counts for less.
        "million_samples_per_cpu_second": [samples / s / 1e6 for s in cpu],
        "own_million_rays_per_cpu_second": rays / cpu[0] / 1e6,
        "own_million_rays_per_second": rays / seconds[0] / 1e6,
    }
    print(json.dumps(report, indent=1))
    off = abs(report["luminance_ratio"] - 1)
    good = off <= 0.01 and off <= 4 * report["luminance_ratio_standard_error"]
    return 0 if good and report["mean_delta_e00_off_edges"] <= 1 else 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", default="cornell-box")
    parser.add_argument("--spp", type=int, default=1024, help="samples per pixel of each, over all rounds")
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--threads", type=int, default=0, help="threads of each; 0: all cores")
    parser.add_argument("--python", type=pathlib.Path, help="a Python that has Mitsuba, NumPy and colour-science")
    parser.add_argument("--program", type=pathlib.Path, help="the `spectral` program; built if not given")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out" / "peers")
    parser.add_argument("--inner", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    return inner(args) if args.inner else outer(args)


if __name__ == "__main__":
    sys.exit(main())
