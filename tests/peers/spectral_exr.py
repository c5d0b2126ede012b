#!/usr/bin/env python3
"""Reads back with other programs what `spectral render --spectral-exr --hdr` writes, and the other way round.

    python3 tests/peers/spectral_exr.py [--spectral target/release/spectral] [--venv DIR]

Installs colour-science and OpenImageIO into a virtual environment (first run only), then checks

- that colour-science's reader of the layout of Fichet et al. 2021 finds the wavelengths, the attributes and, through its own
  colour-matching functions, the colours of the picture that was rendered (the R, G, B of the ordinary EXR);
- that `spectral map --from` measures a file that colour-science has written as colour-science measures its spectra: luminance
  and colour temperature, for lamps in emissive images of 5 nm and of 10 nm;
- that OpenImageIO and, if it is there, pyradiance read the Radiance file as the picture, within its precision.

Exits with 1 if one of them fails. Not part of the test suite.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import venv
import warnings

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = ["numpy>=2.2,<2.4", "scipy", "colour-science==0.4.7", "OpenImageIO==3.2.2.0"]
FAILED = []


def check(name, found, limit):
    print(f"{'ok  ' if found <= limit else 'FAIL'} {name}: {found:.3g} (at most {limit:g})")
    if not found <= limit:
        FAILED.append(name)


def run(spectral, *arguments):
    done = subprocess.run([spectral, *map(str, arguments), "--json"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{arguments}: {done.stderr}")
    return json.loads(done.stdout)


def pixels(path):
    """The R, G, B of an EXR, by OpenImageIO."""
    import numpy
    import OpenImageIO

    picture = OpenImageIO.ImageBuf(str(path))
    names = list(picture.spec().channelnames)
    values = picture.get_pixels(OpenImageIO.FLOAT)
    return numpy.stack([values[..., names.index(c)] for c in "RGB"], axis=-1).astype(float)


def reads_ours(spectral, folder, channels):
    """colour-science on a file of ours."""
    import colour
    import numpy
    from colour.io import read_spectral_image_Fichet2021

    spectra = ["--spectra", "uniform:40"] if channels == "40" else ["--threshold", "0.02"]
    out = folder / f"ours{channels}"
    answer = run(spectral, "render", "cornell-box-lamp", "--size", "64x48", "--spp", "4", "--spectral-exr", channels,
                 *spectra, "--out", out)
    files = {name.rsplit("-", 1)[-1]: name for name in answer["files"]}
    components, specification = read_spectral_image_Fichet2021(files["spectral.exr"], additional_data=True)
    attributes = {a.name: a.value for a in specification.attributes}
    check(f"{channels}: layout and unit", float((attributes.get("spectralLayoutVersion"), attributes.get("emissiveUnits"))
                                                != ("1.0", "W.m^-2.sr^-1")), 0)
    wavelengths, radiance = components["S0"]
    expected = numpy.arange(380, 781, 5.0) if channels == "5nm" else 385 + 10.0 * numpy.arange(40)
    check(f"{channels}: wavelengths in nm", float(numpy.abs(wavelengths - expected).max()), 0)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    if channels == "5nm":
        weights = 5.0 * observer[wavelengths]
    else:
        fine = numpy.arange(380, 780, 0.1) + 0.05
        weights = 0.1 * observer[fine].reshape(40, 100, 3).sum(axis=1)
    xyz = radiance.astype(float) @ weights / 106.85639928288
    ours = next(name for name in answer["files"] if name.endswith(".exr") and "spectral.exr" not in name)
    rgb = xyz @ numpy.linalg.inv(colour.models.RGB_COLOURSPACE_BT709.matrix_RGB_to_XYZ).T
    truth = pixels(ours)
    # The bound of intervals is absolute, so that darkness may be off by more.
    off = numpy.abs(rgb - truth).max(axis=-1) / numpy.maximum(truth.max(axis=-1), 0.01 * truth.max())
    # Bins are the very picture; 5 nm are sums where the picture has integrals, within ΔE*ab 0.02.
    check(f"{channels}: colours, relative, all pixels", float(off.max()), 1e-3 if channels == "40" else 2e-3)
    preview = pixels(files["spectral.exr"])
    check(f"{channels}: preview against the picture", float(numpy.abs(preview - truth).max()), 0)


def writes_theirs(spectral, folder, step):
    """A file of colour-science's, whose pixels are lamps."""
    import colour
    import numpy
    from colour.io import write_spectral_image_Fichet2021
    from colour.temperature import uv_to_CCT_Ohno2013

    lamps = ["FL2", "FL7", "FL11", "A", "D65"]
    shape = colour.SpectralShape(380, 780, step)
    values = numpy.stack([colour.SDS_ILLUMINANTS[lamp].copy().align(shape).values * 1e-3 for lamp in lamps])
    image = numpy.repeat(values[None], 3, axis=0)
    path = folder / f"theirs{step}.exr"
    specification = colour.io.Specification_Fichet2021(is_emissive=True)
    if not write_spectral_image_Fichet2021({"S0": (shape.wavelengths, image)}, str(path), "float32", specification=specification):
        sys.exit("colour-science can't write its own file")
    run(spectral, "map", "--from", path, "--quantity", "luminance,cct", "--out", folder)
    import OpenImageIO

    maps = OpenImageIO.ImageBuf(str(folder / f"theirs{step}-map.exr"))
    names = list(maps.spec().channelnames)
    found = {name: maps.get_pixels(OpenImageIO.FLOAT)[1, :, names.index(name)] for name in names}
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(colour.SpectralShape(380, 780, 5))
    for index, lamp in enumerate(lamps):
        fine = numpy.interp(observer.wavelengths, shape.wavelengths, values[index])
        xyz = 5 * fine @ observer.values
        check(f"{step} nm, {lamp}: luminance", abs(found["luminance"][index] / (683.002 * xyz[1]) - 1), 1e-5)
        uv = colour.UCS_to_uv(colour.XYZ_to_UCS(xyz / xyz[1]))
        cct = uv_to_CCT_Ohno2013(uv, start=1500, end=12000)[0]
        # Ohno's table is of a black body at 1 nm with another c2.
        check(f"{step} nm, {lamp}: colour temperature", abs(found["cct"][index] / cct - 1), 1e-3)


def radiance_file(spectral, folder):
    import numpy

    answer = run(spectral, "render", "cornell-box-lamp", "--size", "64x48", "--spp", "4", "--hdr", "--spectra", "rgb",
                 "--out", folder)
    hdr = next(name for name in answer["files"] if name.endswith(".hdr"))
    truth = numpy.maximum(pixels(next(name for name in answer["files"] if name.endswith(".exr"))), 0)
    limit = truth.max(axis=-1, keepdims=True) / 128 + 1e-9
    check("OpenImageIO: error by the largest component / 128", float((numpy.abs(pixels(hdr) - truth) / limit).max()), 1)
    try:
        import pyradiance
    except ImportError:
        return
    values = numpy.frombuffer(pyradiance.pvalue(hdr, header=False, resstr=False, outform="f"), dtype=numpy.float32)
    values = values.reshape(48, 64, 3).astype(float)
    check("pyradiance: error by the largest component / 128", float((numpy.abs(values - truth) / limit).max()), 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--spectral", default=str(ROOT / "target/release/spectral"))
    parser.add_argument("--venv", default=str(ROOT / "target/peers"))
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    python = pathlib.Path(arguments.venv) / "bin/python"
    if not arguments.inside:
        if not python.exists():
            venv.create(arguments.venv, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "-q", *PACKAGES], check=True)
        command = [python, __file__, "--inside", "--spectral", arguments.spectral, "--venv", arguments.venv]
        sys.exit(subprocess.run(command, check=False).returncode)
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for channels in ["5nm", "40"]:
            reads_ours(arguments.spectral, folder, channels)
        for step in [5, 10]:
            writes_theirs(arguments.spectral, folder, step)
        radiance_file(arguments.spectral, folder)
    sys.exit(1 if FAILED else 0)


if __name__ == "__main__":
    main()
