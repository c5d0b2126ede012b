//! What the renderer does where numbers, depths and caches end.
#![allow(clippy::unwrap_used, reason = "a test stops at the first thing that should not be")]

use core::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use renderers::image::read_exr;
use renderers::render::{Options, Rendering, Spectra, render};
use renderers::scene::{Source, load};
use renderers::spectral::IntervalSettings;
use spectral_core::adaptive::Status;
use spectral_core::subdivision::Subdivision;
use spectral_tests::program;

/// A camera that looks along +z at a white wall 10 units away, and whatever `body` adds.
fn scene(integrator: &str, side: u32, body: &str) -> String {
    format!(
        r#"<scene version="3.0.0">
  {integrator}
  <sensor type="perspective"><float name="fov" value="40"/>
    <film type="hdrfilm"><integer name="width" value="{side}"/><integer name="height" value="{side}"/>
      <rfilter type="box"/></film></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="20"/><rotate y="1" angle="180"/>
      <translate z="10"/></transform></shape>
  {body}
</scene>"#
    )
}

fn rendered(xml: &str) -> Result<Rendering, String> {
    let scene = load(&Source::text("limits.xml", xml), &[]).map_err(|e| e.to_string())?;
    let spectra = Spectra::Interval(IntervalSettings::default());
    render(&scene, &Options { spectra, samples: Some(1), ..Options::default() }, &|_| {}).map_err(|e| e.to_string())
}

const LIGHT: &str = r#"<emitter type="point"><point name="position" x="0" y="3" z="0"/>
    <spectrum name="intensity" value="20"/></emitter>"#;

#[test]
fn a_subdivision_without_stages_knows_nothing() {
    let found = Subdivision::from_stages(&[], [1.0_f64; 3], Status::DepthExhausted).at_scale(1.0);
    assert!(found.delta_e == f64::INFINITY && found.radius == [f64::INFINITY; 3]);
}

#[test]
fn light_beyond_the_range_of_numbers_has_no_bound() {
    let body = r#"<emitter type="point"><point name="position" x="0" y="0" z="9.999"/>
        <spectrum name="intensity" value="1.7e308"/></emitter>"#;
    let found = rendered(&scene("", 8, body)).unwrap();
    assert!(found.picture.pixels().iter().flatten().all(|v| v.is_finite()));
    let bounds = found.delta_e.unwrap();
    let unknown = bounds.pixels().iter().filter(|bound| **bound == f32::MAX).count();
    assert!(unknown > 0, "{:?}", bounds.pixels());
    // A pixel that is black for want of knowledge says so.
    for (pixel, bound) in found.picture.pixels().iter().zip(bounds.pixels()) {
        assert!(*pixel != [0.0; 3] || *bound == f32::MAX);
    }
}

#[test]
fn the_depth_of_a_path_counts() {
    let mirror = r#"<shape type="sphere"><float name="radius" value="2"/><point name="center" x="0" y="0" z="6"/>
        <bsdf type="conductor"/></shape>"#;
    let body = format!("{mirror}{LIGHT}");
    let rays = |depth: u32| {
        let integrator = format!(r#"<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>"#);
        rendered(&scene(&integrator, 16, &body)).map(|found| found.rays)
    };
    assert_eq!(rays(2).unwrap(), 16 * 16);
    assert!(rays(3).unwrap() > 16 * 16);
    assert!(rays(1).unwrap_err().contains("max_depth"));
}

/// Spheres of gold that mirror each other make more products of spectra than are remembered.
#[test]
fn what_is_forgotten_of_products_does_not_change_a_picture() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("render_limits");
    std::fs::create_dir_all(&folder).unwrap();
    let mut body = LIGHT.to_owned();
    for i in 0..18 {
        let (x, y, z) = (f64::from(i % 6) * 1.6 - 4.0, f64::from(i / 6) * 1.6 - 1.6, 8.0 + f64::from(i % 2));
        write!(
            body,
            r#"<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/><float name="radius" value="0.75"/>
               <bsdf type="conductor"><string name="material" value="Au"/></bsdf></shape>"#
        )
        .unwrap();
    }
    let file = folder.join("gold.xml");
    std::fs::write(&file, scene("", 128, &body)).unwrap();
    let picture = |threads: &str| {
        let out: PathBuf = folder.join(threads);
        let run = Command::new(program::spectral(env!("CARGO_TARGET_TMPDIR")))
            .args(["render", "--spp", "4", "--threads", threads, "--out"])
            .args([&out, &file])
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        read_exr(&out.join("gold-interval.exr")).unwrap()
    };
    assert!(picture("1") == picture("3"));
}
