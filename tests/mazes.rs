//! Mazes of boards two centimetres thick, all of which hang on the outer wall: the robot goes along one face of a
//! board and comes back along the other half a lap later, when it is off by more than the board is thick. On
//! paper the faces have changed places then, and an outline that is freed of that anyhow has lost a corridor.
#![expect(clippy::expect_used, reason = "a test that cannot go on has failed")]

#[path = "common/reported.rs"]
mod reported;

use std::collections::BTreeMap;
use std::fmt::Write;

/// 49 cells of 45 cm, in which every board but the outer ones ends free.
const SIX: &str = r"
+---+---+---+---+---+---+---+
|   |                       |
+   +   +---+---+   +---+   +
|       |       |   |   |   |
+   +---+   +---+   +   +   +
|           |       |   |   |
+   +---+---+   +---+   +   +
|   |           |       |   |
+---+   +---+---+   +---+   +
|       |           |       |
+   +---+   +   +---+   +---+
|   |       |               |
+---+---+---+---+---+---+---+
";

/// 48 cells of 40 cm.
const SEVEN: &str = r"
+---+---+---+---+---+---+---+---+
|                               |
+   +---+---+   +---+   +---+---+
|   |       |       |           |
+---+   +   +---+   +---+---+   +
|       |   |       |       |   |
+   +---+   +   +---+   +---+   +
|       |   |           |       |
+   +   +   +---+---+   +   +   +
|   |   |           |   |   |   |
+---+   +---+---+   +---+   +   +
|       |                   |   |
+---+---+---+---+---+---+---+---+
";

/// 81 cells of 45 cm.
const NINE: &str = r"
+---+---+---+---+---+---+---+---+---+
|                           |       |
+   +---+---+---+---+   +   +   +   +
|   |               |   |   |   |   |
+   +   +---+---+   +   +   +   +   +
|   |   |       |       |   |   |   |
+   +   +   +   +---+---+   +   +---+
|   |       |   |       |   |       |
+---+---+---+   +   +   +   +   +   +
|               |   |   |   |   |   |
+   +   +---+---+---+   +   +---+   +
|   |   |       |       |           |
+   +---+   +   +   +   +---+---+   +
|           |   |   |       |       |
+   +---+---+   +   +---+---+   +---+
|           |   |           |   |   |
+---+---+---+   +   +---+   +   +   +
|               |       |           |
+---+---+---+---+---+---+---+---+---+
";

/// A maze as it is drawn, with cells of so many metres and walls so thick, as a world; and the area of its floor.
fn maze(drawn: &str, cell: f64, thick: f64) -> (String, f64) {
    let lines: Vec<&[u8]> = drawn.trim().lines().rev().map(str::as_bytes).collect();
    let (width, height) = (lines[0].len() / 4, lines.len() / 2);
    // Cells and the walls between them by turns, along x and along y; all from one on.
    let is_floor = |x: usize, y: usize| {
        let drawn_at = if x.is_multiple_of(2) { 2 * x } else { 4 * (x / 2) + 2 };
        let within = (1..2 * width).contains(&x) && (1..2 * height).contains(&y);
        within && lines[y].get(drawn_at) == Some(&b' ')
    };
    let side = |k: usize| {
        let wall = if k.is_multiple_of(2) { -0.5 } else { 0.5 };
        (k / 2) as f64 * cell + wall * thick
    };
    // Sides of the floor, the floor on their left.
    let mut sides: BTreeMap<(usize, usize), (usize, usize)> = BTreeMap::new();
    let mut area = 0.0;
    for y in 1..2 * height {
        for x in (1..2 * width).filter(|&x| is_floor(x, y)) {
            area += (side(x + 1) - side(x)) * (side(y + 1) - side(y));
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let beyond = [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)];
            for k in (0..4).filter(|&k| !is_floor(beyond[k].0, beyond[k].1)) {
                sides.insert(corners[k], corners[(k + 1) % 4]);
            }
        }
    }
    let mut world = format!(
        "name = \"a maze\"\nstart = {{ x = {0}, y = {0}, heading = 45.8 }}\n[boundary]\nvertices = [",
        cell / 2.0
    );
    let (&first, &next) = sides.first_key_value().expect("a floor");
    let (mut before, mut at) = (first, next);
    while let Some(next) = sides.remove(&at) {
        // Corners only: not where a side goes straight on.
        if (before.0 == at.0) != (at.0 == next.0) {
            write!(world, "[{:.3}, {:.3}], ", side(at.0), side(at.1)).expect("text");
        }
        (before, at) = (at, next);
    }
    assert!(sides.is_empty(), "all boards hang on the outer wall");
    world.push_str("]\n");
    (world, area)
}

#[test]
fn no_corridor_is_lost_where_the_faces_of_a_board_changed_places() {
    for (drawn, cell, noise, seed) in [
        (SIX, 0.45, "calibrated", 11),
        (SIX, 0.45, "calibrated", 24),
        (SIX, 0.45, "harsh", 9),
        (SEVEN, 0.4, "harsh", 2),
    ] {
        let (world, floor) = maze(drawn, cell, 0.02);
        let (area, _) = reported::bounded(&world, noise, seed);
        assert!((area / floor - 1.0).abs() < 0.03, "seed {seed}: {area} m2 of {floor}");
    }
}

#[test]
fn corridors_side_by_side_are_no_rounds_in_a_pocket() {
    // By then the robot believes itself to be where it was in the next corridor, one board farther.
    let (world, floor) = maze(NINE, 0.45, 0.03);
    // What worn wheels misjudge all lengths by is as much floor as two cells: a tape takes it out.
    let tape = ["--tape", "0.015,0.015:4.035,0.015=4.02"];
    for seed in [1, 9] {
        let (area, _) = reported::bounded_by(&world, "harsh", seed, &tape);
        assert!((area / floor - 1.0).abs() < 0.03, "seed {seed}: {area} m2 of {floor}");
    }
}
