//! Places along the way of which the survey keeps the error, and what is mapped that hangs on them. Knows
//! nothing of what corrects them.

use super::{FIRST_KNOT, Knot, Survey, Tie};
use crate::geometry::{Point, Pose, Vector, angle, perp};
use crate::mapping::map::Contact;
use nalgebra::DVector;
use std::ops::Range;

/// What a mapped outline hangs on.
#[derive(Debug, Clone, PartialEq)]
pub enum Hung {
    /// All of it on one place.
    Once(Tie),
    /// Each contact on those of these knots between which it was seen.
    Along(Range<usize>),
}

impl Hung {
    /// What was seen at `time_us` (robot time) hangs on.
    #[must_use]
    pub fn tie(&self, survey: &Survey, time_us: u64) -> Tie {
        match self {
            Self::Once(tie) => *tie,
            Self::Along(knots) => survey.tie_within(time_us, knots),
        }
    }

    /// What `place` of the outline hangs on: as the nearest of its `contacts`.
    #[must_use]
    pub fn beside(&self, survey: &Survey, contacts: &[Contact], place: Point) -> Tie {
        if let Self::Once(tie) = self {
            return *tie;
        }
        let off = |contact: &&Contact| (contact.point - place).norm_squared();
        let nearest = contacts.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
        self.tie(survey, nearest.map_or(0, Contact::time_us))
    }
}

impl Survey {
    /// Keeps the error of the pose, believed to be at `at`, as a knot; returns what to tie to it.
    pub fn mark(&mut self, at: Point, time_us: u64) -> Tie {
        let size = self.mean.len();
        self.covariance.repeat();
        let pose = [self.mean[0], self.mean[1], self.mean[2]];
        self.mean =
            std::mem::replace(&mut self.mean, DVector::zeros(0)).resize_vertically(size + 3, 0.0);
        for (k, value) in pose.into_iter().enumerate() {
            self.mean[size + k] = value;
        }
        self.knots.push(Knot { at, time_us });
        let index = self.knots.len() - 1;
        Tie { first: index, second: index, share: 0.0 }
    }

    /// What was seen at `time_us` on the lap hangs on the knots before and after; only the first
    /// `count` knots are looked at.
    #[must_use]
    pub fn tie(&self, time_us: u64, count: usize) -> Tie {
        self.tie_within(time_us, &(0..count))
    }

    /// The same for the knots `within`, which follow each other in time.
    #[must_use]
    pub fn tie_within(&self, time_us: u64, within: &Range<usize>) -> Tie {
        let offset = within.start.min(self.knots.len());
        let knots = &self.knots[offset..within.end.clamp(offset, self.knots.len())];
        let after = knots.partition_point(|knot| knot.time_us <= time_us);
        let first = after.saturating_sub(1);
        let second = after.min(knots.len().saturating_sub(1));
        let (from, to) = (knots[first].time_us, knots[second].time_us);
        let share = if to > from {
            (time_us.saturating_sub(from) as f64 / (to - from) as f64).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Tie { first: offset + first, second: offset + second, share }
    }

    /// A round from knot `begun` to knot `back` has closed, and is mapped as seen from where it began. Its
    /// knots are moved to where that map has them; what is left to correct of each is what is left of the
    /// beginning, while their covariances stay. Returns the knots of the round.
    pub fn mapped_from(&mut self, begun: &Tie, back: &Tie) -> Range<usize> {
        let turn = self.mean[FIRST_KNOT + 3 * begun.first + 2];
        for index in begun.first + 1..=back.first {
            let row = FIRST_KNOT + 3 * index;
            let believed = self.knots[index].at + Vector::new(self.mean[row], self.mean[row + 1]);
            let at = believed - self.displacement(believed, begun);
            let moved = self.displacement(at, begun);
            self.knots[index].at = at;
            for (k, value) in [moved.x, moved.y, turn].into_iter().enumerate() {
                self.mean[row + k] = value;
            }
        }
        begun.first..back.first + 1
    }

    /// Takes the corrections so far as the new nominal survey.
    pub fn rebase(&mut self) {
        for (index, knot) in self.knots.iter_mut().enumerate() {
            let row = FIRST_KNOT + 3 * index;
            knot.at += Vector::new(self.mean[row], self.mean[row + 1]);
            for k in 0..3 {
                self.mean[row + k] = 0.0;
            }
        }
    }

    /// How many knots there are.
    #[must_use]
    pub fn knots(&self) -> usize {
        self.knots.len()
    }

    /// Where the first knot that `tie` hangs on was believed to be when it was marked.
    #[must_use]
    pub fn place_of(&self, tie: &Tie) -> Point {
        self.knots[tie.first].at
    }

    /// By how much what is tied by `tie` and was believed at `point` when its knots were marked is
    /// now believed to be elsewhere.
    #[must_use]
    pub fn displacement(&self, point: Point, tie: &Tie) -> Vector {
        let of = |index: usize| {
            let row = FIRST_KNOT + 3 * index;
            let arm = perp(point - self.knots[index].at);
            Vector::new(self.mean[row], self.mean[row + 1]) + arm * self.mean[row + 2]
        };
        of(tie.first) * (1.0 - tie.share) + of(tie.second) * tie.share
    }

    /// Where a pose goes that hangs on `tie`.
    #[must_use]
    pub fn place(&self, pose: Pose, tie: &Tie) -> Pose {
        let of = |index: usize| self.mean[FIRST_KNOT + 3 * index + 2];
        let turn = of(tie.first) * (1.0 - tie.share) + of(tie.second) * tie.share;
        Pose {
            position: pose.position + self.displacement(pose.position, tie),
            heading: angle::wrap(pose.heading + turn),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_mapped_from_a_place_moves_with_it_until_more_is_known() {
        let mut survey = Survey::new(0.003);
        let begun = survey.mark(Point::new(1.0, 0.0), 0);
        survey.mark(Point::new(3.0, 0.0), 10_000_000);
        let back = survey.mark(Point::new(1.0, 0.1), 20_000_000);
        // The beginning is off by 20 mm and 10 mrad, the far side by 50 mm more.
        let off = [[0.02, 0.0, 0.01], [0.07, 0.02, 0.03], [0.02, 0.0, 0.01]];
        for (row, value) in off.concat().into_iter().enumerate() {
            survey.mean[FIRST_KNOT + row] = value;
        }
        let knots = survey.mapped_from(&begun, &back);
        assert_eq!(knots, 0..3);
        let far = survey.tie_within(10_000_000, &knots);
        // Where it was believed, with its own correction and without that of the beginning.
        let at = survey.place_of(&far);
        let nominal = Point::new(3.05, 0.0);
        assert!((at - nominal).norm() < 1e-3, "{at}");
        for place in [nominal, Point::new(3.0, 0.4)] {
            let [with, alone] = [&far, &begun].map(|tie| survey.displacement(place, tie));
            assert!((with - alone).norm() < 1e-3, "{with} and {alone}");
        }
        // Later the far side is found to be off by itself.
        survey.mean[FIRST_KNOT + 3] += 0.03;
        let moved = survey.displacement(nominal, &far) - survey.displacement(nominal, &begun);
        assert!((moved.x - 0.03).abs() < 1e-3 && moved.y.abs() < 1e-3, "{moved}");
    }
}
