//! What the plan of a room with arcs promises.

use super::*;
use crate::geometry::angle;
use crate::mapping::map::PartClass;
use crate::mapping::shape::identify;

/// A piece of a disc of 2 m about the origin, bent over `degrees`, and its straight side to the west.
fn segment(degrees: f64) -> Ring {
    let half = (degrees / 2.0).to_radians();
    let corner = angle::unit(half) * 2.0;
    rooms::bent(&[(corner.x, -corner.y, degrees), (corner.x, corner.y, 0.0)])
}

fn classes(shape: &Shape) -> Vec<PartClass> {
    shape.parts.iter().map(|part| part.class).collect()
}

fn kept(plan: &Plan) -> impl Iterator<Item = &PlanLine> {
    plan.lines.iter().filter(|line| line.status == LineStatus::Planned)
}

/// The lines kept that run along the straight way from `a` to `b`.
fn kept_along(plan: &Plan, a: Point, b: Point) -> usize {
    let way = Segment::new(a, b);
    let on = |p: Point| way.distance_squared(p).sqrt() < 1e-6;
    kept(plan).filter(|line| on(line.start) && on(line.end)).count()
}

/// Plans the room as it was found to be and looks at what every circular room's plan has to be.
fn planned(room: &Ring, want: &[PartClass], alpha: f64) -> Plan {
    let shape = identify(room.clone(), &[]);
    assert_eq!(classes(&shape), want);
    let plan = plan_in(&shape, &[], alpha, Strategy::Paper);
    for part in 0..want.len() {
        assert!(kept(&plan).any(|line| line.part == part), "no line in part {part}");
    }
    for line in kept(&plan) {
        let at = |share| line.start + (line.end - line.start) * share;
        for end in [line.start, line.end] {
            let off = if room.contains(end) { 0.0 } else { room.distance(end) };
            assert!(off < 0.002, "{line:?} has an end {off} m outside");
        }
        let inside = (1..20).all(|k| room.contains(at(f64::from(k) / 20.0)));
        assert!(inside, "{line:?} leaves the room");
    }
    assert!(plan.figures.hidden_disc <= alpha, "{:?}", plan.figures);
    let lean = plan.alternatives.iter().find(|f| f.strategy == Strategy::Lean).unwrap();
    assert!(lean.hidden_disc <= alpha, "{lean:?}");
    plan
}

#[test]
fn a_quarter_of_a_disc_is_planned_though_its_fitted_centre_lies_outside() {
    for degrees in [89.0, 89.9, 90.0, 90.1, 91.0] {
        let room = rooms::bent(&[(0.0, 0.0, 0.0), (3.0, 0.0, degrees), (0.0, 3.0, 0.0)]);
        let plan = planned(&room, &[PartClass::Sector], 0.4);
        // An arc of 4.7 m: eleven radii between the two along the walls.
        let count = kept(&plan).count();
        assert!((10..=12).contains(&count), "{count} lines at {degrees} degrees");
    }
}

#[test]
fn less_than_half_a_disc_is_planned_from_its_arc_to_its_straight_side() {
    for degrees in [100.0, 140.0, 165.0] {
        let plan = planned(&segment(degrees), &[PartClass::Sector], 0.3);
        let x = 2.0 * angle::cos((degrees / 2.0).to_radians());
        assert!(kept(&plan).all(|line| (line.end.x - x).abs() < 1e-6), "at {degrees} degrees");
    }
}

#[test]
fn of_a_lens_each_half_is_planned_to_the_cut_between_them() {
    let room = rooms::bent(&[(-1.8, 0.0, 100.0), (1.8, 0.0, 100.0)]);
    let plan = planned(&room, &[PartClass::Sector, PartClass::Sector], 0.3);
    assert!(kept(&plan).all(|line| line.end.y.abs() < 1e-6));
}

#[test]
fn a_round_room_with_a_round_bite_is_planned_by_diameters() {
    let (x, y) = (2.0 * angle::cos(angle::PI / 18.0), 2.0 * angle::sin(angle::PI / 18.0));
    let bitten = rooms::bent(&[(x, y, 340.0), (x, -y, -200.0)]);
    let plan = planned(&bitten, &[PartClass::Concave], 0.4);
    assert!((20..=32).contains(&kept(&plan).count()), "{:?}", plan.figures);
    // Of a crescent the centre lies in the bite.
    let crescent = rooms::bent(&[(-2.0, 0.0, 180.0), (2.0, 0.0, -100.0)]).counter_clockwise();
    planned(&crescent, &[PartClass::Concave], 0.4);
}

#[test]
fn diameters_of_a_round_room_with_a_straight_wall_begin_and_end_at_its_walls() {
    let plan = planned(&segment(270.0), &[PartClass::Circle], 0.4);
    assert!(kept(&plan).count() > 15, "{:?}", plan.figures);
    for line in kept(&plan) {
        assert!((line.start.coords.norm() - 2.0).abs() < 1e-6, "{line:?}");
    }
}

#[test]
fn the_radii_of_a_part_are_driven_in_and_out_by_turns() {
    let plan = planned(&segment(180.0), &[PartClass::Semicircle], 0.5);
    let line = |id: u32| plan.lines.iter().find(|line| line.id == id).unwrap();
    for (k, &(_, back)) in plan.order.iter().enumerate() {
        assert_eq!(back, k % 2 == 1, "in place {k}");
    }
    for pair in plan.order.windows(2) {
        let apart = (line(pair[0].0).start - line(pair[1].0).start).norm();
        assert!(apart < 0.51, "{pair:?} begin {apart} m apart");
    }
    let driven: f64 = kept(&plan).filter_map(|l| l.drive).map(|(a, b)| (b - a).norm()).sum();
    assert!(plan.figures.length < 1.4 * driven, "{driven} m of {:?}", plan.figures);
}

#[test]
fn a_cut_beside_a_semicircle_is_driven_along_once() {
    let room =
        rooms::bent(&[(0.0, 0.0, 0.0), (4.0, 0.0, 180.0), (4.0, 3.0, 0.0), (0.0, 3.0, 180.0)]);
    let half = PartClass::Semicircle;
    let plan = planned(&room, &[half, half, PartClass::Convex], 0.5);
    for x in [0.0, 4.0] {
        assert_eq!(kept_along(&plan, Point::new(x, 0.0), Point::new(x, 3.0)), 1, "at {x}");
    }
    // Two halves of a disc: along the cut between them the radii of one.
    let disc = rooms::bent(&[(-2.0, 0.0, 180.0), (2.0, 0.0, 180.0)]);
    let plan = planned(&disc, &[half, half], 0.5);
    assert_eq!(kept_along(&plan, Point::new(-2.0, 0.0), Point::new(2.0, 0.0)), 2);
}
