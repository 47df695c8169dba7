//! Description of a setting, and the macro that defines a table of settings.

use fixed::types::I16F16;

/// Description of one setting: a number, or a choice between words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingSpec {
    /// Name in the calibration and in errors; that of a number ends in its unit.
    pub name: &'static str,
    /// Unit of a number; empty for a choice.
    pub unit: &'static str,
    /// Smallest and largest allowed number; another setting may narrow the range. For a choice the range is 0 to 0.
    pub range: [I16F16; 2],
    /// Words of a choice, beginning with number 0; empty for a number.
    pub choices: &'static [&'static str],
    /// Form in a controller file.
    pub form: Form,
    /// Table of a controller file.
    pub section: &'static str,
    /// Keys in this table, of which the other settings select one.
    pub keys: &'static [&'static str],
    /// Meaning, with its equation or section.
    pub about: &'static str,
}

/// Form of a setting in a controller file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Decimal number.
    Number,
    /// Word of a choice.
    Word,
    /// Number of a choice, from 0.
    Index,
    /// The word `off` in place of the number at the same key; every number means `on`.
    NumberOrOff,
    /// The section itself: without it, the choice is `off`.
    Section,
}

/// Defines a table of settings: an enum with one variant per row, and the access to the value of each row.
///
/// A row describes a number or a choice of the settings type. The order of the rows is that of the ids in the
/// calibration. The choice that decides whether a number is in use comes before the number.
///
/// ```text
/// Id: number ("name_with_unit" ["unit"] "min" ..= "max", "meaning", section { key: pattern of the place, ... });
/// Id: choice ("name" form, "meaning", section { key }, field { "word" = value, ... });
/// ```
///
/// The pattern of a place binds the number under the name that the head of the table gives. A number that no pattern
/// finds is not in use. The forms are those of [`Form`](crate::Form).
#[macro_export]
macro_rules! settings_table {
    (
        $(#[$about:meta])*
        $table:ident of $settings:ident, number as $number:ident;
        $($id:ident: $kind:ident $row:tt;)*
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[allow(missing_docs, reason = "the row of each variant describes it")]
        #[repr(u8)]
        pub enum $table {
            $($id,)*
        }

        impl $table {
            /// Number of settings.
            pub const COUNT: usize = [$(Self::$id),*].len();

            /// All settings, in the order of the table.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$id),*];

            /// Returns the description of the setting.
            pub const fn spec(self) -> &'static $crate::SettingSpec {
                match self {
                    $(Self::$id => const { &$crate::settings_table!(@spec $kind $row) },)*
                }
            }

            /// Returns the name in the calibration and in errors.
            pub const fn name(self) -> &'static str {
                self.spec().name
            }

            /// Returns the unit of a number; empty for a choice.
            pub const fn unit(self) -> &'static str {
                self.spec().unit
            }

            /// Returns the range of a number, as the description does; an ECU needs no description for it.
            pub const fn range(self) -> [$crate::fixed::types::I16F16; 2] {
                match self {
                    $(Self::$id => const { $crate::settings_table!(@spec $kind $row).range },)*
                }
            }

            /// Returns how many words a choice has, as the description does; 0 for a number.
            pub const fn choice_count(self) -> usize {
                match self {
                    $(Self::$id => const { $crate::settings_table!(@spec $kind $row).choices.len() },)*
                }
            }

            /// Returns the bits of a number (2⁻¹⁶ of its unit), or the number of a choice from 0. `None` if the choices do
            /// not use the setting.
            #[allow(unreachable_patterns, reason = "most numbers are always in use")]
            pub fn get(self, settings: &$settings) -> Option<i32> {
                match self {
                    $(Self::$id => $crate::settings_table!(@get $kind settings $number $row),)*
                }
            }

            /// Sets the bits of a number (2⁻¹⁶ of its unit), or the number of a choice from 0. The numbers that a changed
            /// choice uses become 0. Returns false, without a change, if the choices do not use the setting or there
            /// is no such choice. Nothing else is checked.
            #[allow(unreachable_patterns, reason = "most numbers are always in use")]
            pub fn set(self, settings: &mut $settings, bits: i32) -> bool {
                match self {
                    $(Self::$id => $crate::settings_table!(@set $kind settings bits $number $row),)*
                }
            }

            /// Returns the key of a controller file at which these settings have this setting. `None` if the choices do
            /// not use the setting.
            #[allow(unreachable_patterns, unused_variables, reason = "most numbers are always in use")]
            pub fn key(self, settings: &$settings) -> Option<&'static str> {
                match self {
                    $(Self::$id => $crate::settings_table!(@key $kind settings $row),)*
                }
            }
        }

        impl core::fmt::Display for $table {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.name())
            }
        }
    };

    (@spec number ($name:literal [$unit:literal] $min:literal ..= $max:literal, $about:literal,
        $section:ident { $($key:ident: $place:pat),+ $(,)? })) => {
        $crate::SettingSpec {
            name: $name,
            unit: $unit,
            range: [$crate::fixed::types::I16F16::lit($min), $crate::fixed::types::I16F16::lit($max)],
            choices: &[],
            form: $crate::Form::Number,
            section: stringify!($section),
            keys: &[$(stringify!($key)),+],
            about: $about,
        }
    };
    (@get number $settings:ident $number:ident ($name:literal [$unit:literal] $min:literal ..= $max:literal,
        $about:literal, $section:ident { $($key:ident: $place:pat),+ $(,)? })) => {
        match $settings {
            $($place => Some($number.to_bits()),)+
            _ => None,
        }
    };
    (@set number $settings:ident $bits:ident $number:ident ($name:literal [$unit:literal] $min:literal ..= $max:literal,
        $about:literal, $section:ident { $($key:ident: $place:pat),+ $(,)? })) => {
        match $settings {
            $($place => {
                *$number = $crate::fixed::types::I16F16::from_bits($bits);
                true
            })+
            _ => false,
        }
    };
    (@key number $settings:ident ($name:literal [$unit:literal] $min:literal ..= $max:literal, $about:literal,
        $section:ident { $($key:ident: $place:pat),+ $(,)? })) => {
        match $settings {
            $($place => Some(stringify!($key)),)+
            _ => None,
        }
    };

    (@spec choice ($name:literal $form:ident, $about:literal, $section:ident { $key:ident },
        $field:ident { $($word:literal = $value:expr),+ $(,)? })) => {
        $crate::SettingSpec {
            name: $name,
            unit: "",
            range: [$crate::fixed::types::I16F16::ZERO; 2],
            choices: &[$($word),+],
            form: $crate::Form::$form,
            section: stringify!($section),
            keys: &[stringify!($key)],
            about: $about,
        }
    };
    (@get choice $settings:ident $number:ident ($name:literal $form:ident, $about:literal, $section:ident { $key:ident },
        $field:ident { $($word:literal = $value:expr),+ $(,)? })) => {{
        let chosen = core::mem::discriminant(&$settings.$field);
        let mut numbers = 0..;
        [$($value),+]
            .iter()
            .zip(&mut numbers)
            .find_map(|(value, number)| (core::mem::discriminant(value) == chosen).then_some(number))
    }};
    (@set choice $settings:ident $bits:ident $number:ident ($name:literal $form:ident, $about:literal,
        $section:ident { $key:ident }, $field:ident { $($word:literal = $value:expr),+ $(,)? })) => {{
        let values = [$($value),+];
        let value = usize::try_from($bits).ok().and_then(|place| values.get(place));
        if let Some(value) = value
            && core::mem::discriminant(value) != core::mem::discriminant(&$settings.$field)
        {
            $settings.$field = *value;
        }
        value.is_some()
    }};
    (@key choice $settings:ident ($name:literal $form:ident, $about:literal, $section:ident { $key:ident },
        $field:ident { $($word:literal = $value:expr),+ $(,)? })) => {
        Some(stringify!($key))
    };
}
