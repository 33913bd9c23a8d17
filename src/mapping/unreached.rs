//! Floor that the robot cannot get to, told as what it is: where the gap is and how wide.
//!
//! Of two kinds. Floor that is on the map, where the body would fit, but that only gaps narrower than the
//! passability threshold lead to. And mouths: stretches of the outline that nobody touched, straight
//! across what the robot did not enter, with the end of a wall beside it. What lies behind is not on the
//! map: more often than not a gap, but a short face of wall in a corner looks the same.

use super::floor::{Floor, SPARE, component};
use super::map::{Contact, MappedObject};
use super::shape::mouths;
use crate::geometry::{Piece, Point, Ring};
use crate::robot::Chassis;
use serde::{Deserialize, Serialize};

/// Less floor than this is no place to get to, square metres.
const LEAST_FLOOR: f64 = 0.02;

/// Floor that cannot be reached, or may be there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Unreached {
    /// The narrowest place of the gap, metres in the map frame.
    pub at: Point,
    /// How wide the gap is there, metres.
    pub width: f64,
    /// Where the centre of the body could stand behind it, square metres; none where nobody knows what
    /// lies there.
    pub area: Option<f64>,
}

/// Squaring and adjusting move a stretch by no more than this after it was found, metres.
const MOVED: f64 = 0.1;

impl Unreached {
    /// Whether nobody knows what is there: a stretch of the outline that was not touched.
    #[must_use]
    pub fn is_untouched(&self) -> bool {
        self.area.is_none()
    }

    /// Which piece of `outline` an untouched stretch is; none where none fits it any longer.
    #[must_use]
    pub fn piece_of(&self, outline: &Ring) -> Option<usize> {
        let off = |piece: &Piece| {
            (piece.at(0.5) - self.at).norm().max((piece.length() - self.width).abs())
        };
        let pieces = outline.pieces.iter().map(off).enumerate();
        let nearest = pieces.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, off)| *off < MOVED).map(|(k, _)| k)
    }
}

/// What of the room within `outline`, seen as `contacts` and with `objects` on it, a robot that stands at
/// `from` does not get to.
#[must_use]
pub fn unreached(
    outline: &Ring,
    contacts: &[Contact],
    objects: &[MappedObject],
    chassis: &Chassis,
    from: Point,
) -> Vec<Unreached> {
    let mut all: Vec<Unreached> = mouths(outline, contacts, chassis)
        .into_iter()
        .map(|chord| Unreached { at: chord.at(0.5), width: chord.length(), area: None })
        .collect();
    let rings: Vec<&Ring> = objects.iter().map(|object| &object.outline).collect();
    all.extend(pockets(&Floor::new(outline, &rings, chassis, from)));
    all
}

/// The pieces of floor on the map where the body would fit and cannot get to.
fn pockets(floor: &Floor) -> Vec<Unreached> {
    let least = (floor.radius + SPARE) as f32;
    let cells = floor.free.iter().zip(&floor.drivable);
    let mut left: Vec<bool> = cells.map(|(&free, sent)| free >= least && !sent).collect();
    let mut found = Vec::new();
    while let Some(cell) = left.iter().position(|&is| is) {
        let together = component(&floor.grid, &left, floor.grid.point(cell));
        let piece: Vec<usize> = (0..left.len()).filter(|&k| together[k]).collect();
        for &k in &piece {
            left[k] = false;
        }
        let area = piece.len() as f64 * floor.grid.cell * floor.grid.cell;
        if area < LEAST_FLOOR {
            continue;
        }
        if let Some((at, width)) = narrowest(floor, &piece) {
            found.push(Unreached { at, width, area: Some(area) });
        }
    }
    found
}

/// The narrowest place of the widest way from `piece` to where the robot is sent, and how wide it is; none
/// when no way leads there at all. On the way the floor is taken up widest first (as by Dijkstra's
/// method, with the narrowest place in place of the length).
fn narrowest(floor: &Floor, piece: &[usize]) -> Option<(Point, f64)> {
    let mut narrow: Vec<f32> = vec![0.0; floor.grid.len()];
    let mut at: Vec<usize> = (0..floor.grid.len()).collect();
    let mut heap = std::collections::BinaryHeap::new();
    for &cell in piece {
        narrow[cell] = floor.free[cell];
        heap.push((Wide(floor.free[cell]), cell));
    }
    while let Some((Wide(free), cell)) = heap.pop() {
        if free < narrow[cell] {
            continue;
        }
        if floor.drivable[cell] {
            return Some((
                floor.grid.point(at[cell]),
                2.0 * floor.clearance(floor.grid.point(at[cell])),
            ));
        }
        for near in floor.grid.neighbours(cell).into_iter().flatten() {
            let through = free.min(floor.free[near]);
            if through > narrow[near] {
                narrow[near] = through;
                at[near] = if floor.free[near] < free { near } else { at[cell] };
                heap.push((Wide(through), near));
            }
        }
    }
    None
}

/// A clearance that can be ordered.
#[derive(Clone, Copy, PartialEq)]
struct Wide(f32);

impl Eq for Wide {}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Wide {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::{ContactKind, ObjectClass};

    fn ring(corners: &[(f64, f64)]) -> Ring {
        Ring::polygon(&corners.iter().map(|(x, y)| Point::new(*x, *y)).collect::<Vec<_>>())
    }

    fn object(corners: &[(f64, f64)]) -> MappedObject {
        MappedObject {
            id: 1,
            class: ObjectClass::Rectangle,
            outline: ring(corners),
            closed: true,
            contacts: Vec::new(),
        }
    }

    /// Contacts every 5 cm of all pieces of `outline` but `but`, from 0.15 m within.
    fn seen(outline: &Ring, but: &[usize]) -> Vec<Contact> {
        let pieces = outline.pieces.iter().enumerate().filter(|(k, _)| !but.contains(k));
        pieces
            .flat_map(|(_, piece)| {
                let count = (piece.length() / 0.05).ceil().max(2.0) as u32;
                (0..=count).map(move |n| {
                    let t = f64::from(n) / f64::from(count);
                    let point = piece.at(t);
                    let from = point + crate::geometry::perp(piece.tangent(t)) * 0.15;
                    Contact { point, from, sensor: Some(0), kind: ContactKind::Range, time: 0.0 }
                })
            })
            .collect()
    }

    fn told(outline: &Ring, but: &[usize], objects: &[MappedObject]) -> Vec<Unreached> {
        let contacts = seen(outline, but);
        unreached(outline, &contacts, objects, &Chassis::default(), Point::new(0.5, 0.5))
    }

    #[test]
    fn a_plain_room_is_all_reached() {
        let room = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        assert_eq!(told(&room, &[], &[]), Vec::new());
    }

    #[test]
    fn floor_behind_a_gap_is_told_with_its_width() {
        // A cupboard and a board close off the corner at (4, 3) but for 0.25 m.
        let room = ring(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        let board = object(&[(2.8, 1.8), (2.85, 1.8), (2.85, 3.0), (2.8, 3.0)]);
        let cupboard = object(&[(3.1, 1.8), (4.0, 1.8), (4.0, 1.85), (3.1, 1.85)]);
        let told = told(&room, &[], &[board, cupboard]);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!((told[0].width - 0.25).abs() < 0.03, "{told:?}");
        assert!((told[0].at - Point::new(2.97, 1.82)).norm() < 0.08, "{told:?}");
        // 1.15 x 1.15 m, worn down by the body all round.
        assert!((told[0].area.unwrap_or(0.0) - 0.9).abs() < 0.15, "{told:?}");
    }

    #[test]
    fn a_mouth_behind_the_end_faces_of_the_wall_is_told() {
        // As an opening of 0.15 m in a straight wall is mapped: 30 mm of either face were seen.
        let room = ring(&[
            (0.0, 0.0),
            (2.0, 0.0),
            (2.0, -0.03),
            (2.15, -0.03),
            (2.15, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ]);
        let told = told(&room, &[2], &[]);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!((told[0].width - 0.15).abs() < 1e-9, "{told:?}");
    }

    #[test]
    fn an_untouched_mouth_is_told_and_a_corner_cut_off_is_not() {
        // The wall's end at (2, 3) and the next one's at (2.2, 3): nobody passed between.
        let room = ring(&[
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 2.9),
            (3.9, 3.0),
            (2.2, 3.0),
            (2.2, 2.7),
            (2.0, 2.7),
            (2.0, 3.0),
            (0.0, 3.0),
        ]);
        let told = told(&room, &[2, 5], &[]);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!((told[0].width - 0.2).abs() < 1e-9 && told[0].area.is_none());
        assert!((told[0].at - Point::new(2.1, 2.7)).norm() < 1e-9);
    }
}
