//! The families of faults: what there is, and what the table lets one expect of it.

pub(super) mod ecu;
pub(super) mod image;
pub(super) mod link;
pub(super) mod plant;
pub(super) mod sensor;

/// How a fault that is short enough ends, by the table of faults and ways in `docs/safety.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Survival {
    /// Shorter than any N: the loop goes on.
    Unnoticed,
    /// Confirmed, and gone before the way has emptied the chamber: the loop comes back by itself.
    Held,
    /// Nothing is claimed: the reference may have to be taken back first.
    NotClaimed,
}

/// An enumeration whose members have a name for people, all of them known.
macro_rules! named {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $member:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name {
            $($(#[$doc])* $member,)+
        }

        impl $name {
            /// Every member, in the order of the declaration.
            pub const ALL: &[Self] = &[$(Self::$member),+];

            /// Its name on a line.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$member => $text,)+
                }
            }
        }
    };
}
pub(super) use named;
