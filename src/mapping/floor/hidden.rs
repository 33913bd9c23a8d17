//! The hidden disc: the largest disc that fits into the floor the body can reach, clear of known
//! objects, which the centre's path, widened by r + d, has not swept. The biggest thing that may
//! still stand there unnoticed.
//!
//! For a centre c it has the radius min(distance to what no body touches, distance to objects,
//! distance to the path - (r + d)). The raster gives the neighbourhood of each maximum and exact
//! distances the rest, so its pitch hardly matters.

use super::Floor;
use super::corner::Corner;
use crate::geometry::index::SegmentIndex;
use crate::geometry::raster::{Grid, Ruler, squared_distances};
use crate::geometry::{Point, Segment, Vector};
use std::cell::RefCell;

/// The largest disc that may still hide something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HiddenDisc {
    /// Metres.
    pub diameter: f64,
    /// Its centre.
    pub at: Point,
}

/// A maximum is followed up until it is known to this, metres.
const FINE: f64 = 0.001;

/// Cells that differ by less than this are level, metres.
const LEVEL: f32 = 1e-5;

/// Sixteen directions, evenly spread.
pub(super) const DIRECTIONS: [Vector; 16] = {
    const C: f64 = 0.923_879_532_511_286_7;
    const S: f64 = 0.382_683_432_365_089_8;
    const H: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        Vector::new(1.0, 0.0),
        Vector::new(C, S),
        Vector::new(H, H),
        Vector::new(S, C),
        Vector::new(0.0, 1.0),
        Vector::new(-S, C),
        Vector::new(-H, H),
        Vector::new(-C, S),
        Vector::new(-1.0, 0.0),
        Vector::new(-C, -S),
        Vector::new(-H, -H),
        Vector::new(-S, -C),
        Vector::new(0.0, -1.0),
        Vector::new(S, -C),
        Vector::new(H, -H),
        Vector::new(C, -S),
    ]
};

/// The field of radii on one floor for one path.
pub(in crate::mapping) struct Unswept<'a> {
    floor: &'a Floor,
    path: SegmentIndex,
    /// For every cell the radius of the disc around it; a little too large where the body cannot
    /// be centred, because there the distance to the wall stands in for the corner's shape.
    pub(in crate::mapping) field: Vec<f32>,
    corner: RefCell<Option<Corner>>,
}

impl<'a> Unswept<'a> {
    pub(in crate::mapping) fn new(floor: &'a Floor, path: Vec<Segment>) -> Self {
        let squared = squared_distances(&floor.grid, &path);
        Self::at(floor, path, &squared)
    }

    /// The same of a `path` from which the cells of the floor's raster are known to be so far, metres `squared`.
    pub(super) fn at(floor: &'a Floor, path: Vec<Segment>, squared: &[f32]) -> Self {
        let reach = floor.reach as f32;
        let radii = squared.iter().zip(&floor.free);
        let field = radii.map(|(square, &free)| free.min(square.sqrt() - reach)).collect();
        Self { floor, path: SegmentIndex::new(path, 0.25), field, corner: RefCell::new(None) }
    }

    /// The same with more driven: only where that comes nearer is anything worked out anew.
    pub(in crate::mapping) fn and(&self, more: &[Segment]) -> Self {
        let floor = self.floor;
        let mut field = self.field.clone();
        for segment in more {
            lower(&floor.grid, segment, floor.reach, &mut field);
        }
        let path = self.path.segments().iter().chain(more).copied().collect();
        Self { floor, path: SegmentIndex::new(path, 0.25), field, corner: RefCell::new(None) }
    }

    /// Depth of the corner at `p`; a climb asks again and again in one place.
    fn corner_depth(&self, p: Point) -> f64 {
        let mut corner = self.corner.borrow_mut();
        match corner.as_ref() {
            Some(known) if known.covers(p) => known.depth(p),
            _ => corner.insert(self.floor.corner(p)).depth(p),
        }
    }

    /// Radius of the disc around `p`, exactly.
    pub(in crate::mapping) fn radius(&self, p: Point) -> f64 {
        self.radius_over(p, 0.0)
    }

    /// The same if it is more than `needed`; else anything up to that.
    fn radius_over(&self, p: Point, needed: f64) -> f64 {
        let floor = self.floor;
        // The raster says within a pitch how far the walls are, and most places fail by the path.
        let (near, far) = floor.wall_bounds(p);
        if far <= needed {
            return far;
        }
        let off = self.path.distance_between(p, needed + floor.reach, far + floor.reach);
        let mut least = off - floor.reach;
        if least <= needed {
            return least;
        }
        let wall = if near >= least.max(floor.radius) { near } else { floor.wall_clearance(p) };
        least = least.min(wall);
        least = least.min(floor.object_clearance_within(p, least));
        if wall < floor.radius && least > needed.max(0.0) {
            least = least.min(self.corner_depth(p));
        }
        least
    }

    /// The `most` largest discs of at least `diameter`, largest first: from each cell that is no
    /// smaller than those around it, uphill.
    pub(in crate::mapping) fn spots(&self, diameter: f64, most: usize) -> Vec<HiddenDisc> {
        let slack = 0.75 * self.floor.grid.cell;
        let mut least = diameter / 2.0 - slack;
        if most == 1 {
            // Where the body can be centred the raster is exact: no top below that matters.
            let touchable = self.field.iter().zip(&self.floor.touchable);
            let best = touchable.filter(|(_, on)| **on).map(|(&r, _)| r);
            least = least.max(f64::from(best.fold(0.0, f32::max)) - slack);
        }
        let mut tops: Vec<usize> = (0..self.field.len())
            .filter(|&cell| f64::from(self.field[cell]) > least)
            .filter(|&cell| self.is_top(cell) && self.is_inside(cell))
            .collect();
        tops.sort_by(|&a, &b| self.field[b].total_cmp(&self.field[a]).then(a.cmp(&b)));
        let mut found: Vec<HiddenDisc> = Vec::new();
        for cell in tops {
            let bound = 2.0 * (f64::from(self.field[cell]) + slack);
            if found.len() >= most && found.last().is_some_and(|d| d.diameter >= bound) {
                break;
            }
            let needed = found.last().map_or(least, |d| d.diameter / 2.0);
            let needed = if found.len() < most { diameter / 2.0 } else { needed };
            let disc = self.climb(self.floor.grid.point(cell), needed);
            let known = |other: &HiddenDisc| (other.at - disc.at).norm() < self.floor.grid.cell;
            if disc.diameter >= diameter.max(2.0 * FINE) && !found.iter().any(known) {
                found.push(disc);
                found.sort_by(|a, b| b.diameter.total_cmp(&a.diameter));
                found.truncate(most);
            }
        }
        found
    }

    /// Whether a cell is no smaller than those around it; of a level ridge only the first cell is,
    /// so that a long corridor does not count as a thousand maxima.
    fn is_top(&self, cell: usize) -> bool {
        let value = self.field[cell];
        self.floor.grid.neighbours(cell).into_iter().flatten().all(|near| {
            let other = self.field[near];
            other <= value + LEVEL && (near > cell || other < value - LEVEL)
        })
    }

    /// Whether the body can touch something there: it fits, or it fits within its own radius.
    fn is_inside(&self, cell: usize) -> bool {
        let floor = self.floor;
        if floor.touchable[cell] {
            return true;
        }
        floor.wall[cell] > -(floor.grid.cell as f32) && floor.touches_near(floor.grid.point(cell))
    }

    /// Uphill from `from` in ever smaller steps; given up where it will not come to `needed`.
    fn climb(&self, from: Point, needed: f64) -> HiddenDisc {
        let (mut at, mut here) = (from, self.radius(from));
        let mut step = 0.7 * self.floor.grid.cell;
        let mut odd = 0;
        while step > FINE / 2.0 {
            let mut best: Option<(Point, f64)> = None;
            // Half of the directions at a time, the others next.
            for direction in DIRECTIONS.into_iter().skip(odd).step_by(2) {
                let next = at + direction * step;
                let most = best.map_or(here, |(_, most)| most);
                let radius = self.radius_over(next, most);
                if radius > most {
                    best = Some((next, radius));
                }
            }
            odd = 1 - odd;
            if let Some(next) = best {
                (at, here) = next;
            } else {
                step *= 0.5;
                // The radius rises by no more than the way gone, and the top is about a step away.
                if here + 3.0 * step < needed {
                    break;
                }
            }
        }
        HiddenDisc { diameter: 2.0 * here, at }
    }
}

/// Lowers the radii that the sweep of one more segment cuts. What it cuts hangs together with the
/// swath itself, so one goes outwards from there, rim by rim, until nothing changes any more.
fn lower(grid: &Grid, segment: &Segment, reach: f64, field: &mut [f32]) {
    let ruler = Ruler::new(grid, segment);
    let (mut inner, mut outer) = (0.0, reach + 4.0 * grid.cell);
    loop {
        let mut changed = false;
        grid.rim_runs(segment, (inner, outer), |row, first, last| {
            let cells = &mut field[row * grid.width + first..=row * grid.width + last];
            ruler.measure((first, row), cells, |value, square| {
                let radius = square.sqrt() - reach as f32;
                // Where nothing fits it does not matter how much less fits now.
                changed |= radius < *value && *value > 0.0;
                *value = value.min(radius);
            });
        });
        if !changed {
            return;
        }
        (inner, outer) = (outer, outer * 1.6);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Coverage, rooms};
    use super::*;
    use crate::geometry::angle;

    fn after_lap(room: &crate::geometry::Ring, gap: f64) -> (Floor, Coverage) {
        let floor = rooms::floor(room, &[]);
        let coverage = Coverage::of(&rooms::lap(room, gap));
        (floor, coverage)
    }

    fn largest(floor: &Floor, coverage: &Coverage) -> f64 {
        coverage.largest(floor).map_or(0.0, |disc| disc.diameter)
    }

    #[test]
    fn nothing_driven_leaves_the_largest_disc_of_the_room() {
        let floor = rooms::floor(&rooms::rectangle(5.0, 4.0), &[]);
        let left = Coverage::new().largest(&floor).unwrap();
        assert!((left.diameter - 4.0).abs() < 0.002, "{left:?}");
    }

    #[test]
    fn the_lap_alone_leaves_the_inner_rectangle() {
        let (floor, coverage) = after_lap(&rooms::rectangle(5.0, 4.0), 0.145);
        let got = largest(&floor, &coverage);
        assert!((got - (4.0 - 2.0 * 0.305)).abs() < 0.002, "{got}");
    }

    #[test]
    fn parallel_lines_leave_their_spacing_less_the_swath() {
        for spacing in [0.40_f64, 0.57, 0.71] {
            let (floor, mut coverage) = after_lap(&rooms::rectangle(6.0, 4.0), 0.145);
            let mut y = 0.145 + spacing;
            while y < 3.9 {
                coverage.add_line(Point::new(0.145, y), Point::new(5.855, y));
                y += spacing;
            }
            let got = largest(&floor, &coverage);
            assert!((got - (spacing - 0.32)).abs() < 0.003, "{got} at spacing {spacing}");
        }
    }

    #[test]
    fn corners_leave_what_no_body_can_sweep() {
        // The touched floor ends in the body's arc; the sweep in that of r + d around the same
        // bisector. Along it: corner arc at (r / sin - r), sweep at (g / sin - (r + d)).
        for degrees in [90.0_f64, 60.0, 45.0, 30.0] {
            let gap = 0.145;
            let (floor, mut coverage) = after_lap(&rooms::wedge(degrees), gap);
            for k in 1..12 {
                let along = angle::unit(degrees.to_radians() * f64::from(k) / 12.0);
                let from = Point::from(along * gap / angle::sin(degrees.to_radians() / 2.0));
                coverage.add_line(from, Point::from(along * 2.8));
            }
            let sine = angle::sin(degrees.to_radians() / 2.0);
            let sliver = (gap / sine - 0.16) - (0.1 / sine - 0.1);
            let near = coverage
                .spots(&floor, 0.002)
                .into_iter()
                .find(|disc| disc.at.coords.norm() < gap / sine);
            let got = near.map_or(0.0, |disc| disc.diameter);
            assert!((got - sliver.max(0.0)).abs() < 0.004, "{got} not {sliver} at {degrees}°");
        }
    }

    #[test]
    fn known_objects_hide_nothing_themselves() {
        let boxed = rooms::boxed(1.5, 1.5, 3.5, 2.5);
        let room = rooms::rectangle(5.0, 4.0);
        let floor = rooms::floor(&room, &[&boxed]);
        let got = largest(&floor, &Coverage::of(&rooms::lap(&room, 0.145)));
        // Between the lap's swath and the box, 1.5 m from the wall, discs reach into the corner.
        assert!((1.195..1.7).contains(&got), "{got}");
    }

    #[test]
    fn spots_are_all_maxima_above_the_diameter() {
        let (floor, mut coverage) = after_lap(&rooms::rectangle(6.0, 4.0), 0.145);
        coverage.add_line(Point::new(0.145, 2.0), Point::new(5.855, 2.0));
        let spots = coverage.spots(&floor, 1.0);
        assert!(spots.iter().any(|s| s.at.y < 2.0) && spots.iter().any(|s| s.at.y > 2.0));
        assert!(spots.windows(2).all(|w| w[0].diameter >= w[1].diameter));
    }

    #[test]
    fn adding_lines_to_what_is_known_is_the_same_as_beginning_anew() {
        let (floor, coverage) = after_lap(&rooms::flat(), 0.145);
        let more = [((0.5, 0.5), (3.5, 2.0)), ((6.0, 1.0), (9.5, 1.2)), ((1.0, 5.0), (1.0, 6.0))]
            .map(|(a, b)| Segment::new(Point::new(a.0, a.1), Point::new(b.0, b.1)));
        let added = Unswept::new(&floor, coverage.segments()).and(&more);
        let mut all = coverage.segments();
        all.extend(more);
        let anew = Unswept::new(&floor, all);
        for (cell, (a, b)) in added.field.iter().zip(&anew.field).enumerate() {
            // Where nothing fits, how deep below zero it is does not matter.
            let off = (a.max(-0.1) - b.max(-0.1)).abs();
            assert!(off < 1e-4, "{a} and {b} at {}", floor.grid.point(cell));
        }
    }
}
