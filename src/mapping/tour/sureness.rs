//! Since when the robot may have been somewhere else than it believes, if it turns out that it is: the last
//! time that its place was sure, and the lines that ended since. It was sure where two walls were felt for
//! and found, and where contacts of walls that run across each other lay where they had to.

use crate::geometry::angle;

/// A contact this near to what it is of, metres, says that the robot is where it believes it is, as far as
/// one direction goes.
const AGREES: f64 = 0.03;
/// Directions less far apart than this are one, radians.
const ONE: f64 = angle::FRAC_PI_4;

/// What it says.
#[derive(Debug, Clone, Default)]
pub(super) struct Sureness {
    since_us: u64,
    /// The last contact with walls of each direction that lay where it had to: along the wall, map frame, and
    /// robot time.
    agreed: Vec<(f64, u64)>,
    /// Lines that ended since: number, whether driven from the end, robot time.
    ended: Vec<(u32, bool, u64)>,
    /// When the robot was somewhere else, as it turned out: after the one until the other.
    astray: Vec<(u64, u64)>,
}

/// The angle between two lines of these directions, 0 to a quarter turn.
fn between(a: f64, b: f64) -> f64 {
    let off = angle::wrap(a - b).abs();
    off.min(angle::PI - off)
}

impl Sureness {
    /// Robot time since when the place is not sure, microseconds.
    pub(super) fn since_us(&self) -> u64 {
        self.since_us
    }

    /// The place is sure at `now_us`.
    pub(super) fn at(&mut self, now_us: u64) {
        self.since_us = self.since_us.max(now_us);
        self.ended.retain(|(.., at)| *at > self.since_us);
    }

    /// The boundary was touched `off` metres away from where it is mapped, at `time_us` (robot time, microseconds),
    /// where it runs `along` this direction. That of the beam says less: one wall is seen at many bearings.
    pub(super) fn touched(&mut self, along: f64, off: f64, time_us: u64) {
        if off > AGREES {
            self.agreed.clear();
            return;
        }
        let across = self.agreed.iter().filter(|(other, _)| between(*other, along) > ONE);
        // Both agree: it was where it believed to be when the earlier one was made.
        let earlier = across.map(|(_, at)| *at).max();
        self.agreed.retain(|(other, _)| between(*other, along) > ONE);
        self.agreed.push((along, time_us));
        if let Some(earlier) = earlier {
            self.at(earlier);
        }
    }

    /// It turned out that the robot was somewhere else, from then on until `until_us`.
    pub(super) fn was_not_until(&mut self, until_us: u64) {
        self.astray.push((self.since_us, until_us));
    }

    /// Whether nobody knows where the robot was at that time.
    pub(super) fn was_astray(&self, time_us: u64) -> bool {
        self.astray.iter().any(|(after, until)| (*after + 1..=*until).contains(&time_us))
    }

    /// A line came to its end.
    pub(super) fn ended(&mut self, id: u32, backwards: bool, now_us: u64) {
        self.ended.push((id, backwards, now_us));
    }

    /// The lines that ended since, in order, to be driven again.
    pub(super) fn take_ended(&mut self) -> Vec<(u32, bool)> {
        std::mem::take(&mut self.ended).into_iter().map(|(id, back, _)| (id, back)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_that_run_across_each_other_say_where_the_robot_was_at_the_earlier_contact() {
        let mut sure = Sureness::default();
        let mut touched = |along: f64, off: f64, time_us: u64| {
            sure.touched(along.to_radians(), off, time_us);
            sure.since_us()
        };
        touched(0.0, 0.01, 10);
        touched(180.0, 0.01, 20);
        assert_eq!(touched(10.0, 0.02, 30), 0, "one direction only");
        assert_eq!(touched(95.0, 0.01, 40), 30);
        touched(-80.0, 0.2, 50);
        assert_eq!(touched(0.0, 0.01, 60), 30, "it did not lie where it had to");
        assert_eq!(touched(90.0, 0.01, 70), 60);
    }

    #[test]
    fn lines_that_ended_before_that_are_done() {
        let mut sure = Sureness::default();
        sure.ended(1, false, 10);
        sure.ended(2, true, 20);
        sure.at(15);
        sure.ended(3, false, 30);
        assert_eq!(sure.take_ended(), [(2, true), (3, false)]);
        assert_eq!(sure.take_ended(), []);
    }
}
