"""Round trips and time of sigmoid upsampling by other software, in linear sRGB under D65 (Jakob and Hanika 2019).

    python tests/peers/upsampling_peers.py

Needs numpy, colour-science (0.4.7 was used) and mitsuba (3.9.1). Both are judged on their own terms: colour-science, which
solves, by its own integrals; Mitsuba, which looks up a table, by CIE tables at 1 nm over 380-780 nm with white made (1, 1, 1).
"""

import pathlib
import time
import warnings

import numpy as np

warnings.filterwarnings("ignore")
import colour  # noqa: E402
import mitsuba  # noqa: E402
from colour.recovery import jakob2019  # noqa: E402

DATA = pathlib.Path(__file__).resolve().parents[2] / "spectral-core" / "data"


def table(name):
    lines = [line for line in (DATA / name).read_text().splitlines() if not line.startswith("#")]
    return np.array([[float(cell) if cell else np.nan for cell in line.split(",")] for line in lines[1:]])


def cube(count):
    steps = np.linspace(0, 1, count)
    return [np.array([r, g, b]) for r in steps for g in steps for b in steps]


def colour_science(count):
    shape = jakob2019.SPECTRAL_SHAPE_JAKOB2019
    light = colour.SDS_ILLUMINANTS["D65"].copy().align(shape)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    space = colour.RGB_COLOURSPACES["sRGB"]
    errors, seconds = [], 0.0
    for rgb in cube(count):
        if rgb.min() == rgb.max():
            continue
        xyz = colour.RGB_to_XYZ(rgb, space, apply_cctf_decoding=False)
        start = time.perf_counter()
        spectrum = jakob2019.XYZ_to_sd_Jakob2019(xyz, observer, light)
        seconds += time.perf_counter() - start
        back = colour.XYZ_to_RGB(colour.sd_to_XYZ(spectrum, observer, light) / 100, space, apply_cctf_encoding=False)
        errors.append(abs(back - rgb).max())
    print(f"colour-science: {len(errors)} colours, worst {max(errors):.2e}, {1e3 * seconds / len(errors):.1f} ms each")


def mitsuba_table(count):
    mitsuba.set_variant("llvm_ad_spectral")
    observer = table("cie_1931_2deg_cmf_1nm.csv")
    observer = observer[(observer[:, 0] >= 380) & (observer[:, 0] <= 780)]
    lights = table("cie_illuminants_A_D50_D55_D65_D75_C_5nm.csv")
    wavelength = observer[:, 0]
    lit = observer[:, 1:] * np.interp(wavelength, lights[:, 0], lights[:, 2])[:, None]
    weights = lit @ colour.RGB_COLOURSPACES["sRGB"].matrix_XYZ_to_RGB.T
    weights /= weights.sum(0)
    worst = 0.0
    for rgb in cube(count):
        quadratic, linear, constant = np.array(mitsuba.srgb_model_fetch(list(rgb))).ravel()
        u = (quadratic * wavelength + linear) * wavelength + constant
        with np.errstate(all="ignore"):
            values = np.where(np.isinf(u), (np.sign(u) + 1) / 2, 0.5 + 0.5 * u / np.sqrt(1 + u * u))
        worst = max(worst, abs(weights.T @ values - rgb).max())
    print(f"Mitsuba's table: {count**3} colours, worst {worst:.2e}")


colour_science(4)
mitsuba_table(32)
