#!/usr/bin/env python3
"""Computes the cases of `spectral verify` with Mitsuba 3 and has the answers scored.

    python3 tests/peers/verify_mitsuba.py [--program target/release/spectral] [--work DIR] [--variant scalar_spectral]
        [--spp 65536] [--limit 20] [CASE ...]

Needs the Python package mitsuba. Each point is an irradiance meter of the exported scene. What the variant makes of a flat
radiance of 1 is measured on a meter under a constant sky and divided out. Of cases with more points than --limit none is
computed. Answers go to DIR/mitsuba.csv; the exit status is that of `spectral verify --score`. Monte Carlo noise at the
default number of samples is 0.1 to 1 %, so failures against tolerances of 0.1 % are expected: the table shows what accuracy
the time bought.
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

SKY = """<scene version="3.0.0"><integrator type="path"/><emitter type="constant"><spectrum name="radiance" value="1"/></emitter>
<shape type="rectangle"><sensor type="irradiancemeter"><sampler type="independent"><integer name="sample_count" value="262144"/>
</sampler><film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><string name="pixel_format"
value="luminance"/><rfilter type="box"/></film></sensor></shape></scene>"""


def pixel(image):
    return float(np.array(image).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "target" / "release" / "spectral")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "target" / "verify-mitsuba")
    parser.add_argument("--variant", default="scalar_spectral")
    parser.add_argument("--spp", type=int, default=65536)
    parser.add_argument("--limit", type=int, default=20)
    parser.add_argument("cases", nargs="*")
    args = parser.parse_args()
    mi.set_variant(args.variant)
    flat = pixel(mi.render(mi.load_string(SKY))) / math.pi
    print(f"{args.variant}: a flat radiance of 1 is read as {flat:.5f}")
    subprocess.run([args.program, "verify", *args.cases, "--export", args.work], check=True, stdout=subprocess.DEVNULL)
    names = [line.split(",")[:2] for line in (args.work / "points.csv").read_text().splitlines()[1:]]
    lines, seconds = ["case,point,value"], {}
    for case in dict.fromkeys(case for case, _ in names):
        points = [point for owner, point in names if owner == case]
        if len(points) > args.limit:
            continue
        scene = mi.load_file(str(args.work / case / "scene.xml"), spp=args.spp)
        # Mitsuba does not keep the file's order.
        order = {sensor.id(): index for index, sensor in enumerate(scene.sensors())}
        start = time.perf_counter()
        for point in points:
            index = order["point-" + point.replace(".", "_")]
            value = pixel(mi.render(scene, sensor=index, seed=index)) / flat
            lines.append(f"{case},{point},{value!r}")
        seconds[case] = (time.perf_counter() - start) / len(points)
    answers = args.work / "mitsuba.csv"
    answers.write_text("\n".join(lines) + "\n")
    return judge(args.program, args.cases, answers, "Mitsuba", seconds)


if __name__ == "__main__":
    sys.exit(main())
