//! The task that keeps a real robot: it alone reads and writes the port, on a thread of its own, so
//! that the screen cannot keep it from its heartbeat. The rest of the program gives it intents and takes
//! pictures of its state. What it decides it decides here, and it hands the record on here as well, before a
//! command leaves: a plan that takes long, or a disk, does keep it, and the robot then stands by itself.

mod requests;
mod syncing;
mod waiting;

use super::live::{Interrupted, LiveRun, Plan};
use super::{Ending, Progress, Stopwatch};
use crate::link::{Address, PortError, Stream, port};
use crate::robot::Intent;
use crate::session::Snapshot;
use crate::wire::{Host, STOP};
use requests::Requests;
use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, Once, PoisonError};
use std::task::{Context, Waker};
use std::thread::JoinHandle;
use std::time::Duration;
use syncing::Syncing;
use tokio::io::{AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::sync::mpsc::{UnboundedSender, unbounded_channel};
use waiting::Waiting;

/// The control loop looks at the time this often.
const TICK: Duration = Duration::from_millis(5);
/// A bridge over which nothing came for this long is opened anew, seconds: longer than a board takes to start.
const SILENT: f64 = 5.0;
/// First and longest pause between attempts to open a port that went away, seconds.
const BACKOFF: (f64, f64) = (0.25, 5.0);
/// How far the run has come is told this often, seconds.
const PROGRESS: f64 = 0.1;
/// How long the last stop is given to leave, seconds.
const FAREWELL: f64 = 0.3;

/// What the rest of the program may ask.
enum Request {
    Intent(Intent),
    /// A stop waits behind others: the robot is told so ahead of them.
    StopAhead,
    Leave,
    /// Fails, to see what becomes of the robot then.
    #[cfg(test)]
    Panic,
    /// Is busy for so many seconds, as with a plan or a disk.
    #[cfg(test)]
    Busy(f64),
    /// Does nothing until it may go on.
    #[cfg(test)]
    Held(std::sync::mpsc::Receiver<()>),
}

/// What the control thread shows.
#[derive(Default)]
struct Shown {
    snapshot: Mutex<Option<Arc<Snapshot>>>,
    progress: Mutex<Option<Progress>>,
    ending: Mutex<Option<Ending>>,
    /// Told when there is an ending.
    ended: Condvar,
    /// Why the keeper is gone, when it failed.
    failure: Mutex<Option<String>>,
    /// Of the picture that is there, not of the state behind it.
    version: AtomicU64,
    /// So often the robot had been told to go on, and that was followed or refused, when that picture was made.
    followed: AtomicU64,
    /// Somebody looks, and would see a newer picture.
    wanted: AtomicBool,
    /// When an operator was there last, microseconds of the line's clock; 0 when none ever was.
    attended: AtomicU64,
}

/// A robot at the end of a line, kept by a thread.
pub struct Line {
    requests: UnboundedSender<Request>,
    /// So often the robot was told to go on.
    wishes: AtomicU64,
    shown: Arc<Shown>,
    watch: Stopwatch,
    thread: Option<JoinHandle<LiveRun<File>>>,
}

/// Those who keep a robot now. A panic is reported before anything is unwound, and the report takes its
/// time; the robots are stopped first.
static KEEPERS: Mutex<Vec<UnboundedSender<Request>>> = Mutex::new(Vec::new());
/// Where the control thread failed.
static FAILED_AT: Mutex<String> = Mutex::new(String::new());
/// What the thread that keeps a robot is called.
const CONTROL: &str = "control";

/// Sees to it that a panic anywhere stops the robots before it is reported. One in a control thread is
/// not reported here: its last word leaves when it is unwound, and what it was is told as the reason for
/// which the run ended.
fn stop_before_reports() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            if std::thread::current().name() == Some(CONTROL) {
                let place = panic.location().map(ToString::to_string).unwrap_or_default();
                *held(&FAILED_AT) = place;
                return;
            }
            held(&KEEPERS).retain(|keeper| keeper.send(Request::Intent(Intent::Stop)).is_ok());
            report(panic);
        }));
    });
}

fn held<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Line {
    /// Opens the port and begins, or goes on with an interrupted run; the record goes to `journal`.
    ///
    /// # Errors
    /// When the port cannot be opened.
    pub fn open(
        address: Address,
        plan: Plan,
        journal: File,
        interrupted: Option<Interrupted>,
    ) -> Result<Self, PortError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let failed = |error: std::io::Error| PortError::Refused {
            port: address.to_string(),
            reason: error.to_string(),
        };
        let runtime = runtime.map_err(failed)?;
        let stream = match runtime.block_on(port::open(&address)) {
            Ok(stream) => stream,
            Err(error) => {
                runtime.shutdown_background();
                return Err(error);
            }
        };
        let (requests, asked) = unbounded_channel();
        stop_before_reports();
        let mut keepers = held(&KEEPERS);
        keepers.retain(|keeper| !keeper.is_closed());
        keepers.push(requests.clone());
        drop(keepers);
        let shown = Arc::new(Shown::default());
        let watch = Stopwatch::start();
        // Tells this conversation from the one before; nothing else depends on it.
        let session = (std::process::id() ^ (journal_age(&journal) as u32).rotate_left(16)) | 1;
        let host = Host::new(address.baud(), session, 0.0);
        let syncing = Syncing::of(&journal).map_err(failed)?;
        let run = LiveRun::new(plan, host, Some(journal));
        let run = match interrupted {
            Some(interrupted) => run.going_on(interrupted),
            None => run,
        };
        let syncing = Some(syncing);
        let asked = Requests::new(asked);
        let mut keeper = Keeper {
            address,
            run,
            watch,
            shown: shown.clone(),
            asked,
            followed: 0,
            syncing,
            progress_due: 0.0,
        };
        let thread = std::thread::Builder::new().name(CONTROL.to_owned()).spawn(move || {
            let keep = AssertUnwindSafe(|| runtime.block_on(keeper.keep(stream)));
            // The robot has its stop by then; what is known is still to be written.
            if let Err(panic) = catch_unwind(keep) {
                keeper.failed(panic.as_ref());
            }
            // A name that is still being looked up is not waited for.
            runtime.shutdown_background();
            keeper.into_run()
        });
        let thread = thread.map_err(|error| PortError::Refused {
            port: "control thread".to_owned(),
            reason: error.to_string(),
        })?;
        let wishes = AtomicU64::new(0);
        Ok(Self { requests, wishes, shown, watch, thread: Some(thread) })
    }

    /// Gives the robot's keeper a wish of the operator; never waits.
    pub fn intent(&self, intent: Intent) {
        self.wishes.fetch_add(u64::from(intent.sets_going()), Ordering::AcqRel);
        let _ = self.requests.send(Request::Intent(intent));
    }

    /// Whether the robot was told to go on, and the newest picture knows nothing of it.
    #[must_use]
    pub fn is_behind(&self) -> bool {
        self.shown.wanted.store(true, Ordering::Release);
        self.shown.followed.load(Ordering::Acquire) < self.wishes.load(Ordering::Acquire)
    }

    /// An operator sees how things are, and is heard. From the first time on the robot is stopped when this
    /// is not said again within a second.
    pub fn attended(&self) {
        let now = (self.watch.seconds() * 1e6) as u64;
        self.shown.attended.store(now.max(1), Ordering::Release);
    }

    /// The newest picture of the state; none before the first.
    #[must_use]
    pub fn snapshot(&self) -> Option<Arc<Snapshot>> {
        self.shown.wanted.store(true, Ordering::Release);
        held(&self.shown.snapshot).clone()
    }

    /// How far the run has come; none before the robot is there. Costs its keeper no picture.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        *held(&self.shown.progress)
    }

    /// Changes whenever there is another picture; to ask is to want one.
    #[must_use]
    pub fn version(&self) -> u64 {
        self.shown.wanted.store(true, Ordering::Release);
        self.shown.version.load(Ordering::Acquire)
    }

    /// How the run ended, waiting for it no longer than `most`; none while there is more to do.
    #[must_use]
    pub fn ending(&self, most: Duration) -> Option<Ending> {
        let ending = held(&self.shown.ending);
        let waited = self.shown.ended.wait_timeout_while(ending, most, |ending| ending.is_none());
        waited.map_or(None, |(ending, _)| ending.clone())
    }

    /// Why nobody keeps the robot any more, if that is so: it was told to stop.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        held(&self.shown.failure).clone()
    }

    /// Stops the robot, closes the port and gives back the run; none when its keeper is gone.
    #[must_use]
    pub fn leave(mut self) -> Option<LiveRun<File>> {
        let _ = self.requests.send(Request::Leave);
        self.thread.take()?.join().ok()
    }
}

impl Drop for Line {
    /// Whatever happens to the rest of the program, the robot is told to stop.
    fn drop(&mut self) {
        let _ = self.requests.send(Request::Leave);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn journal_age(journal: &File) -> u128 {
    let created = journal.metadata().and_then(|data| data.modified()).ok();
    created.and_then(|time| time.elapsed().ok()).map_or(0, |age| age.as_nanos())
}

/// What is written to. Should this program fail, its last word to the robot is to stop.
struct LastWord<W: AsyncWrite + Unpin>(W);

impl<W: AsyncWrite + Unpin> Drop for LastWord<W> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // Twice, in case a frame was cut short by the first. Nobody is left to wait for a full line.
            let mut context = Context::from_waker(Waker::noop());
            let _ = Pin::new(&mut self.0).poll_write(&mut context, &[STOP, STOP]);
        }
    }
}

struct Keeper {
    address: Address,
    run: LiveRun<File>,
    watch: Stopwatch,
    shown: Arc<Shown>,
    asked: Requests,
    /// So often it was told so, and that was followed or refused.
    followed: u64,
    syncing: Option<Syncing>,
    progress_due: f64,
}

impl Keeper {
    fn now(&self) -> f64 {
        self.watch.seconds()
    }

    /// Keeps the robot until it is told to leave.
    async fn keep(&mut self, mut stream: Box<dyn Stream>) {
        let address = self.address.clone();
        while !self.converse(stream).await {
            // The port is gone: try again, ever less often.
            let mut pause = BACKOFF.0;
            stream = loop {
                let pausing = tokio::time::sleep(Duration::from_secs_f64(pause));
                if self.meanwhile(pausing).await.is_none() {
                    return;
                }
                match self.meanwhile(port::open(&address)).await {
                    Some(Ok(open)) => break open,
                    Some(Err(_)) => pause = (pause * 2.0).min(BACKOFF.1),
                    None => return,
                }
            };
            let now = self.now();
            self.run.reopened(now);
        }
    }

    /// Waits for `what` without a port, open for requests; none when told to leave, however long `what`
    /// would have taken.
    async fn meanwhile<T>(&mut self, what: impl Future<Output = T>) -> Option<T> {
        let mut what = std::pin::pin!(what);
        loop {
            tokio::select! {
                biased;
                request = self.asked.next() => {
                    if self.ask(request.as_ref()) { return None; }
                }
                done = &mut what => return Some(done),
                () = tokio::time::sleep(TICK * 4) => {}
            }
            let now = self.now();
            self.tick(now);
            let _ = self.run.take_output();
            self.show();
        }
    }

    /// Lets the time pass.
    fn tick(&mut self, now: f64) {
        let attended = self.shown.attended.load(Ordering::Acquire);
        if attended > 0 {
            self.run.attended(attended as f64 * 1e-6);
        }
        if let Some(error) = self.syncing.as_ref().and_then(Syncing::failure) {
            self.run.record_lost(error);
        }
        self.run.tick(now);
    }

    /// Takes a request; true when it is to leave.
    fn ask(&mut self, request: Option<&Request>) -> bool {
        match request {
            Some(&Request::Intent(intent)) => {
                let now = self.now();
                self.run.intent(intent, now);
                self.followed += u64::from(intent.sets_going());
                false
            }
            Some(Request::StopAhead) => {
                let now = self.now();
                self.run.stop_ahead(now);
                false
            }
            Some(Request::Leave) | None => true,
            #[cfg(test)]
            Some(Request::Panic) => panic!("asked to"),
            #[cfg(test)]
            Some(&Request::Busy(seconds)) => {
                self.watch.skip(seconds);
                false
            }
            #[cfg(test)]
            Some(Request::Held(go_on)) => {
                let _ = go_on.recv();
                false
            }
        }
    }

    /// The run, with its record on the disk as far as it goes.
    fn into_run(mut self) -> LiveRun<File> {
        self.run.hand_record_on();
        if let Some(error) = self.syncing.take().and_then(Syncing::end) {
            self.run.record_lost(error);
        }
        self.run
    }

    /// This program failed while it kept the robot: nothing more can be done but to say so.
    fn failed(&mut self, panic: &(dyn std::any::Any + Send)) {
        let words = panic.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| panic.downcast_ref::<String>().cloned());
        let words = words.unwrap_or_else(|| "no reason given".to_owned());
        let place = held(&FAILED_AT).clone();
        let why = format!("the program failed ({words}, {place}); the robot was told to stop");
        self.run.broke(why.clone());
        *held(&self.shown.failure) = Some(why);
        if let Some(ending) = self.run.ending() {
            held(&self.shown.ending).get_or_insert(ending);
        }
        self.shown.version.fetch_add(1, Ordering::AcqRel);
        self.shown.ended.notify_all();
    }

    /// Talks over an open port until it is gone (false) or the run is left (true).
    async fn converse(&mut self, stream: Box<dyn Stream>) -> bool {
        let (mut from, to) = tokio::io::split(stream);
        let mut to = LastWord(to);
        let mut tick = tokio::time::interval(TICK);
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        // As much as a port keeps while nobody reads it.
        let mut bytes = [0_u8; 4096];
        let mut heard = self.now();
        let mut looked = heard;
        let mut waiting = Waiting::new(heard);
        let mut leaving: Option<f64> = None;
        loop {
            // How late it is, is asked only after the port was read, or had nothing to be read. What came while
            // this program was busy is not known to be there as long as there is something else to do at once.
            let mut was_read = false;
            tokio::select! {
                biased;
                // A stop leaves before anything else is begun: that may be a plan, which takes its time.
                request = self.asked.next(), if leaving.is_none() && !waiting.is_stop() => {
                    if self.ask(request.as_ref()) {
                        let now = self.now();
                        self.run.intent(Intent::Stop, now);
                        leaving = Some(now + FAREWELL);
                    }
                }
                written = to.0.write(waiting.bytes()), if !waiting.bytes().is_empty() => match written {
                    Ok(0) | Err(_) => break,
                    Ok(count) => waiting.took(count, self.now()),
                },
                read = from.read(&mut bytes) => match read {
                    Ok(0) | Err(_) => break,
                    Ok(count) => {
                        let now = self.now();
                        (heard, was_read) = (now, true);
                        self.run.receive(&bytes[..count], now);
                    }
                },
                _ = tick.tick() => {
                    was_read = true;
                    // As of the look before, as all that is overdue: see `Host::tick`.
                    let judged = std::mem::replace(&mut looked, self.now());
                    if self.address.is_bridge() && judged - heard > SILENT {
                        break;
                    }
                }
            }
            let now = self.now();
            if was_read {
                self.tick(now);
            }
            waiting.add(&self.run.take_output(), now);
            if waiting.is_stuck(now) {
                break;
            }
            self.show();
            if leaving.is_some_and(|end| now > end || self.run.host().is_at_rest()) {
                return true;
            }
        }
        let now = self.now();
        self.run.unplugged(now);
        self.show();
        leaving.is_some()
    }

    /// Shows the state to those who want to see it.
    fn show(&mut self) {
        let now = self.now();
        let version = self.run.version(now);
        let first = held(&self.shown.snapshot).is_none();
        if first
            || (version != self.shown.version.load(Ordering::Acquire)
                && self.shown.wanted.swap(false, Ordering::AcqRel))
        {
            let snapshot = Arc::new(self.run.snapshot(now));
            *held(&self.shown.snapshot) = Some(snapshot);
            // Only now: whoever sees the new number finds the new picture.
            self.shown.version.store(version, Ordering::Release);
        }
        if version == self.shown.version.load(Ordering::Acquire) {
            self.shown.followed.store(self.followed, Ordering::Release);
        }
        if now >= self.progress_due {
            self.progress_due = now + PROGRESS;
            *held(&self.shown.progress) = self.run.progress();
        }
        if let Some(ending) = self.run.ending() {
            held(&self.shown.ending).get_or_insert(ending);
            self.shown.ended.notify_all();
        }
    }
}

#[cfg(test)]
mod tests;
