//! The numbers of the objects: within an object that has room for its own, else beside it. The numbers of the
//! walls, where they are asked for: beside the middle of each. Never over a wall, an object or another number.
//! Knows what is drawn already, not what it is of.

use crate::console::canvas::Canvas;
use crate::console::canvas::viewport::{DOTS_X, DOTS_Y};
use crate::console::theme::{Role, Theme};
use crate::console::view::list::wall_name;
use crate::console::view::pen::{Pen, width};
use crate::geometry::{Piece, Point, Ring};
use crate::session::Snapshot;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// A piece of the map in cells, right and bottom not included; it may lie out of view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Box {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl Box {
    fn meets(&self, other: &Self, within: i32) -> bool {
        self.left < other.right + within
            && other.left < self.right + within
            && self.top < other.bottom + within
            && other.top < self.bottom + within
    }
}

pub(super) fn draw(
    canvas: &Canvas,
    snapshot: &Snapshot,
    with_walls: bool,
    theme: &Theme,
    area: Rect,
    buf: &mut Buffer,
) {
    let mut pen = Pen::new(buf, theme, area);
    let objects: Vec<(String, &Ring)> = snapshot
        .map
        .objects
        .iter()
        .map(|object| (format!("O{}", object.id), &object.outline))
        .collect();
    let places = places(canvas, &objects);
    let mut write = |label: &str, place: &Box, role: Role| {
        let (col, row) = (place.left as u16, place.top as u16);
        pen.text(area.x + col, area.y + row, label, role);
    };
    for ((label, _), place) in objects.iter().zip(&places) {
        if let Some(place) = place {
            write(label, place, Role::Object);
        }
    }
    if let Some(shape) = snapshot.map.shape.as_ref().filter(|_| with_walls) {
        let mut taken: Vec<Box> = places.into_iter().flatten().collect();
        for (k, piece) in shape.outline.pieces.iter().enumerate() {
            let label = wall_name(k);
            let wide = i32::from(width(&label));
            if let Some(place) = beside_wall(canvas, piece, &shape.outline, wide, &taken) {
                write(&label, &place, Role::Wall);
                taken.push(place);
            }
        }
    }
}

/// A wall shorter than its number is wide, and as much again, has none, in cells.
const SHORTEST_WALL: f64 = 6.0;

/// Where a number `wide` stands beside the middle of a wall, clear of those `taken`.
fn beside_wall(
    canvas: &Canvas,
    wall: &Piece,
    outline: &Ring,
    wide: i32,
    taken: &[Box],
) -> Option<Box> {
    let cells = wall.length() / (canvas.view().scale * f64::from(DOTS_X));
    if cells < SHORTEST_WALL {
        return None;
    }
    let (x, y) = canvas.view().to_dots(wall.at(0.5));
    let (left, top) = (cell(x, DOTS_X), cell(y, DOTS_Y));
    let own = Box { left, top, right: left + 1, bottom: top + 1 };
    let free = |place: &Box| {
        !place.meets(&own, 0)
            && !taken.iter().any(|other| other.meets(place, 1))
            && is_clear(canvas, place)
    };
    // Outside, where there is nothing else.
    let is_outside = |place: &&Box| {
        let middle = f64::from(place.left + place.right) / 2.0;
        !outline.contains(on_floor(canvas, middle, place))
    };
    let free: Vec<Box> = candidates(&own, wide).into_iter().filter(free).collect();
    free.iter().find(is_outside).or(free.first()).copied()
}

/// Where the number of each object stands; none where there is no place for it.
fn places(canvas: &Canvas, objects: &[(String, &Ring)]) -> Vec<Option<Box>> {
    let mut taken: Vec<Option<Box>> = Vec::new();
    for (label, ring) in objects {
        let Some(own) = around(canvas, ring) else {
            taken.push(None);
            continue;
        };
        let free = |place: &Box| {
            let inside = inside_first(canvas, place, ring, &own);
            let clear = !taken.iter().flatten().any(|other| other.meets(place, 1));
            inside && clear && is_clear(canvas, place)
        };
        let candidates = candidates(&own, i32::from(width(label)));
        // Beside its own object and no other, if that can be had.
        let alone = |place: &&Box| !is_beside_another(canvas, place, &own);
        let free: Vec<Box> = candidates.into_iter().filter(free).collect();
        taken.push(free.iter().find(alone).or(free.first()).copied());
    }
    taken
}

/// Places for a number `wide`, the best first: in the middle, then beside, then off the corners.
fn candidates(own: &Box, wide: i32) -> [Box; 9] {
    let (col, row) =
        ((own.left + own.right - wide).div_euclid(2), (own.top + own.bottom - 1).div_euclid(2));
    let (before, after) = (own.left - wide, own.right);
    let (above, below) = (own.top - 1, own.bottom);
    [
        (col, row),
        (after, row),
        (before, row),
        (col, above),
        (col, below),
        (after, above),
        (after, below),
        (before, above),
        (before, below),
    ]
    .map(|(left, top)| Box { left, top, right: left + wide, bottom: top + 1 })
}

/// Whether a place over the box of its object lies in the object: the bay of a concave one is floor.
fn inside_first(canvas: &Canvas, place: &Box, ring: &Ring, own: &Box) -> bool {
    !place.meets(own, 0)
        || (place.left..place.right)
            .all(|col| ring.contains(on_floor(canvas, f64::from(col) + 0.5, place)))
}

/// The floor under a column of a place.
fn on_floor(canvas: &Canvas, col: f64, place: &Box) -> Point {
    let view = canvas.view();
    let cell = (f64::from(DOTS_X), f64::from(DOTS_Y));
    let x = col * cell.0 - f64::from(view.cols) * cell.0 / 2.0;
    let y = f64::from(view.rows) * cell.1 / 2.0 - (f64::from(place.top) + 0.5) * cell.1;
    Point::new(view.center.x + x * view.scale, view.center.y + y * view.scale)
}

/// Whether a place is in view, above the row of the scale, and nothing of the map is under it.
fn is_clear(canvas: &Canvas, place: &Box) -> bool {
    let view = canvas.view();
    let in_view = place.left >= 0
        && place.top >= 0
        && place.right <= i32::from(view.cols)
        && place.bottom < i32::from(view.rows);
    // Way and plan are background; from the outline on it is the map.
    in_view
        && (place.left..place.right).all(|col| {
            canvas.shows(col as u16, place.top as u16).is_none_or(|role| role < Role::Untouched)
        })
}

/// Whether a place is next to an object that is not within the box of its own.
fn is_beside_another(canvas: &Canvas, place: &Box, own: &Box) -> bool {
    (place.top - 1..=place.bottom).any(|row| {
        (place.left - 1..=place.right).any(|col| {
            let cell = Box { left: col, top: row, right: col + 1, bottom: row + 1 };
            let (Ok(col), Ok(row)) = (u16::try_from(col), u16::try_from(row)) else { return false };
            !cell.meets(own, 0) && canvas.shows(col, row) == Some(Role::Object)
        })
    })
}

/// The cell at so many dots, of so many dots each.
fn cell(dots: f64, size: u16) -> i32 {
    (dots / f64::from(size)).floor().clamp(-1e6, 1e6) as i32
}

/// The cells that `ring` takes.
fn around(canvas: &Canvas, ring: &Ring) -> Option<Box> {
    let (low, high) = ring.bounds()?;
    let (left, bottom) = canvas.view().to_dots(low);
    let (right, top) = canvas.view().to_dots(high);
    Some(Box {
        left: cell(left, DOTS_X),
        top: cell(top, DOTS_Y),
        right: cell(right, DOTS_X) + 1,
        bottom: cell(bottom, DOTS_Y) + 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::canvas::viewport::Viewport;

    fn ring(corners: &[(f64, f64)]) -> Ring {
        Ring::polygon(&corners.iter().map(|(x, y)| Point::new(*x, *y)).collect::<Vec<_>>())
    }

    /// Where the numbers of `rings` stand on a map of 40 by 20 cells, ten dots to the metre.
    fn placed(rings: &[Ring]) -> (Canvas, Vec<Option<Box>>) {
        let mut canvas = Canvas::new(Viewport::new(Point::new(4.0, 4.0), 0.1, 40, 20));
        for ring in rings {
            canvas.ring(ring, Role::Object);
        }
        let named: Vec<_> = (1..).zip(rings).map(|(k, ring)| (format!("O{k}"), ring)).collect();
        let places = places(&canvas, &named);
        (canvas, places)
    }

    #[test]
    fn a_number_stands_in_a_large_object_and_beside_a_small_one() {
        let large = ring(&[(1.0, 1.0), (4.0, 1.0), (4.0, 4.0), (1.0, 4.0)]);
        let small = ring(&[(6.0, 6.0), (6.3, 6.0), (6.3, 6.3), (6.0, 6.3)]);
        let (canvas, places) = placed(&[large.clone(), small.clone()]);
        let own = [around(&canvas, &large), around(&canvas, &small)].map(Option::unwrap);
        let places: Vec<Box> = places.into_iter().flatten().collect();
        assert!(places[0].meets(&own[0], 0), "{places:?}");
        assert!(!places[1].meets(&own[1], 0) && places[1].meets(&own[1], 1), "{places:?}");
    }

    #[test]
    fn no_number_stands_on_another_or_in_the_bay_of_an_object() {
        let bay = ring(&[(1.0, 1.0), (4.0, 1.0), (4.0, 4.0), (3.8, 4.0), (3.8, 1.2), (1.0, 1.2)]);
        let near = |x: f64| ring(&[(x, 6.0), (x + 0.2, 6.0), (x + 0.2, 6.2), (x, 6.2)]);
        let rings = [bay, near(5.0), near(5.4), near(5.8)];
        let (canvas, places) = placed(&rings);
        let places: Vec<Box> = places.into_iter().flatten().collect();
        assert_eq!(places.len(), 4, "{places:?}");
        for (k, place) in places.iter().enumerate() {
            assert!(is_clear(&canvas, place), "O{} covers something", k + 1);
            assert!(!places[..k].iter().any(|other| other.meets(place, 0)), "O{}", k + 1);
        }
        let bay = around(&canvas, &rings[0]).unwrap();
        assert!(!places[0].meets(&bay, 0), "in the open floor of its bay: {:?}", places[0]);
    }
}
