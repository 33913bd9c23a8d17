//! A session over the embedded simulator, with its record: what `run`, the console and `snapshot`
//! drive. Virtual time: one step is 20 ms of the robot's life, however long it takes.

use super::{Ending, OutputFolder, Progress, Runner, Step, keep};
use crate::export::{Outcome, RunRecord, truth};
use crate::geometry::Pose;
use crate::journal::{Header, Journal};
use crate::link::SimulatedLink;
use crate::mapping::map::{Phase, RoomMap};
use crate::robot::{Intent, Telemetry};
use crate::session::{Outgoing, RunState, Session, Snapshot};
use crate::simulator::{NoiseProfile, World};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A simulated run; `W` is where its record goes.
pub struct SimulatedRun<W: Write> {
    session: Session,
    link: SimulatedLink,
    journal: Option<Journal<W>>,
    /// The file that the record goes to, for [`SimulatedRun::export`] to copy.
    journal_path: Option<PathBuf>,
    header: Header,
    said: Vec<Telemetry>,
    outgoing: Vec<Outgoing>,
    /// Why the run came to its end before the session did.
    unrecorded: Option<String>,
    /// Filled when the run has ended, for the exports.
    map: RoomMap,
    true_path: Option<Vec<Pose>>,
}

impl<W: Write> SimulatedRun<W> {
    /// The robot of `header.settings` in `world`; it waits for the operator.
    #[must_use]
    pub fn new(
        world: &World,
        header: Header,
        noise: NoiseProfile,
        journal: Option<Journal<W>>,
    ) -> Self {
        let settings = header.settings.clone();
        let until = header.until.unwrap_or(Phase::Objects);
        let link = SimulatedLink::new(world, &settings.chassis, noise, settings.seed);
        let mut run = Self {
            session: Session::new(settings, header.source.clone(), until),
            link,
            journal,
            journal_path: None,
            header,
            said: Vec::new(),
            outgoing: Vec::new(),
            unrecorded: None,
            map: RoomMap::default(),
            true_path: None,
        };
        run.said.push(run.link.greeting());
        run.take_telemetry();
        run
    }

    /// The same run, whose record goes to the file at `path`: exports take a copy of it along.
    #[must_use]
    pub fn recorded_at(self, path: PathBuf) -> Self {
        Self { journal_path: Some(path), ..self }
    }

    /// Takes a wish of the operator.
    pub fn intent(&mut self, intent: Intent) {
        if let Some(journal) = &mut self.journal {
            journal.intent(self.session.mission().tracker().time_us(), &intent);
        }
        self.session.intent(intent, &mut self.outgoing);
        self.deliver();
    }

    /// Lets 20 ms of the robot's life pass.
    pub fn advance(&mut self) {
        self.link.advance(&mut self.said);
        self.take_telemetry();
        self.stop_unrecorded();
    }

    /// A run that can no longer be recorded is stopped, as on a real robot, and again whenever it is set
    /// going: no run is to be lost.
    fn stop_unrecorded(&mut self) {
        let Some(error) = self.journal.as_ref().and_then(Journal::error) else { return };
        let goes_on = matches!(self.session.run_state(), RunState::Running | RunState::Stepping(_));
        if goes_on {
            let why = format!("the record cannot be written: {error}; the robot was stopped");
            self.intent(Intent::Stop);
            self.session.remark(why.clone(), &mut self.outgoing);
            self.deliver();
            self.unrecorded = Some(why);
        }
    }

    /// The session.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The state for the screen.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.session.snapshot()
    }

    /// Whether the body moves or may move without further word: time has to go on for it.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        self.link.is_moving()
            || matches!(self.session.run_state(), RunState::Running | RunState::Stepping(_))
    }

    fn take_telemetry(&mut self) {
        let said = std::mem::take(&mut self.said);
        for telemetry in &said {
            if let Some(journal) = &mut self.journal {
                journal.telemetry(self.session.mission().tracker().time_us(), telemetry);
            }
            self.session.telemetry(telemetry, &mut self.outgoing);
            self.deliver();
        }
        self.said = said;
        self.said.clear();
    }

    fn deliver(&mut self) {
        for outgoing in std::mem::take(&mut self.outgoing) {
            keep(&mut self.journal, &self.session, &outgoing);
            match outgoing {
                Outgoing::Command(command) => self.link.send(command),
                Outgoing::Stop => self.link.stop(),
                Outgoing::Event(_) | Outgoing::PhaseEnded(_) => {}
            }
        }
    }

    /// How the run ended; none while there is more to do.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        let unrecorded = self.unrecorded.as_ref().filter(|_| !self.link.is_moving());
        let failed = |reason: &String| Ending { outcome: Outcome::Failed, reason: reason.clone() };
        Ending::of(&self.session).or_else(|| unrecorded.map(failed))
    }

    /// Writes everything known so far into `dir`, and the record so far: it plays back to this instant.
    /// `wall_seconds` is how long the run took so far.
    ///
    /// # Errors
    /// In words, when the folder holds another run or cannot be written.
    pub fn export(&mut self, dir: &Path, wall_seconds: f64) -> Result<String, String> {
        let (folder, journal) = OutputFolder::create(dir).map_err(|error| error.to_string())?;
        let recorded = self.copy_record(journal);
        self.conclude();
        let ending = self.ending().unwrap_or(Ending {
            outcome: Outcome::Stopped,
            reason: "exported while under way".to_owned(),
        });
        let failures = folder.write_results(&self.record_of(&ending, wall_seconds));
        // An empty record would say that the run never began.
        folder.discard_unbegun();
        let complaints = [self.torn_record(), folder.complaint(recorded, &failures)];
        let complaints: Vec<String> = complaints.into_iter().flatten().collect();
        if complaints.is_empty() {
            return Ok(format!("written to {}", dir.display()));
        }
        Err(complaints.join("; "))
    }

    /// Writes the results of a run that has ended into its own `folder`; the record stays open. What fails
    /// is told in the log, and tried again when the console is left.
    pub fn write_results(&mut self, folder: &OutputFolder, wall_seconds: f64) {
        let Some(ending) = self.ending() else { return };
        if let Some(journal) = &mut self.journal {
            journal.flush();
        }
        self.conclude();
        let failures = folder.write_results(&self.record_of(&ending, wall_seconds));
        if let Some(complaint) = folder.complaint(Ok(()), &failures) {
            self.session.remark(complaint, &mut self.outgoing);
            self.deliver();
        }
    }

    /// Hands on all that is recorded so far.
    pub fn hand_record_on(&mut self) {
        if let Some(journal) = &mut self.journal {
            journal.flush();
        }
    }

    /// What a copy of the record lacks, and where: the disk it is written to is seldom that of the copy.
    fn torn_record(&self) -> Option<String> {
        let why = self.journal.as_ref()?.error()?;
        let path = self.journal_path.as_ref()?.display();
        Some(format!("{path}: this record ends before its run ({why}), and so does its copy"))
    }

    /// Copies the record so far to `copy`, as far as it goes; a run that keeps none has nothing to copy.
    fn copy_record(&mut self, mut copy: impl Write) -> io::Result<()> {
        let Some(journal) = &mut self.journal else { return Ok(()) };
        journal.flush();
        let Some(path) = &self.journal_path else { return Ok(()) };
        io::copy(&mut std::fs::File::open(path)?, &mut copy)?;
        copy.flush()
    }

    /// The record as the exports need it.
    fn record_of<'a>(&'a self, ending: &'a Ending, wall_seconds: f64) -> RunRecord<'a> {
        let mission = self.session.mission();
        RunRecord {
            map: &self.map,
            settings: mission.settings(),
            outcome: ending.outcome,
            reason: &ending.reason,
            world: mission.settings().name.as_deref().unwrap_or(&self.header.source),
            noise: &self.header.noise,
            progress: *self.session.progress(),
            laps: mission.laps(),
            bumps: mission.bumps(),
            contact: self.link.contact(),
            true_path: self.true_path.as_deref(),
            wall_seconds,
        }
    }

    /// Fixes the map and the truth beside it, for [`Runner::record`].
    pub fn conclude(&mut self) {
        self.map = self.session.mission().map_now();
        self.true_path = truth::along(&self.map.path, self.link.truth());
    }
}

/// Steps without a command after which a run that claims to go on is at fault: 60 s.
const LONGEST_SILENCE: u32 = 3000;

/// A [`SimulatedRun`] that goes on by itself to its end.
pub struct Headless<W: Write> {
    run: SimulatedRun<W>,
    idle: u32,
}

impl<W: Write> Headless<W> {
    /// Sets `run` going.
    #[must_use]
    pub fn new(mut run: SimulatedRun<W>) -> Self {
        run.intent(Intent::Run);
        Self { run, idle: 0 }
    }

    /// A run that the operator has left.
    #[must_use]
    pub fn left(run: SimulatedRun<W>) -> Self {
        Self { run, idle: 0 }
    }

    /// Ends the record and writes the results; what failed, in one message. `left` says why the run ended if it
    /// had not by itself, `wall_seconds` is how long it took, pauses included.
    pub fn write(
        &mut self,
        folder: &OutputFolder,
        left: &str,
        wall_seconds: f64,
    ) -> Option<String> {
        let recorded = self.finish_journal();
        self.run.conclude();
        let left = Ending { outcome: Outcome::Stopped, reason: left.to_owned() };
        let ending = self.run.ending().unwrap_or(left);
        let failures = folder.write_results(&self.run.record_of(&ending, wall_seconds));
        folder.complaint(recorded, &failures)
    }

    /// The run itself.
    #[must_use]
    pub fn inner(&self) -> &SimulatedRun<W> {
        &self.run
    }
}

impl<W: Write> Runner for Headless<W> {
    fn step(&mut self) -> Step {
        self.run.advance();
        self.idle = if self.run.link.is_moving() { 0 } else { self.idle + 1 };
        let failed = |reason: &str| Ending { outcome: Outcome::Failed, reason: reason.to_owned() };
        let lost = self.run.session.mission().waits_for_place();
        let lost = lost.then(|| failed("the robot does not know where it is"));
        let stuck = (self.idle > LONGEST_SILENCE).then(|| failed("nothing happens any more"));
        match self.run.ending().or(lost).or(stuck) {
            Some(ending) => {
                self.run.conclude();
                Step::Ended(ending)
            }
            None => Step::Going,
        }
    }

    fn stop(&mut self) {
        self.run.intent(Intent::Stop);
        // The body comes to rest before the map is written, so that nothing is lost of the path.
        for _ in 0..50 {
            self.run.advance();
        }
        self.run.conclude();
    }

    fn progress(&self) -> Progress {
        let mission = self.run.session.mission();
        Progress {
            phase: mission.phase(),
            share: mission.share(),
            time: mission.tracker().passed(),
            travel: mission.tracker().travelled(),
        }
    }

    fn record<'a>(&'a self, ending: &'a Ending, wall_seconds: f64) -> RunRecord<'a> {
        self.run.record_of(ending, wall_seconds)
    }

    fn finish_journal(&mut self) -> io::Result<()> {
        self.run.journal.take().map_or(Ok(()), |journal| journal.finish().map(|_| ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::event::{Event, EventKind};
    use crate::mapping::settings::Settings;
    use crate::session::Replay;

    /// A disk with so much room.
    struct Disk(usize);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let left = self.0.checked_sub(bytes.len());
            self.0 = left.ok_or_else(|| io::Error::from(io::ErrorKind::StorageFull))?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// A file on such a disk.
    struct Small(std::fs::File, usize);

    impl Write for Small {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let left = self.1.checked_sub(bytes.len());
            self.1 = left.ok_or_else(|| io::Error::from(io::ErrorKind::StorageFull))?;
            self.0.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }

    #[test]
    fn a_run_that_cannot_be_recorded_any_longer_is_stopped_and_again_when_it_is_set_going() {
        let (world, header) = header("rectangle", include_str!("../../sims/rectangle.toml"));
        let journal = Journal::begin(Disk(100_000), &header).expect("room for the header");
        let mut run = SimulatedRun::new(&world, header, NoiseProfile::None, Some(journal));
        for times in 1..=2 {
            run.intent(Intent::ClearStop);
            run.intent(Intent::Run);
            while run.is_under_way() {
                run.advance();
            }
            let snapshot = run.snapshot();
            assert_eq!(snapshot.run, RunState::Stopped);
            let told = |event: &Event| event.kind.to_string().contains("record");
            assert_eq!(snapshot.events.iter().filter(|event| told(event)).count(), times);
            let ending = run.ending().expect("it has ended");
            assert_eq!(ending.outcome, Outcome::Failed);
            assert!(ending.reason.contains("no storage space"), "{}", ending.reason);
        }
    }

    /// A full disk is no reason to hand over less on another one, nor to blame that.
    #[test]
    fn what_a_full_disk_left_of_a_record_is_exported_and_said_to_be_torn() {
        let (world, header) = header("rectangle", include_str!("../../sims/rectangle.toml"));
        let top = place("export-torn");
        let (folder, file) = OutputFolder::create(&top.join("full")).expect("a folder");
        let journal = Journal::begin(Small(file, 200_000), &header).expect("room for the header");
        let run = SimulatedRun::new(&world, header, NoiseProfile::None, Some(journal));
        let mut run = run.recorded_at(folder.journal());
        run.intent(Intent::Run);
        while run.is_under_way() {
            run.advance();
        }
        let there = top.join("spare");
        let told = run.export(&there, 1.0).expect_err("the record is torn");
        let full = folder.journal().display().to_string();
        assert!(told.starts_with(&format!("{full}: this record ends before its run")), "{told}");
        assert!(!told.contains("spare"), "{told}");
        let whole = crate::journal::read_whole_part(&there).expect("what there is of it");
        assert!(whole.records.len() > 500, "{}", whole.records.len());
        assert!(there.join("map.geojson").exists());
        let _ = std::fs::remove_dir_all(&top);
    }

    #[test]
    fn a_run_without_a_console_ends_when_the_robot_does_not_know_where_it_is() {
        let (world, header) = header("rectangle", include_str!("../../sims/rectangle.toml"));
        let run = SimulatedRun::<io::Sink>::new(&world, header, NoiseProfile::None, None);
        let mut headless = Headless::new(run);
        for _ in 0..200 {
            assert!(matches!(headless.step(), Step::Going));
        }
        // No boundary is closed yet to know a place by.
        headless.stop();
        headless.run.intent(Intent::Placed { near: None });
        let Step::Ended(ending) = headless.step() else { panic!("it waits for ever") };
        assert_eq!(ending.outcome, Outcome::Failed);
        assert_eq!(ending.reason, "the robot does not know where it is");
    }

    fn header(name: &str, text: &str) -> (World, Header) {
        let world = World::from_toml(text, name, 0.1).expect("a world");
        let header = Header {
            settings: Settings::new(world.start),
            source: world.name.clone(),
            noise: String::new(),
            until: None,
            robot: None,
        };
        (world, header)
    }

    /// An empty place for one test, under the system's own temporary folder.
    fn place(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("periplus-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        path
    }

    #[test]
    fn what_is_exported_in_mid_run_plays_back_to_that_moment() {
        let (world, header) = header("rectangle", include_str!("../../sims/rectangle.toml"));
        let top = place("export-mid-run");
        let (folder, file) = OutputFolder::create(&top.join("run")).expect("a folder");
        let journal = Journal::begin(file, &header).expect("room for the header");
        let run = SimulatedRun::new(&world, header, NoiseProfile::Calibrated, Some(journal));
        let mut run = run.recorded_at(folder.journal());
        run.intent(Intent::Run);
        // Long after the last phase that ended has written the record, and in the middle of a motion.
        while !(run.snapshot().time > 60.0 && run.link.is_moving()) {
            run.advance();
        }
        let there = top.join("so far");
        run.export(&there, 12.5).expect("an export");
        let mut replay = Replay::new(crate::journal::read(&there).expect("a record"));
        replay.finish();
        assert_eq!(replay.difference(), None);
        assert_eq!(replay.session().snapshot(), run.snapshot());
        let report = std::fs::read_to_string(there.join("report.json")).expect("a report");
        assert!(report.contains("\"wall_s\": 12.5"), "{report}");
        assert!(run.export(&there, 13.0).is_err(), "an export over another");
        // The run's own record goes on.
        run.advance();
        assert_eq!(run.journal.as_ref().and_then(Journal::error).map(ToString::to_string), None);
        let _ = std::fs::remove_dir_all(&top);
    }

    #[test]
    fn an_export_of_a_run_without_a_record_holds_none() {
        let (world, header) = header("rectangle", include_str!("../../sims/rectangle.toml"));
        let there = place("export-unrecorded");
        let mut run: SimulatedRun<io::Sink> =
            SimulatedRun::new(&world, header, NoiseProfile::None, None);
        run.export(&there, 0.0).expect("an export");
        assert!(there.join("report.json").exists());
        assert!(!there.join("journal").exists(), "a record of nothing");
        let _ = std::fs::remove_dir_all(&there);
    }

    #[test]
    fn report_screen_and_log_count_the_same_bumps() {
        let text = "name = \"peg\"\nstart = { x = 1, y = 1, heading = 0 }\n[boundary]\n\
                    vertices = [[0, 0], [4, 0], [4, 3], [0, 3]]\n[[objects]]\nname = \"peg\"\n\
                    circle = { center = [2, 1.06], radius = 0.01 }\n";
        let (world, header) = header("peg", text);
        let mut run: SimulatedRun<io::Sink> =
            SimulatedRun::new(&world, header, NoiseProfile::None, None);
        run.intent(Intent::Run);
        // The peg stands beside the beam that looks ahead, and in the body's way.
        while run.snapshot().time < 20.0 {
            run.advance();
        }
        let snapshot = run.snapshot();
        let told = snapshot.events.iter().filter(|event| event.kind == EventKind::Bumped).count();
        assert!(told > 0, "nothing was met");
        let ending = Ending { outcome: Outcome::Stopped, reason: String::new() };
        let counts = (run.record_of(&ending, 0.0).bumps as usize, snapshot.bumps as usize);
        assert_eq!(counts, (told, told));
    }
}
