//! Bad scenes: each is refused with the line at fault and a message that says why, and nothing panics.
#![allow(clippy::panic, reason = "how helpers of tests fail")]

use renderers::scene::{Scene, SceneError, Source, builtin, load};

const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='40'/></sensor>";
const MESH: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn load_text(xml: &str) -> Result<Scene, SceneError> {
    let source = Source::text("s.xml", xml.to_owned())
        .with_asset("nan.spd", "# heading\n400 0.1\n500 nan\n")
        .with_asset("unsorted.spd", "400 0.1\n\n390 0.2\n")
        .with_asset("negative.spd", "400 0.1\n410 -0.2\n")
        .with_asset("columns.spd", "400 0.1 7\n410 0.2\n")
        .with_asset("bright.spd", "400 0.1\n410 1.2\n")
        .with_asset("index.obj", format!("{MESH}f 1 2 4\n"))
        .with_asset("pentagon.obj", format!("{MESH}f 1 2 3 1 2\n"))
        .with_asset("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        .with_asset("word.obj", "v 0 0 zero\n");
    load(&source, &[])
}

/// A scene with a good sensor on line 2 and `body` from line 3 on.
fn scene(body: &str) -> String {
    format!("<scene version='3.0.0'>\n{SENSOR}\n{body}\n</scene>")
}

/// An object of a scene, on line 3, with its properties from line 4 on.
fn object(tag: &str, kind: &str, properties: &str) -> String {
    scene(&format!("<{tag} type='{kind}'>\n{properties}\n</{tag}>"))
}

/// A diffuse material with its property on line 4.
fn diffuse(property: &str) -> String {
    object("bsdf", "diffuse", property)
}

/// An area light with its property on line 5.
fn light(property: &str) -> String {
    object("shape", "rectangle", &format!("<emitter type='area'>\n{property}\n</emitter>"))
}

/// A scene whose sensor is on line 2, with what it holds but `fov` from line 3 on.
fn sensor(inside: &str) -> String {
    let body = "<float name='fov' value='40'/></sensor>\n</scene>";
    format!("<scene version='3.0.0'>\n<sensor type='perspective'>\n{inside}\n{body}")
}

/// The scene, the line to be named, and a part of the message.
type Row = (String, u32, &'static str);

#[track_caller]
fn assert_refused(rows: Vec<Row>) {
    for (xml, line, part) in rows {
        let error = load_text(&xml).err().unwrap_or_else(|| panic!("not refused:\n{xml}"));
        let text = error.to_string();
        assert_eq!(error.line, line, "{text}\n{xml}");
        assert!(error.message.contains(part), "{text}\n{xml}");
        assert!(!text.contains(['\n', '\r']), "{text:?}\n{xml}");
        assert!(text.starts_with(&format!("{}:{line}: ", error.file)), "{text}\n{xml}");
    }
}

#[test]
fn malformed_documents_are_refused() {
    assert_refused(vec![
        (String::new(), 1, "malformed XML"),
        ("what is this".into(), 1, "malformed XML"),
        ("<scene version='3.0.0'>\n<film>\n</scene>".into(), 3, "malformed XML"),
        ("<scene version='3.0.0'>\n<film/>\n".into(), 2, "malformed XML"),
        ("<scene version='3.0.0'\nversion='3.0.0'/>".into(), 2, "malformed XML"),
        ("<!DOCTYPE x>\n<scene version='3.0.0'/>".into(), 1, "malformed XML"),
        ("<scene version='3.0.0'>\n&x;</scene>".into(), 2, "malformed XML"),
        ("<!-- -->\n<shape type='sphere'/>".into(), 2, "must be <scene>"),
        ("<scene/>".into(), 1, "missing attribute \"version\""),
        ("<scene version='0.6.0'/>".into(), 1, "not supported"),
        ("<scene version='three'/>".into(), 1, "not a version"),
        ("<scene version='3.0.0' xmlns='urn:x'/>".into(), 1, "namespaces"),
        ("<scene version='3.0.0'>\n</scene>".into(), 1, "no <sensor>"),
        (scene("\n  hello"), 4, "text between elements"),
    ]);
}

#[test]
fn elements_outside_the_subset_are_refused() {
    assert_refused(vec![
        (scene("<thing/>"), 3, "not supported inside <scene>"),
        (scene("<medium type='homogeneous'/>"), 3, "not supported inside <scene>"),
        (scene("<include filename='x.xml'/>"), 3, "included files are not supported"),
        (object("shape", "disk", "<thing/>"), 4, "not supported inside <shape type=\"disk\">"),
        (diffuse("<texture name='reflectance' type='bitmap'/>"), 4, "textures are not supported"),
        (scene("<shape/>"), 3, "missing attribute \"type\""),
        (scene("<shape type='ply'/>"), 3, "\"ply\" is not supported (supported: rectangle"),
        (scene("<bsdf type='plastic'/>"), 3, "\"plastic\" is not supported"),
        (scene("<integrator type='volpath'/>"), 3, "\"volpath\" is not supported"),
        (scene("<emitter type='spot'/>"), 3, "\"spot\" is not supported"),
        (scene("<emitter type='area'/>"), 3, "inside the <shape>"),
        (object("shape", "disk", "<emitter type='point'/>"), 4, "\"point\" is not supported"),
        (object("shape", "disk", "<emitter type='area'/>\n<emitter type='area'/>"), 5, "not supported"),
        (object("shape", "disk", "<bsdf type='diffuse'/>\n<bsdf type='diffuse'/>"), 5, "not supported"),
        ("<scene version='3.0.0'>\n<sensor type='thinlens'/></scene>".into(), 2, "\"thinlens\" is not"),
        (scene(SENSOR), 3, "only one <sensor>"),
        (scene("<integrator type='path'/>\n<integrator type='path'/>"), 4, "only one <integrator>"),
        (scene("<emitter type='constant'/>\n<emitter type='constant'/>"), 4, "only one emitter"),
        (sensor("<film type='specfilm'/>"), 3, "\"specfilm\" is not supported"),
        (sensor("<film type='hdrfilm'>\n<rfilter type='lanczos'/></film>"), 4, "\"lanczos\" is not"),
        (sensor("<sampler type='sobol'/>"), 3, "\"sobol\" is not supported"),
    ]);
}

#[test]
fn properties_outside_the_subset_are_refused() {
    let float = |name: &str, value: &str| format!("<float name='{name}' value='{value}'/>");
    let twice = format!("{}\n{}", float("reflectance", "0.1"), float("reflectance", "0.2"));
    assert_refused(vec![
        (object("shape", "disk", &float("radius", "1")), 4, "no property \"radius\""),
        (object("integrator", "direct", "<integer name='max_depth' value='3'/>"), 4, "no property \"max_depth\""),
        (sensor("<film type='hdrfilm'>\n<integer name='crop_width' value='3'/></film>"), 4, "no property"),
        (sensor("<film type='hdrfilm'>\n<string name='pixel_format' value='xyz'/></film>"), 4, "\"xyz\" is not"),
        (diffuse(&twice), 5, "given twice"),
        (sensor("<string name='far_clip' value='2'/>"), 3, "must be given as <float> or <integer>"),
        (diffuse("<float name='reflectance' val='0.1'/>"), 4, "unknown attribute \"val\""),
        (diffuse("<float name='reflectance'/>"), 4, "missing attribute \"value\""),
        (diffuse("<string name='reflectance' value='0.1'/>"), 4, "must be given as <spectrum>"),
        (sensor("<float name='near_clip' value='1'>\n<float/></float>"), 4, "not expected inside <float>"),
        (diffuse("<rgb name='reflectance' value='0.1 0.2 1.3'/>"), 4, "component 2 of the colour"),
        (diffuse("<rgb name='reflectance' value='0.1 0.2'/>"), 4, "one or three numbers"),
        (object("shape", "disk", "<boolean name='flip_normals' value='yes'/>"), 4, "neither \"true\""),
    ]);
}

#[test]
fn bad_references_and_parameters_are_refused() {
    let shape_as_bsdf = "<shape type='sphere' id='s'/>\n<shape type='disk'>\n<ref id='s'/></shape>";
    let bsdf_as_spectrum = "<bsdf type='diffuse' id='b'>\n<ref name='reflectance' id='b'/></bsdf>";
    assert_refused(vec![
        (object("shape", "disk", "<ref id='nobody'/>"), 4, "nothing has the id \"nobody\""),
        (object("shape", "disk", "<ref/>"), 4, "missing attribute \"id\""),
        (scene(shape_as_bsdf), 5, "refers to a <shape>"),
        (scene(bsdf_as_spectrum), 4, "not to a spectrum"),
        (scene("<bsdf type='diffuse' id='b'/>\n<bsdf type='diffuse' id='b'/>"), 4, "given twice"),
        (scene("<ref id='b'/>"), 3, "directly inside <scene>"),
        (scene("<bsdf type='twosided' id='b'>\n<ref id='b'/></bsdf>"), 3, "nor a two-sided"),
        (object("bsdf", "twosided", "<bsdf type='dielectric'/>"), 3, "neither a dielectric"),
        (scene("<bsdf type='twosided'/>"), 3, "one or two bsdfs, not 0"),
        (diffuse("<float name='reflectance' value='$rho'/>"), 4, "undefined parameter \"$rho\""),
        (scene("<bsdf type='$t'/>\n<default name='t' value='diffuse'/>"), 3, "undefined parameter \"$t\""),
        (scene("<default name='t'/>"), 3, "missing attribute \"value\""),
        (scene("<default name='a b' value='1'/>"), 3, "not a parameter name"),
        (scene("<default name='a' value='1'><float/></default>"), 3, "not expected inside <default>"),
    ]);
    let unused = load(&Source::text("s.xml", scene("")), &[("spp".into(), "4".into())]).unwrap_err();
    assert_eq!(unused.to_string(), "s.xml: parameter \"spp\" is given but not used by this scene");
}

#[test]
fn bad_reflectances_are_refused() {
    let value = |v: &str| diffuse(&format!("<spectrum name='reflectance' value='{v}'/>"));
    let typed =
        |kind: &str, body: &str| diffuse(&format!("<spectrum name='reflectance' type='{kind}'>\n{body}</spectrum>"));
    let backwards = "<float name='wavelength_min' value='700'/><float name='wavelength_max' value='400'/>\
                     <string name='values' value='0 1'/>";
    let unequal = "<string name='wavelengths' value='400 500'/><string name='values' value='0'/>";
    assert_refused(vec![
        (value("nan"), 4, "not a finite number"),
        (value("400:0.1, 500:NaN"), 4, "not a finite number"),
        (value("400:0.1, inf:0.1"), 4, "not a finite number"),
        (value("1e999"), 4, "not a finite number"),
        (value("white"), 4, "not a number"),
        (value("-0.1"), 4, "negative"),
        (value("400:0.1, 500:-0.2"), 4, "negative"),
        (value("500:0.1, 400:0.2"), 4, "must increase"),
        (value("500:0.1, 500:0.2"), 4, "must increase"),
        (value("0:0.1, 500:0.2"), 4, "not positive"),
        (value("500:0.1"), 4, "at least two"),
        (value("500:0.1, 600"), 4, "not a pair"),
        (value("1.5"), 4, "must not be above 1"),
        (value("400:0.1, 500:1.01"), 4, "reaches 1.01"),
        (diffuse("<float name='reflectance' value='1.5'/>"), 4, "above 1"),
        (diffuse("<rgb name='reflectance' value='2'/>"), 4, "above 1"),
        (diffuse("<spectrum name='reflectance'/>"), 4, "needs \"value\" or"),
        (diffuse("<spectrum name='reflectance' filename='no.spd'/>"), 4, "cannot read \"no.spd\""),
        (diffuse("<spectrum name='reflectance' filename='bright.spd'/>"), 4, "reaches 1.2"),
        (typed("d65", ""), 4, "is light"),
        (typed("rawconstant", ""), 4, "\"rawconstant\" is not supported"),
        (typed("uniform", "<float name='value' value='-1'/>"), 5, "not negative"),
        (typed("regular", "<string name='values' value='0 1'/>"), 4, "missing property \"wavelength_min\""),
        (typed("regular", backwards), 4, "must be above"),
        (typed("irregular", unequal), 5, "2 wavelengths but 1 values"),
        (scene("<spectrum type='uniform'/>"), 3, "missing attribute \"id\""),
    ]);
}

#[test]
fn bad_lights_are_refused() {
    let value = |v: &str| light(&format!("<spectrum name='radiance' value='{v}'/>"));
    let typed = |kind: &str, body: &str| light(&format!("<spectrum name='radiance' type='{kind}'>\n{body}</spectrum>"));
    let empty_range = "<float name='temperature' value='3000'/>\n<float name='wavelength_min' value='900'/>";
    let speck = "<float name='radius' value='1e-200'/><emitter type='area'/>";
    let both = "<transform name='to_world'/>\n<point name='position' value='1 2 3'/>";
    assert_refused(vec![
        (value("-1"), 5, "negative"),
        (value("400:1, 500:nan"), 5, "finite"),
        (light("<float name='radiance' value='-1'/>"), 5, "negative"),
        (typed("d65", "<float name='scale' value='-1'/>"), 6, "not negative"),
        (typed("d65", "<float name='scale' value='nan'/>"), 6, "finite"),
        (typed("blackbody", ""), 5, "missing property \"temperature\""),
        (typed("blackbody", "<float name='temperature' value='0'/>"), 6, "must be positive"),
        (typed("blackbody", empty_range), 5, "above \"wavelength_min\""),
        (object("shape", "sphere", speck), 3, "area is zero"),
        (object("emitter", "point", both), 5, "excludes"),
        (object("emitter", "point", "<point name='position' value='1 2'/>"), 4, "one or three numbers"),
        (object("emitter", "point", "<point name='position' x='1' y='2'/>"), 4, "missing attribute \"z\""),
        (object("emitter", "point", "<vector name='position' value='1'/>"), 4, "must be given as <point>"),
        (object("emitter", "directional", "<vector name='direction' value='0'/>"), 4, "direction is zero"),
    ]);
}

#[test]
fn faults_inside_a_file_name_that_file_and_its_line() {
    let spectrum = |file: &str| diffuse(&format!("<spectrum name='reflectance' filename='{file}'/>"));
    let mesh = |file: &str| object("shape", "obj", &format!("<string name='filename' value='{file}'/>"));
    for (xml, place, part) in [
        (spectrum("nan.spd"), "nan.spd:3: ", "not a finite number"),
        (spectrum("unsorted.spd"), "unsorted.spd:3: ", "must increase"),
        (spectrum("negative.spd"), "negative.spd:2: ", "negative"),
        (spectrum("columns.spd"), "columns.spd:1: ", "3 columns"),
        (mesh("index.obj"), "index.obj:5: <f>: ", "no vertex 4"),
        (mesh("pentagon.obj"), "pentagon.obj:5: <f>: ", "3 or 4 corners"),
        (mesh("word.obj"), "word.obj:1: <v>: ", "not a number"),
        (mesh("flat.obj"), "flat.obj:4: ", "no triangle with an area"),
    ] {
        let text = load_text(&xml).unwrap_err().to_string();
        assert!(text.starts_with(place) && text.contains(part), "{text}");
    }
}

#[test]
fn bad_geometry_is_refused() {
    let transform =
        |body: &str| object("shape", "rectangle", &format!("<transform name='to_world'>\n{body}</transform>"));
    let stretched = "<transform name='to_world'><scale x='2'/></transform>";
    let overflow = "<scale value='1e100'/>\n<scale value='1e100'/>\n<scale value='1e100'/>";
    assert_refused(vec![
        (transform("<scale value='0'/>"), 5, "singular"),
        (transform("<translate x='1'/>\n<scale y='0'/>"), 6, "singular"),
        (transform(overflow), 4, "singular or too large"),
        (transform("<matrix value='1 2 0 2 4 0 0 0 1'/>"), 5, "singular"),
        (transform("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/>"), 5, "last row"),
        (transform("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0'/>"), 5, "9 or 16 values, not 12"),
        (transform("<translate x='nan'/>"), 5, "finite"),
        (transform("<translate x='1' value='2'/>"), 5, "excludes"),
        (transform("<rotate angle='3'/>"), 5, "axis is zero"),
        (transform("<rotate x='1'/>"), 5, "missing attribute \"angle\""),
        (transform("<lookat origin='1 1 1' target='1 1 1' up='0 1 0'/>"), 5, "same point"),
        (transform("<lookat origin='0 0 0' target='0 2 0' up='0 1 0'/>"), 5, "\"up\""),
        (transform("<shear x='1'/>"), 5, "not supported inside <transform>"),
        (transform("<matrix value='1 1 0 0 1 0 0 0 1'/>"), 4, "shears"),
        (object("shape", "disk", stretched), 4, "ellipse"),
        (object("shape", "sphere", stretched), 4, "ellipsoid"),
        (object("shape", "sphere", "<float name='radius' value='-1'/>"), 4, "must be positive"),
        (object("shape", "sphere", "<float name='radius' value='0'/>"), 4, "must be positive"),
        (object("shape", "obj", ""), 3, "missing property \"filename\""),
        (object("shape", "obj", "<string name='filename' value='no.obj'/>"), 4, "cannot read \"no.obj\""),
    ]);
}

#[test]
fn bad_cameras_and_films_are_refused() {
    let film = |body: &str| sensor(&format!("<film type='hdrfilm'>\n{body}</film>"));
    let fov = |fov: &str| format!("<scene version='3.0.0'><sensor type='perspective'>\n{fov}</sensor></scene>");
    let samples = "<sampler type='independent'>\n<integer name='sample_count' value='0'/></sampler>";
    assert_refused(vec![
        (fov(""), 1, "missing property \"fov\""),
        (fov("<float name='fov' value='0'/>"), 2, "between 0 and 180"),
        (fov("<float name='fov' value='180'/>"), 2, "between 0 and 180"),
        (sensor("<string name='fov_axis' value='z'/>"), 3, "\"z\" is not supported"),
        (sensor("<transform name='to_world'><scale value='2'/></transform>"), 3, "not scaled"),
        (sensor("<float name='near_clip' value='20000'/>"), 2, "below \"far_clip\""),
        (sensor("<float name='near_clip' value='0'/>"), 3, "must be positive"),
        (film("<integer name='width' value='0'/>"), 4, "between 1 and"),
        (film("<integer name='height' value='-4'/>"), 4, "between 1 and"),
        (film("<integer name='width' value='99999999999'/>"), 4, "between 1 and"),
        (film("<integer name='width' value='3.5'/>"), 4, "not an integer"),
        (film("<float name='width' value='3'/>"), 4, "must be given as <integer>"),
        (film("<rfilter type='tent'>\n<float name='radius' value='0'/></rfilter>"), 5, "above 0"),
        (sensor(samples), 4, "between 1 and"),
        (object("integrator", "path", "<integer name='max_depth' value='-2'/>"), 4, "between -1 and"),
    ]);
}

#[test]
fn bad_materials_are_refused() {
    let glass = |body: &str| object("bsdf", "dielectric", body);
    let metal = |body: &str| object("bsdf", "conductor", body);
    let eta_and_k = "<spectrum name='eta' value='0'/><spectrum name='k' value='1'/>";
    assert_refused(vec![
        (glass("<float name='int_ior' value='0'/>"), 4, "must be positive"),
        (glass("<float name='ext_ior' value='nan'/>"), 4, "finite"),
        (glass("<string name='int_ior' value='N-BK8'/>"), 4, "no material is called \"N-BK8\""),
        (glass("<spectrum name='int_ior' value='500:1.5, 600:1.4'/>"), 4, "from 380 to 780 nm"),
        (glass("<spectrum name='absorption' value='-1'/>"), 4, "negative"),
        (glass("<spectrum name='specular_transmittance' value='1.1'/>"), 4, "above 1"),
        (metal("<string name='material' value='Xx'/>"), 4, "\"Xx\" is not supported"),
        (metal("<spectrum name='eta' value='1'/>"), 3, "must be given together"),
        (metal(&format!("<string name='material' value='Au'/>{}", eta_and_k.replace("'0'", "'1'"))), 3, "excludes"),
        (metal(eta_and_k), 4, "must be positive"),
        (object("bsdf", "schlick", "<float name='roughness' value='1.1'/>"), 4, "between 0 and 1"),
        (object("bsdf", "schlick", "<float name='isotropy' value='0'/>"), 4, "above 0"),
    ]);
}

#[test]
fn bad_highlights_are_refused() {
    let ward = |body: &str| object("bsdf", "ward", body);
    let float = |name: &str, value: &str| ward(&format!("<float name='{name}' value='{value}'/>"));
    let sum = |specular: &str, diffuse: &str| {
        let [specular, diffuse] = [("specular", specular), ("diffuse", diffuse)]
            .map(|(name, value)| format!("<spectrum name='{name}_reflectance' value='{value}'/>"));
        ward(&format!("{specular}\n{diffuse}"))
    };
    assert_refused(vec![
        (float("alpha", "0"), 4, "\"alpha\" must be between 1e-6 and 100"),
        (float("alpha_u", "-0.1"), 4, "\"alpha_u\" must be between"),
        (float("alpha_v", "nan"), 4, "finite"),
        (float("alpha_v", "101"), 4, "between 1e-6 and 100, not 101"),
        (ward("<float name='alpha' value='0.1'/>\n<float name='alpha_u' value='0.1'/>"), 4, "\"alpha\" excludes"),
        (ward("<string name='variant' value='phong'/>"), 4, "\"phong\" is not supported"),
        (float("specular_reflectance", "1.1"), 4, "above 1"),
        (float("diffuse_reflectance", "-0.1"), 4, "negative"),
        (float("reflectance", "0.1"), 4, "no property \"reflectance\""),
        (float("specular_reflectance", "0.51"), 3, "but reach 1.01"),
        (sum("0.5", "400:0.2, 500:0.6"), 3, "but reach 1.1 at 500 nm"),
        // Only between the nodes of one of them is the sum too large.
        (sum("400:0, 600:0.8", "550:0.5, 560:0.1"), 3, "but reach 1.1 at 550 nm"),
        (sum("300:0.7, 800:0.7", "400:0.3, 500:0.3, 510:0.31, 520:0.3"), 3, "but reach 1.01 at 510 nm"),
    ]);
    // Where one ends, the other may reach 1; decimal fractions may add up to 1.
    // Nor does it matter what they are where nobody sees it.
    for good in [
        sum("0.5", "400:0.2, 780:0.5, 790:0.9"),
        sum("300:1, 400:1", "401:1, 800:1"),
        sum("0.7", "0.3"),
        sum("400:0.9, 500:0.1", "400:0.1, 500:0.9"),
    ] {
        assert!(load_text(&good).is_ok(), "{good}");
    }
}

#[test]
fn missing_scene_files_are_refused() {
    let error = load(&Source::disk("no/such/scene.xml"), &[]).unwrap_err();
    assert!(error.to_string().starts_with("no/such/scene.xml: cannot read the scene: "), "{error}");
    let error = builtin::load("cornell", &[]).unwrap_err();
    let expected = "cornell: no built-in scene has this name (built-in: cornell-box,";
    assert!(error.to_string().starts_with(expected), "{error}");
}

/// Every prefix of a good scene, and the scene with single bytes replaced by awkward text, is read or refused.
#[test]
fn damaged_scenes_never_panic() {
    let good = include_str!("../../renderers/scenes/cornell-box-spheres.xml");
    let (mut read, mut refused) = (0, 0);
    let mut count = |text: String| match builtin_assets(text) {
        Ok(_) => read += 1,
        Err(error) => {
            assert!(!error.message.is_empty());
            refused += 1;
        }
    };
    let whole = |at: &usize| good.is_char_boundary(*at) && good.is_char_boundary(at + 1);
    for end in (0..good.len()).filter(whole) {
        count(good[..end].to_owned());
    }
    for at in (0..good.len()).step_by(7).filter(whole) {
        for replacement in ["", "-", "$", "\"", "<", "é", "9999", "\u{0}"] {
            count(format!("{}{replacement}{}", &good[..at], &good[at + 1..]));
        }
    }
    // Damage in comments and names goes unseen, most other damage does not.
    assert!(read > 100 && refused > 1000, "{read} read, {refused} refused");
}

/// Loads a variant of a built-in scene's text with that scene's files beside it.
fn builtin_assets(xml: String) -> Result<Scene, SceneError> {
    let Some(Source::Memory { assets, .. }) = builtin::source("cornell-box-spheres") else { unreachable!() };
    load(&Source::Memory { name: "s.xml".into(), xml, assets }, &[])
}
