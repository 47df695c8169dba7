//! Rules of the local server, as requests of a hostile page, another user of the machine or a broken client.
//!
//! | rule | tested in |
//! |---|---|
//! | 1 loopback only | `guard` |
//! | 2 `Host` | `guard` |
//! | 3 requests of other pages | `guard` |
//! | 4 token and cookie | `guard`; the comparison in constant time is code alone (`src/token.rs`) |
//! | 5 no path reaches the disk | `guard` |
//! | 6 size, number, time | `loads`; the two deadlines and the folder's rights beside their code (`src/server.rs`, `src/store.rs`) |
//! | 7 nothing from elsewhere | `guard`, `report`; the files of the page in `src/assets.rs`; the browser counts what its policy refuses |
//! | 8 names are text | `logs`, `report`; in the browser `hostile` |
//! | 9 no program is started | `src/assets.rs` |
//! | 10 no paths in answers | `guard` |
//! | 11 work ends, memory is bounded | `sessions`, `control`; the budget of memory in `src/cache.rs` |
//! | 12 what is linked | `retarder-tests`, `dependencies`; advisories by hand, with the reason in CONTRIBUTING.md |

mod bench;
mod compare;
mod control;
mod diagnose;
mod estimate;
mod guard;
mod loads;
mod logs;
mod memory;
mod plant;
mod refine;
mod report;
mod sessions;
