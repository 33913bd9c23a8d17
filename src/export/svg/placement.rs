//! Where labels go: within what they name where it is large enough, else beside it, with a leader when
//! there is no room close by. No label lies on another, on a wall or on an object that is not its own.
//!
//! One label after the other takes the best place that is left (greedy, with candidates all round as in
//! Christensen, Marks and Shieber 1995), so the same map gives the same picture. Knows areas and lines on
//! the sheet, in pixels, and no maps.

use crate::geometry::{Point, Ring, Segment, Vector, angle, ring};

/// Room between two labels, pixels.
const APART: f64 = 3.0;
/// Room between a label and the edge of an object, its own included, pixels.
const OFF_OBJECTS: f64 = 3.5;
/// Room between a label and a wall, pixels.
const OFF_WALLS: f64 = 6.0;
/// Nearest a label stands beside what it names, pixels.
const NEAREST: f64 = 5.0;
/// A label farther away than this has a leader, pixels.
const PLAIN: f64 = 9.0;
/// Directions in which a label may stand, the best first.
const DIRECTIONS: [(f64, f64); 16] = [
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, -1.0),
    (-1.0, 1.0),
    (1.0, -0.5),
    (1.0, 0.5),
    (-1.0, -0.5),
    (-1.0, 0.5),
    (0.5, -1.0),
    (0.5, 1.0),
    (-0.5, -1.0),
    (-0.5, 1.0),
];

/// How many directions there are farther off.
const DIRECTIONS_FAR: u32 = 72;

/// How often all labels are placed anew when some found no room.
const ATTEMPTS: usize = 6;

/// A label that looks for a place: the index of what it names, and its size.
type Label = (usize, Vector);

/// An upright rectangle on the sheet, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    /// Upper left corner.
    pub(super) low: Point,
    /// Lower right corner.
    pub(super) high: Point,
}

impl Area {
    /// The area of a given size around `middle`.
    pub(super) fn around(middle: Point, size: Vector) -> Self {
        Self { low: middle - size / 2.0, high: middle + size / 2.0 }
    }

    /// Its middle.
    pub(super) fn middle(&self) -> Point {
        nalgebra::center(&self.low, &self.high)
    }

    /// Width and height.
    pub(super) fn size(&self) -> Vector {
        self.high - self.low
    }

    fn grown(&self, by: f64) -> Self {
        let by = Vector::repeat(by);
        Self { low: self.low - by, high: self.high + by }
    }

    /// Whether the two have more than an edge in common.
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.low[axis] < other.high[axis] && other.low[axis] < self.high[axis])
    }

    fn holds(&self, other: &Self) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// Whether a segment comes into it, by the method of Liang and Barsky.
    fn is_hit_by(&self, segment: &Segment) -> bool {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (from, along) = (segment.from[axis], segment.along[axis]);
            if along.abs() < 1e-9 {
                if from < self.low[axis] || from > self.high[axis] {
                    return false;
                }
                continue;
            }
            let (a, b) = ((self.low[axis] - from) / along, (self.high[axis] - from) / along);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    }

    fn nearest(&self, p: Point) -> Point {
        Point::new(p.x.clamp(self.low.x, self.high.x), p.y.clamp(self.low.y, self.high.y))
    }
}

/// An outline on the sheet.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    ring: Ring,
    chords: Vec<Segment>,
    area: Area,
}

impl Outline {
    /// The closed outline through `points`, pixels; none when they enclose nothing.
    pub(super) fn new(points: &[Point]) -> Option<Self> {
        let (low, high) = ring::bounds(points)?;
        let chords = (0..points.len())
            .map(|k| Segment::new(points[k], points[(k + 1) % points.len()]))
            .collect();
        Some(Self { ring: Ring::polygon(points), chords, area: Area { low, high } })
    }

    fn hits(&self, area: &Area) -> bool {
        self.area.meets(area) && self.chords.iter().any(|chord| area.is_hit_by(chord))
    }

    fn crosses(&self, segment: &Segment) -> bool {
        self.area.is_hit_by(segment) && self.chords.iter().any(|c| c.gap_squared(segment) < 1.0)
    }
}

/// Where one label is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// What it covers.
    pub(super) area: Area,
    /// The line from the label to what it names.
    pub(super) leader: Option<Segment>,
    /// Whether it lies within what it names.
    pub(super) within: bool,
}

/// What leaders keep off, besides labels, walls and each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leaders {
    /// Every object but their own.
    Clear,
    /// Nothing more.
    AcrossObjects,
}

/// What is on the sheet, and which labels have found their place.
#[derive(Debug, Clone)]
pub(super) struct Board {
    /// The drawing.
    pub(super) sheet: Area,
    /// The walls, once they are known.
    pub(super) floor: Option<Outline>,
    /// What labels name; none for what has no outline.
    pub(super) objects: Vec<Option<Outline>>,
    /// What labels keep off.
    pub(super) taken: Vec<Area>,
    /// The leaders so far.
    pub(super) leaders: Vec<Segment>,
}

impl Board {
    /// A place for a label of the given size within object `of`, the nearest to its `middle`.
    pub(super) fn within(&mut self, of: usize, middle: Point, size: Vector) -> Option<Spot> {
        let outline = self.objects.get(of)?.as_ref()?;
        let room = outline.area.size() - size;
        if room.min() < 2.0 * OFF_OBJECTS {
            return None;
        }
        // A grid as fine as a few pixels, and never of very many places.
        let steps = room.map(|extent| (extent / 4.0).ceil().clamp(2.0, 40.0) as u32);
        let first = outline.area.low + size / 2.0;
        let at = |k: u32, n: u32, extent: f64| f64::from(k) / f64::from(n) * extent;
        let mut places: Vec<Point> = (0..=steps.x)
            .flat_map(|i| (0..=steps.y).map(move |k| (i, k)))
            .map(|(i, k)| first + Vector::new(at(i, steps.x, room.x), at(k, steps.y, room.y)))
            .collect();
        places.push(middle);
        places.sort_by(|a, b| (a - middle).norm().total_cmp(&(b - middle).norm()));
        let fits = |place: &Point| {
            let area = Area::around(*place, size);
            outline.ring.contains(*place)
                && !outline.hits(&area.grown(OFF_OBJECTS))
                && self.is_free(&area)
        };
        let area = Area::around(places.into_iter().find(fits)?, size);
        self.taken.push(area);
        Some(Spot { area, leader: None, within: true })
    }

    /// Places beside their objects for labels of the given sizes, no farther off than `farthest`. Where
    /// there is least room the first is placed; the last leaders may cross objects, if there is no other
    /// way out of a crowd.
    pub(super) fn all_beside(&mut self, labels: &[Label], farthest: f64) -> Vec<(usize, Spot)> {
        let room = |&(of, size): &Label| {
            let near = [NEAREST, PLAIN].into_iter().flat_map(|away| self.around(of, size, away));
            near.filter(|area| self.spot(of, *area, Leaders::Clear).is_some()).count()
        };
        let mut order = labels.to_vec();
        order.sort_by_cached_key(|label| (room(label), label.0));
        let mut best = (self.clone(), Vec::new());
        for _ in 0..ATTEMPTS {
            let mut board = self.clone();
            let (found, left) = board.in_order(&order, farthest);
            if found.len() > best.1.len() {
                best = (board, found);
            }
            if left.is_empty() {
                break;
            }
            // What found no room comes first the next time.
            order.retain(|label| !left.contains(label));
            order.splice(0..0, left);
        }
        *self = best.0;
        best.1
    }

    /// The labels placed one after the other; and those that found no room.
    fn in_order(&mut self, labels: &[Label], farthest: f64) -> (Vec<(usize, Spot)>, Vec<Label>) {
        let (mut found, mut left) = (Vec::new(), labels.to_vec());
        for leaders in [Leaders::Clear, Leaders::AcrossObjects] {
            left.retain(|&(of, size)| {
                let spot = self.beside(of, size, farthest, leaders);
                found.extend(spot.map(|spot| (of, spot)));
                spot.is_none()
            });
        }
        (found, left)
    }

    /// A place for a label of the given size beside object `of`.
    fn beside(&mut self, of: usize, size: Vector, farthest: f64, leaders: Leaders) -> Option<Spot> {
        let mut away = NEAREST;
        while away <= farthest {
            let mut places = self.around(of, size, away).into_iter();
            if let Some(spot) = places.find_map(|area| self.spot(of, area, leaders)) {
                self.taken.push(spot.area);
                self.leaders.extend(spot.leader);
                return Some(spot);
            }
            away += (away / 4.0).max(3.0);
        }
        None
    }

    /// The areas of a given size all round an object, so many pixels away from it.
    fn around(&self, of: usize, size: Vector, away: f64) -> Vec<Area> {
        let Some(Some(object)) = self.objects.get(of) else {
            return Vec::new();
        };
        let reach = (object.area.size() + size) / 2.0 + Vector::repeat(away);
        let place = |(x, y): (f64, f64)| {
            Area::around(object.area.middle() + Vector::new(x, y).component_mul(&reach), size)
        };
        if away <= PLAIN {
            return DIRECTIONS.into_iter().map(place).collect();
        }
        // Farther off a label may find a hole in the crowd between any two directions.
        let direction = |k: u32| {
            let angle = f64::from(k) * angle::TAU / f64::from(DIRECTIONS_FAR);
            let unit = angle::unit(angle);
            place((unit.x / unit.amax(), unit.y / unit.amax()))
        };
        (0..DIRECTIONS_FAR).map(direction).collect()
    }

    /// The label at `area` with its leader, when both are clear of everything.
    fn spot(&self, of: usize, area: Area, leaders: Leaders) -> Option<Spot> {
        if !self.sheet.holds(&area) || !self.is_free(&area) || !self.is_on_the_floor(&area) {
            return None;
        }
        let own = self.objects.get(of)?.as_ref()?;
        let end = own.ring.nearest(area.middle())?.point;
        let leader = Segment::new(area.nearest(end), end);
        if leader.length() <= PLAIN {
            return Some(Spot { area, leader: None, within: false });
        }
        let mut others = self.objects.iter().enumerate().filter(|(k, _)| *k != of);
        let clear = self.taken.iter().all(|other| !other.grown(1.0).is_hit_by(&leader))
            && self.leaders.iter().all(|other| other.gap_squared(&leader) > APART * APART)
            && (leaders == Leaders::AcrossObjects
                || others.all(|(_, object)| object.iter().all(|object| !object.crosses(&leader))))
            && self.floor.iter().all(|floor| !floor.crosses(&leader));
        clear.then_some(Spot { area, leader: Some(leader), within: false })
    }

    /// Whether no other label and no leader is there.
    fn is_free(&self, area: &Area) -> bool {
        let wide = area.grown(APART);
        !self.taken.iter().any(|other| wide.meets(other))
            && !self.leaders.iter().any(|leader| wide.is_hit_by(leader))
    }

    /// Whether neither wall nor object is there.
    fn is_on_the_floor(&self, area: &Area) -> bool {
        let (near_wall, near) = (area.grown(OFF_WALLS), area.grown(OFF_OBJECTS));
        let inside = |outline: &Outline| outline.ring.contains(area.middle());
        self.floor.iter().all(|floor| inside(floor) && !floor.hits(&near_wall))
            && self.objects.iter().flatten().all(|object| !inside(object) && !object.hits(&near))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(x: f64, y: f64, w: f64, h: f64) -> Option<Outline> {
        Outline::new(
            &[(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| Point::new(x, y)),
        )
    }

    fn board(objects: Vec<Option<Outline>>) -> Board {
        let sheet = Area { low: Point::new(0.0, 0.0), high: Point::new(400.0, 400.0) };
        let floor = boxed(10.0, 10.0, 380.0, 380.0);
        Board { sheet, floor, objects, taken: Vec::new(), leaders: Vec::new() }
    }

    #[test]
    fn a_label_lies_within_what_is_large_enough() {
        let mut board = board(vec![boxed(100.0, 100.0, 80.0, 40.0)]);
        let spot = board.within(0, Point::new(140.0, 120.0), Vector::new(40.0, 10.0));
        let spot = spot.expect("there is room");
        assert_eq!(spot.area.middle(), Point::new(140.0, 120.0));
        assert!(spot.within && spot.leader.is_none());
        assert_eq!(board.within(0, Point::new(140.0, 120.0), Vector::new(78.0, 10.0)), None);
    }

    #[test]
    fn the_middle_of_a_bay_is_not_within() {
        let corners =
            [(0, 0), (100, 0), (100, 20), (20, 20), (20, 80), (100, 80), (100, 100), (0, 100)];
        let corners = corners.map(|(x, y)| Point::new(50.0 + f64::from(x), 50.0 + f64::from(y)));
        let outline = Outline::new(&corners).expect("a bay");
        let mut board = board(vec![Some(outline.clone())]);
        let spot = board.within(0, Point::new(110.0, 100.0), Vector::new(12.0, 9.0));
        let spot = spot.expect("an arm is wide enough");
        assert!(outline.ring.contains(spot.area.middle()), "{spot:?}");
        assert!(!outline.hits(&spot.area), "{spot:?}");
    }

    /// Twenty-five small things close together: more labels than fit among them.
    #[test]
    fn labels_of_a_crowd_keep_off_each_other_and_off_everything_else() {
        let place = |k: u32| (150.0 + f64::from(k % 5) * 18.0, 150.0 + f64::from(k / 5) * 18.0);
        let objects: Vec<_> = (0..25).map(place).map(|(x, y)| boxed(x, y, 6.0, 6.0)).collect();
        let mut board = board(objects.clone());
        let size = Vector::new(26.0, 10.0);
        let spots: Vec<Spot> = board
            .all_beside(&(0..25).map(|k| (k, size)).collect::<Vec<_>>(), 400.0)
            .into_iter()
            .map(|(_, spot)| spot)
            .collect();
        assert_eq!(spots.len(), 25, "not every label found room");
        for (k, spot) in spots.iter().enumerate() {
            for other in &spots[..k] {
                assert!(!spot.area.meets(&other.area), "{spot:?} lies on {other:?}");
                let led = |a: &Spot, b: &Spot| a.leader.is_some_and(|l| b.area.is_hit_by(&l));
                assert!(!led(spot, other) && !led(other, spot), "a leader runs through a label");
            }
            assert!(!objects.iter().flatten().any(|object| object.hits(&spot.area)), "{spot:?}");
        }
    }

    #[test]
    fn a_segment_hits_what_it_passes_through() {
        let area = Area { low: Point::new(0.0, 0.0), high: Point::new(4.0, 2.0) };
        let hits = |a: (f64, f64), b: (f64, f64)| {
            area.is_hit_by(&Segment::new(Point::new(a.0, a.1), Point::new(b.0, b.1)))
        };
        assert!(hits((-1.0, 1.0), (5.0, 1.0)) && hits((1.0, 1.0), (2.0, 1.0)));
        assert!(!hits((-1.0, 1.0), (-0.5, 1.0)) && !hits((-1.0, 1.0), (1.0, 4.0)));
    }
}
