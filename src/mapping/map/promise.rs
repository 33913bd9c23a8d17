//! Whether a map that is handed over keeps its promise: that nothing wider than α stands on the floor
//! unseen. A run can come to its end and not keep it, where something it could not go round shut it in: then
//! whoever takes the map is told, in one sentence and wherever the end of the run is told. Reads the map
//! alone: what is still to be driven, and why a line was given up, is for the tour.

use super::{LineStatus, RoomMap};
use std::fmt;

/// The promise counts as kept when no disc wider than α and this may hide, metres.
const SLACK: f64 = 0.01;

/// By how much a promise was not kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shortfall {
    /// Diameter of the disc that may still hide something, metres.
    pub hidden: f64,
    /// α, metres.
    pub alpha: f64,
    /// Lines of the plan.
    pub lines: usize,
    /// How many of them were driven from end to end.
    pub driven: usize,
}

impl RoomMap {
    /// What the map owes after all lines were driven or given up; none when it keeps its promise, or makes
    /// none: there is no plan, or there are lines still to be driven.
    #[must_use]
    pub fn shortfall(&self) -> Option<Shortfall> {
        self.owed(SLACK)
    }

    /// The same to the letter, with nothing let pass: what is worth driving through while the robot is there.
    #[must_use]
    pub fn shortfall_to_the_letter(&self) -> Option<Shortfall> {
        self.owed(0.0)
    }

    fn owed(&self, slack: f64) -> Option<Shortfall> {
        let (plan, hidden) = (self.plan.as_ref()?, self.hidden_disc?);
        let open = |status| matches!(status, LineStatus::Planned | LineStatus::Driving);
        if plan.lines.iter().any(|line| open(line.status)) {
            return None;
        }
        let driven = plan.lines.iter().filter(|line| line.status == LineStatus::Driven).count();
        let lines = plan.figures.lines.max(driven);
        (hidden > plan.alpha + slack).then_some(Shortfall {
            hidden,
            alpha: plan.alpha,
            lines,
            driven,
        })
    }
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a disc of {:.2} m may still hide something, and α is {:.2} m; {} of {} lines were driven \
             from end to end",
            self.hidden, self.alpha, self.driven, self.lines
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::mapping::map::{Plan, PlanFigures, PlanLine};
    use crate::mapping::settings::Strategy;

    /// A map with a plan of three lines for α = 0.5 m.
    fn map(statuses: [LineStatus; 3], hidden: f64) -> RoomMap {
        let line = |(k, status)| PlanLine {
            id: k as u32 + 1,
            part: 0,
            vertex: 0,
            start: Point::origin(),
            end: Point::new(1.0, k as f64),
            angle: 0.0,
            drive: None,
            status,
            reason: None,
        };
        let figures =
            PlanFigures { strategy: Strategy::Lean, lines: 3, length: 9.0, hidden_disc: 0.49 };
        let plan = Plan {
            alpha: 0.5,
            lines: statuses.into_iter().enumerate().map(line).collect(),
            order: vec![(1, false), (2, true), (3, false)],
            figures,
            alternatives: Vec::new(),
        };
        RoomMap { plan: Some(plan), hidden_disc: Some(hidden), ..RoomMap::default() }
    }

    #[test]
    fn a_promise_is_kept_to_a_centimetre_and_told_otherwise() {
        use LineStatus::{Blocked, Driven};
        let driven = [Driven, Blocked, Driven];
        assert_eq!(map(driven, 0.509).shortfall(), None);
        let little = map(driven, 0.509).shortfall_to_the_letter().expect("more than 0.5");
        assert!((little.hidden - 0.509).abs() < 1e-12);
        assert_eq!(map(driven, 0.499).shortfall_to_the_letter(), None);
        let owed = map(driven, 1.5).shortfall().expect("1.5 m is more than 0.5");
        assert_eq!(
            owed.to_string(),
            "a disc of 1.50 m may still hide something, and α is 0.50 m; 2 of 3 lines were driven from \
             end to end"
        );
    }

    #[test]
    fn nothing_is_owed_before_the_last_line_or_without_a_plan() {
        use LineStatus::{Driven, Driving, Planned};
        assert_eq!(map([Driven, Driven, Planned], 1.5).shortfall(), None);
        assert_eq!(map([Driven, Driving, Driven], 1.5).shortfall(), None);
        let unplanned = RoomMap { plan: None, ..map([Driven; 3], 1.5) };
        assert_eq!(unplanned.shortfall(), None);
    }
}
