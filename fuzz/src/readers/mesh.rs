//! Meshes from files: what is taken is sound in every respect that a mesh in memory is asked for.

use stickslip::body::mesh::{MeshFormat, MeshSource};

use super::{changed, told};
use crate::corpus::Corpus;
use crate::pool::Verdict;
use crate::random::Random;

pub(super) fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.meshes, &[])
}

pub(super) fn check(bytes: &[u8]) -> Verdict {
    let format = match bytes.trim_ascii_start() {
        [b'$', ..] => MeshFormat::Gmsh,
        [b'-', ..] => MeshFormat::Unv,
        _ => MeshFormat::Abaqus,
    };
    match format.parse("fuzz.msh", bytes, 1e-3) {
        Err(error) => told(&error),
        Ok(mesh) => match MeshSource::from(mesh).check() {
            Ok(()) => Ok("read"),
            Err(fault) => Err(format!("what was read is not sound: {fault}")),
        },
    }
}
