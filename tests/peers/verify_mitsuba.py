#!/usr/bin/env python3
"""Computes the cases of `spectral verify` with Mitsuba 3 and has the answers scored.

    python3 tests/peers/verify_mitsuba.py [--program target/release/spectral] [--work DIR] [--variant scalar_spectral]
        [--spp 4096] [--limit 20] [CASE ...]

Needs the Python package mitsuba. For each point a radiance meter looks at a white patch. What the variant makes of a flat
intensity of 1, seen on a white surface 1 m away, is divided out. Of cases with more points than --limit none is
computed. Answers go to DIR/mitsuba.csv; the exit status is that of `spectral verify --score`. Monte Carlo noise is about
1 % at the default number of samples, so failures against tolerances of 0.1 % are expected: the table shows what accuracy the
time bought. Time per point does not include loading the scene.
"""
import argparse
import math
import pathlib
import subprocess
import sys
import time

import mitsuba as mi
import numpy as np

from verify_radiance import ROOT, judge

FLAT = """<scene version="3.0.0"><integrator type="direct"/><shape type="rectangle"><bsdf type="diffuse"><spectrum name="reflectance"
value="1"/></bsdf></shape><emitter type="point"><point name="position" x="0" y="0" z="1"/><spectrum name="intensity" value="1"/>
</emitter><sensor type="radiancemeter"><transform name="to_world"><lookat origin="0, 0, 0.5" target="0, 0, 0" up="0, 1, 0"/>
</transform><sampler type="independent"><integer name="sample_count" value="262144"/></sampler><film type="hdrfilm"><integer
name="width" value="1"/><integer name="height" value="1"/><string name="pixel_format" value="luminance"/><rfilter type="box"/>
</film></sensor></scene>"""


def pixel(image):
    return float(np.array(image).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "spectral")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "target" / "verify-mitsuba")
    parser.add_argument("--variant", default="scalar_spectral")
    parser.add_argument("--spp", type=int, default=4096)
    parser.add_argument("--limit", type=int, default=20)
    parser.add_argument("cases", nargs="*")
    args = parser.parse_args()
    mi.set_variant(args.variant)
    flat = math.pi * pixel(mi.render(mi.load_string(FLAT)))
    print(f"{args.variant}: a flat spectrum of 1 is read as {flat:.5f}")
    subprocess.run([args.program, "verify", *args.cases, "--export", args.work], check=True, stdout=subprocess.DEVNULL)
    names = [line.split(",")[:2] for line in (args.work / "points.csv").read_text().splitlines()[1:]]
    lines, seconds = ["case,point,value"], {}
    for case in dict.fromkeys(case for case, _ in names):
        points = [point for owner, point in names if owner == case]
        if len(points) > args.limit:
            continue
        places = (args.work / case / "places.txt").read_text().splitlines()
        seconds[case] = 0.0
        for seed, (point, place) in enumerate(zip(points, places, strict=True)):
            scene = mi.load_file(str(args.work / case / "scene.xml"), spp=args.spp, place=place)
            start = time.perf_counter()
            value = math.pi * pixel(mi.render(scene, seed=seed)) / flat
            seconds[case] += (time.perf_counter() - start) / len(points)
            lines.append(f"{case},{point},{value!r}")
    answers = args.work / "mitsuba.csv"
    answers.write_text("\n".join(lines) + "\n")
    return judge(args.program, args.cases, answers, "Mitsuba", seconds)


if __name__ == "__main__":
    sys.exit(main())
