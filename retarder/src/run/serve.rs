//! Serving of the page until Ctrl-C.

use workbench::{Options, Server};

use crate::failure::Failure;

/// Serves the page, and calls `begin` with the address once the server answers. Returns the text to print at the end.
pub(crate) fn run(options: &Options, begin: &mut dyn FnMut(&str)) -> Result<String, Failure> {
    let server = Server::bind(options)?;
    for problem in server.unreadable_projects() {
        eprintln!("note: {problem}");
    }
    let stopper = server.stopper();
    ctrlc::set_handler(move || stopper.stop())?;
    begin(&server.address());
    server.run()?;
    Ok(format!(
        "\nThe project is kept in {}.\n",
        options.project.display()
    ))
}
