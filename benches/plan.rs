//! How long the path plan takes: `sims/flat.toml`, and a flat of 40 corners, 10 x 7 m, at several
//! α, with the lean and lanes alternatives and all hidden discs. `cargo bench --bench plan`.

use periplus::geometry::{Piece, Point, Pose, Ring, angle, cross, perp};
use periplus::mapping::floor::{Coverage, Floor};
use periplus::mapping::map::{Part, PartClass, Shape, ShapeClass};
use periplus::mapping::plan::{self, PlanRequest};
use periplus::mapping::settings::{Settings, Strategy};
use periplus::simulator::World;

fn main() {
    divan::main();
}

/// Four rooms around a hall, with door frames, a chimney and niches.
const FLAT: [(f64, f64); 40] = [
    (0.0, 0.0),
    (4.0, 0.0),
    (4.0, 1.2),
    (4.1, 1.2),
    (4.1, 0.0),
    (10.0, 0.0),
    (10.0, 1.0),
    (9.7, 1.0),
    (9.7, 1.5),
    (10.0, 1.5),
    (10.0, 2.8),
    (7.2, 2.8),
    (7.2, 2.9),
    (10.0, 2.9),
    (10.0, 7.0),
    (8.0, 7.0),
    (8.0, 6.6),
    (7.4, 6.6),
    (7.4, 7.0),
    (6.0, 7.0),
    (6.0, 4.9),
    (6.1, 4.9),
    (6.1, 4.0),
    (5.9, 4.0),
    (5.9, 7.0),
    (3.4, 7.0),
    (3.4, 4.2),
    (3.3, 4.2),
    (3.3, 5.2),
    (3.3, 7.0),
    (0.0, 7.0),
    (0.0, 4.4),
    (0.4, 4.4),
    (0.4, 4.0),
    (2.3, 4.0),
    (2.3, 3.9),
    (0.0, 3.9),
    (0.0, 2.4),
    (0.3, 2.1),
    (0.0, 1.8),
];

fn flat() -> Ring {
    let corners: Vec<Point> = FLAT.iter().map(|&(x, y)| Point::new(x, y)).collect();
    Ring::polygon(&corners)
}

fn shape(outline: &Ring) -> Shape {
    Shape {
        class: ShapeClass::Concave,
        outline: outline.clone(),
        vertices: outline.pieces.iter().map(Piece::from).collect(),
        parts: vec![Part {
            class: PartClass::Concave,
            ring: outline.clone(),
            cut: vec![false; outline.pieces.len()],
            circle: None,
        }],
    }
}

/// The lap of the centre along the walls.
fn lap(outline: &Ring) -> Vec<Point> {
    let corners: Vec<Point> = outline.pieces.iter().map(Piece::from).collect();
    let count = corners.len();
    let mut path = Vec::new();
    for k in 0..count {
        let (a, b, c) = (corners[(k + count - 1) % count], corners[k], corners[(k + 1) % count]);
        let (u, v) = ((b - a).normalize(), (c - b).normalize());
        let (m, n) = (perp(u), perp(v));
        if cross(u, v) >= 0.0 {
            path.push(b + (m + n) * (0.145 / (1.0 + m.dot(&n))));
        } else {
            let sweep = angle::atan2(cross(u, v), u.dot(&v));
            path.extend(
                (0..=8).map(|k| b + angle::unit(angle::of(m) + sweep * f64::from(k) / 8.0) * 0.145),
            );
        }
    }
    path.push(path[0]);
    path
}

fn settings(alpha: f64) -> Settings {
    let mut settings = Settings::new(Pose::new(0.5, 0.5, 0.0));
    settings.alpha = alpha;
    settings
}

#[divan::bench(args = [0.5, 0.25, 0.1])]
fn lean_plan(bencher: divan::Bencher<'_, '_>, alpha: f64) {
    with_request(&flat(), alpha, |request| {
        bencher.bench_local(|| plan::make_alone(request));
    });
}

#[divan::bench(args = [0.5, 0.25, 0.1])]
fn lean_plan_and_figures_of_the_others(bencher: divan::Bencher<'_, '_>, alpha: f64) {
    with_request(&flat(), alpha, |request| {
        bencher.bench_local(|| plan::make(request));
    });
}

/// The boundary of `sims/flat.toml`, as the maps' users plan it: 29 corners, 9.6 x 6.4 m.
fn sims_flat() -> Ring {
    match World::from_toml(include_str!("../sims/flat.toml"), "sims/flat.toml", 0.1) {
        Ok(world) => world.boundary,
        Err(error) => panic!("{error}"),
    }
}

#[divan::bench(args = [0.5, 0.25, 0.1])]
fn sims_flat_lean(bencher: divan::Bencher<'_, '_>, alpha: f64) {
    with_request(&sims_flat(), alpha, |request| {
        bencher.bench_local(|| plan::make_alone(request));
    });
}

#[divan::bench(args = [0.5, 0.25, 0.1])]
fn sims_flat_paper(bencher: divan::Bencher<'_, '_>, alpha: f64) {
    with_request(&sims_flat(), alpha, |request| {
        let mut settings = request.settings.clone();
        settings.strategy = Strategy::Paper;
        let request = PlanRequest { settings: &settings, ..*request };
        bencher.bench_local(|| plan::make_alone(&request));
    });
}

fn with_request(outline: &Ring, alpha: f64, run: impl FnOnce(&PlanRequest<'_>)) {
    run(&PlanRequest {
        shape: &shape(outline),
        objects: &[],
        driven: &Coverage::of(&lap(outline)),
        from: Point::new(0.5, 0.145),
        settings: &settings(alpha),
    });
}

#[divan::bench]
fn floor(bencher: divan::Bencher<'_, '_>) {
    let (outline, settings) = (flat(), settings(0.1));
    bencher.bench(|| Floor::new(&outline, &[], &settings.chassis, Point::new(0.5, 0.5)));
}

#[divan::bench(args = [0.5, 0.1])]
fn paper_lines(bencher: divan::Bencher<'_, '_>, alpha: f64) {
    let (outline, settings) = (flat(), settings(alpha));
    let floor = Floor::new(&outline, &[], &settings.chassis, Point::new(0.5, 0.5));
    let shape = shape(&outline);
    bencher.bench(|| plan::paper(&floor, &shape, alpha, 1));
}

#[divan::bench]
fn hidden_disc(bencher: divan::Bencher<'_, '_>) {
    let (outline, settings) = (flat(), settings(0.1));
    let floor = Floor::new(&outline, &[], &settings.chassis, Point::new(0.5, 0.5));
    let coverage = Coverage::of(&lap(&outline));
    bencher.bench(|| coverage.largest(&floor));
}

#[divan::bench]
fn route_through_three_doors(bencher: divan::Bencher<'_, '_>) {
    let (outline, settings) = (flat(), settings(0.1));
    let floor = Floor::new(&outline, &[], &settings.chassis, Point::new(0.5, 0.5));
    bencher.bench(|| floor.route(Point::new(0.5, 6.5), Point::new(9.5, 0.5), 0.16));
}
