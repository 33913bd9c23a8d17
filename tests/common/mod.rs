//! Mapping a world with the simulated robot, for tests that measure the map.

use periplus::journal::Header;
use periplus::mapping::map::{Phase, RoomMap};
use periplus::mapping::settings::Settings;
use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::simulator::{NoiseProfile, World};
use std::io::Sink;

/// The map of `world` as the robot has it when it leaves `phase`.
pub(crate) fn mapped(
    world: &World,
    settings: Settings,
    noise: NoiseProfile,
    phase: Phase,
) -> RoomMap {
    let mut run = begun(world, settings, noise);
    run.intent(Intent::Run);
    while run.is_under_way() && run.session().mission().phase() <= phase {
        run.advance();
    }
    run.snapshot().map
}

/// A run that waits for its first intent.
pub(crate) fn begun(world: &World, settings: Settings, noise: NoiseProfile) -> SimulatedRun<Sink> {
    let header = Header {
        settings,
        source: world.name.clone(),
        noise: String::new(),
        until: None,
        robot: None,
    };
    SimulatedRun::new(world, header, noise, None)
}
