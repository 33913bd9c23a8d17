//! `chassis.toml`: the robot's body as the run has measured it, to be given to the robot, or to
//! `--chassis`. Written once laps were driven both ways round.

use super::RunRecord;
use crate::mapping::tape::Taped;
use std::fmt::Write as _;

/// The body of the record's robot with what was measured of it, and with how well that is known; none
/// when nothing was.
#[must_use]
pub fn write(record: &RunRecord<'_>) -> Option<String> {
    let known = record.map.calibration.as_ref()?;
    let chassis = &record.settings.chassis;
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
    let how = how(record, "as it was", "only a taped length tells");
    line(format!("tick = {:.9} # {}{how}; was {}", known.tick, within(record, "; "), chassis.tick));
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

/// How the travel per tick was found: by tape, or `not` at all, as what happened to the tape says, or else the
/// `hint`.
fn how(record: &RunRecord<'_>, not: &str, hint: &str) -> String {
    match (record.map.taped, record.map.untaped) {
        (Some(_), _) => "by tape".to_owned(),
        (None, Some(why)) => format!("{not}: {why}"),
        (None, None) => format!("{not}: {hint}"),
    }
}

/// One standard deviation of the travel per tick, metres, and what parts it `from_next`; nothing where no tape told of
/// it.
fn within(record: &RunRecord<'_>, from_next: &str) -> String {
    let of = |taped: Taped| {
        let sd = taped.doubt() * record.settings.chassis.tick * taped.stretch;
        format!("± {sd:.9}{from_next}")
    };
    record.map.taped.map_or_else(String::new, of)
}

/// What was measured of wheels and gyro, a line for each figure, with its standard error; none when nothing
/// was.
#[must_use]
pub fn figures(record: &RunRecord<'_>) -> Option<String> {
    let known = record.map.calibration.as_ref()?;
    let chassis = &record.settings.chassis;
    let hourly = |rate: f64| rate.to_degrees() * 3600.0;
    let how = how(record, "not measured", "give --tape a length");
    Some(format!(
        "wheel base: {:.5} ± {:.5} m, was {} m\n\
         travel per tick: {:.9} {}m, was {} m, {how}\n\
         a tick of the right wheel over one of the left: {:.5} ± {:.5}\n\
         gyro scale: {:.5} ± {:.5}\n\
         gyro drift at rest: {:.1} ± {:.1} degrees an hour\n",
        known.wheel_base.value,
        known.wheel_base.sd,
        chassis.wheel_base,
        known.tick,
        within(record, " "),
        chassis.tick,
        1.0 / known.wheel_ratio.value,
        known.wheel_ratio.sd,
        known.gyro_scale.value,
        known.gyro_scale.sd,
        hourly(known.gyro_drift.value),
        hourly(known.gyro_drift.sd),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::sample;
    use crate::mapping::calibration::{Calibration, Measured};

    #[test]
    fn without_a_second_lap_there_is_none() {
        assert_eq!(write(&sample::room().record()), None);
        assert_eq!(figures(&sample::room().record()), None);
    }

    #[test]
    fn the_figures_are_told_with_their_errors_and_what_was_believed() {
        let measured = |value, sd| Measured { value, sd };
        let mut sample = sample::room();
        sample.map.calibration = Some(Calibration {
            wheel_base: measured(0.1612, 0.0002),
            wheel_ratio: measured(0.998, 0.0001),
            gyro_scale: measured(1.003, 0.0007),
            gyro_drift: measured(0.0, 1e-6),
            tick: 0.0001,
        });
        let told = figures(&sample.record()).expect("figures");
        let was = sample.settings.chassis.wheel_base;
        for words in [
            &format!("wheel base: 0.16120 ± 0.00020 m, was {was} m"),
            "travel per tick: 0.000100000 m",
            "not measured: give --tape",
            "right wheel over one of the left: 1.00200 ± 0.00010",
            "gyro scale: 1.00300 ± 0.00070",
            "0.0 ± 0.2 degrees an hour",
        ] {
            assert!(told.contains(words), "no `{words}` in {told}");
        }
        // Of 5 m a tape that is read to 2 mm tells 0.04 %, and its ends 0.03 %.
        sample.map.taped = Some(Taped { mapped: 5.05, taped: 5.0, stretch: 0.99, sd: 3e-4 });
        let sd = 5e-4 * sample.settings.chassis.tick * 0.99;
        let told = figures(&sample.record()).expect("figures");
        let words = format!("travel per tick: 0.000100000 ± {sd:.9} m, ");
        assert!(told.contains(&words) && told.contains("by tape"), "no `{words}` in {told}");
        let told = write(&sample.record()).expect("a body");
        let words = format!("tick = 0.000100000 # ± {sd:.9}; by tape");
        assert!(told.contains(&words), "no `{words}` in {told}");
    }
}
