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
use crate::mapping::map::RoomMap;
use crate::mapping::survey::Survey;

/// After so many metres all is adjusted anew: a gyro that drifts by 20 degrees an hour turns by half a degree
/// meanwhile, and places 5 m off the middle move by less than the thinnest column.
const EVERY: f64 = 20.0;

impl Tour {
    /// Whether all is to be adjusted before the next line is chosen.
    pub(super) fn is_to_be_adjusted(&mut self, scene: &Scene<'_>) -> bool {
        let travelled = scene.tracker.travelled();
        let has_things = self.chart.objects().next().is_some();
        let is_due =
            self.chart.outline().is_circle() && has_things && travelled > self.adjusted_at + EVERY;
        if is_due {
            self.adjusted_at = travelled;
        }
        is_due
    }

    /// Goes on on `map` as it was adjusted.
    pub fn on_adjusted(&mut self, map: &RoomMap, survey: &Survey) {
        self.chart = Chart::new(map, survey);
        self.floor = None;
    }
}
