//! Limits of the system on how large a file may be.

/// Makes a file that may not grow further (`ulimit -f`) an error of whoever writes it. As the system
/// has it the program would end at once, without a message, and leave a part behind.
pub(crate) fn meet_file_limits() {
    #[cfg(unix)]
    {
        use std::sync::Arc;
        use std::sync::atomic::AtomicBool;

        use signal_hook::consts::SIGXFSZ;
        use signal_hook::flag::register;

        // Where it cannot be done the program ends as ever.
        register(SIGXFSZ, Arc::new(AtomicBool::new(false))).map(drop).unwrap_or_default();
    }
}
