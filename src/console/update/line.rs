//! What the command line does: a key to the line that is typed, and a line that was entered to the run.

use super::{
    Effect, is_nowhere, not_answered, only_looked_at, perform, refuse, set_alpha, set_speed,
};
use crate::console::action::Action;
use crate::console::command::{Command, CommandError};
use crate::console::key::Key;
use crate::console::model::{Model, Overlay};
use crate::console::prompt::{Prompt, Typed};
use crate::console::view::list::wall_name;
use crate::geometry::{Piece, Point};
use crate::mapping::tape::Tape;
use crate::robot::Intent;
use crate::session::snapshot::{RunState, Snapshot};

/// A key was pressed while a command is typed.
pub(super) fn press(
    model: &mut Model,
    snapshot: &Snapshot,
    key: Key,
    prompt: Prompt,
) -> Vec<Effect> {
    match prompt.press(key, &model.past, model.steered(snapshot)) {
        Typed::On(prompt) => model.overlay = Overlay::Line(prompt),
        Typed::Left => {}
        Typed::Entered(line) => {
            model.past.add(&line);
            return match Command::parse(&line) {
                Ok(command) => obey(model, snapshot, command),
                Err(CommandError::Empty) => Vec::new(),
                Err(error) => refuse(model, error.to_string()),
            };
        }
    }
    Vec::new()
}

/// Does what the command says.
pub(super) fn obey(model: &mut Model, snapshot: &Snapshot, command: Command) -> Vec<Effect> {
    let is_told_to_the_run = matches!(
        command,
        Command::Alpha(_) | Command::Tape(_) | Command::TapeWall { .. } | Command::Placed(_)
    );
    match command {
        _ if is_told_to_the_run && snapshot.recorded => only_looked_at(model),
        _ if is_told_to_the_run && model.is_alone(snapshot) => not_answered(model, snapshot),
        Command::Action(action) => perform(model, snapshot, action),
        Command::Alpha(alpha) => set_alpha(model, snapshot, alpha),
        Command::Tape(Tape { from, to, length }) => {
            vec![Effect::Intent(Intent::SetTape { from, to, length })]
        }
        Command::TapeWall { wall, length } => match tape_of(snapshot, wall, length) {
            Ok(Tape { from, to, length }) => {
                vec![Effect::Intent(Intent::SetTape { from, to, length })]
            }
            Err(why) => refuse(model, why),
        },
        Command::Placed(Some(near)) if is_outside(snapshot, near.position) => {
            let at = near.position;
            refuse(model, format!("{:.2},{:.2} lies outside the room", at.x, at.y))
        }
        Command::Placed(Some(_)) if drops_a_lap(snapshot) && snapshot.run != RunState::Stopped => {
            let stop = model.keymap.way(Action::Stop);
            let why = "where the robot is put, the lap so far is dropped and begins anew";
            refuse(model, format!("{why}: {stop} stops first, then say it again"))
        }
        Command::Placed(near) => vec![Effect::Intent(Intent::Placed { near })],
        Command::Speed(speed) => set_speed(model, snapshot, |_| speed),
        Command::Export(dir) => vec![Effect::Export(dir)],
        Command::At(seconds) => vec![Effect::GoTo(seconds)],
    }
}

/// The tape held from end to end of a wall, counted from 0; in words why it cannot be.
fn tape_of(snapshot: &Snapshot, wall: usize, length: f64) -> Result<Tape, String> {
    let Some(shape) = &snapshot.map.shape else {
        return Err("no wall is known yet; the tape can be given by places: X,Y:X,Y=M".to_owned());
    };
    let name = wall_name(wall);
    match shape.outline.pieces.get(wall) {
        None => Err(format!(
            "there is no {name}: the last is {}",
            wall_name(shape.outline.pieces.len().saturating_sub(1))
        )),
        Some(Piece::Arc { .. }) => Err(format!("{name} is bent, and a tape is straight")),
        Some(&Piece::Line { from, to }) => {
            Tape { from, to, length }.checked().map_err(|error| error.to_string())
        }
    }
}

/// Whether walls are known that hang on nothing but where the robot has been since: the first lap is under way.
fn drops_a_lap(snapshot: &Snapshot) -> bool {
    let met = !snapshot.map.contacts.is_empty();
    !snapshot.map.closed && met && !is_nowhere(snapshot) && !snapshot.run.is_over()
}

/// Whether the room is known and a place is not in it.
fn is_outside(snapshot: &Snapshot, place: Point) -> bool {
    let shape = snapshot.map.shape.as_ref();
    shape.is_some_and(|shape| !shape.outline.contains(place))
}
