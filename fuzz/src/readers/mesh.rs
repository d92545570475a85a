//! Meshes from files: what is taken is sound in every respect that a mesh in memory is asked for.

use stickslip::body::mesh::{MeshFormat, MeshSource};

use super::{changed, check_diagnostic};
use crate::corpus::Corpus;
use crate::pool::Verdict;
use crate::random::Random;

pub(super) fn make_gmsh(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.gmsh, &[])
}

pub(super) fn make_abaqus(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.abaqus, &[])
}

pub(super) fn make_unv(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.unv, &[])
}

pub(super) fn check_gmsh(bytes: &[u8]) -> Verdict {
    check(MeshFormat::Gmsh, bytes)
}

pub(super) fn check_abaqus(bytes: &[u8]) -> Verdict {
    check(MeshFormat::Abaqus, bytes)
}

pub(super) fn check_unv(bytes: &[u8]) -> Verdict {
    check(MeshFormat::Unv, bytes)
}

fn check(format: MeshFormat, bytes: &[u8]) -> Verdict {
    match format.parse("fuzz.msh", bytes, 1e-3) {
        Err(error) => check_diagnostic(&error),
        Ok(mesh) => match MeshSource::from(mesh).check() {
            Ok(()) => Ok("read"),
            Err(fault) => Err(format!("what was read is not sound: {fault}")),
        },
    }
}
