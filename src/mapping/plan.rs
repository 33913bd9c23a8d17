//! interim
use super::map::*;
use super::settings::Settings;
use crate::geometry::Point;
/// r
pub struct PlanRequest<'a> {
    /// s
    pub shape: &'a Shape,
    /// o
    pub objects: &'a [MappedObject],
    /// d
    pub driven: &'a [Point],
    /// f
    pub from: Point,
    /// s
    pub settings: &'a Settings,
}
/// m
pub fn make(r: &PlanRequest<'_>) -> Plan {
    Plan {
        alpha: r.settings.alpha,
        lines: vec![],
        order: vec![],
        figures: PlanFigures {
            strategy: r.settings.strategy,
            lines: 0,
            length: 0.0,
            hidden_disc: 0.0,
        },
        alternatives: vec![],
    }
}
