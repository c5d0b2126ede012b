//! What a case is, and how an answer is judged.

use serde::Serialize;

use super::model::{Model, SensorPoint};

/// What computes a case.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Work {
    /// Illuminance at the case's points, light that reaches them without reflection only.
    Direct,
    /// Illuminance at the case's points with all reflections.
    Global,
    /// One of the methods that place samples on a disk light; other programs have no part in it.
    Method(super::disk::Sampling),
    /// The share in per cent of a method's samples that miss the disk when they are spread over their parts (dj = 1).
    Misses(super::disk::Sampling),
    /// Illuminance under a disk by as few samples as a requested error allows; other programs have no part in it.
    Request(super::disk::Requested),
}

impl Work {
    /// Whether any renderer can compute it: illuminance in a scene.
    #[must_use]
    pub const fn is_scene(&self) -> bool {
        matches!(self, Self::Direct | Self::Global)
    }
}

/// A scene with the points where illuminance is asked for, and what is expected there.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Name, such as `cie-171.5.6.1`: parts between dots, from general to special.
    pub name: String,
    /// What it tests, and its geometry in words.
    pub about: String,
    /// Geometry and lights.
    pub model: Model,
    /// Points; answers come in this order.
    pub points: Vec<SensorPoint>,
    /// What computes it.
    pub work: Work,
    /// What is expected.
    pub checks: Vec<Check>,
}

/// One expected number.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Name within the case, such as `A` or `A.printed`; empty where a case has only one.
    pub name: String,
    /// What the number is, with its unit.
    pub quantity: &'static str,
    /// How it follows from the illuminances at the points.
    pub reduction: Reduction,
    /// The number.
    pub reference: f64,
    /// Where it comes from.
    pub provenance: Provenance,
    /// How far off an answer may be.
    pub tolerance: Tolerance,
    /// Whether it decides about passing.
    pub standing: Standing,
}

/// How a number follows from the illuminances E at the points of a case.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reduction {
    /// `scale` · E at one point.
    Point {
        /// Index of the point.
        index: usize,
        /// Factor.
        scale: f64,
    },
    /// Σ `weights[i]` · (E − `less[i]`) over all points.
    Sum {
        /// A weight for each point.
        weights: Vec<f64>,
        /// What is subtracted first at each point: a direct part known in closed form, or zeros.
        less: Vec<f64>,
    },
}

/// Where a reference comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind", content = "source")]
#[non_exhaustive]
pub enum Provenance {
    /// Printed in a publication.
    Published(&'static str),
    /// Computed here from a closed form or a construction, by code that shares nothing with what is judged.
    Recomputed(&'static str),
}

/// How far an answer may be from the reference: `relative` · |reference| + `absolute`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative part.
    pub relative: f64,
    /// Absolute part, in the quantity's unit.
    pub absolute: f64,
}

impl Tolerance {
    /// Only a relative part.
    #[must_use]
    pub const fn relative(relative: f64) -> Self {
        Self { relative, absolute: 0.0 }
    }

    /// The largest allowed difference from a reference.
    #[must_use]
    pub fn around(self, reference: f64) -> f64 {
        self.relative * reference.abs() + self.absolute
    }
}

/// Whether a check decides about passing.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Standing {
    /// It does.
    Judged,
    /// It does not, for this reason; the figures are shown.
    Informative(String),
}

/// Illuminance at one point, as some program answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// lx; `None` where the program gave no answer.
    pub illuminance: Option<f64>,
    /// Samples taken, if known.
    pub samples: Option<u64>,
    /// Time in seconds, if known.
    pub seconds: Option<f64>,
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Within tolerance.
    Pass,
    /// Outside it.
    Fail,
    /// Not computed: neither passed nor failed.
    Skipped,
    /// Computed, but the reference is not one to be judged by.
    Informative,
}

/// A check with its answer.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Name of the case and of the check, joined by a dot.
    pub name: String,
    /// What the number is, with its unit.
    pub quantity: &'static str,
    /// The expected number.
    pub reference: f64,
    /// The number found; `None` when skipped.
    pub computed: Option<f64>,
    /// (computed − reference) / |reference|; `None` when skipped or when the reference is 0.
    pub relative_error: Option<f64>,
    /// Largest allowed |relative error|; for a reference of 0 the largest allowed |computed|.
    pub tolerance: f64,
    /// Whether it passed; `None` when skipped or informative.
    pub pass: Option<bool>,
    /// Samples taken, if known.
    pub samples: Option<u64>,
    /// Time in seconds, if known.
    pub seconds: Option<f64>,
    /// How it ended.
    pub status: Status,
    /// Why it was skipped or does not count.
    pub reason: Option<String>,
    /// Where the reference comes from.
    pub provenance: Provenance,
}

impl Case {
    /// The outcomes of all checks for given answers, one for each point, or for the reason why there are none.
    #[must_use]
    pub fn judge(&self, answers: &Result<Vec<Answer>, String>) -> Vec<Outcome> {
        self.checks.iter().map(|check| self.outcome(check, answers)).collect()
    }

    /// The name of a check among all: the case's and its own, joined by a dot.
    #[must_use]
    pub fn row_name(&self, check: &Check) -> String {
        if check.name.is_empty() { self.name.clone() } else { format!("{}.{}", self.name, check.name) }
    }

    fn outcome(&self, check: &Check, answers: &Result<Vec<Answer>, String>) -> Outcome {
        let found = match answers {
            Ok(answers) => check.reduction.apply(answers).ok_or_else(|| "no answer".to_owned()),
            Err(reason) => Err(reason.clone()),
        };
        let reference = check.reference;
        let allowed = check.tolerance.around(reference);
        let magnitude = if reference == 0.0 { 1.0 } else { reference.abs() };
        let mut outcome = Outcome {
            name: self.row_name(check),
            quantity: check.quantity,
            reference,
            computed: None,
            relative_error: None,
            tolerance: allowed / magnitude,
            pass: None,
            samples: None,
            seconds: None,
            status: Status::Skipped,
            reason: None,
            provenance: check.provenance.clone(),
        };
        match found {
            Err(reason) => outcome.reason = Some(reason),
            Ok(answer) => outcome.settle(check, answer, allowed),
        }
        outcome
    }
}

impl Outcome {
    fn settle(&mut self, check: &Check, answer: Reduced, allowed: f64) {
        self.computed = Some(answer.value);
        self.samples = answer.samples;
        self.seconds = answer.seconds;
        let error = answer.value - self.reference;
        self.relative_error = (self.reference != 0.0).then(|| error / self.reference.abs());
        match &check.standing {
            Standing::Informative(reason) => {
                self.status = Status::Informative;
                self.reason = Some(reason.clone());
            }
            Standing::Judged => {
                let pass = error.abs() <= allowed;
                self.pass = Some(pass);
                self.status = if pass { Status::Pass } else { Status::Fail };
            }
        }
    }
}

/// A number with the effort behind it.
struct Reduced {
    value: f64,
    samples: Option<u64>,
    seconds: Option<f64>,
}

impl Reduction {
    /// The number and the effort behind it; `None` if a point that it needs has no answer.
    fn apply(&self, answers: &[Answer]) -> Option<Reduced> {
        match self {
            Self::Point { index, scale } => {
                let answer = answers.get(*index)?;
                let value = scale * answer.illuminance?;
                Some(Reduced { value, samples: answer.samples, seconds: answer.seconds })
            }
            Self::Sum { weights, less } => {
                let parts = weights.iter().zip(less);
                let terms = parts
                    .enumerate()
                    .map(|(index, (weight, less))| Some(weight * (answers.get(index)?.illuminance? - less)));
                let value = terms.sum::<Option<f64>>()?;
                let samples = answers.iter().map(|answer| answer.samples).sum();
                let seconds = answers.iter().map(|answer| answer.seconds).sum();
                Some(Reduced { value, samples, seconds })
            }
        }
    }
}

/// Half a unit of the last printed digit, with that many decimals printed.
#[must_use]
pub fn half_printed_unit(decimals: i32) -> f64 {
    0.5 * 10_f64.powi(-decimals)
}

#[cfg(test)]
mod tests {
    use super::{Answer, Case, Check, Provenance, Reduction, Standing, Status, Tolerance, Work};
    use crate::verify::model::{Model, SensorPoint};

    fn case(reference: f64, tolerance: Tolerance, standing: Standing) -> Case {
        let reduction = Reduction::Point { index: 0, scale: 2.0 };
        let provenance = Provenance::Recomputed("by hand");
        let check = Check {
            name: "A".into(),
            quantity: "illuminance, lx",
            reduction,
            reference,
            provenance,
            tolerance,
            standing,
        };
        let points = vec![SensorPoint::new("A", [0.0; 3], [0.0, 0.0, 1.0])];
        let model = Model::default();
        Case { name: "test".into(), about: String::new(), model, points, work: Work::Direct, checks: vec![check] }
    }

    fn status(case: &Case, value: f64) -> (Status, Option<bool>) {
        let answer = Answer { illuminance: Some(value), samples: Some(3), seconds: Some(0.1) };
        let outcome = &case.judge(&Ok(vec![answer]))[0];
        assert_eq!(outcome.name, "test.A");
        (outcome.status, outcome.pass)
    }

    #[test]
    fn answers_are_judged() {
        let judged = case(10.0, Tolerance::relative(0.01), Standing::Judged);
        assert_eq!(status(&judged, 5.04), (Status::Pass, Some(true)));
        assert_eq!(status(&judged, 4.94), (Status::Fail, Some(false)));
        assert_eq!(status(&judged, f64::NAN), (Status::Fail, Some(false)));
        let shown = case(10.0, Tolerance::relative(0.01), Standing::Informative("stand-in".into()));
        assert_eq!(status(&shown, 5.0), (Status::Informative, None));
        let zero = case(0.0, Tolerance { relative: 0.5, absolute: 1e-6 }, Standing::Judged);
        assert_eq!(status(&zero, 4e-7), (Status::Pass, Some(true)));
        assert_eq!(status(&zero, 6e-7), (Status::Fail, Some(false)));
    }

    #[test]
    fn what_is_skipped_never_passes() {
        let judged = case(10.0, Tolerance::relative(10.0), Standing::Judged);
        let none = Answer { illuminance: None, samples: None, seconds: None };
        for answers in [Err("not built".to_owned()), Ok(vec![none]), Ok(Vec::new())] {
            let outcome = &judged.judge(&answers)[0];
            assert_eq!((outcome.status, outcome.pass, outcome.computed), (Status::Skipped, None, None));
            assert!(outcome.reason.is_some());
        }
    }
}
