//! Reading the world of a run, and whether the arguments fit it.

use super::CommandError;
use crate::cli::{ArgumentError, Common};
use crate::simulator::World;
use std::path::Path;

/// Reads the world in which a robot as `common` describes it is to run.
///
/// # Errors
/// When the world is wrong, the robot cannot stand at the start, or α does not fit the room.
pub fn load(path: &Path, common: &Common) -> Result<World, CommandError> {
    let radius = common.body()?.radius;
    fitted(World::load(path, radius).map_err(input)?, common, radius)
}

/// The same for a world that comes with the program.
///
/// # Errors
/// As [`load`].
pub fn built_in(text: &str, common: &Common) -> Result<World, CommandError> {
    let radius = common.body()?.radius;
    fitted(World::from_toml(text, "the built-in world", radius).map_err(input)?, common, radius)
}

#[expect(clippy::needless_pass_by_value, reason = "map_err hands the error over")]
fn input(error: crate::simulator::WorldError) -> CommandError {
    CommandError::Input(error.to_string())
}

fn fitted(mut world: World, common: &Common, radius: f64) -> Result<World, CommandError> {
    if let Some(start) = common.robot.start {
        let place = common.robot.start_place.as_deref().unwrap_or("--start");
        world = world.with_start(start, place, radius).map_err(input)?;
    }
    let (low, high) = world.boundary.bounds().unwrap_or_default();
    if let Some(alpha) = common.mapping.alpha {
        alpha_fits(alpha, (high.x - low.x, high.y - low.y))?;
    }
    Ok(world)
}

/// Refuses an α that no line of any plan in this room could be spaced by.
fn alpha_fits(alpha: f64, (width, height): (f64, f64)) -> Result<(), ArgumentError> {
    let limit = width.max(height);
    if alpha > limit {
        return Err(ArgumentError::AlphaTooLarge { alpha, width, height, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_must_fit_the_room() {
        assert!(alpha_fits(0.25, (5.0, 4.0)).is_ok());
        let error = alpha_fits(6.0, (5.0, 4.0)).expect_err("six metres in five");
        assert_eq!(
            error.to_string(),
            "α of 6 m is larger than the room (5.00 x 4.00 m): give --alpha a length below 5.00"
        );
    }
}
