//! A taped length laid on the map: all of it is stretched until the length is what the tape said. Which wall was
//! taped, and how far that may be believed, is for `tape` to know.

use super::{Mission, Output};
use crate::geometry::{Point, Ring};
use crate::mapping::event::EventKind;
use crate::mapping::shape;
use crate::mapping::tape::{Tape, Taped, Untaped};

/// A taped length is laid on the map at most so often; each time the outline is fitted anew.
const TAPINGS: u32 = 4;

impl Mission {
    /// Stretches all that was mapped towards what the tape said, if there is one, as far as its ends are
    /// known.
    pub(super) fn lay_tape(&mut self, out: &mut Vec<Output>) {
        let Some(tape) = self.settings.tape else { return };
        let Some(fitted) = self.map.shape.as_ref().map(|shape| shape.outline.clone()) else {
            return;
        };
        let outline = self.taped(tape, fitted, out);
        self.map.shape = Some(shape::identify(outline, &self.map.contacts));
    }

    /// The outline `fitted` once all is stretched to where `tape` says.
    fn taped(&mut self, tape: Tape, fitted: Ring, out: &mut Vec<Output>) -> Ring {
        let Some(length) = tape.on(&fitted) else {
            return self.not_taped(Untaped::Nowhere, fitted, out);
        };
        if length.is_vague() {
            return self.not_taped(Untaped::Vague, fitted, out);
        }
        let (mapped, before) = (length.mapped, self.tracker.stretched());
        if tape.stretch(length, self.tracker.stretched()).is_none() {
            return self.not_taped(Untaped::Refused { mapped, taped: tape.length }, fitted, out);
        }
        let mut outline = fitted.clone();
        for _ in 0..TAPINGS {
            let length = tape.on(&outline);
            let stretched = self.tracker.stretched();
            let stretch = length.and_then(|length| tape.stretch(length, stretched));
            let Some(stretch) = stretch else { break };
            if (stretch - 1.0).abs() < 1e-5 {
                break;
            }
            self.stretch(stretch);
            let again = if self.map.beyond.is_empty() {
                self.fitted_outline()
            } else {
                // A fit would draw wall across the straits.
                let start = self.settings.start.position;
                Ok(outline.deformed(|at| (at - start) * (stretch - 1.0)))
            };
            let Ok(again) = again else {
                self.stretch(before / self.tracker.stretched());
                let why = Untaped::Refused { mapped, taped: tape.length };
                return self.not_taped(why, fitted, out);
            };
            outline = again;
        }
        let stretch = self.tracker.stretched();
        // As it was before any tape: that is what it is stretched from.
        let mapped = mapped / before;
        let sd = length.doubt();
        self.map.taped = Some(Taped { mapped, taped: tape.length, stretch, sd });
        self.map.untaped = None;
        self.tell(EventKind::TapeLaid { mapped, taped: tape.length, stretch }, out);
        outline
    }

    /// The tape made nothing of `outline`, and says why: who watches hears of it now, and who does not at the end.
    fn not_taped(&mut self, why: Untaped, outline: Ring, out: &mut Vec<Output>) -> Ring {
        let told = match why {
            Untaped::Nowhere => EventKind::TapeNowhere,
            Untaped::Vague => EventKind::TapeVague,
            Untaped::Refused { mapped, taped } => EventKind::TapeRefused { mapped, taped },
        };
        self.tell(told, out);
        self.map.untaped = Some(why);
        outline
    }

    /// Lays the tape on the outline that there is, when the operator has just read it.
    pub(super) fn tape_shape(&mut self, out: &mut Vec<Output>) {
        self.lay_tape(out);
        self.state_errors(self.map.accuracy.as_ref().and_then(|accuracy| accuracy.datum));
    }

    /// Stretches the way the robot went, and what it saw from there, away from the start.
    fn stretch(&mut self, stretch: f64) {
        let start = self.settings.start.position;
        let moved = |at: Point| (at - start) * (stretch - 1.0);
        for contact in &mut self.map.contacts {
            let by = moved(contact.from);
            contact.point += by;
            contact.from += by;
        }
        for object in &mut self.map.objects {
            object.displace(moved);
        }
        for beyond in &mut self.map.beyond {
            beyond.displace(moved);
        }
        for stroke in &mut self.way {
            *stroke = stroke.placed(|at, _| at + moved(at));
        }
        let before = self.tracker.pose();
        self.tracker.stretch(stretch, start);
        let now = self.tracker.pose();
        // What a further lap begins with is where the robot is.
        self.beside =
            self.beside.take().map(|beside| beside.moved(&before, &now).stretched(stretch));
        self.survey.stretch(stretch, start);
        self.rest.pose = self.tracker.pose();
    }
}
