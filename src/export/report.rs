//! `report.json`: the figures of a run. Keys and units are part of the program's contract.

mod outline;

use super::{Outcome, PHASES, RunRecord, rounded};
use crate::geometry::measure::measure;
use crate::mapping::calibration::{Calibration, Measured};
use crate::mapping::map::{
    ObjectClass, Part, PartClass, Phase, Plan, PlanFigures, PlanLine, Shape, ShapeClass,
};
use crate::mapping::settings::{Contour, Strategy};
use crate::mapping::trust::Doubted;
use crate::mapping::unreached::Unreached;
use outline::Boundary;
use serde::Serialize;

/// The report as the text of a JSON file. `map_bytes` is the size of `map.json`.
#[must_use]
pub fn write(record: &RunRecord<'_>, map_bytes: usize) -> String {
    let report = Report::of(record, map_bytes);
    // Plain numbers, strings and lists: writing them to memory cannot fail.
    let mut text = serde_json::to_string_pretty(&report).unwrap_or_default();
    text.push('\n');
    text
}

#[derive(Serialize)]
struct Report<'a> {
    outcome: Outcome,
    reason: &'a str,
    seed: u64,
    world: &'a str,
    /// Errors of the simulated robot; none of a real one.
    noise: Option<&'a str>,
    alpha_m: f64,
    contour: Contour,
    phases: Vec<PhaseFigures>,
    boundary: Option<Boundary>,
    shape: Option<ShapeFigures>,
    plan: Option<PlanReport>,
    objects: Vec<Object>,
    /// What laps driven both ways round tell of wheels and gyro.
    #[serde(skip_serializing_if = "Option::is_none")]
    calibration: Option<CalibrationFigures>,
    passable_gap_m: f64,
    /// Floor behind gaps that are too narrow.
    unreached: Vec<Gap>,
    /// Motions that the bumper or a stall ended.
    bumps: u32,
    /// Switches that gave themselves away as broken.
    #[serde(skip_serializing_if = "<[Doubted]>::is_empty")]
    broken_switches: &'a [Doubted],
    contact_m: f64,
    map_bytes: usize,
    /// On the wall clock, seconds; in the console from its opening, pauses included.
    wall_s: f64,
}

/// Wheels and gyro as measured; `chassis.toml` holds what a robot can be given of it.
#[derive(Serialize)]
struct CalibrationFigures {
    wheel_base_m: Figure,
    /// A tick of the right wheel over one of the left.
    wheel_ratio: Figure,
    gyro_scale: Figure,
    gyro_drift_deg_per_h: Figure,
    tick_m: f64,
}

#[derive(Serialize)]
struct Figure {
    value: f64,
    standard_error: f64,
}

impl CalibrationFigures {
    fn of(known: &Calibration) -> Self {
        let figure = |measured: Measured, unit: f64, decimals: i32| Figure {
            value: rounded(measured.value * unit, decimals),
            standard_error: rounded(measured.sd * unit, decimals),
        };
        let ratio = known.wheel_ratio;
        Self {
            wheel_base_m: figure(known.wheel_base, 1.0, 5),
            wheel_ratio: figure(Measured { value: 1.0 / ratio.value, ..ratio }, 1.0, 5),
            gyro_scale: figure(known.gyro_scale, 1.0, 5),
            gyro_drift_deg_per_h: figure(known.gyro_drift, 1.0_f64.to_degrees() * 3600.0, 1),
            tick_m: rounded(known.tick, 9),
        }
    }
}

/// A gap that the robot does not pass, where it is narrowest.
#[derive(Serialize)]
struct Gap {
    x_m: f64,
    y_m: f64,
    width_m: f64,
    /// Floor for the body's centre behind it; null where nobody knows.
    area_m2: Option<f64>,
}

impl Gap {
    fn of(unreached: &Unreached) -> Self {
        Self {
            x_m: rounded(unreached.at.x, 3),
            y_m: rounded(unreached.at.y, 3),
            width_m: rounded(unreached.width, 3),
            area_m2: unreached.area.map(|area| rounded(area, 2)),
        }
    }
}

#[derive(Serialize)]
struct PhaseFigures {
    name: Phase,
    simulated_s: f64,
    travel_m: f64,
    commands: u32,
    done: bool,
}

#[derive(Serialize)]
struct ShapeFigures {
    class: ShapeClass,
    vertices: usize,
    parts: Vec<PartFigures>,
}

#[derive(Serialize)]
struct PartFigures {
    class: PartClass,
    #[serde(skip_serializing_if = "Option::is_none")]
    radius_m: Option<f64>,
}

#[derive(Serialize)]
struct PlanReport {
    #[serde(flatten)]
    chosen: StrategyFigures,
    /// Diameter of the hidden disc as the plan was made; that of the strategy is as driven, once it was.
    hidden_disc_planned_m: f64,
    /// Lines driven beyond the plan as it was made, and what they come to without the ways between them.
    added_lines: usize,
    added_length_m: f64,
    alternatives: Vec<StrategyFigures>,
}

#[derive(Serialize)]
struct StrategyFigures {
    strategy: Strategy,
    lines: usize,
    length_m: f64,
    hidden_disc_m: f64,
}

#[derive(Serialize)]
struct Object {
    id: u32,
    class: ObjectClass,
    closed: bool,
    x_m: f64,
    y_m: f64,
    width_m: f64,
    length_m: f64,
    area_m2: f64,
    /// Standard error of its place; null until it is known.
    standard_error_m: Option<f64>,
}

impl<'a> Report<'a> {
    fn of(record: &RunRecord<'a>, map_bytes: usize) -> Self {
        let map = record.map;
        Self {
            outcome: record.outcome,
            reason: record.reason,
            seed: record.settings.seed,
            world: record.world,
            noise: (!record.noise.is_empty()).then_some(record.noise),
            alpha_m: record.settings.alpha,
            contour: record.settings.contour,
            phases: phases(record),
            boundary: Boundary::of(record),
            shape: map.shape.as_ref().map(shape),
            plan: map.plan.as_ref().map(|plan| plan_report(plan, map.hidden_disc)),
            objects: objects(record),
            calibration: map.calibration.as_ref().map(CalibrationFigures::of),
            passable_gap_m: rounded(record.settings.chassis.passable_gap(), 4),
            unreached: map.unreached.iter().map(Gap::of).collect(),
            bumps: record.bumps,
            broken_switches: &map.doubted,
            contact_m: rounded(record.contact, 4),
            map_bytes,
            wall_s: rounded(record.wall_seconds, 3),
        }
    }
}

fn phases(record: &RunRecord<'_>) -> Vec<PhaseFigures> {
    PHASES
        .into_iter()
        .zip(record.progress)
        .map(|(name, progress)| PhaseFigures {
            name,
            simulated_s: rounded(progress.seconds, 3),
            travel_m: rounded(progress.travel, 4),
            commands: progress.commands,
            done: progress.done,
        })
        .collect()
}

fn shape(shape: &Shape) -> ShapeFigures {
    let part = |part: &Part| PartFigures {
        class: part.class,
        radius_m: part.circle.map(|(_, radius)| rounded(radius, 4)),
    };
    ShapeFigures {
        class: shape.class,
        vertices: shape.vertices.len(),
        parts: shape.parts.iter().map(part).collect(),
    }
}

fn plan_report(plan: &Plan, driven: Option<f64>) -> PlanReport {
    let length = |line: &PlanLine| line.drive.map_or(0.0, |(from, to)| (to - from).norm());
    PlanReport {
        // What was driven counts, once it was: the plan may have been amended on the way.
        chosen: StrategyFigures {
            hidden_disc_m: rounded(driven.unwrap_or(plan.figures.hidden_disc), 4),
            ..strategy(&plan.figures)
        },
        hidden_disc_planned_m: rounded(plan.figures.hidden_disc, 4),
        added_lines: plan.added().count(),
        added_length_m: rounded(plan.added().map(length).sum(), 3),
        alternatives: plan.alternatives.iter().map(strategy).collect(),
    }
}

fn strategy(figures: &PlanFigures) -> StrategyFigures {
    StrategyFigures {
        strategy: figures.strategy,
        lines: figures.lines,
        length_m: rounded(figures.length, 3),
        hidden_disc_m: rounded(figures.hidden_disc, 4),
    }
}

fn objects(record: &RunRecord<'_>) -> Vec<Object> {
    let error = |k: usize| Some(rounded(*record.map.accuracy.as_ref()?.objects.get(k)?, 4));
    let measured = |(k, object): (usize, &crate::mapping::map::MappedObject)| {
        let size = measure(&object.outline)?;
        Some(Object {
            id: object.id,
            class: object.class,
            closed: object.closed,
            x_m: rounded(size.center.x, 4),
            y_m: rounded(size.center.y, 4),
            width_m: rounded(size.width, 4),
            length_m: rounded(size.length, 4),
            area_m2: rounded(size.area, 5),
            standard_error_m: error(k),
        })
    };
    record.map.objects.iter().enumerate().filter_map(measured).collect()
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use crate::geometry::Point;
    use crate::mapping::map::{Alike, LineStatus};
    use serde_json::Value;

    fn parsed(record: &RunRecord<'_>) -> Value {
        let text = write(record, 1234);
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"))
    }

    #[test]
    fn the_report_holds_every_promised_key() {
        let report = parsed(&sample::room().record());
        for key in [
            "/outcome",
            "/reason",
            "/seed",
            "/world",
            "/alpha_m",
            "/phases/0/name",
            "/phases/3/simulated_s",
            "/phases/3/travel_m",
            "/phases/3/commands",
            "/boundary/perimeter_m",
            "/boundary/area_m2",
            "/boundary/laps",
            "/boundary/misclosure/dx_m",
            "/boundary/misclosure/dy_m",
            "/boundary/misclosure/heading_deg",
            "/boundary/misclosure/ratio",
            "/boundary/standard_error/walls/median_m",
            "/boundary/standard_error/corners/worst_m",
            "/shape/class",
            "/shape/vertices",
            "/shape/parts/0/class",
            "/plan/strategy",
            "/plan/lines",
            "/plan/length_m",
            "/plan/hidden_disc_m",
            "/plan/alternatives/0/strategy",
            "/plan/alternatives/0/lines",
            "/plan/alternatives/0/length_m",
            "/plan/alternatives/0/hidden_disc_m",
            "/objects/0/id",
            "/objects/0/class",
            "/objects/0/closed",
            "/objects/0/x_m",
            "/objects/0/y_m",
            "/objects/0/width_m",
            "/objects/0/length_m",
            "/objects/0/area_m2",
            "/objects/0/standard_error_m",
            "/passable_gap_m",
            "/bumps",
            "/contact_m",
            "/map_bytes",
            "/wall_s",
        ] {
            assert!(report.pointer(key).is_some(), "{key} is missing in {report:#}");
        }
        assert_eq!(report["outcome"], "complete");
        assert_eq!(report["map_bytes"], 1234);
    }

    #[test]
    fn what_is_not_known_is_null_and_never_a_number() {
        let mut sample = sample::room();
        sample.map = crate::mapping::map::RoomMap::default();
        let report = parsed(&sample.record());
        for key in ["boundary", "shape", "plan"] {
            assert!(report[key].is_null(), "{key} of an empty map is {}", report[key]);
        }
        let real = sample.record();
        let report = parsed(&RunRecord { noise: "", ..real });
        assert!(report["noise"].is_null(), "a real robot errs as {}", report["noise"]);
    }

    /// What was driven beyond the plan is told beside what was planned, which stays what it was.
    #[test]
    fn lines_that_were_added_are_told_with_their_length() {
        let mut sample = sample::room();
        let plan = &parsed(&sample.record())["plan"];
        assert_eq!((&plan["added_lines"], &plan["added_length_m"]), (&0.into(), &0.0.into()));
        let (lines, length) = (plan["lines"].clone(), plan["length_m"].clone());
        if let Some(plan) = &mut sample.map.plan {
            let driven = |line: &&PlanLine| line.status == LineStatus::Driven;
            let line = plan.lines.iter().find(driven).cloned().expect("a line");
            let way = |x: f64| Some((Point::new(1.0, 1.0), Point::new(x, 1.0)));
            plan.lines.push(PlanLine { id: 98, drive: way(2.5), ..line });
            plan.lines.push(PlanLine { id: 99, drive: way(3.0), ..line });
            // One that was not driven was not added either.
            plan.lines.push(PlanLine { id: 97, status: LineStatus::Rejected, ..line });
        }
        let plan = &parsed(&sample.record())["plan"];
        assert_eq!((&plan["added_lines"], &plan["added_length_m"]), (&2.into(), &3.5.into()));
        assert_eq!((&plan["lines"], &plan["length_m"]), (&lines, &length));
    }

    /// Half of the walls are known better than the median, and half worse.
    #[test]
    fn the_median_of_an_even_number_lies_between_the_two_in_the_middle() {
        let mut sample = sample::room();
        let accuracy = sample.map.accuracy.as_mut().expect("errors");
        accuracy.walls = vec![0.009, 0.001, 0.002, 0.004];
        let report = parsed(&sample.record());
        assert_eq!(report["boundary"]["standard_error"]["walls"]["median_m"], 0.003);
        assert_eq!(report["boundary"]["standard_error"]["walls"]["worst_m"], 0.009);
    }

    #[test]
    fn a_lap_that_closes_elsewhere_as_well_says_where() {
        let mut sample = sample::room();
        assert!(parsed(&sample.record())["boundary"].get("closes_as_well").is_none());
        sample.map.alike = Some(Alike { longer: -2.01, drift: -3.0e-4 });
        let report = parsed(&sample.record());
        assert_eq!(report["boundary"]["closes_as_well"]["longer_m"], -2.01);
        assert_eq!(report["boundary"]["closes_as_well"]["drift_deg_h"], -61.88);
    }

    #[test]
    fn a_perfect_lap_has_no_ratio() {
        let mut sample = sample::room();
        if let Some(off) = &mut sample.map.misclosure {
            (off.dx, off.dy) = (0.0, 0.0);
        }
        let report = parsed(&sample.record());
        assert!(report["boundary"]["misclosure"]["ratio"].is_null());
    }
}
