//! Warnings: reasons why a result may be inaccurate although every law holds, and why a run is slow.

use serde::{Deserialize, Serialize, Serializer};

/// A warning.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Warning {
    /// The kind of the warning.
    pub kind: WarningKind,
    /// The warning in words, with the cure.
    pub message: String,
}

/// The kind of a warning, with what the page of warnings says of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct WarningKind {
    /// The name in reports.
    pub name: &'static str,
    /// The meaning, as Markdown.
    pub meaning: &'static str,
    /// The cure, as Markdown with links from the folder of the page.
    pub cure: &'static str,
    /// The condition to ignore the warning.
    pub ignored_if: &'static str,
    /// `true` if the warning is known only after the solution. Locking is also predicted before it.
    pub needs_the_solution: bool,
}

impl WarningKind {
    /// Returns `true` if the warning is never to be ignored: results may be those of another problem.
    pub fn is_grave(self) -> bool {
        self.ignored_if == "never"
    }

    /// Returns a warning of this kind.
    pub(in crate::run) fn warning(self, message: String) -> Warning {
        Warning { kind: self, message }
    }
}

impl Serialize for WarningKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

/// Declares the kinds of warnings of a file: the meaning as comment, then the name in reports, the cure, and the
/// condition to ignore it, each as the page of warnings has it. `before` marks a kind known before the solution.
macro_rules! kinds {
    ($($(#[doc = $meaning:literal])* $kind:ident($name:literal, $cure:literal, $ignored_if:literal $(, $before:ident)?);)*) => {
        impl WarningKind {
            $($(#[doc = $meaning])*
            pub const $kind: WarningKind = WarningKind {
                name: $name,
                meaning: concat!($($meaning),*).trim_ascii_start(),
                cure: $cure,
                ignored_if: $ignored_if,
                needs_the_solution: stringify!($($before)?).is_empty(),
            };)*
        }

        pub(in crate::run) const KINDS: &[WarningKind] = &[$(WarningKind::$kind),*];
    };
}
pub(in crate::run) use kinds;
