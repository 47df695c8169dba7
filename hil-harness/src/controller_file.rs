//! stub
use controller::Settings;
/// thesis
pub fn thesis() -> Settings {
    Settings::thesis()
}
/// recommended
pub fn recommended() -> Settings {
    Settings::recommended()
}
/// write
pub fn write(settings: &Settings) -> String {
    format!("{settings:?}")
}
