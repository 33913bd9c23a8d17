//! Floor that the robot cannot get to, told as what it is: where the gap is and how wide.
//!
//! Of three kinds. Floor that is on the map, where the body would fit, but that only gaps narrower than the
//! passability threshold lead to. Floor beyond straits: the lap went round it, but the follower does not get
//! through such a gap every time, and the map ends there. And mouths: stretches of the outline that nobody
//! touched, straight across what the robot did not enter, with the end of a wall beside it. What lies behind is not
//! known: more often than not a gap, but a short face of wall in a corner looks the same.

use super::event::EventKind;
use super::floor::{Floor, Narrow, SPARE};
use super::map::{Contact, RoomMap};
use super::shape::mouths;
use crate::geometry::{Piece, Point, Ring, Vector};
use crate::robot::Chassis;
use serde::{Deserialize, Serialize};

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

/// How what was `found` is told: floor behind a gap each by itself, and what nobody touched all together.
pub fn told<'a>(found: impl IntoIterator<Item = &'a Unreached>) -> Vec<EventKind> {
    let (mut told, mut untouched) = (Vec::new(), Vec::new());
    for &Unreached { at, width, area } in found {
        match area {
            Some(area) => told.push(EventKind::Unreached { at, width, area }),
            None => untouched.push(width),
        }
    }
    let least = untouched.iter().copied().fold(f64::INFINITY, f64::min);
    let most = untouched.iter().copied().fold(0.0, f64::max);
    let count = untouched.len();
    told.extend((count > 0).then_some(EventKind::Untouched { count, least, most }));
    told
}

/// Floor beyond a strait ([`super::shape::cut_at_straits`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Beyond {
    /// What is round it, counter-clockwise; the last piece is the chord across the strait, which nobody touched.
    pub outline: Ring,
    /// What was seen there.
    pub contacts: Vec<Contact>,
}

impl Beyond {
    /// The chord across the strait, where that is narrowest; none for an outline without pieces.
    #[must_use]
    pub fn strait(&self) -> Option<&Piece> {
        self.outline.pieces.last()
    }

    /// Moves all of it.
    pub fn displace(&mut self, displacement: impl Fn(Point) -> Vector) {
        self.outline = self.outline.deformed(&displacement);
        for contact in &mut self.contacts {
            contact.point += displacement(contact.point);
            contact.from += displacement(contact.from);
        }
    }

    /// The strait as the stretch of the outline that nobody touched.
    #[must_use]
    pub fn mouth(&self) -> Option<Unreached> {
        let strait = self.strait()?;
        Some(Unreached { at: strait.at(0.5), width: strait.length(), area: None })
    }

    /// The same with the floor behind it, where the centre of the body could stand.
    #[must_use]
    pub fn told(&self, chassis: &Chassis) -> Option<Unreached> {
        let mouth = self.mouth()?;
        let floor = Floor::new(&self.outline, &[], chassis, mouth.at);
        let least = (floor.radius + SPARE) as f32;
        let cells = floor.free.iter().filter(|&&free| free >= least).count();
        let area = cells as f64 * floor.grid.cell * floor.grid.cell;
        Some(Unreached { area: Some(area), ..mouth })
    }
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

/// What of the room on the `map` a robot that stands at `from` does not get to; nothing before it has a shape.
#[must_use]
pub fn unreached(map: &RoomMap, chassis: &Chassis, from: Point) -> Vec<Unreached> {
    let Some(outline) = map.shape.as_ref().map(|shape| &shape.outline) else { return Vec::new() };
    let straits: Vec<Unreached> = map.beyond.iter().filter_map(|one| one.told(chassis)).collect();
    let mut all: Vec<Unreached> = mouths(outline, &map.contacts, chassis)
        .into_iter()
        .map(|chord| Unreached { at: chord.at(0.5), width: chord.length(), area: None })
        .filter(|mouth| straits.iter().all(|strait| (strait.at - mouth.at).norm() > MOVED))
        .collect();
    all.extend(straits);
    let rings: Vec<&Ring> = map.objects.iter().map(|object| &object.outline).collect();
    let pockets = Floor::new(outline, &rings, chassis, from).pockets();
    all.extend(pockets.into_iter().map(|pocket| {
        let Narrow { at, width, .. } = pocket.narrow;
        Unreached { at, width, area: Some(pocket.area) }
    }));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::{ContactKind, MappedObject, ObjectClass};
    use crate::mapping::shape::identify;

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
        let shape = Some(identify(outline.clone(), &contacts));
        let map = RoomMap { shape, contacts, objects: objects.to_vec(), ..RoomMap::default() };
        unreached(&map, &Chassis::default(), Point::new(0.5, 0.5))
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
