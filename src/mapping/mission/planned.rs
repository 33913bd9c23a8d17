//! The lines of the plan go along with the map: they were planned on walls as they were believed then, and the touches
//! of the tour have moved those since. Done when the map is handed over; the robot drove by the lines as they were.

use super::Mission;
use crate::geometry::{Point, Vector};
use crate::mapping::map::Contact;
use crate::mapping::network::displacement;

/// What the plan was made on.
#[derive(Debug, Clone, Default)]
pub(super) struct PlannedOn {
    /// The boundary's contacts, as they were believed.
    contacts: Vec<Contact>,
    /// So many lines there were; those after them were added on the way, where the walls were then.
    lines: usize,
}

impl Mission {
    /// Keeps what the plan that there is was made on.
    pub(super) fn keep_planned(&mut self) {
        let lines = self.map.plan.as_ref().map_or(0, |plan| plan.lines.len());
        self.planned_on = PlannedOn { contacts: self.map.contacts.clone(), lines };
    }

    /// Moves the lines of the plan as the walls have moved that they lead to.
    pub(super) fn move_planned(&mut self) {
        let PlannedOn { contacts, lines } = std::mem::take(&mut self.planned_on);
        let now = &self.map.contacts;
        let same =
            |(a, b): (&Contact, &Contact)| (a.time_us(), a.sensor) == (b.time_us(), b.sensor);
        let alike = contacts.len() == now.len() && contacts.iter().zip(now).all(same);
        let Some(plan) = self.map.plan.as_mut().filter(|_| alike) else { return };
        let mut last: Option<(Point, Vector)> = None;
        for line in plan.lines.iter_mut().take(lines) {
            // Many lines in a row begin at one vertex.
            let at_start = match last {
                Some((at, by)) if at == line.start => by,
                _ => displacement(&contacts, now, line.start),
            };
            last = Some((line.start, at_start));
            let at_end = displacement(&contacts, now, line.end);
            line.start += at_start;
            line.end += at_end;
            if let Some((from, to)) = &mut line.drive {
                *from += at_start;
                *to += at_end;
            }
        }
    }
}
