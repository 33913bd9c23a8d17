//! Stepping a run with the simulated robot phase by phase, as the operator does.

use periplus::robot::Intent;
use periplus::runtime::simulated::SimulatedRun;
use periplus::session::snapshot::RunState;
use std::io::Sink;

/// On to the end of the phase, or of the run.
pub(crate) fn step_phase(run: &mut SimulatedRun<Sink>) {
    run.intent(Intent::StepPhase);
    until_paused(run);
}

/// On until the run pauses by itself, or is over.
pub(crate) fn until_paused(run: &mut SimulatedRun<Sink>) {
    while run.is_under_way() && run.session().run_state() != RunState::Paused {
        run.advance();
    }
}
