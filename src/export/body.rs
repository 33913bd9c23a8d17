//! `chassis.toml`: the robot's body as the run has measured it, to be given to the robot, or to
//! `--chassis`. Written once laps were driven both ways round.

use super::RunRecord;
use std::fmt::Write as _;

/// The body of the record's robot with what was measured of it, and with how well that is known; none
/// when nothing was.
#[must_use]
pub fn write(record: &RunRecord<'_>) -> Option<String> {
    let known = record.map.calibration.as_ref()?;
    let chassis = &record.settings.chassis;
    let taped = record.map.taped.is_some();
    let mut text = String::new();
    let mut line = |words: String| {
        text.push_str(&words);
        text.push('\n');
    };
    line(format!("# The body of the robot, as measured on {} laps.", record.map.laps));
    line(format!(
        "# A tick of the right wheel is {:.5} ± {:.5} times one of the left.",
        1.0 / known.wheel_ratio.value,
        known.wheel_ratio.sd
    ));
    line(format!(
        "# The gyro tells {:.5} ± {:.5} times the turn, and {:.1} ± {:.1} degrees an hour at rest.",
        known.gyro_scale.value,
        known.gyro_scale.sd,
        known.gyro_drift.value.to_degrees() * 3600.0,
        known.gyro_drift.sd.to_degrees() * 3600.0
    ));
    line(format!("radius = {}", chassis.radius));
    line(format!(
        "wheel_base = {:.5} # ± {:.5}; was {}",
        known.wheel_base.value, known.wheel_base.sd, chassis.wheel_base
    ));
    let how = if taped { "by tape" } else { "as it was: only a taped length tells" };
    line(format!("tick = {:.9} # {how}; was {}", known.tick, chassis.tick));
    line(format!("range = {}", chassis.range));
    line(format!("hysteresis = {}", chassis.hysteresis));
    line(format!("speed = {}", chassis.speed));
    line(format!("turn_rate = {:.4}", chassis.turn_rate.to_degrees()));
    line(format!("acceleration = {}", chassis.acceleration));
    line(format!("bumper_half_angle = {:.4}", chassis.bumper_half_angle.to_degrees()));
    for mount in &chassis.sensors {
        // A name is written as TOML writes it.
        let name = toml::Value::from(mount.name.as_str());
        let angle = mount.angle.to_degrees();
        let _ = write!(text, "\n[[sensors]]\nname = {name}\nangle = {angle:.4}\n");
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::sample;

    #[test]
    fn without_a_second_lap_there_is_none() {
        assert_eq!(write(&sample::room().record()), None);
    }
}
