//! Where the page is.

use std::io::Write as _;

/// The address, on the standard output, as soon as it answers.
pub(crate) fn serving(address: &str) {
    let mut out = anstream::stdout().lock();
    // Whoever closed the standard output does not want to know.
    let _ = write!(
        out,
        "Open {address}\n\nIt is for one browser on this machine. Ctrl-C ends it.\n"
    );
    let _ = out.flush();
}
