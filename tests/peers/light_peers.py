#!/usr/bin/env python3
"""Compares `spectral light` with colour-science and luxpy for all FL, HP and LED lamps, A, C and the D series.

    python3 tests/peers/light_peers.py [--spectral target/release/spectral] [--venv DIR]

Installs both peers into a virtual environment (first run only) and prints, lamp by lamp, how far their colour temperature,
Duv, R_a and special indices are from those of `spectral light`: as the packages come, and, for colour-science, brought to
the convention of `spectral light`: sums over 380-780 nm at 5 nm for the light, the samples and the Planckian locus, a
finely searched colour temperature, and factors M1, M2 of daylight that are not rounded; for luxpy without its rounding of
chromaticities to four decimals and of special indices to whole numbers before their mean. Not part of the test suite.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import venv
import warnings

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = ["numpy>=2.2,<2.4", "scipy", "matplotlib", "setuptools<80", "colour-science==0.4.7", "luxpy==1.12.5"]
FILES = [
    "cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv",
    "cie_fl1_fl12_5nm.csv",
    "cie_fl3_1_fl3_15_5nm.csv",
    "cie_hp1_hp5_5nm.csv",
    "cie_led_illuminants_5nm.csv",
]


def lamps():
    """Name and {wavelength: power} over 380-780 nm of each lamp, from the tables of the crate."""
    for file in FILES:
        with open(ROOT / "spectral-core/data" / file, encoding="utf-8") as lines:
            rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        for name in list(rows[0])[1:]:
            powers = {int(row["wavelength_nm"]): float(row[name]) for row in rows if row[name]}
            yield name, {nm: powers[nm] for nm in range(380, 781, 5)}


class Colour:
    """colour-science, as it comes or in the convention of `spectral light`."""

    def __init__(self, same_grid):
        import colour
        from colour.quality import cri
        from colour.temperature import uv_to_CCT_Ohno2013, uv_to_CCT_Robertson1968

        self.colour, self.cri = colour, cri
        shape = colour.SpectralShape(380, 780, 5)
        cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy()
        if not hasattr(cri, "plain"):
            cri.plain = (cri.SPECTRAL_SHAPE_DEFAULT, uv_to_CCT_Robertson1968, cri.sd_CIE_illuminant_D_series)
        default_shape, robertson, daylight = cri.plain
        if same_grid:
            cmfs = cmfs.align(shape)
            self.cct = lambda uv: uv_to_CCT_Ohno2013(uv, cmfs=cmfs, start=1000, end=25000, spacing=1.0003)
            self.settings = (shape, self.cct, lambda xy: daylight(xy, M1_M2_rounding=False))
        else:
            self.cct = robertson
            self.settings = (default_shape, robertson, daylight)

    def measure(self, powers):
        self.cri.SPECTRAL_SHAPE_DEFAULT, self.cri.uv_to_CCT_Robertson1968, self.cri.sd_CIE_illuminant_D_series = (
            self.settings
        )
        colour = self.colour
        light = colour.SpectralDistribution(powers)
        xyz = colour.sd_to_XYZ(light.values, shape=light.shape, method="Integration")
        cct, duv = self.cct(colour.models.UCS_to_uv(colour.XYZ_to_UCS(xyz)))
        found = self.cri.colour_rendering_index(light, additional_data=True)
        return cct, duv, found.Q_a, [found.Q_as[i].Q_a for i in sorted(found.Q_as)]


class Luxpy:
    """luxpy as it comes, or without its rounding."""

    def __init__(self, rounded):
        import luxpy
        import numpy

        self.luxpy, self.numpy, self.rounded = luxpy, numpy, rounded

    def measure(self, powers):
        luxpy, numpy = self.luxpy, self.numpy
        spd = numpy.array([list(powers), list(powers.values())], dtype=float)
        xyz = luxpy.spd_to_xyz(spd, cieobs="1931_2")
        cct, duv = luxpy.xyz_to_cct(xyz, cieobs="1931_2", out="cct,duv", mode="ohno2014")
        for kind in ("ciera", "ciera-14"):
            luxpy.cri._CRI_DEFAULTS[kind]["cri_specific_pars"]["round_xy_to"] = 4 if self.rounded else None
        ra = luxpy.cri.spd_to_cri(spd, cri_type="ciera", out="Rf")
        special = numpy.ravel(luxpy.cri.spd_to_cri(spd, cri_type="ciera-14", out="Rfi"))
        if not self.rounded:
            ra = numpy.mean(special[:8])
        scalar = lambda value: float(numpy.ravel(value)[0])
        return scalar(cct), scalar(duv), scalar(ra), [float(r) for r in special]


def differences(ours, theirs):
    cct, duv, ra, special = theirs
    worst = max((abs(a - b), i + 1) for i, (a, b) in enumerate(zip(special, ours["r"])))
    return cct - ours["cct"], (duv - ours["duv"]) * 1e5, ra - ours["ra"], worst


def compare(spectral):
    peers = {"colour-science": Colour(False), "the same, 5 nm": Colour(True), "luxpy": Luxpy(True), "luxpy, not rounded": Luxpy(False)}
    print("differences to spectral light: CCT (K), Duv (1e-5), R_a, largest of R_1-R_14 (which)")
    print(f"{'lamp':9}{'CCT':>8}{'R_a':>8}" + "".join(f" | {name:^36}" for name in peers))
    worst = {name: [0.0] * 4 for name in peers}
    seconds = dict.fromkeys(peers, 0.0)
    count = 0
    for name, powers in lamps():
        answer = subprocess.run([spectral, "light", name, "--json"], check=True, capture_output=True)
        ours = json.loads(answer.stdout)
        line = f"{name:9}{ours['cct']:8.1f}{ours['ra']:8.3f}"
        for peer, implementation in peers.items():
            start = time.perf_counter()
            theirs = implementation.measure(powers)
            seconds[peer] += time.perf_counter() - start
            cct, duv, ra, (special, index) = differences(ours, theirs)
            line += f" | {cct:+9.3f}{duv:+9.3f}{ra:+9.4f}{special:7.3f}{index:2d}"
            for k, value in enumerate((cct, duv, ra, special)):
                worst[peer][k] = max(worst[peer][k], abs(value))
        print(line, flush=True)
        count += 1
    print("largest, and time of CCT and R_a a lamp")
    for peer, (cct, duv, ra, special) in worst.items():
        each = seconds[peer] / count * 1e6
        print(f"{peer:16} CCT {cct:.4f} K  Duv {duv:.4f}e-5  R_a {ra:.5f}  R_i {special:.5f}  {each:.0f} us")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spectral", type=pathlib.Path, default=ROOT / "target/release/spectral")
    parser.add_argument("--venv", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()) / "light_peers")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.inside:
        warnings.simplefilter("ignore")
        compare(arguments.spectral)
        return
    python = arguments.venv / "bin/python"
    if not python.exists():
        venv.create(arguments.venv, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    command = [python, __file__, "--inside", "--spectral", arguments.spectral]
    sys.exit(subprocess.run(command, check=False).returncode)


if __name__ == "__main__":
    main()
