//! How long a robot at the end of a real line waits for its host: from the operator's stop to its byte
//! on the line and to a drive at rest, and from the end of one motion to the next command; over a
//! pseudo-terminal at full telemetry rate, with the screen drawn and the record kept meanwhile.
//!
//! Real time, about a minute. Told beside what the robot itself takes: 0.1 s to brake from 0.2 m/s at
//! 2 m/s², and up to 20 ms until the next step of its control.
#![cfg_attr(not(unix), expect(unused, reason = "pseudo-terminals"))]

#[cfg(unix)]
fn main() {
    match measured::all() {
        Ok(()) => {}
        Err(error) => eprintln!("no measurement: {error}"),
    }
}

#[cfg(not(unix))]
fn main() {
    eprintln!("needs a pseudo-terminal");
}

#[cfg(unix)]
mod measured {
    use periplus::console::model::Model;
    use periplus::console::theme::Theme;
    use periplus::console::{Keymap, view};
    use periplus::firmware::Device;
    use periplus::mapping::settings::Settings;
    use periplus::robot::{Chassis, Intent};
    use periplus::runtime::Stopwatch;
    use periplus::runtime::line::Line;
    use periplus::runtime::live::Plan;
    use periplus::session::RunState;
    use periplus::simulator::{Body, NoiseProfile, World};
    use ratatui::buffer::Buffer;
    use ratatui::layout::Rect;
    use std::error::Error;
    use std::sync::mpsc::{Receiver, Sender, channel};
    use std::time::Duration;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    use tokio_serial::{SerialPort, SerialStream};

    const STOPS: usize = 60;
    const STEP: Duration = Duration::from_millis(20);
    /// The robot brakes from full speed in this time, milliseconds.
    const BRAKING: f64 = 100.0;

    /// What the robot's side saw, and when, seconds.
    enum Seen {
        StopByte(f64),
        Rest(f64),
        Turnaround(f64),
    }

    /// The robot, on a thread of its own, until the line goes.
    fn robot(
        mut line: SerialStream,
        world: &World,
        watch: Stopwatch,
        seen: &Sender<Seen>,
        runtime: &tokio::runtime::Runtime,
    ) {
        runtime.block_on(async {
            let chassis = Chassis::default();
            let mut device = Device::new(&chassis, "tin", std::process::id(), 1.0);
            let mut body = Body::new(world, &chassis, NoiseProfile::None, 1);
            let mut tick = tokio::time::interval(STEP);
            let mut bytes = [0_u8; 512];
            let (mut done_at, mut stopping) = (None, false);
            loop {
                tokio::select! {
                    biased;
                    read = line.read(&mut bytes) => {
                        let Ok(count @ 1..) = read else { return };
                        let now = watch.seconds();
                        if bytes[..count].contains(&periplus::wire::STOP) && !stopping {
                            stopping = true;
                            let _ = seen.send(Seen::StopByte(now));
                        }
                        let stood = !device.is_moving();
                        device.receive(&bytes[..count]);
                        if stood && device.is_moving() {
                            stopping = false;
                            if let Some(done) = done_at.take() {
                                let _ = seen.send(Seen::Turnaround(now - done));
                            }
                        }
                    }
                    _ = tick.tick() => {
                        let was = device.is_moving();
                        device.step(&mut body, |_, _| {});
                        body.step(STEP.as_secs_f64());
                        if was && !device.is_moving() {
                            let now = watch.seconds();
                            if stopping {
                                let _ = seen.send(Seen::Rest(now));
                            } else {
                                done_at = Some(now);
                            }
                        }
                    }
                }
                if line.write_all(&device.take_output()).await.is_err() {
                    return;
                }
            }
        });
    }

    pub(super) fn all() -> Result<(), Box<dyn Error>> {
        let text = include_str!("../sims/rectangle.toml");
        let world = World::from_toml(text, "rectangle", 0.1)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (ours, theirs) = {
            let _inside = runtime.enter();
            SerialStream::pair()?
        };
        let name = theirs.name().ok_or("a pseudo-terminal without a name")?;
        let record = std::env::temp_dir().join(format!("periplus-latency-{}", std::process::id()));
        let journal = std::fs::File::create(&record)?;
        let watch = Stopwatch::start();
        let (tell, told) = channel();
        let settings = Settings::new(world.start);
        let plan = Plan { settings, port: name.clone(), until: None, at_once: false };
        std::thread::spawn(move || robot(ours, &world, watch, &tell, &runtime));
        let line = Line::open(name.parse()?, plan, journal, None)?;
        let (keys, mut turnarounds) = stops(&line, watch, &told);
        drop(line);
        let _ = std::fs::remove_file(&record);
        let mut bytes: Vec<f64> = keys.iter().map(|key| key.0 * 1e3).collect();
        let mut rests: Vec<f64> = keys.iter().map(|key| key.1 * 1e3).collect();
        println!("{} stops, milliseconds from the operator's key", keys.len());
        histogram("to the byte on the line", &mut bytes);
        histogram("to a drive at rest", &mut rests);
        println!("rest, p99 over braking alone: {:.2}", share(&rests, 0.99) / BRAKING);
        histogram("end of a motion to the next command", &mut turnarounds);
        Ok(())
    }

    /// Drives, stops, clears, and so on; the screen is drawn as often as a console would.
    fn stops(line: &Line, watch: Stopwatch, told: &Receiver<Seen>) -> (Vec<(f64, f64)>, Vec<f64>) {
        let model = Model::new(120, 40, Keymap::default());
        let (theme, area) = (Theme::dark(), Rect::new(0, 0, 120, 40));
        let mut buffer = Buffer::empty(area);
        let (mut keys, mut turnarounds) = (Vec::new(), Vec::new());
        let mut draw = |seconds: f64, until: &dyn Fn(RunState) -> bool| {
            let end = watch.seconds() + seconds;
            while watch.seconds() < end {
                if let Some(snapshot) = line.snapshot() {
                    buffer.reset();
                    view::draw(&model, &snapshot, &theme, area, &mut buffer);
                    if until(snapshot.run) {
                        return;
                    }
                }
                let _ = line.ending(Duration::from_millis(30));
            }
        };
        draw(4.0, &|_| false);
        for k in 0..STOPS {
            line.intent(Intent::ClearStop);
            line.intent(Intent::Run);
            draw(0.6 + 0.013 * k as f64, &|_| false);
            turnarounds.extend(told.try_iter().filter_map(|seen| match seen {
                Seen::Turnaround(seconds) => Some(seconds * 1e3),
                Seen::StopByte(_) | Seen::Rest(_) => None,
            }));
            let pressed = watch.seconds();
            line.intent(Intent::Stop);
            draw(0.5, &|_| false);
            let (mut byte, mut rest) = (None, None);
            for seen in told.try_iter() {
                match seen {
                    Seen::StopByte(at) => byte = byte.or(Some(at - pressed)),
                    Seen::Rest(at) => rest = Some(at - pressed),
                    Seen::Turnaround(_) => {}
                }
            }
            // Between two motions there is nothing to bring to rest.
            if let (Some(byte), Some(rest)) = (byte, rest) {
                keys.push((byte, rest));
            }
        }
        (keys, turnarounds)
    }

    fn share(sorted: &[f64], share: f64) -> f64 {
        let last = sorted.len().saturating_sub(1);
        sorted.get((last as f64 * share).round() as usize).copied().unwrap_or(f64::NAN)
    }

    fn histogram(what: &str, values: &mut [f64]) {
        values.sort_by(f64::total_cmp);
        println!(
            "{what}: {} of them, median {:.2}, p90 {:.2}, p99 {:.2}, worst {:.2}",
            values.len(),
            share(values, 0.5),
            share(values, 0.9),
            share(values, 0.99),
            share(values, 1.0)
        );
        let mut low = 0.0;
        for high in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 1e9] {
            let count = values.iter().filter(|v| (low..high).contains(*v)).count();
            if count > 0 {
                println!("  {low:>5} to {high:<10} {count:>4} {}", "#".repeat(count.min(60)));
            }
            low = high;
        }
    }
}
