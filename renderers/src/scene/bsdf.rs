//! Materials.

use std::collections::HashMap;

use super::load::{Ids, label};
use super::props::{Props, unsupported};
use super::spectrum::{Role, Spectra};
use super::xml::Node;
use super::{Bsdf, BsdfId, BsdfKind, ConductorFresnel, Ior, Metal, SceneError, SpectrumKind, WardVariant};

/// Refractive indices that Mitsuba 3 knows by name: constants over the spectrum.
const NAMED_IORS: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.3330),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.470),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.5750),
    ("diamond", 2.419),
];

/// Names of [`Ior::Glass`]: materials of `spectral_core::dispersion`, case-sensitive unlike Mitsuba's names. Its `diamond`
/// is not among them, because that name is Mitsuba's for a constant.
pub const DISPERSIVE_GLASSES: [&str; 9] =
    ["N-BK7", "SF10", "SF11", "N-SF11", "fused-silica", "water-20C", "CaF2", "S-FPL53", "437907"];

/// What decimal fractions that add up to 1 may be above it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The roughness that the models are accurate for.
const ALPHA: core::ops::RangeInclusive<f64> = 1e-6..=100.0;

const TYPES: [&str; 6] = ["diffuse", "conductor", "dielectric", "schlick", "ward", "twosided"];

/// The materials of a scene under construction; each element is read once however often it is referred to.
pub(crate) struct Bsdfs<'a> {
    ids: &'a Ids<'a>,
    list: Vec<Bsdf>,
    known: HashMap<usize, BsdfId>,
    default: Option<BsdfId>,
}

impl<'a> Bsdfs<'a> {
    pub(crate) fn new(ids: &'a Ids<'a>) -> Self {
        Self { ids, list: Vec::new(), known: HashMap::new(), default: None }
    }

    pub(crate) fn finish(self) -> Vec<Bsdf> {
        self.list
    }

    /// Reads a `<bsdf>` element.
    pub(crate) fn add(&mut self, node: Node<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfId, SceneError> {
        if let Some(&id) = self.known.get(&node.index()) {
            return Ok(id);
        }
        let mut props = Props::new(node)?;
        let kind = match props.kind() {
            "diffuse" => BsdfKind::Diffuse {
                reflectance: spectra.property(
                    &mut props,
                    "reflectance",
                    Role::Fraction,
                    SpectrumKind::Constant(0.5),
                )?,
            },
            "conductor" => conductor(&mut props, spectra)?,
            "dielectric" => dielectric(&mut props, spectra)?,
            "schlick" => schlick(&mut props, spectra)?,
            "ward" => ward(&mut props, spectra)?,
            "twosided" => self.two_sided(&mut props, spectra)?,
            other => return Err(unsupported(node, "bsdf type", other, &TYPES)),
        };
        props.finish()?;
        let id = self.push(kind, label(node));
        self.known.insert(node.index(), id);
        Ok(id)
    }

    /// Takes the nested or referenced material of a shape; diffuse with reflectance 0.5 if there is none.
    pub(crate) fn of_shape(&mut self, props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfId, SceneError> {
        if let Some(node) = self.next_nested(props)? {
            return self.add(node, spectra);
        }
        if let Some(id) = self.default {
            return Ok(id);
        }
        let place = props.node().place();
        let reflectance = spectra.constant(0.5, || format!("default reflectance ({place})"));
        let id = self.push(BsdfKind::Diffuse { reflectance }, "default diffuse".into());
        self.default = Some(id);
        Ok(id)
    }

    /// Takes the next `<bsdf>`, or the one that the next `<ref>` refers to.
    fn next_nested(&self, props: &mut Props<'a>) -> Result<Option<Node<'a>>, SceneError> {
        let Some(node) = props.take_tag(&["bsdf", "ref"]) else { return Ok(None) };
        let target = if node.tag() == "ref" { self.ids.resolve(node)? } else { node };
        if target.tag() == "bsdf" {
            Ok(Some(target))
        } else {
            Err(node.error(format!("refers to a <{}>, not to a bsdf", target.tag())))
        }
    }

    fn two_sided(&mut self, props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfKind, SceneError> {
        let mut sides = Vec::new();
        while let Some(node) = self.next_nested(props)? {
            if matches!(node.attribute("type"), Some("twosided" | "dielectric")) {
                return Err(props.node().error("a two-sided bsdf holds neither a dielectric nor a two-sided bsdf"));
            }
            sides.push(self.add(node, spectra)?);
        }
        match *sides.as_slice() {
            [both] => Ok(BsdfKind::TwoSided { front: both, back: both }),
            [front, back] => Ok(BsdfKind::TwoSided { front, back }),
            _ => Err(props.node().error(format!("a two-sided bsdf holds one or two bsdfs, not {}", sides.len()))),
        }
    }

    fn push(&mut self, kind: BsdfKind, label: String) -> BsdfId {
        self.list.push(Bsdf { kind, label });
        BsdfId(self.list.len() - 1)
    }
}

fn conductor<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfKind, SceneError> {
    const MATERIALS: [&str; 5] = ["none", "Au", "Ag", "Cu", "Al"];
    let material = props.choice("material", &MATERIALS)?;
    let eta = spectra.optional(props, "eta", Role::Index)?;
    let k = spectra.optional(props, "k", Role::Extinction)?;
    let fresnel = match (material, eta, k) {
        (Some("Au"), None, None) => ConductorFresnel::Metal(Metal::Au),
        (Some("Ag"), None, None) => ConductorFresnel::Metal(Metal::Ag),
        (Some("Cu"), None, None) => ConductorFresnel::Metal(Metal::Cu),
        (Some("Al"), None, None) => ConductorFresnel::Metal(Metal::Al),
        (_, None, None) => ConductorFresnel::Perfect,
        (None, Some(eta), Some(k)) => ConductorFresnel::Spectra { eta, k },
        (None, ..) => return Err(props.node().error("\"eta\" and \"k\" must be given together")),
        (Some(_), ..) => return Err(props.node().error("\"material\" excludes \"eta\" and \"k\"")),
    };
    Ok(BsdfKind::Conductor { fresnel, specular_reflectance: factor(props, spectra, "specular_reflectance")? })
}

fn dielectric<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfKind, SceneError> {
    Ok(BsdfKind::Dielectric {
        int_ior: ior(props, spectra, "int_ior", 1.5046)?,
        ext_ior: ior(props, spectra, "ext_ior", 1.000_277)?,
        specular_reflectance: factor(props, spectra, "specular_reflectance")?,
        specular_transmittance: factor(props, spectra, "specular_transmittance")?,
        absorption: spectra.optional(props, "absorption", Role::Absorption)?,
    })
}

fn schlick<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfKind, SceneError> {
    Ok(BsdfKind::Schlick {
        reflectance: spectra.property(props, "reflectance", Role::Fraction, SpectrumKind::Constant(0.5))?,
        roughness: props.float_where("roughness", 1.0, |r| (0.0..=1.0).contains(&r), "between 0 and 1")?,
        isotropy: props.float_where("isotropy", 1.0, |p| p > 0.0 && p <= 1.0, "above 0 and at most 1")?,
    })
}

/// Ward's family, with the defaults of Mitsuba 0.6.
fn ward<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>) -> Result<BsdfKind, SceneError> {
    const VARIANTS: [&str; 4] = ["ward", "ward-duer", "ward-neumann", "balanced"];
    let variant = match props.choice("variant", &VARIANTS)? {
        Some("ward") => WardVariant::Ward,
        Some("ward-duer") => WardVariant::WardDuer,
        Some("ward-neumann") => WardVariant::WardNeumann,
        _ => WardVariant::Balanced,
    };
    let [alpha_u, alpha_v] = roughness(props)?;
    let mut reflectance =
        |name, default| spectra.property(props, name, Role::Fraction, SpectrumKind::Constant(default));
    let specular_reflectance = reflectance("specular_reflectance", 0.2)?;
    let diffuse_reflectance = reflectance("diffuse_reflectance", 0.5)?;
    let (most, wavelength) = spectra.largest_sum(specular_reflectance, diffuse_reflectance);
    if !(most <= 1.0 + ROUNDING) {
        let place = wavelength.map_or(String::new(), |wavelength| format!(" at {wavelength} nm"));
        let message = "\"specular_reflectance\" and \"diffuse_reflectance\" must not add up to more than 1, but reach";
        return Err(props.node().error(format!("{message} {most}{place}")));
    }
    Ok(BsdfKind::Ward { variant, alpha_u, alpha_v, specular_reflectance, diffuse_reflectance })
}

/// `alpha`, or `alpha_u` and `alpha_v`, each 0.1 by default.
fn roughness(props: &mut Props<'_>) -> Result<[f64; 2], SceneError> {
    if let (Some(node), true) = (props.peek("alpha"), props.peek("alpha_u").or(props.peek("alpha_v")).is_some()) {
        return Err(node.error("\"alpha\" excludes \"alpha_u\" and \"alpha_v\""));
    }
    let mut alpha = |name, default| props.float_where(name, default, |a| ALPHA.contains(&a), "between 1e-6 and 100");
    let both = alpha("alpha", 0.1)?;
    Ok([alpha("alpha_u", both)?, alpha("alpha_v", both)?])
}

fn factor<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>, name: &str) -> Result<super::SpectrumId, SceneError> {
    spectra.property(props, name, Role::Fraction, SpectrumKind::Constant(1.0))
}

/// A refractive index: a number, a name of Mitsuba's or of a dispersive glass, or a spectrum. A `<float>` may hold a glass's name too,
/// so that a parameter of a scene that Mitsuba opens can be either; 437907 is a name, no number.
fn ior<'a>(props: &mut Props<'a>, spectra: &mut Spectra<'a>, name: &str, default: f64) -> Result<Ior, SceneError> {
    let Some(node) = props.peek(name) else { return Ok(Ior::Constant(default)) };
    match node.tag() {
        "float" if node.attribute("value").is_some_and(|text| DISPERSIVE_GLASSES.contains(&text)) => {
            let text = props.number_text(name)?;
            Ok(text.map_or(Ior::Constant(default), |(_, glass)| Ior::Glass(glass.to_owned())))
        }
        "string" => {
            let Some((node, text)) = props.string(name)? else { return Ok(Ior::Constant(default)) };
            named_ior(text).ok_or_else(|| {
                let message = format!("no material is called {text:?} (dispersive: {})", DISPERSIVE_GLASSES.join(", "));
                node.error(message)
            })
        }
        "float" | "integer" => Ok(Ior::Constant(props.float_where(name, default, |n| n > 0.0, "positive")?)),
        _ => Ok(spectra.optional(props, name, Role::Index)?.map_or(Ior::Constant(default), Ior::Spectrum)),
    }
}

fn named_ior(name: &str) -> Option<Ior> {
    if DISPERSIVE_GLASSES.contains(&name) {
        return Some(Ior::Glass(name.to_owned()));
    }
    let lower = name.to_lowercase();
    NAMED_IORS.iter().find(|(known, _)| *known == lower).map(|&(_, index)| Ior::Constant(index))
}
