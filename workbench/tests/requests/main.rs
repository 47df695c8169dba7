//! The rules of the local server, each as requests that a hostile page, a neighbour or a broken client would send.

mod bench;
mod diagnose;
mod guard;
mod loads;
mod logs;
mod refine;
mod sessions;
