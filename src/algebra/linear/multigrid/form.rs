//! The two forms of the stiffness with contact eliminated.

/// How friction gets into `K̂`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Not at all, so that it is symmetric: friction is what the iterations are for.
    Symmetric,
    /// Exactly.
    Oblique,
}
