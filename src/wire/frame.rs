//! Lines with a checksum, and the byte that stops: bytes in, bodies of whole lines out. Knows nothing
//! of what the lines say.

use crc::{CRC_16_IBM_3740, Crc};
use std::fmt::Display;
use std::io::Write;

/// Bytes of a line at most, its end counted.
pub const LONGEST: usize = 96;
/// Brakes the robot, wherever it comes; no frame contains it.
pub const STOP: u8 = 0x18;

const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// Appends the line of `body` to `out`. A body that is too long or not printable is left out: no
/// such thing is ever said.
pub fn seal(body: &(impl Display + ?Sized), out: &mut Vec<u8>) {
    let start = out.len();
    out.reserve(LONGEST);
    // Writing to memory cannot fail.
    let _ = write!(out, "{body}");
    let body = &out[start..];
    if body.len() + 6 <= LONGEST && body.iter().all(|byte| (32..127).contains(byte)) {
        let sum = CRC.checksum(body);
        let _ = writeln!(out, "*{sum:04X}");
    } else {
        out.truncate(start);
    }
}

/// What a byte, or some of them, came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Item {
    /// The stop byte.
    Stop,
    /// The body of a whole line with a good checksum.
    Body(String),
    /// A line that could not be read, and was dropped.
    Garbled,
}

/// Puts lines together from bytes, however they are cut up.
#[derive(Debug, Clone, Default)]
pub struct Decoder {
    line: Vec<u8>,
    /// The line in hand is no good; it is skipped to its end.
    spoilt: bool,
}

impl Decoder {
    /// Takes one byte.
    #[inline]
    pub fn push(&mut self, byte: u8) -> Option<Item> {
        match byte {
            STOP => {
                // What came before it in this line was cut short.
                self.line.clear();
                self.spoilt = false;
                Some(Item::Stop)
            }
            b'\n' => {
                let spoilt = std::mem::take(&mut self.spoilt);
                let item = match (spoilt, self.line.is_empty()) {
                    (false, true) => None,
                    (false, false) => Some(body(&self.line).map_or(Item::Garbled, Item::Body)),
                    (true, _) => Some(Item::Garbled),
                };
                self.line.clear();
                item
            }
            b'\r' => None,
            32..127 if self.line.len() + 1 < LONGEST => {
                self.line.push(byte);
                None
            }
            _ => {
                self.line.clear();
                self.spoilt = true;
                None
            }
        }
    }

    /// Takes some bytes.
    pub fn feed<'a>(&'a mut self, bytes: &'a [u8]) -> impl Iterator<Item = Item> + 'a {
        bytes.iter().filter_map(|byte| self.push(*byte))
    }
}

fn body(line: &[u8]) -> Option<String> {
    let split = line.len().checked_sub(5)?;
    let (body, sum) = line.split_at(split);
    let sum = std::str::from_utf8(sum.strip_prefix(b"*")?).ok()?;
    let upper = sum.bytes().all(|byte| byte.is_ascii_digit() || (b'A'..=b'F').contains(&byte));
    let told = u16::from_str_radix(sum, 16).ok().filter(|_| upper)?;
    (CRC.checksum(body) == told).then(|| String::from_utf8_lossy(body).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(body: &str) -> Vec<u8> {
        let mut out = Vec::new();
        seal(body, &mut out);
        out
    }

    #[test]
    fn the_checksum_is_the_one_that_the_page_names() {
        assert_eq!(CRC.checksum(b"123456789"), 0x29B1);
        assert_eq!(line("a 7"), b"a 7*2095\n");
    }

    /// Whoever writes a robot from the page tries his checksum on what it shows.
    #[test]
    fn the_line_that_the_page_shows_is_a_good_one() {
        let page = include_str!("PROTOCOL.md");
        let shown = page.lines().find_map(|line| line.trim().strip_prefix("body *CRC <newline>"));
        let body = "r 20000 12 12 -1500 04 0 7 0";
        assert_eq!(shown.map(|line| line.trim().as_bytes()), line(body).strip_suffix(b"\n"));
    }

    #[test]
    fn lines_come_out_whole_wherever_they_are_cut() {
        let bytes: Vec<u8> =
            [line("P 1 0"), line("a 12"), line("M 1 5000 200 FF 00 3000")].concat();
        let whole: Vec<Item> = Decoder::default().feed(&bytes).collect();
        assert_eq!(whole.len(), 3);
        for cut in 0..=bytes.len() {
            let mut decoder = Decoder::default();
            let mut items: Vec<Item> = decoder.feed(&bytes[..cut]).collect();
            items.extend(decoder.feed(&bytes[cut..]));
            assert_eq!(items, whole, "cut at {cut}");
        }
    }

    #[test]
    fn one_wrong_bit_is_noticed_wherever_it_is() {
        let bytes = line("d 9 4 g2+ 123456 1000 1001 -15000 04 0");
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut wrong = bytes.clone();
                wrong[at] ^= 1 << bit;
                let mut decoder = Decoder::default();
                let items: Vec<Item> = decoder.feed(&wrong).collect();
                let bodies = items.iter().filter(|item| matches!(item, Item::Body(_)));
                assert_eq!(bodies.count(), 0, "byte {at} bit {bit}: {items:?}");
            }
        }
    }

    #[test]
    fn a_stop_is_heard_inside_a_line_and_the_next_line_is_whole() {
        let mut bytes = line("P 1 0");
        bytes.truncate(4);
        bytes.push(STOP);
        bytes.extend(line("S 3"));
        let items: Vec<Item> = Decoder::default().feed(&bytes).collect();
        assert_eq!(items, [Item::Stop, Item::Body("S 3".to_owned())]);
    }

    #[test]
    fn babble_neither_grows_nor_passes() {
        let mut decoder = Decoder::default();
        let noise: Vec<u8> =
            (0..200_000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        let bodies = decoder.feed(&noise).filter(|item| matches!(item, Item::Body(_))).count();
        assert_eq!(bodies, 0);
        assert!(decoder.line.capacity() <= 2 * LONGEST);
        let after: Vec<Item> = decoder.feed(b"\na 7*2095\n").collect();
        assert_eq!(after.last(), Some(&Item::Body("a 7".to_owned())));
    }
}
