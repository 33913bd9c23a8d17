//! Ports: serial devices, pseudo-terminals and TCP, opened as one kind of stream, with errors that say
//! what to try.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio_serial::{ClearBuffer, SerialPort, SerialPortBuilderExt, SerialPortType, SerialStream};

/// The speed of a serial port when nothing is said.
pub const BAUD: u32 = 115_200;

/// A bridge that has not answered after this long is not there; the system itself would wait for minutes.
const REACH: Duration = Duration::from_secs(5);

/// Where a robot can be reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A device: USB, Bluetooth, pseudo-terminal.
    Serial {
        /// Its path.
        path: String,
        /// Its speed.
        baud: u32,
    },
    /// A wireless bridge.
    Tcp {
        /// Host and port.
        place: String,
    },
}

impl Address {
    /// The same at another speed, where it has one.
    #[must_use]
    pub fn at_baud(self, speed: Option<u32>) -> Self {
        match (self, speed) {
            (Self::Serial { path, .. }, Some(baud)) => Self::Serial { path, baud },
            (other, _) => other,
        }
    }

    /// Whether a bridge is in between, which may go away without a word: the system itself would wait for
    /// minutes before it says so.
    #[must_use]
    pub fn is_bridge(&self) -> bool {
        matches!(self, Self::Tcp { .. })
    }

    /// Bits a second; 0 where bytes take no time that counts.
    #[must_use]
    pub fn baud(&self) -> u32 {
        match self {
            Self::Serial { baud, .. } => *baud,
            Self::Tcp { .. } => 0,
        }
    }
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix("tcp://") {
            Some(place)
                if place.rsplit_once(':').is_some_and(|(_, p)| p.parse::<u16>().is_ok()) =>
            {
                Ok(Self::Tcp { place: place.to_owned() })
            }
            Some(place) => Err(match place.rsplit_once(':') {
                Some((_, port)) if !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => {
                    format!("`{text}`: a port is a number up to {}", u16::MAX)
                }
                _ => format!("`{text}`: write tcp://HOST:PORT"),
            }),
            None if text.is_empty() => Err("the name of the port is empty".to_owned()),
            None => Ok(Self::Serial { path: text.to_owned(), baud: BAUD }),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { path, .. } => f.write_str(path),
            Self::Tcp { place } => write!(f, "tcp://{place}"),
        }
    }
}

/// Why a port cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// Nothing of that name.
    #[error("{port}: there is no such port; {}", instead_of(.port))]
    Missing {
        /// The port.
        port: String,
    },
    /// A file or a folder.
    #[error("{port}: a file or a folder, and no port; `periplus ports` lists those there are")]
    NoPort {
        /// The path.
        port: String,
    },
    /// Somebody else has it, or the rights are missing.
    #[error(
        "{port}: refused ({reason}); is another program using it, and may you (group dialout)?"
    )]
    Refused {
        /// The port.
        port: String,
        /// What the system said.
        reason: String,
    },
    /// Nobody can be waited for there.
    #[error(
        "{port}: cannot be waited at: {reason}; the address is one of this machine's, the port a free one"
    )]
    Taken {
        /// The address.
        port: String,
        /// What the system said.
        reason: String,
    },
    /// The bridge does not answer.
    #[error("{port}: cannot be reached: {reason}; is the bridge on, and the address right?")]
    Unreachable {
        /// The port.
        port: String,
        /// What the system said.
        reason: String,
    },
}

/// What to try in place of a port that is not there.
fn instead_of(port: &str) -> String {
    let ports = "`periplus ports` lists those there are";
    let in_the_net = port.rsplit_once(':').is_some_and(|(host, number)| {
        !host.is_empty() && !host.contains('/') && number.parse::<u16>().is_ok()
    });
    if in_the_net {
        format!("{ports}, and a robot in the net is tcp://{port}")
    } else {
        ports.to_owned()
    }
}

/// Anything that bytes go through both ways.
pub trait Stream: AsyncRead + AsyncWrite + Unpin + Send {}
impl<T: AsyncRead + AsyncWrite + Unpin + Send> Stream for T {}

/// Opens the port for a host; waits 5 s at most for a bridge.
///
/// # Errors
/// When it is not there, not free, or not to be reached.
pub async fn open(address: &Address) -> Result<Box<dyn Stream>, PortError> {
    match address {
        Address::Serial { path, baud } => {
            let stream = serial(path, *baud)?;
            // What was said before anybody listened is of no use.
            let _ = stream.clear(ClearBuffer::Input);
            Ok(Box::new(stream))
        }
        Address::Tcp { place } => {
            let refused =
                |reason: String| PortError::Unreachable { port: address.to_string(), reason };
            let reached = tokio::time::timeout(REACH, TcpStream::connect(place)).await;
            let Ok(stream) = reached else {
                return Err(refused("no answer".to_owned()));
            };
            let stream = stream.map_err(|error| refused(error.to_string()))?;
            stream.set_nodelay(true).map_err(|error| refused(error.to_string()))?;
            Ok(Box::new(stream))
        }
    }
}

fn serial(path: &str, baud: u32) -> Result<SerialStream, PortError> {
    if std::fs::metadata(path).is_ok_and(|data| data.is_file() || data.is_dir()) {
        return Err(PortError::NoPort { port: path.to_owned() });
    }
    tokio_serial::new(path, baud).open_native_async().map_err(|error| {
        let port = path.to_owned();
        // The library calls a port that is taken "no such device".
        if Path::new(path).exists() {
            PortError::Refused { port, reason: error.to_string() }
        } else {
            PortError::Missing { port }
        }
    })
}

/// The end of a line at which a simulated robot sits.
pub enum RobotEnd {
    /// A new pseudo-terminal. The other end is kept open, lest it hangs up between two hosts.
    Pty {
        /// Our end.
        ours: SerialStream,
        /// The end that hosts open; never read here.
        theirs: SerialStream,
    },
    /// A serial port.
    Serial(SerialStream),
    /// A server for one host at a time.
    Tcp(TcpListener),
}

impl RobotEnd {
    /// A new pseudo-terminal, and its path.
    ///
    /// # Errors
    /// When the system has none left.
    pub fn pty() -> Result<(Self, String), PortError> {
        let refused = |reason| PortError::Refused { port: "a pseudo-terminal".to_owned(), reason };
        let (ours, theirs) = SerialStream::pair().map_err(|error| refused(error.to_string()))?;
        let path = theirs.name().ok_or_else(|| refused("it has no name".to_owned()))?;
        Ok((Self::Pty { ours, theirs }, path))
    }

    /// The robot's end of `address`; for TCP it listens there.
    ///
    /// # Errors
    /// As [`open`].
    pub async fn at(address: &Address) -> Result<Self, PortError> {
        match address {
            Address::Serial { path, baud } => Ok(Self::Serial(serial(path, *baud)?)),
            Address::Tcp { place } => {
                TcpListener::bind(place).await.map(Self::Tcp).map_err(|error| PortError::Taken {
                    port: address.to_string(),
                    reason: error.to_string(),
                })
            }
        }
    }
}

/// One line for every serial port: its path, what it is, and whether it is free.
#[must_use]
pub fn list() -> Vec<String> {
    let mut ports = tokio_serial::available_ports().unwrap_or_default();
    ports.sort_by(|a, b| a.port_name.cmp(&b.port_name));
    ports
        .into_iter()
        .map(|port| {
            let what = match port.port_type {
                SerialPortType::UsbPort(usb) => {
                    let name = usb.product.unwrap_or_else(|| "USB".to_owned());
                    format!("{name} ({:04x}:{:04x})", usb.vid, usb.pid)
                }
                SerialPortType::BluetoothPort => "Bluetooth".to_owned(),
                SerialPortType::PciPort => "built in".to_owned(),
                SerialPortType::Unknown => "unknown".to_owned(),
            };
            let free = match tokio_serial::new(&port.port_name, BAUD).open() {
                Ok(_) => "free".to_owned(),
                Err(error) => format!("not free: {error}"),
            };
            // Names come from the device: nothing of them may steer the terminal.
            let line = format!("{}\t{what}\t{free}", port.port_name);
            line.chars().map(|c| if c.is_control() && c != '\t' { '?' } else { c }).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_devices_or_tcp() {
        let tcp = Address::Tcp { place: "robot.local:3333".to_owned() };
        assert_eq!("tcp://robot.local:3333".parse(), Ok(tcp));
        assert!("tcp://robot.local".parse::<Address>().is_err());
        let too_large = "tcp://robot:99999".parse::<Address>();
        assert!(too_large.is_err_and(|why| why.contains("number up to 65535")));
        assert!("".parse::<Address>().is_err());
        let serial: Address = "/dev/ttyUSB0".parse().expect("an address");
        assert_eq!(serial.at_baud(Some(9600)).baud(), 9600);
    }
}
