//! The progress bar of a run without a console: one line on standard error, and only when that
//! is a terminal.

use super::Progress;
use crate::export::PHASES;
use crate::wording::clock;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Positions of the bar for each phase.
const PER_PHASE: u64 = 1000;

/// The bar.
#[derive(Debug)]
pub struct Bar {
    bar: Option<ProgressBar>,
}

impl Bar {
    /// A bar on standard error, or none at all where nobody would see it move.
    #[must_use]
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let length = PER_PHASE * PHASES.len() as u64;
            let bar =
                ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(10));
            if let Ok(style) = ProgressStyle::with_template("{bar:12} {wide_msg}") {
                bar.set_style(style.progress_chars("━╸─"));
            }
            bar
        });
        Self { bar }
    }

    /// Shows how far the run has come after `wall` seconds.
    pub fn show(&mut self, progress: &Progress, wall: f64) {
        let Some(bar) = &self.bar else { return };
        let index = PHASES.iter().position(|&phase| phase == progress.phase).unwrap_or(0);
        let within = progress.share.unwrap_or(0.0).clamp(0.0, 1.0) * PER_PHASE as f64;
        bar.set_position(index as u64 * PER_PHASE + within as u64);
        let share =
            progress.share.map_or(String::new(), |share| format!(" {:.0} %", share * 100.0));
        bar.set_message(message(progress, &share, wall));
    }

    /// Takes the bar off the screen.
    pub fn clear(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// What stands beside the bar: 80 columns hold both.
fn message(progress: &Progress, share: &str, wall: f64) -> String {
    let (time, wall) = (clock(progress.time), clock(wall));
    format!("{}{share} · robot {time}, {:.1} m · took {wall}", progress.phase, progress.travel)
}

impl Default for Bar {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::Phase;

    #[test]
    fn bar_and_message_of_a_long_run_take_one_row_of_80_columns() {
        let progress =
            Progress { phase: Phase::Boundary, share: None, time: 35_999.0, travel: 4_999.9 };
        let told = message(&progress, " 100 %", 7_199.0);
        assert_eq!(told, "boundary 100 % · robot 9:59:59, 4999.9 m · took 1:59:59");
        assert!(12 + 1 + told.chars().count() <= 80, "{told}");
    }
}
