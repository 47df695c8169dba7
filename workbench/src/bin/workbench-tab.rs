//! Process of one tab, for servers that tests start. `retarder serve` starts its own program.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [project, memory_bytes] = &arguments[..] else {
        eprintln!("usage: workbench-tab PROJECT MEMORY_BYTES");
        return ExitCode::from(2);
    };
    let Ok(memory_bytes) = memory_bytes.parse() else {
        eprintln!("MEMORY_BYTES: {memory_bytes} is not a whole number of bytes");
        return ExitCode::from(2);
    };
    match workbench::work(Path::new(project), memory_bytes) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}
