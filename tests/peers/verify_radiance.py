#!/usr/bin/env python3
"""Computes the cases of `spectral verify` with Radiance's rtrace and has the answers scored.

    python3 tests/peers/verify_radiance.py [--program target/release/spectral] [--work DIR] [--python PYTHON] [CASE ...]

Radiance comes from the Python package pyradiance, which holds its programs; PYTHON is an interpreter that has it (this one by
default). For each case the settings are those of the thesis where it gives them, for 5.8 the fastest good one found
(path tracing with Russian roulette: within 0.3 % up to a reflectance of 0.95, 1 to 3 s for 400 points). Under area lights each point is a run of
its own: in Radiance 6.0a a receiver whose horizon cuts a disk light makes the same light vanish for later points. Time per
point is wall-clock time less that of a run without points; short runs are repeated on copies of a point. One table on
stdout; answers in DIR/radiance.csv; the exit status is that of `spectral verify --score`.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
DIRECT = ["-ab", "0", "-dt", "0", "-dj", "0", "-ds", "0.02"]
ONE_BOUNCE = ["-ab", "1", "-aa", "0", "-ad", "100000", "-lw", "0", "-lr", "1"]
ALL_BOUNCES = ["-ab", "400", "-aa", "0", "-ad", "8", "-lw", "1e-3", "-lr", "-400", "-dt", "0"]


def settings(case):
    if case.startswith(("cie-171.5.6", "cie-171.5.7")) and not case.endswith("-shining"):
        return ONE_BOUNCE
    return ALL_BOUNCES if case.startswith(("cie-171.5.8", "cie-171.4")) else DIRECT


def binaries(python):
    find = "import pyradiance, pathlib; print(pathlib.Path(pyradiance.__file__).parent)"
    return pathlib.Path(subprocess.run([python, "-c", find], check=True, capture_output=True, text=True).stdout.strip())


def trace(home, octree, points, options):
    environment = dict(os.environ, RAYPATH=f"{home / 'lib'}:.")
    start = time.perf_counter()
    done = subprocess.run([home / "bin" / "rtrace", "-I", "-h", *options, octree], input=points, text=True,
                          capture_output=True, check=True, env=environment)
    return [float(line.split()[0]) for line in done.stdout.splitlines()], time.perf_counter() - start


def compute(home, folder, case):
    """Illuminances at the points of a case, and seconds per point."""
    octree = folder / "scene.oct"
    with open(octree, "wb") as out:
        subprocess.run([home / "bin" / "oconv", folder / "scene.rad"], stdout=out, check=True, stderr=subprocess.DEVNULL)
    points, options = (folder / "points.txt").read_text().splitlines(keepends=True), settings(case)
    empty = min(trace(home, octree, "", options)[1] for _ in range(3))
    if options is not DIRECT or len(points) > 40:
        values, full = trace(home, octree, "".join(points), options)
        return values, (full - empty) / len(points)
    values, total, copies = [], 0.0, 2000
    for point in points:
        values += trace(home, octree, point, options)[0]
        total += min(trace(home, octree, point * copies, options)[1] for _ in range(2)) - empty
    return values, max(total, 0.0) / (copies * len(points))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "spectral")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "target" / "verify-radiance")
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("cases", nargs="*")
    args = parser.parse_args()
    home = binaries(args.python)
    subprocess.run([args.program, "verify", *args.cases, "--export", args.work], check=True, stdout=subprocess.DEVNULL)
    names = [line.split(",")[:2] for line in (args.work / "points.csv").read_text().splitlines()[1:]]
    lines, seconds = ["case,point,value"], {}
    for case in dict.fromkeys(case for case, _ in names):
        folder = args.work / case
        if not (folder / "scene.rad").exists():
            continue
        values, seconds[case] = compute(home, folder, case)
        points = [point for owner, point in names if owner == case]
        assert len(values) == len(points), case
        lines += [f"{case},{point},{value!r}" for point, value in zip(points, values)]
    answers = args.work / "radiance.csv"
    answers.write_text("\n".join(lines) + "\n")
    return judge(args.program, args.cases, answers, "Radiance", seconds)


def judge(program, cases, answers, who, seconds):
    """Has a file of answers scored, prints them, and returns the exit status."""
    score = [program, "verify", *cases, "--score", answers, "--json"]
    judged = subprocess.run(score, capture_output=True, text=True)
    if judged.returncode not in (0, 1):
        sys.exit(judged.stderr)
    result = json.loads(judged.stdout)
    print(f"{'check':48} {'reference':>12} {who:>12} {'error':>10} {'s/point':>10}  status")
    for row in result["cases"]:
        case = max((name for name in seconds if row["name"].startswith(name + ".")), key=len, default=None)
        if case is None or row["computed"] is None or row["name"].endswith((".printed", ".cie")):
            continue
        error = "" if row["relative_error"] is None else f"{100 * row['relative_error']:+.3f} %"
        print(f"{row['name']:48} {row['reference']:12.6g} {row['computed']:12.6g} {error:>10} {seconds[case]:10.2e}  "
              f"{row['status']}")
    print({key: result[key] for key in ("passed", "failed", "skipped", "informative")})
    return judged.returncode


if __name__ == "__main__":
    sys.exit(main())
