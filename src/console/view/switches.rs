//! The proximity switches as a rose around the robot, front up: `●` closed, `○` open.

use super::pen::Piece;
use crate::console::theme::Role;
use crate::geometry::angle;
use crate::robot::Chassis;
use crate::session::snapshot::RobotView;

/// Three rows of three places. Switches that share an eighth of the circle share a place, which
/// is closed when any of them is.
pub(super) fn rose(chassis: &Chassis, robot: Option<&RobotView>) -> [Vec<Piece>; 3] {
    // Places counter-clockwise from the front.
    const PLACES: [(usize, usize); 8] =
        [(0, 1), (0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2)];
    let mut grid = [[(Role::Muted, " "); 3]; 3];
    grid[1][1] = (Role::Value, "▲");
    for (index, mount) in chassis.sensors.iter().enumerate() {
        let eighth = (angle::wrap_positive(mount.angle) / angle::FRAC_PI_4).round() as usize % 8;
        let (row, col) = PLACES[eighth];
        let place = &mut grid[row][col];
        match robot {
            None => *place = (Role::Unknown, "?"),
            Some(robot) if robot.switches.has(index) => *place = (Role::Active, "●"),
            Some(_) if place.1 == "●" => {}
            Some(_) => *place = (Role::Muted, "○"),
        }
    }
    grid.map(|row| row.iter().map(|&(role, symbol)| (role, format!("{symbol} "))).collect())
}

/// The names of the closed switches, or that none is.
pub(super) fn closed(chassis: &Chassis, robot: &RobotView) -> String {
    let names: Vec<&str> = robot
        .switches
        .iter()
        .filter_map(|index| chassis.sensors.get(index))
        .map(|mount| mount.name.as_str())
        .collect();
    if names.is_empty() { "all open".to_owned() } else { names.join(", ") }
}
