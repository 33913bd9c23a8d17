//! The hidden disc: the largest disc that fits into the floor the body can reach, clear of known
//! objects, which the centre's path, widened by r + d, has not swept. The biggest thing that may
//! still stand there unnoticed.
//!
//! For a centre c it has the radius min(distance to what no body touches, distance to objects,
//! distance to the path - (r + d)). The raster gives the neighbourhood of each maximum and exact
//! distances the rest, so its pitch hardly matters.

use super::{Floor, reach};
use crate::geometry::index::SegmentIndex;
use crate::geometry::raster::Nearest;
use crate::geometry::{Point, Segment, Vector, cross};

/// The largest disc that may still hide something.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HiddenDisc {
    /// Metres.
    pub diameter: f64,
    /// Its centre.
    pub at: Point,
}

/// A path driven is kept as straight segments that stray no more than this from it, metres.
const STRAIGHT: f64 = 0.001;
/// A maximum is followed up until it is known to this, metres.
const FINE: f64 = 0.0005;

/// Where the centre has been: grows as the robot drives.
#[derive(Debug, Clone, Default)]
pub struct Coverage {
    segments: Vec<Segment>,
    run: Option<Run>,
}

/// The straight run that the path is on: where it began, where it has come to, and the directions
/// (a wedge between two vectors) that pass all places in between closely enough.
#[derive(Debug, Clone, Copy)]
struct Run {
    from: Point,
    to: Point,
    right: Option<(Vector, Vector)>,
}

impl Coverage {
    /// Nothing driven yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What driving along `path` covers.
    #[must_use]
    pub fn of(path: &[Point]) -> Self {
        let mut coverage = Self::new();
        coverage.add(path);
        coverage
    }

    /// Adds a piece of path of its own, not joined to what came before.
    pub fn add(&mut self, path: &[Point]) {
        self.lift();
        for &p in path {
            self.push(p);
        }
    }

    /// Adds the straight way from `a` to `b`.
    pub fn add_line(&mut self, a: Point, b: Point) {
        self.lift();
        self.segments.push(Segment::new(a, b));
    }

    /// Adds the way from the last place to `p`.
    pub fn push(&mut self, p: Point) {
        let Some(run) = self.run else {
            self.run = Some(Run {
                from: p,
                to: p,
                right: None,
            });
            return;
        };
        if let Some(longer) = run.extended(p) {
            self.run = Some(longer);
            return;
        }
        self.segments.push(Segment::new(run.from, run.to));
        let fresh = Run {
            from: run.to,
            to: run.to,
            right: None,
        };
        self.run = Some(fresh.extended(p).unwrap_or(fresh));
    }

    /// Ends the piece of path: the next place begins a new one.
    pub fn lift(&mut self) {
        if let Some(run) = self.run.take() {
            self.segments.push(Segment::new(run.from, run.to));
        }
    }

    /// The path as straight segments.
    #[must_use]
    pub fn segments(&self) -> Vec<Segment> {
        let open = self.run.map(|run| Segment::new(run.from, run.to));
        self.segments.iter().copied().chain(open).collect()
    }

    /// The largest disc left on `floor`; none when every place is swept.
    #[must_use]
    pub fn largest(&self, floor: &Floor) -> Option<HiddenDisc> {
        Unswept::new(floor, self.segments()).spots(0.0, 1).pop()
    }

    /// The largest disc around each place that is left, from `diameter` metres up, largest first.
    #[must_use]
    pub fn spots(&self, floor: &Floor, diameter: f64) -> Vec<HiddenDisc> {
        Unswept::new(floor, self.segments()).spots(diameter, usize::MAX)
    }
}

impl Run {
    /// This run led on to `p`, if one straight line still passes all of its places.
    fn extended(&self, p: Point) -> Option<Self> {
        let way = p - self.from;
        let length = way.norm();
        if length <= STRAIGHT {
            let near = (self.to - self.from).norm() <= STRAIGHT;
            return near.then_some(Self { to: p, ..*self });
        }
        // A run never turns back on itself.
        if (p - self.to).dot(&way) < 0.0 {
            return None;
        }
        let side = crate::geometry::perp(way) * (STRAIGHT / length);
        let (mut right, mut left) = (way - side, way + side);
        if let Some((r, l)) = self.right {
            if cross(r, way) < 0.0 || cross(way, l) < 0.0 {
                return None;
            }
            if cross(right, r) > 0.0 {
                right = r;
            }
            if cross(l, left) > 0.0 {
                left = l;
            }
        }
        Some(Self {
            to: p,
            right: Some((right, left)),
            ..*self
        })
    }
}

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
struct Unswept<'a> {
    floor: &'a Floor,
    path: SegmentIndex,
    /// For every cell the radius of the disc around it; a little too large where the body cannot
    /// be centred, because there the distance to the wall stands in for the corner's shape.
    field: Vec<f32>,
}

impl<'a> Unswept<'a> {
    fn new(floor: &'a Floor, path: Vec<Segment>) -> Self {
        let nearest = Nearest::new(&floor.grid, &path);
        let reach = floor.reach as f32;
        let field = nearest
            .squared
            .iter()
            .zip(&floor.free)
            .map(|(square, &free)| free.min(square.sqrt() - reach))
            .collect();
        Self {
            floor,
            path: SegmentIndex::new(path, 0.25),
            field,
        }
    }

    /// Radius of the disc around `p`, exactly.
    fn radius(&self, p: Point) -> f64 {
        let floor = self.floor;
        let wall = floor.wall_clearance(p);
        if wall <= 0.0 {
            return wall;
        }
        let mut least = wall.min(floor.object_clearance(p));
        let most = least + floor.reach;
        least = least.min(self.path.distance(p, most) - floor.reach);
        if wall < floor.radius && least > 0.0 {
            least = least.min(floor.corner_depth(p));
        }
        least
    }

    /// The `most` largest discs of at least `diameter`, largest first: from each cell that is no
    /// smaller than those around it, uphill.
    fn spots(&self, diameter: f64, most: usize) -> Vec<HiddenDisc> {
        let slack = 0.75 * self.floor.grid.cell;
        let mut tops: Vec<usize> = (0..self.field.len())
            .filter(|&cell| f64::from(self.field[cell]) + slack > diameter / 2.0)
            .filter(|&cell| self.is_top(cell) && self.is_inside(cell))
            .collect();
        tops.sort_by(|&a, &b| self.field[b].total_cmp(&self.field[a]).then(a.cmp(&b)));
        let mut found: Vec<HiddenDisc> = Vec::new();
        for cell in tops {
            let bound = 2.0 * (f64::from(self.field[cell]) + slack);
            if found.len() >= most && found.last().is_some_and(|d| d.diameter >= bound) {
                break;
            }
            let disc = self.climb(self.floor.grid.point(cell));
            let known = |other: &HiddenDisc| (other.at - disc.at).norm() < self.floor.grid.cell;
            if disc.diameter >= diameter.max(2.0 * FINE) && !found.iter().any(known) {
                found.push(disc);
                found.sort_by(|a, b| b.diameter.total_cmp(&a.diameter));
                found.truncate(most);
            }
        }
        found
    }

    fn is_top(&self, cell: usize) -> bool {
        let value = self.field[cell];
        // Of a plateau, one cell in a few is enough; exact ties are rare off symmetric rooms.
        reach::neighbours(&self.floor.grid, cell)
            .into_iter()
            .flatten()
            .all(|near| self.field[near] <= value)
    }

    /// Whether the body can touch something there: it fits, or it fits within its own radius.
    fn is_inside(&self, cell: usize) -> bool {
        let floor = self.floor;
        if floor.touchable[cell] {
            return true;
        }
        floor.wall[cell] > -(floor.grid.cell as f32) && floor.touches_near(floor.grid.point(cell))
    }

    /// Uphill from `from` in ever smaller steps.
    fn climb(&self, from: Point) -> HiddenDisc {
        let (mut at, mut here) = (from, self.radius(from));
        let mut step = 0.7 * self.floor.grid.cell;
        while step > FINE / 2.0 {
            let mut best: Option<(Point, f64)> = None;
            for direction in DIRECTIONS {
                let next = at + direction * step;
                let radius = self.radius(next);
                if radius > best.map_or(here, |(_, most)| most) {
                    best = Some((next, radius));
                }
            }
            match best {
                Some(next) => (at, here) = next,
                None => step *= 0.5,
            }
        }
        HiddenDisc {
            diameter: 2.0 * here,
            at,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rooms;
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
            assert!(
                (got - (spacing - 0.32)).abs() < 0.003,
                "{got} at spacing {spacing}"
            );
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
            assert!(
                (got - sliver.max(0.0)).abs() < 0.004,
                "{got} not {sliver} at {degrees}°"
            );
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
    fn a_path_of_many_places_is_kept_as_few_segments_close_to_it() {
        let path: Vec<Point> = (0..2000)
            .map(|k| {
                let turn = f64::from(k) * 0.001;
                Point::new(1.0, 1.0) + angle::unit(turn) * 0.8
            })
            .collect();
        let kept = Coverage::of(&path).segments();
        assert!(kept.len() < 40, "{} segments", kept.len());
        for p in path {
            let off = kept
                .iter()
                .map(|s| s.distance_squared(p))
                .fold(1.0, f64::min)
                .sqrt();
            assert!(off <= 1.5 * STRAIGHT, "{off} m off the path");
        }
    }
}
