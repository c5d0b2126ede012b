//! Defaults, references and world-space geometry.

use glam::DVec3;

use super::*;

const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='60'/></sensor>";

fn read(body: &str) -> Scene {
    let xml = format!("<scene version='3.0.0'>{SENSOR}{body}</scene>");
    load(&Source::text("s.xml", xml), &[]).unwrap_or_else(|error| unreachable!("{error}"))
}

#[track_caller]
fn assert_near(a: DVec3, b: DVec3) {
    let err = (a - b).length();
    assert!(err <= 1e-12 * (1.0 + b.length()), "{a} is not {b}");
}

#[test]
fn what_a_scene_leaves_out_is_as_in_mitsuba() {
    let scene = read("<shape type='sphere'><emitter type='area'/></shape>");
    assert_eq!(scene.name, "s");
    assert_eq!(scene.integrator, Integrator::Path { max_depth: None, rr_depth: 5 });
    let film = Film { width: 768, height: 576, filter: Filter::Gaussian { stddev: 0.5 } };
    assert_eq!((scene.film, scene.sampler), (film, Sampler { sample_count: 4, seed: 0 }));
    assert_eq!((scene.camera.near_clip, scene.camera.far_clip), (1e-2, 1e4));
    assert_eq!(
        scene.shapes[0].geometry,
        Geometry::Sphere { center: DVec3::ZERO, radius: 1.0, inward: false, axis: DVec3::Z }
    );
    let BsdfKind::Diffuse { reflectance } = scene.bsdf(scene.shapes[0].bsdf).kind else { unreachable!() };
    assert_eq!(scene.spectrum(reflectance).kind, SpectrumKind::Constant(0.5));
    let Emitter::Area { shape: ShapeId(0), radiance } = scene.emitters[0] else { unreachable!() };
    assert_eq!(scene.shapes[0].emitter, Some(EmitterId(0)));
    assert_eq!(scene.spectrum(radiance).kind, SpectrumKind::D65 { scale: 1.0 });
}

#[test]
fn default_conductors_are_mirrors_and_default_dielectrics_bk7_in_air() {
    let scene = read("<bsdf type='conductor'/><bsdf type='dielectric'/><bsdf type='schlick'/>");
    assert!(matches!(scene.bsdfs[0].kind, BsdfKind::Conductor { fresnel: ConductorFresnel::Perfect, .. }));
    let BsdfKind::Dielectric { int_ior, ext_ior, absorption, .. } = &scene.bsdfs[1].kind else { unreachable!() };
    assert_eq!((int_ior, ext_ior, absorption), (&Ior::Constant(1.5046), &Ior::Constant(1.000_277), &None));
    assert!(matches!(scene.bsdfs[2].kind, BsdfKind::Schlick { roughness: 1.0, isotropy: 1.0, .. }));
}

#[test]
fn highlights_have_the_defaults_of_mitsuba_0_6() {
    let scene = read(
        "<bsdf type='ward'/><bsdf type='ward'><string name='variant' value='ward-duer'/><float name='alpha' value='0.3'/>\
         </bsdf><bsdf type='ward'><float name='alpha_v' value='0.3'/></bsdf>",
    );
    let found = |i: usize| match scene.bsdfs[i].kind {
        BsdfKind::Ward { variant, alpha_u, alpha_v, specular_reflectance, diffuse_reflectance } => {
            let [s, d] = [specular_reflectance, diffuse_reflectance].map(|id| scene.spectrum(id).kind.clone());
            assert_eq!((s, d), (SpectrumKind::Constant(0.2), SpectrumKind::Constant(0.5)));
            (variant, alpha_u, alpha_v)
        }
        _ => unreachable!(),
    };
    assert_eq!(found(0), (WardVariant::Balanced, 0.1, 0.1));
    assert_eq!(found(1), (WardVariant::WardDuer, 0.3, 0.3));
    assert_eq!(found(2), (WardVariant::Balanced, 0.1, 0.3));
}

#[test]
fn indices_go_by_number_name_glass_or_spectrum() {
    let ior = |property: &str| {
        let scene = read(&format!("<bsdf type='dielectric'>{property}</bsdf>"));
        let BsdfKind::Dielectric { int_ior, .. } = &scene.bsdfs[0].kind else { unreachable!() };
        int_ior.clone()
    };
    assert_eq!(ior("<float name='int_ior' value='1.7'/>"), Ior::Constant(1.7));
    assert_eq!(ior("<string name='int_ior' value='Water Ice'/>"), Ior::Constant(1.31));
    assert_eq!(ior("<string name='int_ior' value='bk7'/>"), Ior::Constant(1.5046));
    assert_eq!(ior("<string name='int_ior' value='N-BK7'/>"), Ior::Glass("N-BK7".into()));
    assert!(matches!(ior("<spectrum name='int_ior' value='300:1.6, 800:1.5'/>"), Ior::Spectrum(_)));
}

#[test]
fn references_point_forward_and_back_to_one_material() {
    let scene = read(
        "<shape type='disk'><ref id='paint'/></shape>
         <bsdf type='twosided' id='both'><ref id='paint'/><bsdf type='conductor'/></bsdf>
         <bsdf type='diffuse' id='paint'><ref name='reflectance' id='tone'/></bsdf>
         <shape type='cube'><ref name='bsdf' id='paint'/></shape>
         <shape type='cube'><ref id='both'/></shape>
         <spectrum type='uniform' id='tone'><float name='value' value='0.25'/></spectrum>",
    );
    assert_eq!(scene.bsdfs.len(), 3);
    let paint = scene.shapes[0].bsdf;
    assert_eq!(scene.shapes[1].bsdf, paint);
    let BsdfKind::TwoSided { front, back } = scene.bsdf(scene.shapes[2].bsdf).kind else { unreachable!() };
    assert!(front == paint && back != paint);
    let BsdfKind::Diffuse { reflectance } = scene.bsdf(paint).kind else { unreachable!() };
    assert_eq!(scene.spectrum(reflectance).kind, SpectrumKind::Constant(0.25));
    assert_eq!(scene.bsdf(paint).label, "paint (s.xml:3)");
}

#[test]
fn equal_spectra_are_one() {
    let scene = read(
        "<bsdf type='diffuse'/>
         <bsdf type='diffuse'><float name='reflectance' value='0.5'/></bsdf>
         <bsdf type='diffuse'><rgb name='reflectance' value='0.5 0.5 0.5'/></bsdf>
         <bsdf type='diffuse'><spectrum name='reflectance' value='400:0.1, 500:0.2'/></bsdf>
         <bsdf type='diffuse'><spectrum name='reflectance' type='regular'>
           <float name='wavelength_min' value='400'/><float name='wavelength_max' value='500'/>
           <string name='values' value='0.1 0.2'/></spectrum></bsdf>
         <bsdf type='diffuse'><spectrum name='reflectance' type='irregular'>
           <string name='wavelengths' value='400 500'/><string name='values' value='0.1, 0.2'/></spectrum></bsdf>",
    );
    let table = SpectrumKind::Table { wavelengths: vec![400.0, 500.0], values: vec![0.1, 0.2] };
    let kinds: Vec<_> = scene.spectra.iter().map(|spectrum| spectrum.kind.clone()).collect();
    assert_eq!(kinds, [SpectrumKind::Constant(0.5), table]);
    assert_eq!(scene.spectra[1].label, "reflectance (s.xml:4)");
}

#[test]
fn bare_numbers_of_lights_are_multiples_of_d65_and_spectra_are_not() {
    let scene = read(
        "<emitter type='constant'><float name='radiance' value='2'/></emitter>
         <emitter type='ambient'><rgb name='radiance' value='2'/></emitter>
         <emitter type='point'><spectrum name='intensity' value='2'/></emitter>
         <emitter type='directional'><spectrum name='irradiance' type='blackbody'>
           <float name='temperature' value='3000'/></spectrum></emitter>",
    );
    let planck =
        SpectrumKind::Blackbody { temperature: 3000.0, scale: 1.0, wavelength_min: 360.0, wavelength_max: 830.0 };
    let kinds: Vec<_> = scene.spectra.iter().map(|spectrum| spectrum.kind.clone()).collect();
    assert_eq!(kinds, [SpectrumKind::D65 { scale: 2.0 }, SpectrumKind::Constant(2.0), planck]);
    let first = SpectrumId(0);
    assert_eq!(
        scene.emitters[..2],
        [
            Emitter::Constant { radiance: first, label: "constant (s.xml:1)".into() },
            Emitter::Ambient { radiance: first }
        ]
    );
}

#[test]
fn lights_stand_and_point_where_they_are_told() {
    let scene = read(
        "<emitter type='point'><transform name='to_world'><translate y='3'/></transform></emitter>
         <emitter type='point'><point name='position' x='1' y='2' z='3'/></emitter>
         <emitter type='directional'><transform name='to_world'><rotate x='1' angle='90'/></transform></emitter>
         <emitter type='directional'><vector name='direction' value='0 0 -4'/></emitter>",
    );
    let [
        Emitter::Point { position: a, .. },
        Emitter::Point { position: b, .. },
        Emitter::Directional { direction: c, .. },
        Emitter::Directional { direction: d, .. },
    ] = scene.emitters[..]
    else {
        unreachable!()
    };
    assert_near(a, DVec3::new(0.0, 3.0, 0.0));
    assert_near(b, DVec3::new(1.0, 2.0, 3.0));
    assert_near(c, DVec3::NEG_Y);
    assert_near(d, DVec3::NEG_Z);
}

#[test]
fn flat_shapes_keep_their_front_under_mirroring_and_lose_it_by_flipping() {
    let mirror = "<transform name='to_world'><scale x='-2' y='3'/><translate z='1'/></transform>";
    let scene = read(&format!(
        "<shape type='rectangle'>{mirror}</shape>
         <shape type='rectangle'>{mirror}<boolean name='flip_normals' value='true'/></shape>
         <shape type='disk'><transform name='to_world'><scale value='2'/><rotate y='1' angle='90'/></transform></shape>"
    ));
    for (shape, front) in [(0, DVec3::Z), (1, DVec3::NEG_Z)] {
        let Geometry::Rectangle { center, half_u, half_v, normal } = scene.shapes[shape].geometry else {
            unreachable!()
        };
        assert_near(center, DVec3::Z);
        assert_near(half_u, DVec3::new(-2.0, 0.0, 0.0));
        assert_near(half_v, DVec3::new(0.0, 3.0, 0.0));
        assert_near(normal, front);
        assert!((scene.shapes[shape].geometry.area() - 24.0).abs() <= 1e-12);
    }
    let Geometry::Disk { center, radius, normal } = scene.shapes[2].geometry else { unreachable!() };
    assert_near(center, DVec3::ZERO);
    assert_near(normal, DVec3::X);
    assert!((radius - 2.0).abs() <= 1e-15);
}

#[test]
fn spheres_move_and_grow_with_their_transform_and_mirroring_turns_them_inside_out() {
    let sphere = |scale: &str, flip: &str| {
        let scene = read(&format!(
            "<shape type='sphere'><point name='center' value='1 0 0'/><float name='radius' value='2'/>
             <transform name='to_world'><rotate z='1' angle='90'/><scale value='{scale}'/><translate y='1'/></transform>
             <boolean name='flip_normals' value='{flip}'/></shape>"
        ));
        let Geometry::Sphere { center, radius, inward, .. } = scene.shapes[0].geometry else { unreachable!() };
        assert!((radius - 6.0).abs() <= 1e-14);
        (center, inward)
    };
    let (center, inward) = sphere("-3", "false");
    assert_near(center, DVec3::new(0.0, -2.0, 0.0));
    assert!(inward && sphere("3", "true").1 && sphere("3 3 -3", "false").1);
    assert!(!sphere("3", "false").1 && !sphere("-3", "true").1 && !sphere("-3 -3 3", "false").1);
}

/// Six times the volume that a closed mesh encloses: positive if its front is outside.
fn signed_volume(geometry: &Geometry) -> f64 {
    let Geometry::Mesh(mesh) = geometry else { unreachable!() };
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)[0].dot(mesh.face_cross(t))).sum()
}

#[test]
fn cubes_are_closed_and_face_outward_even_mirrored() {
    let cube = |inside: &str| read(&format!("<shape type='cube'>{inside}</shape>")).shapes.remove(0).geometry;
    let plain = cube("");
    assert!((signed_volume(&plain) - 48.0).abs() <= 1e-12 && (plain.area() - 24.0).abs() <= 1e-12);
    let Geometry::Mesh(mesh) = &plain else { unreachable!() };
    for t in 0..mesh.triangles.len() {
        let centroid: DVec3 = mesh.corners(t).iter().sum();
        assert!(mesh.face_cross(t).dot(centroid) > 0.0, "triangle {t} faces inward");
    }
    let mirrored = "<transform name='to_world'><scale x='-1'/></transform>";
    assert!((signed_volume(&cube(mirrored)) - 48.0).abs() <= 1e-12);
    assert!((signed_volume(&cube("<boolean name='flip_normals' value='true'/>")) + 48.0).abs() <= 1e-12);
}

#[test]
fn the_field_of_view_spans_the_axis_it_names() {
    let half_width = |axis: &str, width, height| {
        let sensor = format!(
            "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='90'/>
             <string name='fov_axis' value='{axis}'/></sensor></scene>"
        );
        let scene = load(&Source::text("s.xml", sensor), &[]).unwrap_or_else(|error| unreachable!("{error}"));
        scene.camera.half_width(width, height)
    };
    for (axis, wide, tall) in [("x", 1.0, 1.0), ("y", 2.0, 0.5), ("smaller", 2.0, 1.0), ("larger", 1.0, 0.5)] {
        assert!((half_width(axis, 200, 100) - wide).abs() <= 1e-12, "{axis}");
        assert!((half_width(axis, 100, 200) - tall).abs() <= 1e-12, "{axis}");
    }
    // Width 4 and height 3 have a diagonal of 5, here with half-length tan 45° = 1.
    assert!((half_width("diagonal", 400, 300) - 0.8).abs() <= 1e-12);
}
