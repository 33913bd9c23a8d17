//! Circular parts: diameters of a full circle, radii of a piece of one (paper III.E, figure 10).

use super::entries::{Entries, Entry};
use crate::geometry::segment::Segment;
use crate::geometry::{Piece, Point, Ring, angle, cross};
use crate::mapping::map::{LineReason, Part, PartClass};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The random stream of the first diameter; other uses of the seed take others.
const STREAM: u64 = 0x0111_000E;
/// A radius nearer than this to a side of the part runs along it, metres.
const ALONG: f64 = 0.002;
/// A centre that lies off by this share of the radius is that of another circle.
const OTHER: f64 = 0.1;
/// A point of the arc lies on it within this, metres.
const ON_RIM: f64 = 1e-6;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;
/// Shares of a line this near to each other are one and the same.
const SAME: f64 = 1e-9;

/// The lines of one circular part.
pub(super) struct Disc<'a> {
    index: usize,
    part: &'a Part,
    center: Point,
    radius: f64,
    alpha: f64,
    /// What bounds the part besides its arc, with the part on the left.
    sides: Vec<Segment>,
}

impl<'a> Disc<'a> {
    /// Part `index` as a piece of a disc, if that is what it is.
    pub(super) fn new(index: usize, part: &'a Part, alpha: f64) -> Option<Self> {
        let (center, radius) = match part.class {
            PartClass::Circle | PartClass::Semicircle | PartClass::Sector => part.circle?,
            PartClass::Convex | PartClass::Concave => bitten(part)?,
        };
        let mut disc = Self { index, part, center, radius, alpha, sides: Vec::new() };
        disc.sides = disc.sides();
        Some(disc)
    }

    /// Enters the lines.
    pub(super) fn lines(&self, entries: &mut Entries<'_>, seed: u64) {
        if has_radii(self.part) {
            self.radii(entries);
        } else {
            self.diameters(entries, seed);
        }
    }

    /// Diameters from a random point on, clockwise by arcs of α, until a point comes again.
    fn diameters(&self, entries: &mut Entries<'_>, seed: u64) {
        let Self { center, radius, .. } = *self;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(STREAM);
        let first = random.random::<f64>() * angle::TAU;
        let step = self.alpha / radius;
        let count = (angle::TAU / step - 1e-9).ceil().max(1.0) as usize;
        // What is missing of the disc has no points to begin at.
        let on_rim = |turn: &f64| {
            let at = center + angle::unit(first - turn) * radius;
            self.part.ring.pieces.iter().any(|p| self.is_rim(p) && p.distance(at) < ON_RIM)
        };
        let turns: Vec<f64> = (0..count).map(|k| k as f64 * step).filter(on_rim).collect();
        for (vertex, &turn) in turns.iter().enumerate() {
            let away = angle::unit(first - turn) * radius;
            // The far end of an earlier diameter: the same line run the other way.
            let again = turn >= angle::PI - 1e-9
                && turns.iter().any(|other| (turn - angle::PI - other).abs() < 1e-9);
            entries.enter(&Entry {
                part: self.index,
                vertex,
                start: center + away,
                end: until(&self.sides, center + away, center - away),
                angle: angle::FRAC_PI_2,
                reason: again.then_some(LineReason::Duplicate),
            });
        }
    }

    /// Radii from the arc of the part to the centre, clockwise, both ends of the arc included.
    fn radii(&self, entries: &mut Entries<'_>) {
        let middle = self.middle();
        let mut vertex = 0;
        for piece in self.part.ring.pieces.iter().filter(|piece| self.is_rim(piece)) {
            let Piece::Arc { center: own, radius, start, sweep } = *piece else {
                continue;
            };
            let step = self.alpha / radius;
            let count = (sweep / step - 1e-9).ceil().max(1.0) as usize;
            for k in 0..=count {
                let turned = start + sweep - (k as f64 * step).min(sweep);
                let from = own + angle::unit(turned) * radius;
                let (mut end, mut reason) = (middle, self.reason(entries, from, middle));
                // The centre of less than half a disc lies beyond its chord, where there is a wall or what is none
                // of this part.
                if reason == Some(LineReason::LeavesArea) {
                    end = until(&self.sides, from, middle);
                    reason = self.reason(entries, from, end);
                }
                entries.enter(&Entry {
                    part: self.index,
                    vertex,
                    start: from,
                    end,
                    angle: angle::FRAC_PI_2,
                    reason,
                });
                vertex += 1;
            }
        }
    }

    /// Where the radii lead to: the centre of the circle; of half a disc the middle of its straight side, which a fit
    /// has some millimetres before or behind the centre. Behind the side no radius would stay in the part.
    fn middle(&self) -> Point {
        let pieces = self.part.ring.pieces.iter();
        let straight = pieces.filter(|piece| matches!(piece, Piece::Line { .. }));
        let feet = straight.map(|piece| piece.at(piece.nearest(self.center)));
        let off = |foot: &Point| (foot - self.center).norm_squared();
        let nearest = feet.min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.filter(|_| self.part.class == PartClass::Semicircle).unwrap_or(self.center)
    }

    /// Whether lines begin on this piece: arcs of other circles bound the part, but its lines lead to its own centre.
    fn is_rim(&self, piece: &Piece) -> bool {
        match *piece {
            Piece::Arc { center, sweep, .. } => {
                sweep > 0.0 && (center - self.center).norm() <= OTHER * self.radius
            }
            Piece::Line { .. } => false,
        }
    }

    fn sides(&self) -> Vec<Segment> {
        let others = self.part.ring.pieces.iter().filter(|piece| !self.is_rim(piece));
        let points = others.map(|piece| {
            let mut points = Ring { pieces: vec![*piece] }.to_points(SAGITTA);
            points.push(piece.to());
            points
        });
        let pairs = |points: Vec<Point>| {
            points.windows(2).map(|two| Segment::new(two[0], two[1])).collect::<Vec<_>>()
        };
        points.flat_map(pairs).collect()
    }

    fn reason(&self, entries: &mut Entries<'_>, from: Point, end: Point) -> Option<LineReason> {
        let places = [0.25, 0.5, 0.75].map(|t| from + (end - from) * t);
        let along = |side: bool| {
            self.part.ring.pieces.iter().zip(&self.part.cut).any(|(piece, &cut)| {
                let straight = matches!(piece, Piece::Line { .. }) && cut == side;
                straight && places.iter().all(|&p| piece.distance(p) < ALONG)
            })
        };
        if along(false) {
            return Some(LineReason::AlongBoundary);
        }
        let inner = from + (end - from) * 0.02;
        let room = entries.floor.wall_clearance(end) > -ALONG;
        if !(room && entries.floor.is_clear(inner, from + (end - from) * 0.98, 1e-3)) {
            return Some(LineReason::LeavesArea);
        }
        // The part on the other side of a cut has it too: a polygon from end to end, half a disc its own radii.
        let again = along(true)
            && (entries.polygon_has(&places, ALONG) || entries.crossed_before(from, end));
        again.then_some(LineReason::Duplicate)
    }
}

/// Whether the lines of a part are radii, which come together at its middle.
pub(super) fn has_radii(part: &Part) -> bool {
    matches!(part.class, PartClass::Semicircle | PartClass::Sector) && part.circle.is_some()
}

/// The circle of the longest arc of a part that has no edge opposite to any of its vertices: a disc out of which
/// another took a bite.
fn bitten(part: &Part) -> Option<(Point, f64)> {
    let arcs = part.ring.pieces.iter().filter_map(|piece| match *piece {
        Piece::Arc { center, radius, sweep, .. } if sweep > 0.0 => {
            Some((radius * sweep, (center, radius)))
        }
        _ => None,
    });
    let longest = arcs.max_by(|a, b| a.0.total_cmp(&b.0));
    longest.filter(|_| part.ring.pieces.len() < 3).map(|(_, circle)| circle)
}

/// Where the way from `from` to `to` first leaves the part that lies on the left of `sides`; `to` if it does not.
fn until(sides: &[Segment], from: Point, to: Point) -> Point {
    let way = to - from;
    let leaves = sides.iter().filter_map(|side| {
        let across = cross(way, side.along);
        if across <= SAME * way.norm() * side.length() {
            return None;
        }
        let off = side.from - from;
        let (gone, place) = (cross(off, side.along) / across, cross(off, way) / across);
        let meets = (-SAME..=1.0 + SAME).contains(&place) && (-SAME..1.0 - SAME).contains(&gone);
        meets.then_some(gone.max(0.0))
    });
    leaves.min_by(f64::total_cmp).map_or(to, |gone| from + way * gone)
}

#[cfg(test)]
mod tests {
    use crate::geometry::{Piece, Point, Ring, angle};
    use crate::mapping::floor::rooms;
    use crate::mapping::map::{LineReason, PartClass, PlanLine, Shape};
    use crate::mapping::plan::paper;

    fn plan(shape: &Shape, alpha: f64, seed: u64) -> Vec<PlanLine> {
        paper(&rooms::floor(&shape.outline, &[]), shape, alpha, seed)
    }

    fn round(class: PartClass, ring: &Ring, center: Point, radius: f64) -> Shape {
        let mut shape = rooms::shape(ring);
        shape.parts[0].class = class;
        shape.parts[0].circle = Some((center, radius));
        shape
    }

    #[test]
    fn a_circle_is_planned_by_diameters_clockwise_until_a_point_comes_again() {
        let center = Point::new(2.0, 2.0);
        let shape = round(PartClass::Circle, &Ring::circle(center, 2.0), center, 2.0);
        let lines = plan(&shape, 0.5, 1);
        // 2π 2 / 0.5 = 25.1: 26 points, the last arc short.
        assert_eq!(lines.len(), 26);
        for pair in lines.windows(2) {
            let turn = |line: &PlanLine| angle::of(line.start - center);
            let arc = angle::wrap(turn(&pair[0]) - turn(&pair[1])) * 2.0;
            assert!((arc - 0.5).abs() < 1e-9, "an arc of {arc} m clockwise");
        }
        for line in &lines {
            assert!((nalgebra::center(&line.start, &line.end) - center).norm() < 1e-9);
            let (from, to) = line.drive.unwrap();
            assert!(((to - from).norm() - (4.0 - 0.29)).abs() < 0.01, "{from} to {to}");
        }
        let other = plan(&shape, 0.5, 2);
        assert_ne!(lines[0].start, other[0].start, "the first point follows the seed");
        assert_eq!(lines, plan(&shape, 0.5, 1), "the same seed, the same plan");
    }

    #[test]
    fn diameters_that_come_again_from_their_far_end_are_duplicates() {
        let center = Point::new(2.0, 2.0);
        let shape = round(PartClass::Circle, &Ring::circle(center, 2.0), center, 2.0);
        let lines = plan(&shape, angle::TAU * 2.0 / 12.0, 1);
        let kept = lines.iter().filter(|line| line.reason.is_none()).count();
        let again = lines.iter().filter(|l| l.reason == Some(LineReason::Duplicate)).count();
        assert_eq!((kept, again), (6, 6));
    }

    #[test]
    fn a_semicircle_is_planned_by_radii_and_those_along_its_wall_are_left_out() {
        let center = Point::new(2.0, 0.0);
        let ring = Ring {
            pieces: vec![
                Piece::Line { from: Point::new(0.0, 0.0), to: Point::new(4.0, 0.0) },
                Piece::Arc { center, radius: 2.0, start: 0.0, sweep: angle::PI },
            ],
        };
        let mut shape = round(PartClass::Semicircle, &ring, center, 2.0);
        // π 2 / 0.5 = 12.6: 14 radii, the two along the diameter on the wall.
        let lines = plan(&shape, 0.5, 1);
        let along = |lines: &[PlanLine]| {
            lines.iter().filter(|l| l.reason == Some(LineReason::AlongBoundary)).count()
        };
        assert_eq!((lines.len(), along(&lines)), (14, 2));
        assert!(lines.iter().all(|line| line.end == center));
        shape.parts[0].cut = vec![true, false];
        assert_eq!(along(&plan(&shape, 0.5, 1)), 0, "along a cut they stay");
    }

    #[test]
    fn of_half_a_disc_that_is_a_little_less_or_more_the_radii_lead_to_its_straight_side() {
        for over in [-0.02, -0.002, 0.002, 0.02_f64] {
            let half = (1.0 - over * over).sqrt();
            let (left, right) =
                (Point::new(2.0 - 2.0 * half, 0.0), Point::new(2.0 + 2.0 * half, 0.0));
            let ring = Ring {
                pieces: vec![
                    Piece::Line { from: left, to: right },
                    Piece::with_bulge(right, left, (1.0 + over) / half),
                ],
            };
            let Piece::Arc { center, radius, .. } = ring.pieces[1] else { panic!("an arc") };
            assert!((center.y - 2.0 * over).abs() < 1e-9 && (radius - 2.0).abs() < 1e-9);
            let lines = plan(&round(PartClass::Semicircle, &ring, center, radius), 0.5, 1);
            let kept: Vec<&PlanLine> = lines.iter().filter(|line| line.reason.is_none()).collect();
            assert!((12..=14).contains(&kept.len()), "{} of {} by {over}", kept.len(), lines.len());
            assert!(kept.iter().all(|line| line.end.y.abs() < 1e-9), "by {over}");
        }
    }
}
