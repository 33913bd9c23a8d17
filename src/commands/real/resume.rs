//! Taking up an interrupted run with a real robot: whether its record is one that is gone on with, whole, not over
//! and as it was begun, and what there is to do where it is not. Knows nothing of how the run goes on.

use super::super::ending::{BOTH_WAYS, Told};
use super::super::{CommandError, glue, output};
use crate::cli::Common;
use crate::geometry::{Point, Pose, ring::bounds};
use crate::journal::{Header, JournalError, Recording};
use crate::link::Address;
use crate::mapping::map::{Phase, RoomMap};
use crate::mapping::mission::Mission;
use crate::mapping::settings::Settings;
use crate::mapping::tape::Tape;
use crate::runtime::line::Line;
use crate::runtime::live::{Interrupted, Plan};
use crate::runtime::{Ending, FolderError, OutputFolder};
use crate::session::Replay;
use serde::Serialize;
use std::fs::File;
use std::path::Path;

/// A place that is told by eye may be so far from where it is, metres.
const ABOUT: f64 = 0.5;

/// Plays the record of an interrupted run back into the core and opens the port to go on with it.
pub(super) fn take_up(
    address: &Address,
    common: &Common,
    (until, at_once): (Option<Phase>, bool),
    told: Told,
    dir: &Path,
) -> Result<(Line, OutputFolder), CommandError> {
    let refused = |why: String| CommandError::Input(format!("--resume {}: {why}", dir.display()));
    let (folder, mut journal) = reopen(dir)?;
    let recording = crate::journal::read_open(&folder.journal(), &mut journal);
    let recording = recording.map_err(|error| damaged(error, address, dir))?;
    glue::warn_torn(&recording);
    let (header, sound) = (recording.header.clone(), recording.sound as u64);
    let records = recording.records.len() as u64;
    let life = recording.life();
    let robot = header.robot.clone().ok_or_else(|| {
        refused("it was made in the simulator; the same seed makes it again".to_owned())
    })?;
    let mut replay = Replay::new(recording);
    replay.finish();
    if let Some(difference) = replay.difference() {
        let why = format!(
            "the replay differs from the run ({difference}): it was made by another version"
        );
        return Err(refused(why));
    }
    if let Some(Ending { reason, .. }) = Ending::of(replay.session()) {
        let todo = "what is over is not gone on with, begin another with --out DIR";
        return Err(refused(format!("it is over: {reason}; {todo}")));
    }
    if told == Told::Measured {
        measures(&header, replay.session().mission()).map_err(|what| {
            let todo = format!("`periplus run --port {address} --resume {}`", dir.display());
            refused(format!(
                "{what}; {todo} goes on with it, and `periplus calibrate --out DIR` begins another"
            ))
        })?;
    }
    let holds = replay.session().mission().settings();
    same_settings(&header.settings, holds, common).map_err(refused)?;
    if let Some(placed) = &common.keeping.placed {
        about_the_room(placed, replay.session().mission().map()).map_err(refused)?;
    }
    if until.is_some() && until != header.until {
        let told = |until: Option<Phase>| until.map_or("not given".to_owned(), |to| to.to_string());
        let (was, now) = (told(header.until), told(until));
        return Err(refused(format!("--until was {was} and is now {now}; leave it out to go on")));
    }
    let (session, unrecorded) = replay.into_session();
    output::say(&format!(
        "periplus: going on in the {} phase, {:.0} s into the run",
        session.mission().phase(),
        session.mission().tracker().passed()
    ));
    if common.keeping.placed.is_some() && session.mission().phase() == Phase::Boundary {
        let why = "the boundary is not closed yet: the lap begins anew from --placed";
        output::say(&format!("periplus: {why}"));
    }
    let plan =
        Plan { settings: header.settings, port: address.to_string(), until: header.until, at_once };
    folder.cut(&mut journal, sound)?;
    let placed = common.keeping.placed;
    let interrupted = Interrupted { session, robot, life, placed, unrecorded, records };
    let line = Line::open(address.clone(), plan, journal, Some(interrupted));
    Ok((line.map_err(|error| CommandError::Input(error.to_string()))?, folder))
}

/// Refuses to go on calibrating with a run that comes to its end without having measured its robot, and says what
/// it is.
fn measures(header: &Header, mission: &Mission) -> Result<(), String> {
    let takes = "and a calibration takes a lap each way round";
    // Fewer than it was begun with are those after which the robot could not go on.
    if mission.settings().laps.max(header.settings.laps) < BOTH_WAYS {
        return Err(format!("it is the record of a run of one lap, {takes}"));
    }
    if header.until == Some(Phase::Boundary) {
        let why = "it is the record of a run that ends with the boundary";
        return Err(format!("{why}, and the laps are laid on the walls after that"));
    }
    if mission.phase() != Phase::Boundary && mission.map().laps < BOTH_WAYS {
        return Err(format!("it is the record of a run that went on after one lap, {takes}"));
    }
    Ok(())
}

/// What to do about a record that is `damaged` in the middle: going on in it would cut off what is behind that. In
/// a copy of what is whole nothing is lost; only the robot has driven on since, and must not be believed to stand
/// where that ends.
fn damaged(error: JournalError, address: &Address, dir: &Path) -> CommandError {
    let JournalError::Damaged { path, line, .. } = &error else { return error.into() };
    let real = |whole: Recording| whole.header.robot.is_some();
    if *line == 1 || !crate::journal::read_whole_part(path).is_ok_and(real) {
        return error.into();
    }
    let (record, whole) = (path.display(), line - 1);
    CommandError::Input(format!(
        "--resume {}: {error}. To go on from there, copy that to a new folder NEW: `mkdir NEW; head -n {whole} \
         {record} > NEW/journal`; switch the robot off and on, since it has driven on after that and has to find \
         its place; then `periplus run --port {address} --resume NEW --placed X,Y,DEG`, with the place where it \
         stands about",
        dir.display()
    ))
}

/// Takes the record of an interrupted run in hand, before it is read: another program may still write to it.
fn reopen(dir: &Path) -> Result<(OutputFolder, File), CommandError> {
    match OutputFolder::reopen(dir) {
        Ok(open) => Ok(open),
        Err(busy @ FolderError::Busy { .. }) => Err(busy.into()),
        Err(error) => {
            // What cannot be read either says more.
            crate::journal::read(dir)?;
            Err(error.into())
        }
    }
}

/// Refuses a place far from the room that is mapped: no search for it would end there.
fn about_the_room(placed: &Pose, map: &RoomMap) -> Result<(), String> {
    let walls: Vec<Point> = map.contacts.iter().map(|contact| contact.point).collect();
    let Some((low, high)) = bounds(&walls).filter(|_| map.closed) else { return Ok(()) };
    let at = placed.position;
    let is_near = |at: f64, low: f64, high: f64| (low - ABOUT..=high + ABOUT).contains(&at);
    if is_near(at.x, low.x, high.x) && is_near(at.y, low.y, high.y) {
        return Ok(());
    }
    Err(format!(
        "--placed {} is not in the room, which goes from {:.1} to {:.1} m in x and from {:.1} to {:.1} m in y",
        as_place(placed),
        low.x,
        high.x,
        low.y,
        high.y
    ))
}

/// A run goes on as it was begun, and as its operator changed it since: a flag that says something else than
/// what `holds` now is refused with the difference.
fn same_settings(begun: &Settings, holds: &Settings, common: &Common) -> Result<(), String> {
    let unsaid = || "not given".to_owned();
    let named = |name: &Option<String>| name.clone().unwrap_or_else(unsaid);
    let taped = |tape: Option<Tape>| tape.map_or_else(unsaid, as_flag);
    let (mapping, robot) = (&common.mapping, &common.robot);
    if let Some(now) = &common.keeping.name {
        let now = Some(now.clone());
        same("--name", &begun.name, &holds.name, &now, named)?;
    }
    if let Some(now) = mapping.alpha {
        same("--alpha", &begun.alpha, &holds.alpha, &now, f64::to_string)?;
    }
    if let Some(now) = mapping.plan {
        same("--plan", &begun.strategy, &holds.strategy, &now, as_word)?;
    }
    if let Some(now) = mapping.contour {
        same("--contour", &begun.contour, &holds.contour, &now, as_word)?;
    }
    if let Some(now) = robot.seed {
        same("--seed", &begun.seed, &holds.seed, &now, u64::to_string)?;
    }
    if let Some(now) = robot.start {
        same("--start", &begun.start, &holds.start, &now, as_place)?;
    }
    if let Some(now) = mapping.laps {
        // Fewer than it was begun with are those after which the robot could not go on: nobody wished for them.
        let wished = holds.laps.max(begun.laps);
        same("--laps", &begun.laps, &wished, &now, u32::to_string)?;
    }
    if let Some(now) = mapping.tape {
        same("--tape", &begun.tape, &holds.tape, &Some(now), |tape| taped(*tape))?;
    }
    if mapping.square {
        let given = |square: &bool| if *square { "given".to_owned() } else { unsaid() };
        same("--square", &begun.square, &holds.square, &true, given)?;
    }
    Ok(())
}

/// Refuses a flag whose value `now` differs from the one that `holds`; the one that the run was `begun` with is
/// told as well, where it is another.
fn same<T: PartialEq>(
    flag: &str,
    begun: &T,
    holds: &T,
    now: &T,
    tell: impl Fn(&T) -> String,
) -> Result<(), String> {
    if now == holds {
        return Ok(());
    }
    let then = if begun == holds { String::new() } else { format!(", then {},", tell(holds)) };
    let (was, now) = (tell(begun), tell(now));
    Err(format!("{flag} was {was}{then} and is now {now}; leave it out to go on"))
}

/// A choice as its flag takes it: records spell it the same way.
fn as_word(choice: &impl Serialize) -> String {
    let word = serde_json::to_value(choice).ok();
    word.as_ref().and_then(serde_json::Value::as_str).unwrap_or_default().to_owned()
}

/// A pose as its flag takes it: metres and degrees, to a thousandth.
fn as_place(pose: &Pose) -> String {
    let to_thousandth = |value: f64| (value * 1000.0).round() / 1000.0;
    let [x, y, degrees] =
        [pose.position.x, pose.position.y, pose.heading.to_degrees()].map(to_thousandth);
    format!("{x},{y},{degrees}")
}

/// A taped length as its flag takes it, metres.
fn as_flag(Tape { from, to, length }: Tape) -> String {
    format!("{},{}:{},{}={length}", from.x, from.y, to.x, to.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Read before it is in hand, what the other program writes last would be cut off as damage.
    #[test]
    fn a_record_that_another_program_writes_is_not_even_read() {
        let dir = std::env::temp_dir().join(format!("periplus-{}-busy", std::process::id()));
        std::fs::create_dir_all(&dir).expect("a folder");
        let file = File::create(dir.join("journal")).expect("a record");
        file.try_lock().expect("nobody has it");
        let address: Address = "tcp://127.0.0.1:1".parse().expect("an address");
        let taken = || take_up(&address, &Common::default(), (None, false), Told::Ending, &dir);
        let why = taken().err().expect("two writers").to_string();
        assert!(why.contains("another program is recording"), "{why}");
        drop(file);
        let why = taken().err().expect("it is empty").to_string();
        assert!(why.contains("never began"), "{why}");
        let _ = std::fs::remove_dir_all(&dir);
    }
}
