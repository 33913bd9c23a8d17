//! Round rooms. A wall that is the same all the way round tells how far off it the robot is and nothing of where along
//! it: by how much the robot has turned about the middle of the room, gyro and things alone can tell. The filter does
//! worse than not to know. It takes each touch as it comes, linear about what it believed then, and what it makes of
//! hundreds of them on one circle is a turn that nobody measured (filters for simultaneous localisation and mapping
//! are known to: Huang, Mourikis and Roumeliotis 2010), until things that are met again are taken for others. All
//! readings adjusted at once know better; so once there are things, that is done on the way.
//!
//! It refuses to know how anything is adjusted, and what becomes of the map.

use super::{Scene, Tour};
use crate::mapping::chart::Chart;
use crate::mapping::floor::Coverage;
use crate::mapping::map::RoomMap;
use crate::mapping::survey::Survey;
use crate::mapping::wall::Wall;

/// After so many metres all is adjusted anew: that takes about 150 s, in which a gyro that drifts by 20 degrees an hour
/// turns by less than one, and what is 5 m off the middle moves by less than a tenth of a metre.
const EVERY: f64 = 20.0;

impl Tour {
    /// Whether all is to be adjusted before the next line is chosen: not while something is only half done that holds
    /// on to where things are.
    pub(super) fn is_to_be_adjusted(&mut self, scene: &Scene<'_>) -> bool {
        let travelled = scene.tracker.travelled();
        // A tour begins on a map that was just adjusted.
        let last = *self.adjusted_at.get_or_insert(travelled);
        let holds_on = !self.halves.is_empty() || self.look_next.is_some() || self.to_tie.is_some();
        let has_things = self.chart.objects().next().is_some();
        let is_due =
            self.chart.outline().is_circle() && has_things && !holds_on && travelled > last + EVERY;
        if is_due {
            self.adjusted_at = Some(travelled);
        }
        is_due
    }

    /// Goes on on `map` as it was adjusted. With that, the way that the robot drove lies elsewhere.
    pub fn on_adjusted(&mut self, map: &RoomMap, survey: &Survey) {
        self.chart = Chart::new(map, survey);
        self.floor = None;
        (self.covered, self.coverage) = (0, Coverage::new());
        self.wall = Wall::new(&self.chassis);
    }
}
