//! A frame of the console at 80x24, 120x40 and 200x60: of a whole small map, and of one with 10 000
//! contacts shown. Beside it what a terminal of that size costs to fill with blanks.

use divan::{Bencher, black_box};
use periplus::console::model::{Layer, Layers, Model};
use periplus::console::theme::Theme;
use periplus::console::{Keymap, view};
use periplus::geometry::{Point, Pose};
use periplus::journal::Header;
use periplus::mapping::map::{Contact, ContactKind};
use periplus::mapping::settings::Settings;
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::session::Snapshot;
use periplus::simulator::{NoiseProfile, World};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use std::io::Sink;

fn main() {
    divan::main();
}

const SIZES: [(u16, u16); 3] = [(80, 24), (120, 40), (200, 60)];

/// The end of a run in a room with an object.
fn mapped() -> Snapshot {
    let text = include_str!("../sims/extrinsic_first.toml");
    let Ok(world) = World::from_toml(text, "extrinsic_first", 0.1) else {
        return Snapshot::waiting(Settings::new(Pose::new(0.0, 0.0, 0.0)), "no world");
    };
    let header = Header {
        settings: Settings::new(world.start),
        source: world.name.clone(),
        noise: String::new(),
        until: None,
        robot: None,
    };
    let mut run: SimulatedRun<Sink> = SimulatedRun::new(&world, header, NoiseProfile::None, None);
    run.intent(Intent::Run);
    while run.is_under_way() {
        run.advance();
    }
    run.snapshot()
}

/// The same with 10 000 contacts.
fn crowded() -> Snapshot {
    let mut snapshot = mapped();
    snapshot.map.contacts = (0..10_000_u32)
        .map(|k| {
            let at = f64::from(k) * 0.002;
            let point = Point::new(0.3 * (at % 20.0), 0.2 * ((at * 7.3) % 20.0));
            Contact { point, from: point, sensor: Some(0), kind: ContactKind::Range, time: at }
        })
        .collect();
    snapshot
}

fn drawn(bencher: Bencher<'_, '_>, snapshot: &Snapshot, size: (u16, u16)) {
    let contacts = Layer { under_way: true, over: true };
    let layers = Layers { contacts, ..Layers::default() };
    let model = Model { layers, ..Model::new(size.0, size.1, Keymap::default()) };
    let theme = Theme::dark();
    let area = Rect::new(0, 0, size.0, size.1);
    let mut buffer = Buffer::empty(area);
    bencher.bench_local(|| {
        buffer.reset();
        view::draw(&model, black_box(snapshot), &theme, area, &mut buffer);
    });
}

#[divan::bench(args = SIZES)]
fn whole_map(bencher: Bencher<'_, '_>, size: (u16, u16)) {
    drawn(bencher, &mapped(), size);
}

#[divan::bench(args = SIZES)]
fn ten_thousand_contacts(bencher: Bencher<'_, '_>, size: (u16, u16)) {
    drawn(bencher, &crowded(), size);
}

#[divan::bench(args = SIZES)]
fn blank(bencher: Bencher<'_, '_>, size: (u16, u16)) {
    let area = Rect::new(0, 0, size.0, size.1);
    let mut buffer = Buffer::empty(area);
    bencher.bench_local(|| {
        buffer.reset();
        black_box(&buffer);
    });
}
