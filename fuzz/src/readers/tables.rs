//! Tables of gaps, surfaces.

use std::fs;

use stickslip::body::GapTable;
use stickslip::run::discretise;
use stickslip::scene::Scene;

use super::{changed, said};
use crate::corpus::Corpus;
use crate::pool::Verdict;
use crate::random::Random;

pub(super) fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    changed(random, &corpus.tables, &[])
}

/// Between the points of a table the gap is between those at the points.
pub(super) fn check(bytes: &[u8]) -> Verdict {
    let text = String::from_utf8_lossy(bytes);
    let table = match GapTable::parse("fuzz.csv", &text) {
        Ok(table) => table,
        Err(error) => return said(&error),
    };
    let rows = text.lines().filter(|line| !line.trim().is_empty()).skip(1);
    let last = rows.filter_map(|line| line.rsplit(',').next()?.trim().parse::<f64>().ok());
    let (low, high) = last.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), gap| (low.min(gap), high.max(gap)));
    let slack = 1e-12 * low.abs().max(high.abs());
    for k in 0..32_u64 {
        let mut random = Random::new("table", k);
        let x = [0; 3].map(|_: i32| random.between(-1.5, 1.5) * random.decades(-3.0, 1.0));
        let gap = table.at(x);
        if gap < low - slack || gap > high + slack {
            return Err(format!("the gap at {x:?} is {gap}, not within {low} to {high}"));
        }
    }
    Ok("read")
}

pub(super) fn make_surface(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let texts: Vec<Vec<u8>> = corpus.surfaces.iter().chain(corpus.gmsh.first()).cloned().collect();
    changed(random, &texts, &[])
}

const IN_FRONT: &str = "[mesh]\nkind = 'block'\nsize = [1, 1, 1]\nelements = [1, 1, 1]\n[material]\nyoung = 1e9\npoisson = 0.3\n\
    [[support]]\nboundary = 'top'\nfix = ['x', 'y', 'z']\n[[contact]]\nboundary = 'bottom'\nfriction = 0.3\n\
    [time]\nend = 1\nincrements = 1\n[[contact.obstacle]]\nkind = 'surface'\n";

/// The only door to surfaces is a scene that names a file.
pub(super) fn check_surface(bytes: &[u8]) -> Verdict {
    let thread = format!("{:?}", std::thread::current().id());
    let number: String = thread.chars().filter(char::is_ascii_digit).collect();
    let path = std::env::temp_dir().join(format!("stickslip-fuzz-{}-{number}.stl", std::process::id()));
    fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
    let nearest = bytes.len().is_multiple_of(2);
    let text = format!(
        "{IN_FRONT}file = '{}'\ndirection = '{}'\n",
        path.display(),
        if nearest { "nearest" } else { "normal" }
    );
    let verdict = match Scene::parse("surface.toml", &text, &[]) {
        Err(error) => said(&error),
        Ok(scene) => discretise(&scene).map_or_else(|error| said(&error), |_| Ok("discretised")),
    };
    let _ = fs::remove_file(&path);
    verdict
}
