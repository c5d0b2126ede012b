//! Answers of other programs: `case,point,value` in a file.

use std::collections::HashMap;
use std::path::Path;

use super::case::{Answer, Case};

/// What is wrong with a file of answers, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScoreError {
    file: String,
    line: usize,
    fault: ScoreFault,
}

/// What is wrong with a line of answers.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ScoreFault {
    /// The file can't be read.
    Unreadable(String),
    /// Not three cells between commas.
    Cells(usize),
    /// No case of this name that is a scene.
    Case(String),
    /// The case has no such point.
    Point(String),
    /// Not a finite number.
    Value(String),
    /// The same point twice.
    Twice,
    /// No answer in the whole file.
    Empty,
}

impl core::fmt::Display for ScoreError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        f.write_str(": ")?;
        match &self.fault {
            ScoreFault::Unreadable(why) => f.write_str(why),
            ScoreFault::Cells(count) => write!(f, "case,point,value expected, but there are {count} cells"),
            ScoreFault::Case(name) => write!(f, "no case {name:?} for other programs (spectral verify --list)"),
            ScoreFault::Point(name) => {
                write!(f, "the case has no point {name:?} (spectral verify --export DIR lists them)")
            }
            ScoreFault::Value(text) => write!(f, "{text:?} is not a finite number"),
            ScoreFault::Twice => f.write_str("this point has been answered before"),
            ScoreFault::Empty => f.write_str("no answers"),
        }
    }
}

impl core::error::Error for ScoreError {}

/// Answers by names of case and point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answers(HashMap<(String, String), f64>);

impl Answers {
    /// Reads a file of answers to any of `cases`.
    ///
    /// # Errors
    /// [`ScoreError`] with the line at fault.
    pub fn read(path: &Path, cases: &[Case]) -> Result<Self, ScoreError> {
        let file = path.display().to_string();
        let unreadable = |why: std::io::Error| ScoreError {
            file: file.clone(),
            line: 0,
            fault: ScoreFault::Unreadable(why.to_string()),
        };
        let bytes = std::fs::read(path).map_err(unreadable)?;
        Self::parse(&file, &String::from_utf8_lossy(&bytes), cases)
    }

    /// Reads the text of a file of answers: lines `case,point,value`; empty lines, lines that start with `#` and a
    /// first line `case,point,value` are passed over.
    ///
    /// # Errors
    /// [`ScoreError`] with the line at fault.
    pub fn parse(file: &str, text: &str, cases: &[Case]) -> Result<Self, ScoreError> {
        let mut answers = HashMap::new();
        for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let cells: Vec<_> = line.split(',').map(str::trim).collect();
            if line.trim().is_empty() || line.starts_with('#') || cells == ["case", "point", "value"] && index == 0 {
                continue;
            }
            let refuse = |fault| ScoreError { file: file.to_owned(), line: index + 1, fault };
            let (key, value) = answer(&cells, cases).map_err(refuse)?;
            if answers.insert(key, value).is_some() {
                return Err(refuse(ScoreFault::Twice));
            }
        }
        if answers.is_empty() {
            return Err(ScoreError { file: file.to_owned(), line: 0, fault: ScoreFault::Empty });
        }
        Ok(Self(answers))
    }

    /// The answers to a case, one for each point; points without are left open.
    ///
    /// # Errors
    /// A reason to skip the case when it is no scene, or when there is no answer at all.
    pub fn of(&self, case: &Case) -> Result<Vec<Answer>, String> {
        if !case.work.is_scene() {
            return Err("a method of this project, not a scene".to_owned());
        }
        let value = |point: &super::SensorPoint| self.0.get(&(case.name.clone(), point.name.clone())).copied();
        let answer = |point| Answer { illuminance: value(point), samples: None, seconds: None };
        Ok(case.points.iter().map(answer).collect())
    }
}

fn answer(cells: &[&str], cases: &[Case]) -> Result<((String, String), f64), ScoreFault> {
    let &[case, point, value] = cells else { return Err(ScoreFault::Cells(cells.len())) };
    let known = cases.iter().find(|known| known.work.is_scene() && known.name == case);
    let known = known.ok_or_else(|| ScoreFault::Case(case.to_owned()))?;
    if !known.points.iter().any(|known| known.name == point) {
        return Err(ScoreFault::Point(point.to_owned()));
    }
    let number = value.parse().ok().filter(|number: &f64| number.is_finite());
    let number = number.ok_or_else(|| ScoreFault::Value(value.to_owned()))?;
    Ok(((case.to_owned(), point.to_owned()), number))
}

#[cfg(test)]
mod tests {
    use super::Answers;
    use crate::verify::case::Status;
    use crate::verify::cases;

    #[test]
    fn answers_are_read_and_judged() {
        let cases = cases(None);
        let text = "case,point,value\n# mine\n\npoint.cosine, 0,250\npoint.cosine,60,130\n";
        let answers = Answers::parse("r.csv", text, &cases).unwrap();
        let case = cases.iter().find(|case| case.name == "point.cosine").unwrap();
        let outcomes = case.judge(&answers.of(case));
        let status = |name: &str| outcomes.iter().find(|outcome| outcome.name == name).unwrap().status;
        assert_eq!(status("point.cosine.0"), Status::Pass);
        assert_eq!(status("point.cosine.60"), Status::Fail);
        assert_eq!(status("point.cosine.45"), Status::Skipped);
    }

    #[test]
    fn faults_name_their_line() {
        let cases = cases(None);
        for (text, expected) in [
            ("point.cosine,0", "r.csv:1: case,point,value expected, but there are 2 cells"),
            ("# x\npoint.cosin,0,1", "r.csv:2: no case \"point.cosin\" for other programs (spectral verify --list)"),
            (
                "disk.table-2.1.hexagon-96,P,124.72",
                "r.csv:1: no case \"disk.table-2.1.hexagon-96\" for other programs (spectral verify --list)",
            ),
            ("point.cosine,1,1", "r.csv:1: the case has no point \"1\" (spectral verify --export DIR lists them)"),
            ("point.cosine,0,nan", "r.csv:1: \"nan\" is not a finite number"),
            ("point.cosine,0,1e999", "r.csv:1: \"1e999\" is not a finite number"),
            ("point.cosine,0,1\npoint.cosine,0,1", "r.csv:2: this point has been answered before"),
            ("\n", "r.csv: no answers"),
        ] {
            assert_eq!(Answers::parse("r.csv", text, &cases).unwrap_err().to_string(), expected);
        }
    }
}
