//! What the rest of the program asks of the robot's keeper, in its order; a stop that waits behind others is known
//! of at once.

use super::Request;
use crate::robot::Intent;
use std::collections::VecDeque;
use tokio::sync::mpsc::UnboundedReceiver;

/// Requests that come, and those that came while the keeper was busy.
pub(super) struct Requests {
    coming: UnboundedReceiver<Request>,
    waiting: VecDeque<Request>,
}

impl Requests {
    pub(super) fn new(coming: UnboundedReceiver<Request>) -> Self {
        Self { coming, waiting: VecDeque::new() }
    }

    /// The next request, as soon as there is one; none when nobody can ask any more. Before others behind which a
    /// stop has come to wait it is [`Request::StopAhead`]. Nothing is lost of a future that is dropped.
    pub(super) async fn next(&mut self) -> Option<Request> {
        if self.waiting.is_empty() {
            let first = self.coming.recv().await?;
            self.waiting.push_back(first);
        }
        let known = self.waiting.len();
        while let Ok(request) = self.coming.try_recv() {
            self.waiting.push_back(request);
        }
        let is_stop = |request: &Request| matches!(request, Request::Intent(Intent::Stop));
        let first_stops = self.waiting.front().is_some_and(is_stop);
        if !first_stops && self.waiting.iter().skip(known).any(is_stop) {
            return Some(Request::StopAhead);
        }
        self.waiting.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::sync::mpsc::unbounded_channel;

    #[tokio::test(flavor = "current_thread")]
    async fn a_stop_is_known_of_before_what_was_asked_before_it() {
        let (ask, coming) = unbounded_channel();
        let mut requests = Requests::new(coming);
        for intent in [Intent::Run, Intent::Pause, Intent::Stop, Intent::ClearStop] {
            ask.send(Request::Intent(intent)).expect("somebody hears it");
        }
        ask.send(Request::Leave).expect("somebody hears it");
        drop(ask);
        assert!(matches!(requests.next().await, Some(Request::StopAhead)));
        for intent in [Intent::Run, Intent::Pause, Intent::Stop, Intent::ClearStop] {
            let next = requests.next().await;
            assert!(matches!(next, Some(Request::Intent(asked)) if asked == intent), "{intent:?}");
        }
        assert!(matches!(requests.next().await, Some(Request::Leave)));
        assert!(requests.next().await.is_none());
    }

    #[tokio::test(flavor = "current_thread")]
    async fn a_stop_that_waits_behind_nothing_is_the_next() {
        let (ask, coming) = unbounded_channel();
        let mut requests = Requests::new(coming);
        for intent in [Intent::Stop, Intent::Stop] {
            ask.send(Request::Intent(intent)).expect("somebody hears it");
        }
        for _ in 0..2 {
            assert!(matches!(requests.next().await, Some(Request::Intent(Intent::Stop))));
        }
    }
}
