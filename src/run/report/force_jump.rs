//! Jumps of contact forces.

/// An increment in which contact forces jump, however short it is made.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ForceJump {
    /// Its beginning, s.
    pub from: f64,
    /// Its end, s.
    pub to: f64,
    /// The change of the contact forces relative to their largest value, both as the root of `Σ |p|² / l`.
    pub share: f64,
}
