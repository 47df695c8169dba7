//! Address of the page.

use std::io::Write as _;

/// Prints the address to the standard output as soon as the server answers.
pub(crate) fn serving(address: &str) {
    let mut out = anstream::stdout().lock();
    // A closed standard output is not a failure.
    let _ = write!(
        out,
        "Open {address}\n\nIt is for one browser on this machine. Ctrl-C ends it.\n"
    );
    let _ = out.flush();
}
