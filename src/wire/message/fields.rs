//! The fields of a line's body, read one after the other; each is none when it makes no sense.

use super::MICRO;
use crate::robot::{Odometer, SwitchSet};
use std::str::FromStr;

/// The fields of a body, taken one after the other.
pub(super) struct Fields<'a>(std::str::SplitN<'a, char>);

impl<'a> Fields<'a> {
    pub(super) fn of(rest: &'a str, most: usize) -> Self {
        Self(rest.splitn(most, ' '))
    }

    pub(super) fn number<T: FromStr>(&mut self) -> Option<T> {
        self.0.next()?.parse().ok()
    }

    /// Motions are counted from 1.
    pub(super) fn sequence(&mut self) -> Option<u32> {
        self.number().filter(|seq| *seq > 0)
    }

    pub(super) fn set(&mut self) -> Option<SwitchSet> {
        u16::from_str_radix(self.0.next()?, 16).ok().map(SwitchSet)
    }

    pub(super) fn hex(&mut self) -> Option<u32> {
        u32::from_str_radix(self.0.next()?, 16).ok()
    }

    pub(super) fn measure(&mut self, unit: f64) -> Option<f64> {
        self.number::<i64>().map(|value| value as f64 / unit)
    }

    pub(super) fn flag(&mut self) -> Option<bool> {
        match self.0.next()? {
            "0" => Some(false),
            "1" => Some(true),
            _ => None,
        }
    }

    pub(super) fn odometer(&mut self) -> Option<Odometer> {
        Some(Odometer {
            time_us: self.number()?,
            left_ticks: self.number()?,
            right_ticks: self.number()?,
            heading: self.measure(MICRO)?,
        })
    }

    pub(super) fn text(&mut self) -> String {
        self.0.next().unwrap_or_default().to_owned()
    }
}
