//! The free floor: how near walls and objects are, where the robot's centre can be, the way from
//! one place to another, and what may still hide unseen. It knows outlines and the robot's size;
//! it refuses to know phases, plans and how the outlines were found.

mod corner;
mod coverage;
mod hidden;
mod pocket;
mod reach;
mod route;

#[cfg(test)]
pub(crate) mod rooms;

pub use coverage::Coverage;
pub use hidden::HiddenDisc;
pub(in crate::mapping) use hidden::Unswept;
pub(in crate::mapping) use pocket::Narrow;
pub(in crate::mapping) use reach::SPARE;

use crate::geometry::index::SegmentIndex;
use crate::geometry::raster::{Grid, inside, squared_distances};
use crate::geometry::segment::chords;
use crate::geometry::{Point, Ring, Segment, ring};
use crate::robot::Chassis;

/// Arcs are cut into chords within this, metres: far below what a switch can tell.
const SAGITTA: f64 = 0.0003;
/// Good enough for a raster, metres.
const COARSE: f64 = 0.002;
/// The raster holds single precision: what it says may be off by this, metres.
const ROUNDED: f64 = 1e-5;
/// Pitch of the raster, metres, for places up to about 100 m².
const CELL: f64 = 0.03;
/// Cells at most: larger places get a coarser raster, and the same time.
const MOST_CELLS: f64 = 120_000.0;
/// Pitch of the buckets that hold walls, metres.
const BUCKET: f64 = 0.25;

/// The floor within the boundary, with the known objects standing on it.
#[derive(Debug, Clone)]
pub struct Floor {
    /// Where the values of the rasters below are taken.
    pub(crate) grid: Grid,
    /// Radius of the body, metres.
    pub(crate) radius: f64,
    /// r + d, metres.
    pub(crate) reach: f64,
    /// Half of the narrowest gap that the robot is sent through, metres.
    pub(crate) half_gap: f64,
    walls: SegmentIndex,
    objects: SegmentIndex,
    /// Distance to the boundary, metres; negative outside.
    pub(crate) wall: Vec<f32>,
    /// Distance to the boundary or the nearest object, metres; negative outside or inside one.
    pub(crate) free: Vec<f32>,
    /// Where the centre can be as far as the boundary goes, from where the robot stands.
    pub(crate) touchable: Vec<bool>,
    /// Where the centre is sent: clear of objects too, and through no gap below the passable one.
    pub(crate) drivable: Vec<bool>,
}

impl Floor {
    /// The floor inside the wall line `boundary` with `objects` on it, for a robot that stands at
    /// `from`. Orientation of the outlines does not matter.
    #[must_use]
    pub fn new(boundary: &Ring, objects: &[&Ring], chassis: &Chassis, from: Point) -> Self {
        let wall_chords = chords(&boundary.clone().counter_clockwise(), SAGITTA);
        let points: Vec<Point> = wall_chords.iter().map(|s| s.from).collect();
        let (low, high) = ring::bounds(&points).unwrap_or((from, from));
        let size = high - low;
        let cell = CELL.max((size.x * size.y / MOST_CELLS).sqrt());
        let grid = Grid::over(low, high, cell, 2.0 * cell);
        let wall = signed(&grid, &wall_chords, 1.0);
        let mut free = wall.clone();
        let coarse: Vec<_> = objects.iter().map(|object| chords(object, COARSE)).collect();
        reach::stand_on(&grid, &coarse, &mut free);
        // All the same way round, so that two outlines that overlap do not cancel each other out.
        let solids = objects.iter().map(|&object| object.clone().counter_clockwise());
        let object_chords = solids.flat_map(|object| chords(&object, SAGITTA)).collect();
        let mut floor = Self {
            grid,
            radius: chassis.radius,
            reach: chassis.reach(),
            half_gap: chassis.passable_gap() / 2.0,
            walls: SegmentIndex::new(wall_chords, BUCKET),
            objects: SegmentIndex::new(object_chords, BUCKET),
            wall,
            free,
            touchable: Vec::new(),
            drivable: Vec::new(),
        };
        floor.flood(from);
        floor
    }

    /// Distance from `p` to the nearest wall or object, metres; negative outside the boundary and
    /// inside objects.
    #[must_use]
    pub fn clearance(&self, p: Point) -> f64 {
        let wall = self.wall_clearance(p);
        wall.min(self.object_clearance_within(p, wall.abs()))
    }

    /// Whether [`Floor::clearance`] is at least `least`, a positive number of metres: most often the raster tells.
    #[must_use]
    pub fn keeps(&self, p: Point, least: f64) -> bool {
        let (low, high) = self.bounds(p);
        high >= least && (low >= least || self.clearance(p) >= least)
    }

    /// Between which two figures [`Floor::clearance`] lies where it is positive, metres, as far as the raster
    /// knows; where it is not, it is no more than the second.
    fn bounds(&self, p: Point) -> (f64, f64) {
        let (cell, off) = self.nearest_cell(p);
        let (known, off) = (f64::from(self.free[cell]), off + ROUNDED + COARSE);
        (known - off, known + off)
    }

    /// Distance from `p` to the boundary alone, metres; negative outside.
    #[must_use]
    pub fn wall_clearance(&self, p: Point) -> f64 {
        let (cell, off) = self.nearest_cell(p);
        let known = f64::from(self.wall[cell]);
        // The raster bounds the distance, so that one look is enough.
        let distance = self.walls.distance_within(p, known.abs() + off + ROUNDED);
        let within = if known.abs() > self.grid.cell {
            known > 0.0
        } else {
            winding(self.walls.segments(), p) % 2 != 0
        };
        if within { distance } else { -distance }
    }

    /// Between which two figures [`Floor::wall_clearance`] lies, metres, as far as the raster knows.
    fn wall_bounds(&self, p: Point) -> (f64, f64) {
        let (cell, off) = self.nearest_cell(p);
        let known = f64::from(self.wall[cell]);
        (known - off - ROUNDED, known + off + ROUNDED)
    }

    /// The cell nearest to `p`, and how far away it is, metres.
    fn nearest_cell(&self, p: Point) -> (usize, f64) {
        let cell = self.grid.index(p);
        (cell, (self.grid.point(cell) - p).norm())
    }

    /// Distance from `p` to the nearest object, metres; negative inside one, infinite without.
    #[must_use]
    pub fn object_clearance(&self, p: Point) -> f64 {
        if self.objects.segments().is_empty() {
            return f64::INFINITY;
        }
        let distance = self.objects.distance(p, f64::INFINITY);
        if winding(self.objects.segments(), p) == 0 { distance } else { -distance }
    }

    /// The same as far as it is less than `most`, if `p` is within the boundary; else `most` or more.
    fn object_clearance_within(&self, p: Point, most: f64) -> f64 {
        if self.objects.segments().is_empty() {
            return most;
        }
        // Nothing is nearer than the raster says, and well off every outline its sign can be trusted.
        let (cell, off) = self.nearest_cell(p);
        let known = f64::from(self.free[cell]);
        if known - off - ROUNDED > most {
            return most;
        }
        let distance = self.objects.distance_within(p, most);
        let outside = known > self.grid.cell + COARSE;
        if outside || winding(self.objects.segments(), p) == 0 {
            distance
        } else {
            -self.objects.distance(p, f64::INFINITY)
        }
    }

    /// Clearance read off the raster: a few cells' neighbours blended, good to a millimetre or
    /// two except right at corners, and much quicker.
    #[must_use]
    pub fn clearance_near(&self, p: Point) -> f64 {
        self.grid.blend(&self.free, p)
    }

    /// [`Floor::clearance_near`] with the boundary alone.
    #[must_use]
    pub fn wall_clearance_near(&self, p: Point) -> f64 {
        self.grid.blend(&self.wall, p)
    }

    /// Least distance from the way straight from `a` to `b` to any wall or object, metres; zero
    /// when it crosses one, negative when it begins outside or inside an object.
    #[must_use]
    pub fn segment_clearance(&self, a: Point, b: Point) -> f64 {
        let begin = self.clearance(a);
        if begin <= 0.0 {
            return begin;
        }
        let most = begin.min(self.clearance(b).abs());
        self.gap(&Segment::new(a, b), most)
    }

    /// Whether the way straight from `a` to `b` keeps at least `clearance` metres.
    #[must_use]
    pub fn is_clear(&self, a: Point, b: Point, clearance: f64) -> bool {
        let most = clearance.max(0.0) + 1e-9;
        self.gap(&Segment::new(a, b), most) >= clearance && self.clearance_near(a) > 0.0
    }

    fn gap(&self, way: &Segment, most: f64) -> f64 {
        let walls = self.walls.gap(way, most);
        self.objects.gap(way, walls)
    }

    /// Whether the robot's centre is sent to `p`: the body fits with a little to spare, and the
    /// way there leads through no gap below the passable one.
    #[must_use]
    pub fn is_drivable(&self, p: Point) -> bool {
        self.drivable[self.grid.index(p)]
    }

    /// Whether any object stands on the floor.
    #[must_use]
    pub fn has_objects(&self) -> bool {
        !self.objects.segments().is_empty()
    }

    /// Area of the floor that the body can reach as far as the boundary goes, square metres.
    #[must_use]
    pub fn touchable_area(&self) -> f64 {
        let cells = self.touchable.iter().filter(|&&on| on).count();
        cells as f64 * self.grid.cell * self.grid.cell
    }
}

/// Signed distance of every cell to closed outlines: `inner` is the sign inside.
fn signed(grid: &Grid, outline: &[Segment], inner: f32) -> Vec<f32> {
    squared_distances(grid, outline)
        .iter()
        .zip(inside(grid, outline))
        .map(|(square, within)| square.sqrt() * if within { inner } else { -inner })
        .collect()
}

/// How many times the outlines run round `p`, counter-clockwise.
fn winding(outline: &[Segment], p: Point) -> i32 {
    let crossings = outline.iter().map(|s| {
        let (from, to) = (s.from, s.to());
        let between = (from.y <= p.y) != (to.y <= p.y);
        let crosses = between && p.x < from.x + (p.y - from.y) / (to.y - from.y) * (to.x - from.x);
        if !crosses {
            0
        } else if from.y < to.y {
            1
        } else {
            -1
        }
    });
    crossings.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ell() -> Floor {
        rooms::floor(&rooms::ell(), &[&rooms::boxed(1.0, 1.0, 1.4, 1.3)])
    }

    #[test]
    fn clearance_is_the_distance_to_the_nearest_wall_or_object_with_its_sign() {
        let floor = ell();
        let cases = [
            ((0.5, 0.3), 0.3),
            ((2.0, 0.5), 0.5),
            ((1.2, 0.8), 0.2),
            ((1.2, 1.15), -0.15),
            ((-0.01, 1.0), -0.01),
            ((3.0, 2.5), -1.0),
            ((0.004, 2.0), 0.004),
        ];
        for ((x, y), want) in cases {
            let got = floor.clearance(Point::new(x, y));
            assert!((got - want).abs() < 1e-9, "{got} instead of {want} at {x}, {y}");
        }
    }

    #[test]
    fn what_keeps_a_clearance_has_it() {
        let column = Ring::circle(Point::new(0.7, 1.9), 0.15);
        let through_the_wall = rooms::boxed(2.5, -0.2, 3.0, 0.4);
        let solids = [&rooms::boxed(1.0, 1.0, 1.4, 1.3), &column, &through_the_wall];
        let floor = rooms::floor(&rooms::ell(), &solids);
        let mut kept = 0;
        for k in 0..40_000_u32 {
            // Places all over the room and beyond it, and clearances round that of each.
            let p =
                Point::new(f64::from(k % 200) * 0.0231 - 0.3, f64::from(k / 200) * 0.0177 - 0.3);
            let clearance = floor.clearance(p);
            let near = (clearance + 0.004 * (f64::from(k % 7) - 3.0)).max(0.01);
            for least in [near, 0.1, 0.16] {
                assert_eq!(
                    floor.keeps(p, least),
                    clearance >= least,
                    "{least} at {p}: {clearance}"
                );
                kept += u32::from(clearance >= least);
            }
        }
        assert!((10_000..110_000).contains(&kept), "{kept}");
    }

    #[test]
    fn within_two_objects_that_overlap_it_is_not_free() {
        let (one, other) = (rooms::boxed(1.0, 1.0, 2.0, 2.0), rooms::boxed(1.6, 1.2, 2.6, 2.2));
        let both = Point::new(1.8, 1.6);
        for other in [other.clone(), other.reversed()] {
            let floor = rooms::floor(&rooms::rectangle(4.0, 3.0), &[&one, &other]);
            let cases = [(both, -0.2), (Point::new(1.2, 1.5), -0.2), (Point::new(2.4, 1.7), -0.2)];
            for (at, want) in cases {
                let got = [floor.clearance(at), floor.object_clearance(at)];
                assert!(got.iter().all(|got| (got - want).abs() < 1e-9), "{got:?} at {at}");
            }
            assert!((floor.clearance(Point::new(1.2, 2.4)) - 0.4).abs() < 1e-9);
        }
    }

    #[test]
    fn the_clearance_of_a_way_is_the_least_along_it() {
        let floor = ell();
        let at = Point::new;
        let cases = [
            (at(0.3, 0.5), at(3.0, 0.5), 0.3),
            (at(0.6, 0.5), at(0.6, 2.5), 0.4),
            (at(0.5, 1.1), at(2.0, 1.1), 0.0),
            (at(1.5, 2.0), at(3.0, 1.0), 0.0),
        ];
        for (a, b, want) in cases {
            let got = floor.segment_clearance(a, b);
            assert!((got - want).abs() < 1e-9, "{got} instead of {want}, {a} to {b}");
            assert!(want <= 0.0 || floor.is_clear(a, b, want - 1e-6), "{a} to {b}");
            assert!(!floor.is_clear(a, b, want + 1e-6), "{a} to {b}");
        }
    }
}
