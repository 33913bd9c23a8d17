//! A simulated robot at the end of a real line: the same control program and the same body as in the
//! embedded simulator, in real time or a multiple of it, behind a pseudo-terminal, a port or TCP.

use super::{Signal, Signals, Stopwatch};
use crate::firmware::{Device, STEP};
use crate::link::{FaultyWay, RobotEnd, Stream};
use crate::simulator::Body;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

/// Bytes that may wait for a host that does not read; what comes after them is lost.
const PATIENCE: usize = 4096;
/// Longest stretch of robot time that is caught up with at once, seconds.
const CATCH_UP: f64 = 1.0;

/// A robot, its body and its clock.
pub struct SimulatedRobot {
    /// The control program.
    pub device: Device,
    /// The body in its world.
    pub body: Body,
    /// Times as fast as life.
    pub speed: f64,
    /// What the line does to what the host says, and to what the robot says.
    pub ways: (FaultyWay, FaultyWay),
}

impl SimulatedRobot {
    /// Serves hosts at `end` until a signal comes.
    pub async fn serve(&mut self, end: RobotEnd, signals: &Signals) -> Signal {
        let watch = Stopwatch::start();
        let mut lived = 0.0;
        match end {
            RobotEnd::Pty { mut ours, theirs } => {
                // Held open to the end: see `RobotEnd`.
                let _theirs = theirs;
                loop {
                    if let Some(signal) = self.talk(&mut ours, signals, &watch, &mut lived).await {
                        return signal;
                    }
                }
            }
            RobotEnd::Serial(mut stream) => loop {
                if let Some(signal) = self.talk(&mut stream, signals, &watch, &mut lived).await {
                    return signal;
                }
            },
            RobotEnd::Tcp(listener) => loop {
                tokio::select! {
                    accepted = listener.accept() => {
                        let Ok((mut stream, _)) = accepted else { continue };
                        let _ = stream.set_nodelay(true);
                        let ended = self.talk(&mut stream, signals, &watch, &mut lived).await;
                        if let Some(signal) = ended {
                            return signal;
                        }
                    }
                    () = tokio::time::sleep(Duration::from_millis(20)) => {
                        self.live(&watch, &mut lived);
                        let _ = self.device.take_output();
                        if let Some(signal) = signals.received() {
                            return signal;
                        }
                    }
                }
            },
        }
    }

    /// Lets the robot's time come up to the clock.
    fn live(&mut self, watch: &Stopwatch, lived: &mut f64) {
        let now = watch.seconds() * self.speed;
        if now - *lived > CATCH_UP * self.speed {
            // The machine slept: the robot did too.
            *lived = now - STEP;
        }
        while *lived + STEP <= now {
            *lived += STEP;
            self.device.step(&mut self.body, |_, _| {});
            self.body.step(STEP);
        }
    }

    /// Talks to a host until it hangs up (none) or a signal comes.
    async fn talk(
        &mut self,
        stream: &mut (impl Stream + ?Sized),
        signals: &Signals,
        watch: &Stopwatch,
        lived: &mut f64,
    ) -> Option<Signal> {
        let (mut from, mut to) = tokio::io::split(stream);
        let mut tick =
            tokio::time::interval(Duration::from_secs_f64((STEP / self.speed).clamp(0.001, 0.02)));
        tick.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut bytes = [0_u8; 1024];
        let mut waiting: Vec<u8> = Vec::new();
        loop {
            tokio::select! {
                biased;
                read = from.read(&mut bytes) => match read {
                    Ok(0) | Err(_) => {
                        tokio::time::sleep(Duration::from_millis(20)).await;
                        self.live(watch, lived);
                        return signals.received();
                    }
                    Ok(count) => {
                        self.live(watch, lived);
                        self.ways.0.put(&bytes[..count], watch.seconds());
                    }
                },
                written = to.write(&waiting), if !waiting.is_empty() => match written {
                    Ok(0) | Err(_) => return signals.received(),
                    Ok(count) => drop(waiting.drain(..count)),
                },
                _ = tick.tick() => {
                    self.live(watch, lived);
                    if let Some(signal) = signals.received() {
                        return Some(signal);
                    }
                }
            }
            let now = watch.seconds();
            let down = self.ways.0.take(now);
            self.device.receive(&down);
            let said = self.device.take_output();
            self.ways.1.put(&said, now);
            let fresh = self.ways.1.take(now);
            if waiting.len() + fresh.len() <= PATIENCE {
                waiting.extend(fresh);
            }
        }
    }
}
