//! The report: one HTML file that holds everything, for a screen, a printer or an e-mail.
//!
//! It loads nothing, runs nothing and names no other machine; its content security policy forbids all of that. Whatever
//! comes from a log or a file name is text: the templates escape every value.

mod contents;
mod control;
mod diagnosis;
mod element;
mod model;
mod number;
mod origin;
mod page;
mod thesis;

pub(crate) use contents::{
    BeforeAndAfter, Contents, ControlPart, DiagnosisPart, Input, ModelPart, Origin,
};
pub(crate) use page::html;

#[cfg(test)]
mod tests;
