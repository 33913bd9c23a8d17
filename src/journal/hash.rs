//! A short fingerprint of a state, the same on every machine.

use serde::Serialize;
use std::io;

/// FNV-1a of the state's JSON. Two states with the same hash are, for telling whether a replay
/// went the way of its record, the same; it guards against mistakes, not against malice.
#[must_use]
pub fn state_hash<T: Serialize>(state: &T) -> u64 {
    let mut hash = Fnv(0xcbf2_9ce4_8422_2325);
    // A state that JSON cannot hold hashes as far as it got, which is as repeatable as the rest.
    let _ = serde_json::to_writer(&mut hash, state);
    hash.0
}

struct Fnv(u64);

impl io::Write for Fnv {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
