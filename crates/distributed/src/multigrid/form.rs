//! The two forms of the stiffness with contact eliminated.

/// The treatment of friction in `K̂`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// No friction, so that `K̂` is symmetric: the iterations account for friction.
    Symmetric,
    /// Exact friction.
    Oblique,
}
