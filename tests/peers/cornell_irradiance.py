"""Illuminances at points of the Cornell box with all interreflections, by Mitsuba 3 (path tracing, irradiancemeter).

    spectral scene cornell-box --export DIR
    python cornell_irradiance.py DIR/cornell-box.xml POINTS.csv [SAMPLES [RUNS]]

POINTS.csv has x, y, z, nx, ny, nz on each line. Prints lux, with the standard deviation of the mean over the runs (1e6 samples, 16 runs by
default; about a minute for each point). Mitsuba's Y is relative to its integral of the observer, 106.7503 nm; 1.001 is by how much its direct
light from this lamp is more than the exact one.
"""

import math
import pathlib
import re
import statistics
import sys

import mitsuba as mi

mi.set_variant("scalar_spectral")

LUX = 683.002 * 106.7503 / 1.001
PATH = '<integrator type="path"><integer name="max_depth" value="-1"/></integrator>'


def with_meter(xml, point, samples):
    """The scene with one small black meter at a point."""
    x, y, z, nx, ny, nz = point
    up = "0 0 1" if abs(nz) < 0.9 else "0 1 0"
    meter = f"""
    <shape type="rectangle">
      <transform name="to_world">
        <scale value="0.01"/>
        <lookat origin="{x} {y} {z}" target="{x + nx} {y + ny} {z + nz}" up="{up}"/>
      </transform>
      <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf>
      <sensor type="irradiancemeter">
        <sampler type="independent"><integer name="sample_count" value="{samples}"/></sampler>
        <film type="hdrfilm">
          <integer name="width" value="1"/><integer name="height" value="1"/>
          <string name="pixel_format" value="xyz"/><rfilter type="box"/>
        </film>
      </sensor>
    </shape>"""
    xml = re.sub(r'<sensor type="perspective">.*?</sensor>', "", xml, flags=re.S)
    xml = re.sub(r"<default[^>]*/>", "", xml)
    xml = re.sub(r'<integrator type="(path|direct)"/>', PATH, xml)
    return xml.replace("</scene>", meter + "</scene>")


def main():
    scene, points = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    samples = int(sys.argv[3]) if len(sys.argv) > 3 else 1_000_000
    runs = int(sys.argv[4]) if len(sys.argv) > 4 else 16
    # The scene's files are found relative to it.
    changed = scene.with_name("cornell-irradiance.xml")
    for line in points.read_text().splitlines():
        point = [float(value) for value in line.split(",")]
        changed.write_text(with_meter(scene.read_text(), point, samples))
        loaded = mi.load_file(str(changed))
        found = [LUX * mi.render(loaded, seed=seed).numpy()[0, 0, 1] for seed in range(runs)]
        print(line, f"{statistics.mean(found):.1f} ± {statistics.stdev(found) / math.sqrt(runs):.1f} lx", flush=True)
    changed.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
