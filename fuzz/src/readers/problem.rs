//! Exchange files: FCLIB in HDF5, Siconos' texts. What is taken is written and read again to the last bit.

use stickslip_exchange::{Problem, ProblemFile};

use super::{changed, said};
use crate::corpus::Corpus;
use crate::pool::Verdict;
use crate::random::Random;

pub(super) fn make_fclib(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut bytes = changed(random, &corpus.hdf5, &[]);
    // Numbers in headers, which changes of texts rarely reach.
    for _ in 0..random.below(4) {
        let at = random.below(bytes.len().max(8) - 7);
        let value = [0, 1, 2, 0x7fff_ffff, 0xffff_ffff, u64::MAX, random.below(1 << 20) as u64][random.below(7)];
        let size = [1, 2, 4, 8][random.below(4)];
        let end = (at + size).min(bytes.len());
        if at < end {
            bytes[at..end].copy_from_slice(&value.to_le_bytes()[..end - at]);
        }
    }
    bytes
}

pub(super) fn make_siconos(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.siconos, &[])
}

pub(super) fn check(bytes: &[u8]) -> Verdict {
    let file = match ProblemFile::from_bytes("fuzz", bytes) {
        Ok(file) => file,
        Err(error) if error.help().is_empty() => return Err(format!("an error without help: {error}")),
        Err(error) => return said(&error),
    };
    let written = file.to_fclib().map_err(|error| format!("not written: {error}"))?;
    let again = ProblemFile::from_bytes("again", &written).map_err(|error| format!("not read again: {error}"))?;
    let same = match (&file.problem, &again.problem) {
        (Problem::Local(a), Problem::Local(b)) => {
            a.q() == b.q() && a.mu() == b.mu() && a.delassus().values() == b.delassus().values()
        }
        (Problem::Global(a), Problem::Global(b)) => {
            a.f() == b.f() && a.w() == b.w() && a.mu() == b.mu() && a.h().values() == b.h().values()
        }
        _ => false,
    };
    if same { Ok("read") } else { Err("read again, it is another problem".to_string()) }
}
