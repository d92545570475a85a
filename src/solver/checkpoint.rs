//! Checkpoints: snapshots from which a history can be resumed in another process.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// The first bytes of every checkpoint. The number changes with the layout.
const MAGIC: &[u8] = b"stickslip checkpoint 2\n";

/// A snapshot between two increments of a history, from which the history continues to the same bits.
///
/// Each layer of a run stores a part of its own: first the history, then its observers.
///
/// ```
/// use stickslip::solver::history::Observer;
/// use stickslip::solver::Checkpoint;
/// use stickslip::run::Run;
/// use stickslip::scene::Scene;
///
/// /// Keeps the checkpoint after the second increment, as if the program were ended there.
/// #[derive(Default)]
/// struct Keep(Vec<u8>);
///
/// impl Observer for Keep {
///     fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
///         let checkpoint = here();
///         if checkpoint.increments() == 2 {
///             self.0 = checkpoint.to_bytes().unwrap_or_default();
///         }
///     }
/// }
///
/// let set = ["mesh.elements=[6,6]".parse()?, "time.increments=4".parse()?];
/// let scene = Scene::parse("block.toml", include_str!("../../data/scenes/block.toml"), &set)?;
/// let mut keep = Keep::default();
/// let whole = Run::new(&scene)?.solve(&mut keep)?;
///
/// let checkpoint = Checkpoint::from_bytes(&keep.0)?;
/// let rest = Run::new(&scene)?.from(checkpoint).solve(&mut ())?;
/// assert_eq!(rest.increments.len(), 2); // the third and the fourth
/// assert_eq!(rest.boundaries, whole.boundaries); // to the last bit
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    increments: usize,
    time: f64,
    parts: Result<Vec<Vec<u8>>, CheckpointError>,
}

/// The reason why a checkpoint cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes are incomplete or changed, or another version of this format.
    #[error("the checkpoint is damaged, or another version of stickslip wrote it")]
    Damaged,
    /// A part of the checkpoint cannot be serialised.
    #[error("the checkpoint cannot be written: {why}")]
    Unwritable {
        /// The message of the serialiser.
        why: String,
    },
    /// The checkpoint belongs to another problem, method or history.
    #[error("the checkpoint is that of another run: {what} differs")]
    Other {
        /// The property that differs.
        what: &'static str,
    },
}

impl Checkpoint {
    /// Creates a checkpoint after `increments` increments, at `time` (s), with the `part` of the history.
    pub fn new<T: Serialize>(increments: usize, time: f64, part: &T) -> Self {
        Checkpoint { increments, time, parts: Ok(Vec::new()) }.with(part)
    }

    /// Adds one more part to the checkpoint.
    #[must_use]
    pub fn with<T: Serialize>(mut self, part: &T) -> Self {
        match (&mut self.parts, rmp_serde::to_vec_named(part)) {
            (Ok(parts), Ok(part)) => parts.push(part),
            (Ok(_), Err(error)) => self.parts = Err(CheckpointError::Unwritable { why: error.to_string() }),
            (Err(_), _) => {}
        }
        self
    }

    /// Reads part `k`.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`] if there is no such part, or if it is not a `T`; the stored error if serialising
    /// failed.
    pub fn part<T: DeserializeOwned>(&self, k: usize) -> Result<T, CheckpointError> {
        let parts = self.parts.as_ref().map_err(Clone::clone)?;
        let part = parts.get(k).ok_or(CheckpointError::Damaged)?;
        rmp_serde::from_slice(part).map_err(|_| CheckpointError::Damaged)
    }

    /// Returns the number of completed increments.
    pub fn increments(&self) -> usize {
        self.increments
    }

    /// Returns the end time of the last completed increment, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Serialises the whole checkpoint, with a checksum.
    ///
    /// # Errors
    /// [`CheckpointError::Unwritable`] if a part of it cannot be written.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CheckpointError> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend((self.increments as u64).to_le_bytes());
        bytes.extend(self.time.to_le_bytes());
        for part in self.parts.as_ref().map_err(Clone::clone)? {
            bytes.extend((part.len() as u64).to_le_bytes());
            bytes.extend(part);
        }
        let sum = crc32fast::hash(&bytes);
        bytes.extend(sum.to_le_bytes());
        Ok(bytes)
    }

    /// Reads a checkpoint from `bytes`.
    ///
    /// # Errors
    /// [`CheckpointError::Damaged`] unless [`Checkpoint::to_bytes`] of this version wrote the bytes.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Self::read(bytes).ok_or(CheckpointError::Damaged)
    }

    fn read(bytes: &[u8]) -> Option<Self> {
        let (content, sum) = bytes.split_last_chunk::<4>()?;
        if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
            return None;
        }
        let (increments, rest) = content.strip_prefix(MAGIC)?.split_first_chunk::<8>()?;
        let (time, mut rest) = rest.split_first_chunk::<8>()?;
        let mut parts = Vec::new();
        while !rest.is_empty() {
            let (length, more) = rest.split_first_chunk::<8>()?;
            let (part, more) = more.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            parts.push(part.to_vec());
            rest = more;
        }
        let increments = usize::try_from(u64::from_le_bytes(*increments)).ok()?;
        Some(Checkpoint { increments, time: f64::from_le_bytes(*time), parts: Ok(parts) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_cut_or_changed_anywhere_are_refused() {
        let checkpoint = Checkpoint::new(7, 0.5, &vec![1.0, f64::NAN, -0.0, f64::INFINITY]).with(&"another part");
        let bytes = checkpoint.to_bytes().unwrap();
        let again = Checkpoint::from_bytes(&bytes).unwrap();
        assert_eq!(again, checkpoint);
        assert_eq!((again.increments(), again.time()), (7, 0.5));
        let values: Vec<f64> = again.part(0).unwrap();
        assert_eq!(values.iter().map(|x| x.to_bits()).collect::<Vec<_>>()[2], (-0.0_f64).to_bits());
        assert!(values[1].is_nan() && values[3] == f64::INFINITY);
        for length in 0..bytes.len() {
            assert_eq!(Checkpoint::from_bytes(&bytes[..length]), Err(CheckpointError::Damaged));
            let mut changed = bytes.clone();
            changed[length] ^= 0x10;
            assert_eq!(Checkpoint::from_bytes(&changed), Err(CheckpointError::Damaged));
        }
        assert_eq!(again.part::<Vec<f64>>(1), Err(CheckpointError::Damaged));
        assert_eq!(again.part::<Vec<f64>>(2), Err(CheckpointError::Damaged));
    }

    /// A type that the format cannot serialise.
    struct Unknown;

    impl Serialize for Unknown {
        fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
            Err(serde::ser::Error::custom("no format for this"))
        }
    }

    /// A part that cannot be serialised gives an error, not an empty part, at any place among the parts.
    #[test]
    fn what_cannot_be_written_is_an_error() {
        for checkpoint in [Checkpoint::new(1, 0.5, &Unknown).with(&1), Checkpoint::new(1, 0.5, &1).with(&Unknown)] {
            let error = checkpoint.to_bytes().unwrap_err();
            assert_eq!(error.to_string(), "the checkpoint cannot be written: no format for this");
            assert_eq!(checkpoint.part::<i32>(0), Err(error));
        }
    }
}
