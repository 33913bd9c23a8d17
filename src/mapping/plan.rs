//! The path plan (paper III.E): from the shape of the boundary to the lines that the robot is to
//! drive, in order, with what each strategy costs and what may still hide after it. It knows
//! shapes, known objects and what was driven so far; it refuses to know how lines are driven.

mod circle;
mod cover;
mod drive;
mod entries;
mod lanes;
mod lean;
mod order;
mod paper;
mod supplement;
mod travel;

pub use paper::lines as paper;
pub use supplement::supplement;

use super::floor::{Coverage, Floor, Unswept};
use super::map::{LineReason, LineStatus, MappedObject, Plan, PlanFigures, PlanLine, Shape};
use super::settings::{Settings, Strategy};
use crate::geometry::{Point, Ring, Segment};

/// The plan stays this much below α, metres, so that the promise survives driving it.
pub(crate) const MARGIN: f64 = 0.01;

/// What a plan is made from.
#[derive(Debug, Clone, Copy)]
pub struct PlanRequest<'a> {
    /// The boundary's shape.
    pub shape: &'a Shape,
    /// Objects known already.
    pub objects: &'a [MappedObject],
    /// Where the centre has been so far: the boundary's lap and what came before it.
    pub driven: &'a Coverage,
    /// Where the robot stands.
    pub from: Point,
    /// α, strategy, seed and body.
    pub settings: &'a Settings,
}

/// Makes the plan of the strategy chosen, and the figures of the others.
#[must_use]
pub fn make(request: &PlanRequest<'_>) -> Plan {
    made(request, true)
}

/// Makes the plan of the strategy chosen alone: no alternatives, in a fraction of the time.
#[must_use]
pub fn make_alone(request: &PlanRequest<'_>) -> Plan {
    made(request, false)
}

fn made(request: &PlanRequest<'_>, with_others: bool) -> Plan {
    let settings = request.settings;
    let rings: Vec<&Ring> = request.objects.iter().map(|o| &o.outline).collect();
    let outline = &request.shape.outline;
    let floor = Floor::new(outline, &rings, &settings.chassis, request.from);
    let mut lines = paper::lines(&floor, request.shape, settings.alpha, settings.seed);
    let driven = request.driven;
    let work = Work {
        floor: &floor,
        shape: request.shape,
        lap: Unswept::new(&floor, driven.segments()),
        from: request.from,
        target: (settings.alpha - MARGIN).max(0.0),
        alpha: settings.alpha,
    };
    let chosen = work.outcome(settings.strategy, &lines);
    let others = [Strategy::Paper, Strategy::Lean, Strategy::Lanes];
    let alternatives = others
        .into_iter()
        .filter(|&other| with_others && other != settings.strategy)
        .map(|other| work.outcome(other, &lines).figures)
        .collect();
    lines.extend(chosen.extra);
    mark(&mut lines, &chosen.order);
    Plan {
        alpha: settings.alpha,
        lines,
        order: chosen.order,
        figures: chosen.figures,
        alternatives,
    }
}

/// Lines that the strategy does without are skipped as redundant.
fn mark(lines: &mut [PlanLine], order: &[(u32, bool)]) {
    let mut ordered: Vec<u32> = order.iter().map(|&(id, _)| id).collect();
    ordered.sort_unstable();
    for line in lines {
        let planned = line.status == LineStatus::Planned;
        if planned && ordered.binary_search(&line.id).is_err() {
            line.status = LineStatus::Skipped;
            line.reason = Some(LineReason::Redundant);
        }
    }
}

/// What all strategies work on.
struct Work<'a> {
    floor: &'a Floor,
    shape: &'a Shape,
    /// What was driven so far leaves.
    lap: Unswept<'a>,
    from: Point,
    /// Diameter that no hidden disc may exceed where a line can help it, metres.
    target: f64,
    alpha: f64,
}

/// What a strategy comes to.
struct Outcome {
    order: Vec<(u32, bool)>,
    figures: PlanFigures,
    /// Lines that the paper's plan does not have.
    extra: Vec<PlanLine>,
}

impl Work<'_> {
    fn outcome(&self, strategy: Strategy, lines: &[PlanLine]) -> Outcome {
        match strategy {
            Strategy::Paper => {
                let (order, length) = order::by_vertex(self, lines);
                outcome(strategy, order, length, &lean::left_by_all(self, lines))
            }
            Strategy::Lean => {
                let (chosen, left) = lean::choose(self, lines);
                let (order, length) = order::shortest(self, &chosen);
                outcome(strategy, order, length, &left)
            }
            Strategy::Lanes => {
                let first = lines.iter().map(|line| line.id).max().unwrap_or(0) + 1;
                let (order, length, lanes) = lanes::plan(self, first);
                let free = lanes.iter().flat_map(|lane| drive::free_pieces(self.floor, lane));
                let pieces: Vec<Segment> = free.map(|(a, b)| Segment::new(a, b)).collect();
                let outcome = outcome(strategy, order, length, &self.lap.and(&pieces));
                Outcome { extra: lanes, ..outcome }
            }
        }
    }
}

/// What lines driven in `order` come to that leave `left`.
fn outcome(strategy: Strategy, order: order::Order, length: f64, left: &Unswept<'_>) -> Outcome {
    let hidden_disc = left.spots(0.0, 1).pop().map_or(0.0, |disc| disc.diameter);
    // The sum of no lengths is minus nothing.
    let length = length.max(0.0);
    let figures = PlanFigures { strategy, lines: order.len(), length, hidden_disc };
    Outcome { order, figures, extra: Vec::new() }
}

#[cfg(test)]
mod tests;
