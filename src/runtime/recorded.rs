//! The console's driver over a record: the operator's keys steer the playback, not the run. Nothing
//! moves; a stop pauses the picture.

use super::Ending;
use crate::console::driver::Driver;
use crate::export::{Outcome, RunRecord};
use crate::journal::{Recording, Torn};
use crate::mapping::map::RoomMap;
use crate::robot::Intent;
use crate::session::replay::{Difference, Landmark, Replay};
use crate::session::{RunState, Snapshot};
use std::path::Path;

/// What a record says of its run: the map made once more, as the run had it where the record ends. What
/// only a simulator knows is not part of it.
pub struct Rebuilt {
    replay: Replay,
    map: RoomMap,
    noise: String,
    /// How the run ended, where the record tells it.
    ending: Option<Ending>,
}

impl Rebuilt {
    /// Plays `recording` back to its end.
    ///
    /// # Errors
    /// When it does not go the way that the run went.
    pub fn of(recording: Recording) -> Result<Self, Difference> {
        let noise = recording.header.noise.clone();
        let mut replay = Replay::new(recording);
        replay.finish();
        if let Some(difference) = replay.difference() {
            return Err(difference.clone());
        }
        let ending = Ending::of(replay.session());
        let map = replay.session().mission().map_now();
        Ok(Self { replay, map, noise, ending })
    }

    /// The same as the exports need it.
    #[must_use]
    pub fn record(&self) -> RunRecord<'_> {
        match &self.ending {
            Some(Ending { outcome, reason }) => self.ended(*outcome, reason),
            None => self.ended(Outcome::Stopped, "the record ends here"),
        }
    }

    /// The same of a run that was stopped for a `reason` that its record does not tell; none of one whose record
    /// tells how it ended.
    #[must_use]
    pub fn stopped_because<'a>(&'a self, reason: &'a str) -> Option<RunRecord<'a>> {
        self.ending.is_none().then(|| self.ended(Outcome::Stopped, reason))
    }

    fn ended<'a>(&'a self, outcome: Outcome, reason: &'a str) -> RunRecord<'a> {
        let session = self.replay.session();
        let mission = session.mission();
        RunRecord {
            map: &self.map,
            settings: mission.settings(),
            outcome,
            reason,
            world: session.source(),
            noise: &self.noise,
            progress: *session.progress(),
            laps: mission.laps(),
            bumps: mission.bumps(),
            contact: 0.0,
            true_path: None,
            wall_seconds: 0.0,
        }
    }
}

/// A recorded run under an operator's hands.
pub struct RecordedDriver {
    /// As it was in the beginning, to go back.
    first: Replay,
    replay: Replay,
    /// Instant of the playback, robot seconds since the run began.
    at: f64,
    playing: bool,
    version: u64,
}

impl RecordedDriver {
    /// Shows `replay` from where it stands, paused.
    #[must_use]
    pub fn new(mut replay: Replay) -> Self {
        // The first report is the beginning: without it there is no robot to see.
        replay.advance_to(0.0);
        Self { first: replay.clone(), replay, at: 0.0, playing: false, version: 0 }
    }

    /// The replay, for what it found.
    #[must_use]
    pub fn replay(&self) -> &Replay {
        &self.replay
    }

    fn step(&mut self, until: Landmark) {
        self.playing = false;
        let version = |replay: &Replay| replay.session().version();
        let before = version(&self.replay);
        // What one message of the robot or one wish of its operator led to, three phases that ended say, is
        // seen at once. What the operator paused for is seen by itself, although it took the robot no time.
        loop {
            self.replay.advance_until(until);
            if version(&self.replay) != before || self.replay.is_over() {
                break;
            }
        }
        self.at = self.time();
    }

    /// Robot time of what is shown, seconds since the run began.
    fn time(&self) -> f64 {
        self.replay.session().mission().tracker().passed()
    }
}

/// Why the playback goes no further, and what to do; none while it does.
fn record_end(replay: &Replay) -> Option<String> {
    if !replay.is_over() {
        return None;
    }
    if let Some(how) = replay.session().run_state().told_over() {
        return Some(how);
    }
    let ends = "the record ends here, and the run was not over";
    Some(match replay.torn() {
        _ if replay.difference().is_some() => {
            "the record ends here, and the playback has gone another way than the run".to_owned()
        }
        Some(Torn { line, damaged: true, .. }) => {
            format!("the record is damaged from here on, from line {line}: no more is played back")
        }
        _ if replay.is_of_a_robot() => {
            format!("{ends}: `periplus run --port DEVICE --resume DIR` goes on with it")
        }
        _ => {
            let seed = replay.session().mission().settings().seed;
            format!(
                "{ends}: simulated, it is made again by `periplus run --world FILE --seed {seed} --out DIR`"
            )
        }
    })
}

/// How a run was `at` of `all` seconds: said to be of then, lest it is taken for what is, and what happened is not
/// changed any more.
#[must_use]
pub fn looked_back_at(snapshot: Snapshot, at: f64, all: f64) -> Snapshot {
    let source = format!("replay {at:.0}/{all:.0} s of {}", snapshot.source);
    Snapshot { source, recorded: true, alpha_is_open: false, laps_are_open: false, ..snapshot }
}

impl Driver for RecordedDriver {
    fn snapshot(&self) -> Snapshot {
        let all = self.replay.duration();
        let mut snapshot = looked_back_at(self.replay.session().snapshot(), self.at.min(all), all);
        if self.replay.difference().is_some() {
            snapshot.source.push_str(", DIFFERS FROM THE RUN");
        }
        snapshot.record_end = record_end(&self.replay);
        // What is done is the playback's; how it stood with the run then, the log tells.
        if !self.replay.is_complete() {
            snapshot.run = if self.playing { RunState::Running } else { RunState::Paused };
            snapshot.latched = false;
        }
        snapshot
    }

    fn version(&self) -> u64 {
        self.replay.session().version() + self.version
    }

    fn intent(&mut self, intent: Intent) {
        self.version += 1;
        match intent {
            // The key that pauses asks for a run where the picture does not tell that the record plays.
            Intent::Run => self.playing = !self.playing,
            Intent::Pause | Intent::Stop | Intent::Finish => self.playing = false,
            Intent::StepCommand => self.step(Landmark::Command),
            Intent::StepEvent => self.step(Landmark::Event),
            Intent::StepPhase => self.step(Landmark::PhaseEnd),
            Intent::ClearStop
            | Intent::SetAlpha { .. }
            | Intent::SetTape { .. }
            | Intent::LapAgain
            | Intent::LapAnew
            | Intent::Square
            | Intent::Placed { .. } => {}
        }
    }

    fn advance(&mut self, seconds: f64) {
        if !self.playing {
            return;
        }
        self.at += seconds;
        self.replay.advance_to(self.at);
        if self.replay.is_over() {
            self.playing = false;
            self.version += 1;
        }
    }

    fn is_at_rest(&self) -> bool {
        !self.playing
    }

    fn go_to(&mut self, seconds: f64) -> Result<String, String> {
        let end = self.replay.duration();
        // The end is named in whole seconds.
        if seconds > end + 0.5 {
            return Err(format!("the record ends at {end:.0} s"));
        }
        let seconds = seconds.min(end);
        self.playing = false;
        if seconds < self.time() {
            // What the screen shows is another state, even if both have changed as often.
            self.version += self.replay.session().version() + 1;
            self.replay = self.first.clone();
        }
        self.replay.advance_to(seconds);
        self.at = seconds;
        self.version += 1;
        Ok(format!("at {seconds:.0} s of {end:.0}"))
    }

    fn export(&mut self, _dir: &Path) -> Result<String, String> {
        Err("a replay writes nothing; `periplus export` makes the map of the record too".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::native::MapFile;
    use crate::journal::reader::parse;
    use crate::journal::{Entry, Header, Journal, Record};
    use crate::mapping::map::Phase;
    use crate::mapping::settings::Settings;
    use crate::robot::Telemetry;
    use crate::runtime::simulated::{Headless, SimulatedRun};
    use crate::runtime::{Runner, Step};
    use crate::simulator::{NoiseProfile, World};
    use std::path::PathBuf;

    const PHASES: [Phase; 4] = [Phase::Boundary, Phase::Shape, Phase::Plan, Phase::Objects];

    /// A run of a small room with noise, and where its record goes.
    fn begun() -> (SimulatedRun<Shared>, Shared) {
        let text = include_str!("../../sims/rectangle.toml");
        let world = World::from_toml(text, "rectangle", 0.1).expect("a world");
        let settings = Settings { seed: 4, ..Settings::new(world.start) };
        let header = Header {
            settings,
            source: "rectangle".to_owned(),
            noise: String::new(),
            until: None,
            robot: None,
        };
        let bytes = Shared::default();
        let journal = Journal::begin(bytes.clone(), &header).expect("memory");
        (SimulatedRun::new(&world, header, NoiseProfile::Calibrated, Some(journal)), bytes)
    }

    /// The record of a whole run.
    fn record() -> Vec<u8> {
        let (run, bytes) = begun();
        let mut headless = Headless::new(run);
        while headless.step() == Step::Going {}
        headless.finish_journal().expect("memory");
        bytes.0.take()
    }

    /// The record of one that its operator took from phase to phase, and changed the plan of.
    fn record_in_steps() -> Vec<u8> {
        let (mut run, bytes) = begun();
        for phase in PHASES {
            if phase == Phase::Objects {
                run.intent(Intent::SetAlpha { alpha: 0.3 });
                run.intent(Intent::SetAlpha { alpha: 0.5 });
            }
            run.intent(Intent::StepPhase);
            while run.is_under_way() {
                run.advance();
            }
        }
        run.hand_record_on();
        bytes.0.take()
    }

    #[derive(Clone, Default)]
    struct Shared(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

    impl std::io::Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.borrow_mut().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    fn read(bytes: &[u8]) -> Recording {
        parse(&PathBuf::from("record"), bytes).expect("a record")
    }

    #[test]
    fn a_replay_goes_the_way_of_its_run_and_notices_when_it_does_not() {
        let bytes = record();
        let recording = read(&bytes);
        let mut replay = Replay::new(recording.clone());
        replay.finish();
        assert_eq!(replay.difference(), None);
        assert_eq!(replay.ends().len(), 4, "four phases ended");
        assert!(replay.is_complete());

        let mut bent = recording;
        let at = bent.records.len() / 2;
        let telemetry = bent.records[at..].iter_mut().find_map(|record| match &mut record.entry {
            Entry::Telemetry(Telemetry::Report { odometer, .. }) => Some(odometer),
            _ => None,
        });
        telemetry.expect("a report").left_ticks += 40;
        let mut replay = Replay::new(bent);
        replay.finish();
        assert!(replay.difference().is_some(), "another way of the robot went unnoticed");
    }

    #[test]
    fn a_record_that_was_cut_off_replays_up_to_there() {
        let bytes = record();
        for share in [0.1, 0.35, 0.62, 0.97] {
            let cut = (bytes.len() as f64 * share) as usize;
            let mut replay = Replay::new(read(&bytes[..cut]));
            replay.finish();
            assert_eq!(replay.difference(), None, "cut at {cut}");
            assert!(!replay.is_complete());
        }
    }

    #[test]
    fn the_map_of_a_run_is_made_again_from_its_record() {
        let bytes = record();
        let whole = Rebuilt::of(read(&bytes)).expect("the same way");
        assert_eq!(whole.record().outcome, Outcome::Complete);
        assert!(MapFile::of(&whole.record()).boundary.is_some());
        // Killed in the first lap: what was touched is there, and no more is claimed.
        let part = Rebuilt::of(read(&bytes[..bytes.len() / 10])).expect("the same way");
        assert_eq!(part.record().outcome, Outcome::Stopped);
        let map = MapFile::of(&part.record());
        assert!(map.boundary.is_none() && !map.touched.is_empty());
    }

    #[test]
    fn keys_steer_the_playback() {
        let mut driver = RecordedDriver::new(Replay::new(read(&record())));
        let first = driver.snapshot().time;
        driver.advance(10.0);
        assert!((driver.snapshot().time - first).abs() < 1e-9, "paused at first");
        driver.intent(Intent::StepPhase);
        assert!(driver.snapshot().progress[0].done);
        let before = driver.snapshot().time;
        driver.intent(Intent::Run);
        driver.advance(30.0);
        let played = driver.snapshot().time - before;
        assert!((29.0..31.0).contains(&played), "{played}");
        driver.intent(Intent::Stop);
        driver.advance(30.0);
        assert!(driver.snapshot().time < before + 31.0);
    }

    #[test]
    fn at_the_end_of_a_record_that_tells_of_none_the_playback_says_so() {
        use crate::console::action::Action;
        use crate::console::frame::planes;
        use crate::console::update::perform;
        use crate::console::{Keymap, model::Model};
        let whole = record();
        let half = || read(&whole[..whole.len() / 2]);
        let mut real = half();
        real.header.robot = Some(crate::journal::RobotMark { name: "tin".to_owned(), boot: 3 });
        let mut damaged = half();
        damaged.torn = Some(Torn { line: 77, lines: 3, bytes: 90, damaged: true });
        for (recording, says) in [
            (half(), "made again by `periplus run --world FILE --seed 4"),
            (real, "`periplus run --port DEVICE --resume DIR` goes on with it"),
            (damaged, "damaged from here on, from line 77"),
        ] {
            let mut driver = RecordedDriver::new(Replay::new(recording));
            let mut model = Model::new(200, 40, Keymap::default());
            let play = perform(&mut model, &driver.snapshot(), Action::RunPause);
            assert_eq!((play.len(), &model.hint), (1, &None), "there is something to play");
            driver.intent(Intent::Run);
            (0..4000).for_each(|_| driver.advance(1.0));
            let snapshot = driver.snapshot();
            for action in
                [Action::RunPause, Action::StepCommand, Action::StepEvent, Action::StepPhase]
            {
                assert!(perform(&mut model, &snapshot, action).is_empty(), "{action:?}");
                let hint = model.hint.take().expect("a word on why nothing happens");
                assert!(hint.refusal && hint.text.contains(says), "{}", hint.text);
            }
            let (symbols, _) = planes(&model, &snapshot);
            assert!(
                symbols.contains("RECORD ENDS") && !symbols.contains("play/pause"),
                "{symbols}"
            );
            driver.go_to(5.0).expect("an instant");
            assert_eq!(driver.snapshot().record_end, None);
            assert!(planes(&model, &driver.snapshot()).0.contains("play/pause"));
        }
        let mut driver = RecordedDriver::new(Replay::new(read(&whole)));
        driver.go_to(driver.replay().duration()).expect("the end");
        assert_eq!(
            (driver.snapshot().run, driver.snapshot().record_end.as_deref()),
            (RunState::Complete, Some("the run is complete"))
        );
    }

    /// Where the operator of the run had paused, the playback plays.
    #[test]
    fn the_key_that_plays_pauses_where_the_run_was_paused_too() {
        let mut driver = RecordedDriver::new(Replay::new(read(&record_in_steps())));
        assert_eq!(driver.snapshot().run, RunState::Paused);
        driver.intent(Intent::Run);
        for _ in 0..9 {
            driver.advance(1.0);
            assert_eq!(driver.snapshot().run, RunState::Running);
        }
        assert!(!driver.is_at_rest());
        driver.intent(Intent::Run);
        assert!(driver.is_at_rest());
    }

    /// What the operator did with the map after the end is in the record, and the keys come to it.
    #[test]
    fn what_was_done_after_the_end_is_played_back_too() {
        use crate::console::action::Action;
        use crate::console::update::{Effect, perform};
        use crate::console::{Keymap, model::Model};
        let mut recording = read(&record());
        let time_us = recording.records.last().expect("records").time_us;
        recording.records.push(Record { time_us, entry: Entry::Intent(Intent::Square) });
        let replay = Replay::new(recording);
        for action in [Action::RunPause, Action::StepCommand, Action::StepEvent, Action::StepPhase]
        {
            let (mut driver, mut asked) = (RecordedDriver::new(replay.clone()), 0);
            let mut model = Model::new(120, 40, Keymap::default());
            while driver.snapshot().map.squared.is_none() {
                asked += 1;
                assert!(asked < 20_000, "{action:?} does not come to the end");
                if driver.is_at_rest() {
                    for effect in perform(&mut model, &driver.snapshot(), action) {
                        let Effect::Intent(intent) = effect else { panic!("{effect:?}") };
                        driver.intent(intent);
                    }
                }
                driver.advance(1.0);
            }
            assert_eq!(driver.snapshot().record_end.as_deref(), Some("the run is complete"));
        }
    }

    #[test]
    fn a_replay_goes_to_any_instant_and_shows_there_what_it_showed_before() {
        let mut driver = RecordedDriver::new(Replay::new(read(&record())));
        driver.go_to(300.0).expect("an instant");
        let (late, version) = (driver.snapshot(), driver.version());
        assert!(late.progress[0].done && late.time > 299.0);
        driver.go_to(late.time / 2.0).expect("an instant before");
        assert!(driver.snapshot().time < late.time / 2.0 + 1.0 && driver.version() != version);
        assert!(!driver.snapshot().progress[0].done);
        driver.go_to(300.0).expect("forth again");
        assert!(driver.snapshot() == late, "another state at the same instant");
        assert!(driver.go_to(1e9).is_err(), "there is nothing");
    }

    #[test]
    fn no_step_stands_still_where_three_phases_end_at_once() {
        let mut driver = RecordedDriver::new(Replay::new(read(&record())));
        driver.intent(Intent::StepPhase);
        let (time, progress) = (driver.snapshot().time, driver.snapshot().progress);
        assert!(progress[2].done && !progress[3].done, "{progress:?}");
        driver.intent(Intent::StepPhase);
        assert!(driver.snapshot().time > time && driver.snapshot().progress[3].done);
    }

    /// Thinking takes no time of the robot's: shape and plan end at the instant at which the lap closed. Who
    /// paused there sees there again what there was to see.
    #[test]
    fn where_the_operator_paused_between_two_phases_the_playback_does_too() {
        let mut driver = RecordedDriver::new(Replay::new(read(&record_in_steps())));
        for phase in PHASES {
            driver.intent(Intent::StepPhase);
            let done = driver.snapshot().progress.map(|progress| progress.done);
            assert_eq!(done, PHASES.map(|other| other <= phase), "{phase}");
        }
        // Each α that was tried has its plan.
        driver.go_to(0.0).expect("the beginning");
        let mut alphas = Vec::new();
        loop {
            let snapshot = driver.snapshot();
            alphas.extend(snapshot.map.plan.map(|plan| plan.alpha));
            if driver.replay().is_over() {
                break;
            }
            driver.intent(Intent::StepEvent);
        }
        alphas.dedup();
        assert_eq!(alphas, [0.25, 0.3, 0.5]);
    }
}
