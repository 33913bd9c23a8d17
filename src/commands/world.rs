//! Reading the world of a run, and whether the arguments fit it.

use super::{CommandError, output};
use crate::cli::{ArgumentError, Common};
use crate::simulator::World;
use std::path::Path;

/// Reads the world in which a robot as `common` describes it is to run.
///
/// # Errors
/// When the world is wrong, the robot cannot stand at the start, or α does not fit the room.
pub fn load(path: &Path, common: &Common) -> Result<World, CommandError> {
    let radius = common.body()?.radius;
    let world = fitted(World::load(path, radius).map_err(input)?, common, radius)?;
    if let Some(told) = outside(&world) {
        output::say(&format!("periplus: {}: {told}", path.display()));
    }
    Ok(world)
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

/// What there is to say of objects that no robot meets: the first of them by name.
fn outside(world: &World) -> Option<String> {
    let mut objects = world.outside();
    let name = &objects.next()?.name;
    Some(match objects.count() {
        0 => format!("object \"{name}\" lies outside the room: nobody meets it"),
        more => {
            format!("object \"{name}\" and {more} more lie outside the room: nobody meets them")
        }
    })
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
    fn objects_that_nobody_meets_are_told_before_a_run() {
        let world = |objects: &[f64]| {
            let text =
                "start = { x = 1, y = 1 }\n[boundary]\nvertices = [[0,0],[4,0],[4,4],[0,4]]\n";
            let object = |x: &f64| {
                format!(
                    "[[objects]]\nname = \"at {x}\"\ncircle = {{ center = [{x}, 2], radius = 0.2 }}\n"
                )
            };
            let objects: String = objects.iter().map(object).collect();
            World::from_toml(&format!("{text}{objects}"), "room.toml", 0.1).expect("a world")
        };
        assert_eq!(outside(&world(&[2.0, 4.1])), None);
        let told = outside(&world(&[2.0, 5.0])).expect("one of them");
        assert!(told.starts_with("object \"at 5\" lies outside the room"), "{told}");
        let told = outside(&world(&[5.0, 2.0, 6.0, 7.0])).expect("three of them");
        assert!(told.starts_with("object \"at 5\" and 2 more lie outside the room"), "{told}");
    }

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
