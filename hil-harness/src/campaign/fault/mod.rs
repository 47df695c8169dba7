//! Families of faults, with the expected behaviour of the loop.

pub(super) mod ecu;
pub(super) mod image;
pub(super) mod link;
pub(super) mod plant;
pub(super) mod sensor;

/// Expected behaviour of the loop with a fault of limited duration (table of faults and reactions, `docs/safety.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Survival {
    /// Shorter than any N: the loop continues.
    Unnoticed,
    /// Confirmed, and gone before the reaction has emptied the chamber: the loop recovers without intervention.
    Held,
    /// No claim: the reference may have to be zero first.
    NotClaimed,
}

/// Defines an enumeration whose members have a text name, with a list of all members.
macro_rules! named {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $member:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name {
            $($(#[$doc])* $member,)+
        }

        impl $name {
            /// All members, in the order of the declaration.
            pub const ALL: &[Self] = &[$(Self::$member),+];

            /// Returns the name of the member in a line.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$member => $text,)+
                }
            }
        }
    };
}
pub(super) use named;
