#!/usr/bin/env python3
"""Time that a prism's spectrum takes: the scene prism by this project, whose glass has its measured index, and by POV-Ray 3.7, in turns.

    python3 tests/peers/prism_time.py [--rounds 5] [--size 320] [--photons 30000] [--shot 200000] [--threads N]
                                      [--program target/release/spectral] [--povray povray] [--pictures DIR]

To be run where POV-Ray is installed (a package of most distributions). It has the same surfaces, camera and parallel light, RGB paints, and the
ratio of violet's to red's index in place of a glass, with 31 samples of built-in hues; both take one ray a pixel and no light between surfaces. POV-Ray
shoots photons at all of the prism, of which the slit lets some through, and this project at the slit: 235 000 of the first become about as
many paths through the prism as 30 000 of the second, each in 31 colours. Times are the least over rounds, from start to picture on disk.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

SCENE = """#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level 8 photons {{ count {shot} autostop 0 max_trace_level 8 }} }}
camera {{ perspective location <-7, 7.5, 6.5> sky z up z right -x angle 31 look_at <2.4, -4.1, 0> }}
light_source {{ <-103, 0, 11.5> rgb 3 parallel point_at <-3, 0, 1.5> photons {{ reflection on refraction on }} }}
#declare Dull = finish {{ ambient 0 diffuse 1 }}
#declare Blocker = texture {{ pigment {{ rgb <0.1, 0.3, 0.1> }} finish {{ Dull }} }}
polygon {{ 5, <-12, -7, 0>, <16, -7, 0>, <16, 11, 0>, <-12, 11, 0>, <-12, -7, 0> pigment {{ rgb 0.5 }} finish {{ Dull }} }}
polygon {{ 5, <-3, -7, 0>, <9, -7, 0>, <9, -7, 2>, <-3, -7, 2>, <-3, -7, 0> pigment {{ rgb 0.8 }} finish {{ Dull }} }}
polygon {{ 5, <-3, -7, 0>, <-3, -0.05, 0>, <-3, -0.05, 3>, <-3, -7, 3>, <-3, -7, 0> texture {{ Blocker }} }}
polygon {{ 5, <-3, 0.05, 0>, <-3, 1.25, 0>, <-3, 1.25, 3>, <-3, 0.05, 3>, <-3, 0.05, 0> texture {{ Blocker }} }}
prism {{
  linear_sweep 0.001, 3.001, 4, <-1.154701, -0.5>, <0.577350, -1.5>, <0.577350, 0.5>, <-1.154701, -0.5>
  matrix <1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0>
  pigment {{ rgbt 1 }} finish {{ ambient 0 diffuse 0 reflection {{ 0, 1 fresnel on }} conserve_energy }}
  interior {{ ior 1.728 dispersion 1.034 dispersion_samples 31 }}
  photons {{ target reflection on refraction on collect off }}
}}
"""


def timed(command):
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(list(map(str, command)), capture_output=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr.decode(errors='replace')}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--size", type=int, default=320)
    parser.add_argument("--photons", type=int, default=30_000, help="this project's, through the slit")
    parser.add_argument("--shot", type=int, default=200_000, help="POV-Ray's, at the prism")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("target/release/spectral"))
    parser.add_argument("--povray", default="povray")
    parser.add_argument("--pictures", type=pathlib.Path, help="where pictures stay, to be looked at")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        home = args.pictures or pathlib.Path(scratch)
        home.mkdir(parents=True, exist_ok=True)
        scene = home / "prism.pov"
        scene.write_text(SCENE.format(shot=args.shot))
        entries = {
            f"own photon-map, {args.photons} photons": [
                args.program, "render", "prism", "--renderer", "photon-map", "--between", "ambient", "--size",
                f"{args.size}x{args.size}", "--spp", 1, "--photons", args.photons, "--threads", args.threads, "--out", home],
            f"POV-Ray, {args.shot} photons": [
                args.povray, f"+I{scene}", f"+O{home / 'povray.png'}", f"+W{args.size}", f"+H{args.size}", "-D",
                f"+WT{args.threads}"],
        }
        runs = {name: [] for name in entries}
        for _ in range(args.rounds):
            for name, command in entries.items():
                runs[name].append(timed(command))
    print(f"{'':32} wall s  CPU s")
    for name, times in runs.items():
        print(f"{name:32} {min(wall for wall, _ in times):6.2f} {min(cpu for _, cpu in times):6.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
