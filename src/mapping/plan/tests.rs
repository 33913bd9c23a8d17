//! What a whole plan promises, for every strategy.

mod round;

use super::*;
use crate::geometry::Pose;
use crate::mapping::floor::rooms;
use crate::mapping::map::ObjectClass;
use proptest::prelude::{ProptestConfig, prop, prop_assert, proptest};

fn settings(alpha: f64, strategy: Strategy) -> Settings {
    let mut settings = Settings::new(Pose::new(0.5, 0.5, 0.0));
    settings.alpha = alpha;
    settings.strategy = strategy;
    settings
}

fn object(outline: Ring) -> MappedObject {
    MappedObject { id: 1, class: ObjectClass::Convex, outline, closed: true, contacts: Vec::new() }
}

fn plan_of(room: &Ring, objects: &[MappedObject], alpha: f64, strategy: Strategy) -> Plan {
    plan_in(&rooms::shape(room), objects, alpha, strategy)
}

fn plan_in(shape: &Shape, objects: &[MappedObject], alpha: f64, strategy: Strategy) -> Plan {
    let room = &shape.outline;
    make(&PlanRequest {
        shape,
        objects,
        driven: &Coverage::of(&rooms::lap(room, 0.145)),
        from: Point::new(0.5, 0.145),
        settings: &settings(alpha, strategy),
    })
}

/// The hidden disc after driving the plan's order, measured anew.
fn hidden_after(room: &Ring, plan: &Plan) -> f64 {
    let floor = rooms::floor(room, &[]);
    let mut coverage = Coverage::of(&rooms::lap(room, 0.145));
    for &(id, _) in &plan.order {
        let line = plan.lines.iter().find(|line| line.id == id).unwrap();
        let (from, to) = line.drive.unwrap();
        coverage.add_line(from, to);
    }
    coverage.largest(&floor).map_or(0.0, |disc| disc.diameter)
}

#[test]
fn lean_and_lanes_keep_the_promise_with_far_fewer_metres_than_the_paper() {
    for room in [rooms::rectangle(5.0, 4.0), rooms::ell(), rooms::flat()] {
        for alpha in [0.5, 0.25, 0.1] {
            let lean = plan_of(&room, &[], alpha, Strategy::Lean);
            let lanes = plan_of(&room, &[], alpha, Strategy::Lanes);
            for plan in [&lean, &lanes] {
                let hidden = hidden_after(&room, plan);
                let figures = plan.figures;
                assert!(hidden <= alpha - 0.5 * MARGIN, "{hidden} left at {alpha}: {figures:?}");
                assert!((hidden - figures.hidden_disc).abs() < 0.002, "{hidden}, {figures:?}");
            }
            let paper = lean.alternatives.iter().find(|f| f.strategy == Strategy::Paper).unwrap();
            assert!(lean.figures.length < 0.4 * paper.length, "{:?}, {paper:?}", lean.figures);
            assert!(lanes.figures.length < lean.figures.length, "{:?}", lanes.figures);
            assert!(paper.hidden_disc < 0.031, "{paper:?}");
        }
    }
}

#[test]
fn every_line_is_ordered_skipped_or_rejected_with_a_reason() {
    for strategy in [Strategy::Paper, Strategy::Lean, Strategy::Lanes] {
        let plan = plan_of(&rooms::ell(), &[], 0.4, strategy);
        let ordered: Vec<u32> = plan.order.iter().map(|&(id, _)| id).collect();
        for line in &plan.lines {
            let planned = line.status == LineStatus::Planned;
            assert_eq!(planned, ordered.contains(&line.id), "{line:?}");
            assert_eq!(planned, line.reason.is_none(), "{line:?}");
            assert!(!planned || line.drive.is_some(), "{line:?}");
        }
        let mut once = ordered.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), ordered.len(), "a line is driven once");
        assert_eq!((plan.figures.strategy, plan.alternatives.len()), (strategy, 2));
    }
}

#[test]
fn the_paper_drives_the_nearest_vertex_first_by_rising_angle_there_and_back() {
    let plan = plan_of(&rooms::rectangle(3.0, 2.0), &[], 0.5, Strategy::Paper);
    let line = |id: u32| plan.lines.iter().find(|line| line.id == id).unwrap();
    let first: Vec<_> = plan.order.iter().take_while(|(id, _)| line(*id).vertex == 0).collect();
    assert!(first.len() > 5, "{:?}", plan.order);
    for (k, &&(id, back)) in first.iter().enumerate() {
        assert_eq!(back, k % 2 == 1, "line {id} in place {k}");
        assert!(k == 0 || line(id).angle > line(first[k - 1].0).angle);
    }
}

#[test]
fn the_same_request_gives_the_same_plan() {
    let room = rooms::flat();
    let a = plan_of(&room, &[], 0.25, Strategy::Lean);
    assert_eq!(a, plan_of(&room, &[], 0.25, Strategy::Lean));
}

#[test]
fn ends_inside_known_objects_are_pulled_out_of_them() {
    let boxed = object(rooms::boxed(2.0, 1.6, 3.0, 2.4));
    let room = rooms::rectangle(5.0, 4.0);
    let plan = plan_of(&room, std::slice::from_ref(&boxed), 0.3, Strategy::Paper);
    let floor = rooms::floor(&room, &[&boxed.outline]);
    let drives: Vec<_> = plan.lines.iter().filter_map(|line| line.drive).collect();
    assert!(drives.len() > 50);
    for (a, b) in drives {
        assert!(floor.clearance(a) > 0.118 && floor.clearance(b) > 0.118, "{a} to {b}");
    }
}

#[test]
fn a_room_that_the_lap_alone_sweeps_needs_no_lines() {
    let plan = plan_of(&rooms::rectangle(2.0, 0.7), &[], 0.3, Strategy::Lean);
    assert_eq!(plan.order, Vec::new());
    assert!(plan.figures.hidden_disc < 0.1, "{:?}", plan.figures);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(11), cases: 24, ..ProptestConfig::default() })]
    /// Rooms of random steps: whatever their form, lean leaves no more than asked for, except
    /// where the paper's own lines leave as much.
    #[test]
    fn lean_leaves_no_more_than_alpha_or_than_the_paper(
        steps in prop::collection::vec((8_u32..20, 10_u32..35), 2..5),
        alpha in 1_u32..6,
    ) {
        let mut corners = vec![(0.0, 0.0)];
        let wide: f64 = steps.iter().map(|&(w, _)| f64::from(w) / 10.0).sum();
        corners.push((wide, 0.0));
        let mut x = wide;
        for &(w, h) in &steps {
            corners.push((x, f64::from(h) / 10.0));
            x -= f64::from(w) / 10.0;
            corners.push((x, f64::from(h) / 10.0));
        }
        corners.last_mut().unwrap().0 = 0.0;
        corners.dedup();
        let room = rooms::polygon(&corners);
        let alpha = f64::from(alpha) / 10.0;
        let plan = plan_of(&room, &[], alpha, Strategy::Lean);
        let paper = plan.alternatives.iter().find(|f| f.strategy == Strategy::Paper).unwrap();
        let most = (alpha - MARGIN).max(paper.hidden_disc) + 0.002;
        prop_assert!(plan.figures.hidden_disc <= most, "{:?} beside {paper:?}", plan.figures);
    }
}
