//! The record is brought to the disk beside the control thread, which a slow disk would keep. Knows a
//! file, not what is in it.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time between two of them.
const PAUSE: Duration = Duration::from_secs(1);

/// Brings a file to the disk once a second.
pub(super) struct Syncing {
    end: Sender<()>,
    failed: Arc<Mutex<Option<io::Error>>>,
    thread: JoinHandle<()>,
}

impl Syncing {
    /// Begins with `journal`.
    ///
    /// # Errors
    /// When the system refuses the thread.
    pub(super) fn of(journal: &File) -> io::Result<Self> {
        let file = journal.try_clone()?;
        Self::with(PAUSE, move || file.sync_data().and_then(|()| still_there(&file)))
    }

    /// Brings something to the disk by `sync`, with `pause` between two times.
    pub(super) fn with(
        pause: Duration,
        mut sync: impl FnMut() -> io::Result<()> + Send + 'static,
    ) -> io::Result<Self> {
        let (end, ended) = channel();
        let failed = Arc::new(Mutex::new(None));
        let told = failed.clone();
        let body = move || {
            loop {
                let over = ended.recv_timeout(pause) != Err(RecvTimeoutError::Timeout);
                if let Err(error) = sync()
                    && !cannot_be_synced(&error)
                {
                    super::held(&told).get_or_insert(error);
                }
                if over {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().name("record".to_owned()).spawn(body)?;
        Ok(Self { end, failed, thread })
    }

    /// Why the file, or part of it, is not on the disk; told once.
    pub(super) fn failure(&self) -> Option<io::Error> {
        super::held(&self.failed).take()
    }

    /// Brings what is there to the disk, and ends; gives the failure that was not told.
    pub(super) fn end(self) -> Option<io::Error> {
        let Self { end, failed, thread } = self;
        drop(end);
        let _ = thread.join();
        super::held(&failed).take()
    }
}

/// A file that somebody removed takes all that is written to it, and nobody will ever read it.
#[cfg(unix)]
fn still_there(file: &File) -> io::Result<()> {
    use std::os::unix::fs::MetadataExt;
    // A pipe or a device stands in no folder either.
    let is_removed = |data: std::fs::Metadata| data.is_file() && data.nlink() == 0;
    if file.metadata().is_ok_and(is_removed) {
        return Err(io::Error::new(
            ErrorKind::NotFound,
            "somebody removed the record while it was written",
        ));
    }
    Ok(())
}

#[cfg(not(unix))]
fn still_there(_: &File) -> io::Result<()> {
    Ok(())
}

/// Some places know no such thing; what is written there is as safe as it will be.
fn cannot_be_synced(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_record_that_was_removed_is_told() {
        let path = std::env::temp_dir().join(format!("periplus-{}-removed", std::process::id()));
        let file = File::create(&path).expect("a file");
        assert!(Syncing::of(&file).expect("a thread").end().is_none(), "it is there");
        std::fs::remove_file(&path).expect("removed");
        let told = Syncing::of(&file).expect("a thread").end().expect("an error");
        assert!(told.to_string().contains("removed the record"), "{told}");
    }

    #[test]
    fn a_record_that_does_not_reach_the_disk_is_told() {
        let full = || Err(io::Error::other("no space left on device"));
        let told = Syncing::with(PAUSE, full).expect("a thread").end();
        assert_eq!(told.map(|error| error.to_string()).as_deref(), Some("no space left on device"));
        let pipe = || Err(io::Error::from(ErrorKind::InvalidInput));
        assert!(Syncing::with(PAUSE, pipe).expect("a thread").end().is_none());
        assert!(Syncing::with(PAUSE, || Ok(())).expect("a thread").end().is_none());
    }
}
