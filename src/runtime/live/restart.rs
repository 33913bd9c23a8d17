//! A robot that was started again counts its time and its wheels from nothing. The run goes on counting
//! where it was: nothing moved in between, as far as the run knows.

use crate::journal::Life;
use crate::robot::{Odometer, Telemetry};

/// What is added to all that the robot counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restart(Odometer);

impl Restart {
    /// The robot now counts `first` where the run had counted `last`.
    pub(super) fn between(last: &Odometer, first: &Odometer) -> Self {
        Self(Odometer {
            time_us: last.time_us.saturating_sub(first.time_us),
            left_ticks: last.left_ticks.saturating_sub(first.left_ticks),
            right_ticks: last.right_ticks.saturating_sub(first.right_ticks),
            heading: last.heading - first.heading,
        })
    }

    /// As it was recorded.
    pub(super) fn recorded(life: &Life) -> Self {
        Self(life.beyond)
    }

    /// To be recorded, of the life `boot`.
    pub(super) fn life(&self, boot: u32) -> Life {
        Life { boot, beyond: self.0 }
    }

    fn odometer(&self, told: Odometer) -> Odometer {
        Odometer {
            // A robot may say any number; the session asks whether it can be.
            time_us: told.time_us.saturating_add(self.0.time_us),
            left_ticks: told.left_ticks.saturating_add(self.0.left_ticks),
            right_ticks: told.right_ticks.saturating_add(self.0.right_ticks),
            heading: told.heading + self.0.heading,
        }
    }

    /// The same message as the run counts.
    pub(super) fn of(&self, told: &Telemetry) -> Telemetry {
        let mut told = *told;
        match &mut told {
            Telemetry::Report { odometer, .. } | Telemetry::Done { odometer, .. } => {
                *odometer = self.odometer(*odometer);
            }
            Telemetry::Edge(edge) => edge.odometer = self.odometer(edge.odometer),
        }
        told
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From one life to the next nothing moves, and from then on all moves as the robot says.
    #[test]
    fn a_new_life_counts_on_from_the_old_one() {
        let odometer = |time_us: u64, left: i64, right: i64, heading: f64| Odometer {
            time_us,
            left_ticks: left,
            right_ticks: right,
            heading,
        };
        let (last, first) = (odometer(9_000_000, 700, 650, 2.5), odometer(20_000, 3, -4, 0.25));
        let restart = Restart::between(&last, &first);
        assert_eq!(restart.odometer(first), last);
        let later = odometer(120_000, 13, 16, 0.5);
        assert_eq!(restart.odometer(later), odometer(9_100_000, 710, 670, 2.75));
        assert_eq!(Restart::recorded(&restart.life(4)), restart);
    }
}
