//! Curves of cost and error: their points, their Pareto fronts, and whether two measures of cost agree.

use serde::{Deserialize, Serialize};

/// One setting of a method: what it cost and how far off it was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// What a user would type or call for it.
    pub setting: String,
    /// The method that it is a setting of.
    pub method: String,
    /// Whether the method is this project's own, rather than a simpler or an older one that it is compared with.
    pub own: bool,
    /// Time: the median over rounds, in which settings take turns.
    pub seconds: f64,
    /// The quartiles of time over rounds.
    pub seconds_spread: [f64; 2],
    /// Counted work, the same on every machine; what is counted is said by [`Curve::operations`].
    pub operations: f64,
    /// The error against truth, as [`Curve::error`] says; the root mean square over rounds for methods at random.
    pub error: f64,
    /// The largest error of any item and round.
    pub worst: f64,
    /// Whether no other setting is as accurate in less time, or more accurate in the same time.
    pub front_seconds: bool,
    /// The same by counted work.
    pub front_operations: bool,
}

/// What accuracy costs by the methods of one kind, on one task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The name: family and task.
    pub name: String,
    /// The family.
    pub family: String,
    /// What the task is.
    pub title: String,
    /// What the error is, with its unit.
    pub error: String,
    /// What is counted as operations.
    pub operations: String,
    /// What errors are taken against, and how certain that is.
    pub truth: String,
    /// Errors below this count as none: truth itself is no surer.
    pub floor: f64,
    /// How often every setting was run.
    pub rounds: usize,
    /// All settings.
    pub points: Vec<Point>,
    /// How the order of costs agrees between both measures.
    pub agreement: Agreement,
    /// For decreasing errors, the cheapest settings by each measure.
    pub budgets: Vec<Budget>,
}

/// How two measures of cost agree about the order of settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Pairs of settings whose times differ beyond their spread.
    pub pairs: usize,
    /// Those of them that counted work orders the other way: the one that takes less time first.
    pub reversed: Vec<[String; 2]>,
}

/// The cheapest settings that keep an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Budget {
    /// The error that is allowed.
    pub error: f64,
    /// The setting that takes the least time.
    pub by_seconds: String,
    /// Its method.
    pub method_by_seconds: String,
    /// Its time.
    pub seconds: f64,
    /// The setting of the least counted work.
    pub by_operations: String,
    /// Its method.
    pub method_by_operations: String,
    /// Its counted work.
    pub operations: f64,
}

/// Which of some (cost, error) pairs are on the Pareto front: no other pair is at most as large in both and less in one.
///
/// Pairs with a NaN are on no front and keep none off it. Of equal pairs all or none are on the front. Takes n log n steps.
#[must_use]
pub fn pareto_front(pairs: &[[f64; 2]]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..pairs.len()).filter(|&i| !pairs[i].iter().any(|v| v.is_nan())).collect();
    order.sort_by(|&a, &b| compare(pairs[a][0], pairs[b][0]).then(compare(pairs[a][1], pairs[b][1])));
    let mut front = vec![false; pairs.len()];
    let mut best: Option<[f64; 2]> = None;
    for index in order {
        let pair = pairs[index];
        // Sorted by cost and then by error, only a smaller error or an equal pair can stand.
        if best.is_none_or(|best| pair[1] < best[1] || pair == best) {
            front[index] = true;
            best = Some(pair);
        }
    }
    front
}

/// The order of numbers, −0 and 0 being equal.
fn compare(a: f64, b: f64) -> core::cmp::Ordering {
    a.partial_cmp(&b).unwrap_or(core::cmp::Ordering::Equal)
}

impl Curve {
    /// Finds fronts, agreement and budgets anew from the points.
    pub(super) fn judge(&mut self) {
        let floor = self.floor;
        let pairs =
            |cost: fn(&Point) -> f64| self.points.iter().map(|p| [cost(p), p.error.max(floor)]).collect::<Vec<_>>();
        let seconds = pareto_front(&pairs(|p| p.seconds));
        let operations = pareto_front(&pairs(|p| p.operations));
        for ((point, seconds), operations) in self.points.iter_mut().zip(seconds).zip(operations) {
            (point.front_seconds, point.front_operations) = (seconds, operations);
        }
        self.agreement = agreement(&self.points);
        self.budgets = budgets(&self.points, floor);
    }

    /// The settings on the front by time, or by counted work, from the cheapest on.
    #[must_use]
    pub fn front(&self, by_seconds: bool) -> Vec<&Point> {
        let on_front = |p: &&Point| if by_seconds { p.front_seconds } else { p.front_operations };
        let mut front: Vec<&Point> = self.points.iter().filter(on_front).collect();
        let cost = |p: &Point| if by_seconds { p.seconds } else { p.operations };
        front.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        front
    }

    /// Whether a setting of this project's own method is on the front by time, and by counted work.
    #[must_use]
    pub fn own_on_front(&self) -> [bool; 2] {
        [true, false].map(|by_seconds| self.front(by_seconds).iter().any(|p| p.own))
    }

    /// Whether an error is reached by the same method at the least cost whichever measure is taken, for all errors.
    #[must_use]
    pub fn measures_agree(&self) -> bool {
        self.budgets.iter().all(|b| b.method_by_seconds == b.method_by_operations)
    }
}

fn agreement(points: &[Point]) -> Agreement {
    let mut found = Agreement::default();
    for fast in points {
        for slow in points {
            if !(fast.seconds_spread[1] < slow.seconds_spread[0]) {
                continue;
            }
            found.pairs += 1;
            if fast.operations > slow.operations {
                found.reversed.push([fast.setting.clone(), slow.setting.clone()]);
            }
        }
    }
    found
}

/// Errors of 1, 2 and 5 times powers of ten between the least that is known and the largest one, and who keeps them.
fn budgets(points: &[Point], floor: f64) -> Vec<Budget> {
    let mut found: Vec<Budget> = Vec::new();
    for decade in (-18..=6).rev() {
        for factor in [5.0, 2.0, 1.0] {
            let error = factor * 10.0_f64.powi(decade);
            if error >= floor
                && points.iter().any(|p| p.error > error)
                && let Some(budget) = budget(points, error)
                && found.last().is_none_or(|last| {
                    (&last.by_seconds, &last.by_operations) != (&budget.by_seconds, &budget.by_operations)
                })
            {
                found.push(budget);
            }
        }
    }
    found
}

fn budget(points: &[Point], error: f64) -> Option<Budget> {
    let fit = || points.iter().filter(|p| p.error <= error);
    let fastest = fit().min_by(|a, b| a.seconds.total_cmp(&b.seconds))?;
    let least = fit().min_by(|a, b| a.operations.total_cmp(&b.operations).then(a.seconds.total_cmp(&b.seconds)))?;
    Some(Budget {
        error,
        by_seconds: fastest.setting.clone(),
        method_by_seconds: fastest.method.clone(),
        seconds: fastest.seconds,
        by_operations: least.setting.clone(),
        method_by_operations: least.method.clone(),
        operations: least.operations,
    })
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "a test stops at the first thing that should not be")]
mod tests;
