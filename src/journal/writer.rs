//! Writing a record while the run goes on. It never stops the run: the first write that fails is
//! remembered, and the rest of the record is left out.

use super::{Entry, Header, Life, MAGIC, PhaseEnd, Record, VERSION};
use crate::mapping::event::Event;
use crate::robot::{Command, Intent, Odometer, Telemetry};
use serde::Serialize;
use std::io::{self, Write};

/// Bytes kept back before they are handed on. Large enough that a simulated run at thousands of
/// times the speed of life is not held up by small writes.
const BUFFER: usize = 64 * 1024;

/// A record being written.
#[derive(Debug)]
pub struct Journal<W: Write> {
    out: W,
    buffer: Vec<u8>,
    sequence: u64,
    failed: Option<io::Error>,
}

impl<W: Write> Journal<W> {
    /// Begins a record with its header line.
    ///
    /// # Errors
    /// When the header cannot be written: then nothing of the run would be kept.
    pub fn begin(out: W, header: &Header) -> io::Result<Self> {
        let mut journal =
            Self { out, buffer: Vec::with_capacity(BUFFER + 1024), sequence: 0, failed: None };
        write!(journal.buffer, "{MAGIC} {VERSION} ")?;
        serde_json::to_writer(&mut journal.buffer, header)?;
        journal.seal(0);
        journal.flush();
        match journal.failed.take() {
            Some(error) => Err(error),
            None => Ok(journal),
        }
    }

    /// Goes on with a record of `records` records, at the end of which `out` stands.
    pub fn go_on(out: W, records: u64) -> Self {
        let buffer = Vec::with_capacity(BUFFER + 1024);
        Self { out, buffer, sequence: records, failed: None }
    }

    /// Records a command that was sent.
    pub fn command(&mut self, time_us: u64, command: &Command) {
        self.line(time_us, b'c', command);
    }

    /// Records what the robot said.
    pub fn telemetry(&mut self, time_us: u64, telemetry: &Telemetry) {
        match telemetry {
            Telemetry::Report { odometer, switches, bumper } => {
                // By far the most frequent record, hence its short form.
                let Odometer { time_us: at, left_ticks, right_ticks, heading } = odometer;
                let row = (at, left_ticks, right_ticks, heading, switches, u8::from(*bumper));
                self.line(time_us, b'r', &row);
            }
            other => self.line(time_us, b't', other),
        }
    }

    /// Records a wish of the operator.
    pub fn intent(&mut self, time_us: u64, intent: &Intent) {
        self.line(time_us, b'i', intent);
    }

    /// Records what the core told.
    pub fn event(&mut self, time_us: u64, event: &Event) {
        self.line(time_us, b'e', event);
    }

    /// Records the end of a phase, and hands everything so far on.
    pub fn phase_end(&mut self, time_us: u64, end: &PhaseEnd) {
        self.line(time_us, b'p', end);
        self.flush();
    }

    /// Records that the robot is in another life.
    pub fn life(&mut self, time_us: u64, life: &Life) {
        self.line(time_us, b'l', life);
    }

    /// Records anything.
    pub fn record(&mut self, record: &Record) {
        let at = record.time_us;
        match &record.entry {
            Entry::Command(command) => self.command(at, command),
            Entry::Telemetry(telemetry) => self.telemetry(at, telemetry),
            Entry::Intent(intent) => self.intent(at, intent),
            Entry::Event(event) => self.event(at, event),
            Entry::PhaseEnd(end) => self.phase_end(at, end),
            Entry::Life(life) => self.life(at, life),
        }
    }

    /// Hands everything recorded so far on.
    pub fn flush(&mut self) {
        if self.failed.is_none() {
            let result = self.out.write_all(&self.buffer).and_then(|()| self.out.flush());
            self.failed = result.err();
        }
        self.buffer.clear();
    }

    /// What was handed on is lost, for this reason; the rest of the record is left out.
    pub fn fail(&mut self, error: io::Error) {
        self.failed.get_or_insert(error);
    }

    /// The first error, if any: what was recorded after it is lost.
    pub fn error(&self) -> Option<&io::Error> {
        self.failed.as_ref()
    }

    /// Ends the record and gives back what it was written to.
    ///
    /// # Errors
    /// When any part of the record could not be written.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush();
        match self.failed {
            Some(error) => Err(error),
            None => Ok(self.out),
        }
    }

    fn line<T: Serialize>(&mut self, time_us: u64, letter: u8, payload: &T) {
        if self.failed.is_some() {
            return;
        }
        let start = self.buffer.len();
        let written = write!(self.buffer, "{} {time_us} {} ", self.sequence, letter as char)
            .and_then(|()| {
                serde_json::to_writer(&mut self.buffer, payload).map_err(io::Error::from)
            });
        if let Err(error) = written {
            self.buffer.truncate(start);
            self.failed = Some(error);
            return;
        }
        self.seal(start);
        self.sequence += 1;
        if self.buffer.len() >= BUFFER {
            self.flush();
        }
    }

    /// Ends the line that began at `start` with its checksum.
    fn seal(&mut self, start: usize) {
        const DIGITS: &[u8; 16] = b"0123456789abcdef";
        let sum = crc32fast::hash(&self.buffer[start..]);
        self.buffer.push(b' ');
        for shift in (0..8).rev() {
            self.buffer.push(DIGITS[(sum >> (shift * 4)) as usize & 15]);
        }
        self.buffer.push(b'\n');
    }
}
