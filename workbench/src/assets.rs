//! Files of the page. All are part of the program; the path of a request is looked up in this list only.

use std::collections::HashMap;
use std::io::{self, Read as _};
use std::sync::LazyLock;

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::{ACCEPT_ENCODING, CONTENT_ENCODING, CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use plotly::Plot;

use crate::refusal::Refusal;

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JAVASCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! modules {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!("web/", $path)))),*]
    };
}

/// Modules of the page.
const MODULES: &[(&str, &str)] = modules![
    "main.js",
    "api.js",
    "chart.js",
    "connection.js",
    "dom.js",
    "filter.js",
    "format.js",
    "jobs.js",
    "menu.js",
    "next.js",
    "side-tabs.js",
    "sketch.js",
    "terms.js",
    "theme.js",
    "time-view.js",
    "view.js",
    "pages/compare/charts.js",
    "pages/compare/closer.js",
    "pages/compare/cursors.js",
    "pages/compare/differences.js",
    "pages/compare/limits.js",
    "pages/compare/look.js",
    "pages/compare/regimes.js",
    "pages/compare/rows.js",
    "pages/compare/shifts.js",
    "pages/compare/statistics.js",
    "pages/calculated.js",
    "pages/diagnose.js",
    "pages/diagnose/candidates.js",
    "pages/diagnose/experiment.js",
    "pages/diagnose/remaining.js",
    "pages/error-steps.js",
    "pages/estimate.js",
    "pages/estimate/charts.js",
    "pages/estimate/estimation.js",
    "pages/estimate/experiment.js",
    "pages/estimate/live-error.js",
    "pages/estimate/parameters.js",
    "pages/estimate/tables.js",
    "pages/inspection.js",
    "pages/logs.js",
    "pages/mapping.js",
    "pages/planned.js",
    "pages/refine.js",
    "pages/refine/effects.js",
    "pages/refine/plots.js",
    "pages/refine/refitted.js",
    "pages/roles.js",
    "pages/steps.js",
    "pages/work.js",
    "pages/compare.js",
    "pages/control.js",
    "pages/control/batch.js",
    "pages/control/charts.js",
    "pages/control/controller.js",
    "pages/control/profile.js",
    "pages/control/requirements.js",
    "pages/report.js",
];

/// The charting library, extracted from the script elements that its crate returns.
static PLOTLY: LazyLock<String> = LazyLock::new(|| {
    let elements = Plot::offline_js_sources();
    let begin = elements.find('>').map_or(0, |at| at + 1);
    // The library itself has no such line; the second element is for formulas in labels, which the page does not use.
    let end = elements.find("</script>\n").unwrap_or(elements.len());
    elements[begin..end].to_owned()
});

/// Returns the only HTML document.
pub(crate) async fn index() -> impl IntoResponse {
    ([(CONTENT_TYPE, HTML)], include_str!("web/index.html"))
}

const STYLE: (&str, &str) = ("style.css", include_str!("web/style.css"));

/// Modules and style sheet, compressed once with gzip. The charting library is not: its compression would take longer
/// than its way to a browser on the same machine.
static COMPRESSED: LazyLock<HashMap<&'static str, Vec<u8>>> = LazyLock::new(|| {
    let files = MODULES.iter().chain([&STYLE]);
    // A file that cannot be compressed is sent as it is.
    files
        .filter_map(|(name, text)| Some((*name, compressed(text).ok()?)))
        .collect()
});

fn compressed(text: &str) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = flate2::read::GzEncoder::new(text.as_bytes(), flate2::Compression::best());
    encoder.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Returns whether the client names gzip among the encodings that it reads.
fn accepts_gzip(headers: &HeaderMap) -> bool {
    let values = headers.get_all(ACCEPT_ENCODING).iter();
    values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','))
        .any(|encoding| encoding.trim() == "gzip")
}

/// Returns a script or the style sheet, compressed for a client that reads it.
pub(crate) async fn asset(
    Path(path): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    let (kind, text): (_, &'static str) = match path.as_str() {
        "style.css" => (CSS, STYLE.1),
        "plotly.js" => (JAVASCRIPT, PLOTLY.as_str()),
        _ => {
            let module = MODULES.iter().find(|(name, _)| *name == path);
            let (_, text) = module.ok_or_else(|| Refusal::not_found("file"))?;
            (JAVASCRIPT, *text)
        }
    };
    let kind = [(CONTENT_TYPE, kind), (VARY, "accept-encoding")];
    let bytes = COMPRESSED.get(path.as_str());
    Ok(match bytes.filter(|_| accepts_gzip(&headers)) {
        Some(bytes) => (kind, [(CONTENT_ENCODING, "gzip")], bytes.as_slice()).into_response(),
        None => (kind, text).into_response(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_charting_library_is_whole_and_alone() {
        assert!(PLOTLY.len() > 4_000_000, "{} bytes", PLOTLY.len());
        let head = PLOTLY.trim_start();
        assert!(head.starts_with("/**\n* plotly.js v3."), "{}", &head[..60]);
        assert!(!PLOTLY.contains("<script type"), "an element is left");
        assert!(
            !PLOTLY.contains("MathJax.loader"),
            "the second library is left"
        );
    }

    /// Returns every file in a folder of this crate and in its subfolders, with its text.
    fn texts_in(folder: &str) -> Vec<(std::path::PathBuf, String)> {
        let mut texts = Vec::new();
        let mut folders = vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let text = std::fs::read_to_string(&path).unwrap();
                    texts.push((path, text));
                }
            }
        }
        texts
    }

    /// Rule 9: the server starts the process of a tab and no other program, and passes it no argument from a request.
    #[test]
    fn no_program_is_started_but_that_of_a_tab() {
        const ALLOWED: &str = "(&self.worker.program)
            .args(&self.worker.arguments)
            .arg(&self.project)
            .arg(self.worker.memory_bytes.to_string())
            .stdin(Stdio::piped())";
        // Written in parts; otherwise this line would be found.
        let forbidden = [
            ["process", "Command"].join("::"),
            ["Command", "new"].join("::"),
        ];
        let mut begun = Vec::new();
        for (path, text) in texts_in("src") {
            for word in &forbidden {
                let starts = text.split(&word[..]).skip(1);
                begun.extend(starts.map(|start| (path.clone(), start.starts_with(ALLOWED))));
            }
        }
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        assert_eq!(begun, [(root.join("src/tabs/process.rs"), true)]);
    }

    /// Every file of the folder is in the list, and none refers to another host.
    #[test]
    fn the_modules_are_those_of_the_folder_and_need_no_network() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/web");
        let mut found = Vec::new();
        for (path, text) in texts_in("src/web") {
            for scheme in ["https://", "http://", "//cdn", "ws://"] {
                assert!(!text.contains(scheme), "{}: {scheme}", path.display());
            }
            for markup in [
                "innerHTML",
                "outerHTML",
                "insertAdjacentHTML",
                "document.write",
                "eval(",
            ] {
                assert!(!text.contains(markup), "{}: {markup}", path.display());
            }
            if path.extension().is_some_and(|end| end == "js") {
                let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
                found.push(name.replace('\\', "/"));
            }
        }
        found.sort();
        let mut listed: Vec<&str> = MODULES.iter().map(|(name, _)| *name).collect();
        listed.sort_unstable();
        assert_eq!(found, listed);
    }
}
