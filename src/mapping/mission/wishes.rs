//! What the operator may change while a run is under way: α, the squaring of the map, a taped length, its end.

use super::{Mission, Outcome, Output, Task};
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::square::square;
use crate::mapping::tape::Tape;
use crate::mapping::tour::Tour;

impl Mission {
    /// Whether the plan, and what it is made from, may still be changed: nothing of it is driven yet.
    #[must_use]
    pub fn plan_is_open(&self) -> bool {
        let begun =
            matches!(&self.task, Task::Tour(tour) | Task::Relocate(_, tour) if tour.has_begun());
        !begun && self.outcome == Outcome::Going
    }

    /// Uses another α. The plan is made anew if there is one and none of it is driven yet; with
    /// lines driven it stays as it is, and false comes back.
    pub fn set_alpha(&mut self, alpha: f64, out: &mut Vec<Output>) -> bool {
        if !self.plan_is_open() {
            return false;
        }
        self.settings.alpha = alpha;
        self.tell(EventKind::AlphaSet { alpha }, out);
        if self.map.plan.is_some() {
            self.make_plan(out);
            self.task = Task::Tour(Box::new(Tour::new(&self.settings, &self.map, &self.survey)));
        }
        true
    }

    /// Squares the map that is handed over, or undoes that.
    pub fn toggle_square(&mut self, out: &mut Vec<Output>) {
        self.settings.square = !self.settings.square;
        let wanted = self.settings.square;
        match &self.map.shape {
            None => self.tell(EventKind::SquareNoted { wanted }, out),
            // What was never squared is not unsquared either.
            Some(shape) if !wanted && square(&shape.outline).is_some() => {
                self.tell(EventKind::Unsquared, out);
            }
            Some(_) if !wanted => self.tell(EventKind::NothingSquare, out),
            Some(_) => self.tell_squared(out),
        }
    }

    /// Tells what squaring makes of the outline, if that is wanted.
    pub(super) fn tell_squared(&mut self, out: &mut Vec<Output>) {
        let Some(shape) = self.map.shape.as_ref().filter(|_| self.settings.square) else {
            return;
        };
        let squared = square(&shape.outline).map(|(_, squared)| squared);
        self.tell(EventKind::squared(squared.as_ref()), out);
    }

    /// Takes a taped length: now when there is an outline, else as soon as there is one. With lines of
    /// the plan driven the map stays as it is, and false comes back.
    pub fn set_tape(&mut self, tape: Tape, out: &mut Vec<Output>) -> bool {
        if !self.plan_is_open() {
            return false;
        }
        let before = self.settings.tape.replace(tape);
        let replaced = before.map(|before| EventKind::TapeReplaced { taped: before.length });
        // A lap under way is beside walls as they were mapped.
        if self.map.shape.is_none() || matches!(self.task, Task::Retrace(_)) {
            self.tell_all(replaced.into_iter().collect(), out);
            self.tell(EventKind::TapeNoted { taped: tape.length }, out);
            return true;
        }
        let mut told = Vec::new();
        self.tape_shape(&mut told);
        if self.map.untaped.is_some() && self.map.taped.is_some() {
            // The map stays as the one before made it.
            (self.settings.tape, self.map.untaped) = (before, None);
        } else {
            self.tell_all(replaced.into_iter().collect(), out);
        }
        out.extend(told);
        if self.map.plan.is_some() {
            self.make_plan(out);
            self.task = Task::Tour(Box::new(Tour::new(&self.settings, &self.map, &self.survey)));
        }
        true
    }

    /// The operator ends the run.
    pub fn finish(&mut self, out: &mut Vec<Output>) {
        if self.outcome == Outcome::Going {
            self.fail(Failure::Ended, out);
        }
    }
}
