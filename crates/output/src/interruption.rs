//! Ctrl-C as a request to finish, for programs that run until they are told to end.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A request to end: Ctrl-C, SIGTERM or SIGHUP, unless the caller has told the program to ignore
/// them. The second such signal ends it at once, and the next program removes the hidden files that
/// it leaves.
///
/// Elsewhere than on Unix nobody is heard, and Ctrl-C ends the program at once.
#[derive(Debug, Clone, Default)]
pub struct Interruption(Arc<AtomicBool>);

impl Interruption {
    /// Listens from now on.
    ///
    /// # Errors
    /// The system's, where it has no place for another listener.
    #[cfg(unix)]
    pub fn listen() -> io::Result<Self> {
        let heard = Self::default();
        for signal in crate::part::handled_signals() {
            // The first of both looks at the flag before the second sets it.
            let ended = 128 + signal;
            signal_hook::flag::register_conditional_shutdown(signal, ended, heard.0.clone())?;
            signal_hook::flag::register(signal, heard.0.clone())?;
        }
        // The removal of hidden files ends the program otherwise.
        crate::part::leave_signals_to_the_program();
        Ok(heard)
    }

    /// Listens from now on.
    ///
    /// # Errors
    /// None.
    #[cfg(not(unix))]
    pub fn listen() -> io::Result<Self> {
        Ok(Self::default())
    }

    /// Returns `true` once the program has been asked to end.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Asks as a signal does.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
