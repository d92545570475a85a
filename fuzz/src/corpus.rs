//! What stands in the tree to begin with: scenes, meshes, tables, and what was found on the way.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use stickslip::run::Run;
use stickslip::scene::{Scene, schema};

/// The folder of scenes whose names of files are meant from here.
pub fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/scenes")
}

/// The folder of what was found, by target.
pub fn found(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

/// Texts to begin with.
#[derive(Debug, Default)]
pub struct Corpus {
    /// Scenes, in TOML.
    pub scenes: Vec<Vec<u8>>,
    /// Meshes of Gmsh, text and binary.
    pub gmsh: Vec<Vec<u8>>,
    /// Input files of Abaqus and CalculiX.
    pub abaqus: Vec<Vec<u8>>,
    /// Universal files.
    pub unv: Vec<Vec<u8>>,
    /// Tables of gaps.
    pub tables: Vec<Vec<u8>>,
    /// STL files.
    pub surfaces: Vec<Vec<u8>>,
    /// FCLIB files.
    pub hdf5: Vec<Vec<u8>>,
    /// Friction problems in Siconos' texts.
    pub siconos: Vec<Vec<u8>>,
    /// Reports of runs.
    pub results: Vec<Vec<u8>>,
    /// The words of the schema of scenes.
    pub words: Vec<String>,
}

/// A scene whose report is one of the results to begin with.
const RUN: &str = "[mesh]\nkind = 'block'\nsize = [1, 1]\nelements = [2, 2]\n[material]\nyoung = 1e9\npoisson = 0.3\n\
    [[support]]\nboundary = 'left'\nfix = ['x', 'y']\n[[contact]]\nboundary = 'bottom'\nfriction = 0.3\nobstacle.kind = 'plane'\n\
    [[load]]\nboundary = 'top'\npressure = 1e4\n[time]\nend = 1\nincrements = 2\n";

/// The files of a folder, in the order of their names; none where there is no such folder.
pub fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    paths.sort();
    paths.into_iter().filter_map(|path| Some((path.clone(), fs::read(path).ok()?))).collect()
}

fn texts(folders: &[PathBuf], most: usize) -> Vec<Vec<u8>> {
    let all = folders.iter().flat_map(|folder| files(folder)).map(|(_, text)| text);
    all.filter(|text| text.len() <= most).collect()
}

/// Those that begin with one of these `heads`: a folder has files of several kinds.
fn beginning(files: Vec<Vec<u8>>, heads: &[&[u8]]) -> Vec<Vec<u8>> {
    files.into_iter().filter(|file| heads.iter().any(|head| file.starts_with(head))).collect()
}

fn words() -> Vec<String> {
    let schema = schema().to_string();
    let quoted = schema.split('"').skip(1).step_by(2);
    let word = |text: &&str| text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-".contains(&byte));
    quoted.filter(word).map(str::to_string).collect::<BTreeSet<_>>().into_iter().collect()
}

fn report() -> Option<Vec<u8>> {
    let scene = Scene::parse("fuzz.toml", RUN, &[]).ok()?;
    let report = Run::new(&scene).ok()?.solve(&mut ()).ok()?;
    serde_json::to_vec_pretty(&report).ok()
}

/// All of it, read once.
pub fn corpus() -> &'static Corpus {
    static CORPUS: OnceLock<Corpus> = OnceLock::new();
    CORPUS.get_or_init(|| {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
        let of = |target: &str, others: &[&str], most: usize| {
            let others = others.iter().map(|folder| data.join(folder));
            texts(&others.chain([found(target)]).collect::<Vec<_>>(), most)
        };
        Corpus {
            hdf5: beginning(of("fclib", &["problems"], 20_000), &[b"\x89HDF"]),
            siconos: beginning(of("siconos", &["problems"], 20_000), &[b"2\n", b"3\n"]),
            scenes: of("scene", &["scenes"], 4000),
            gmsh: beginning(of("gmsh", &["meshes", "meshes/formats"], 10_000), &[b"$"]),
            abaqus: beginning(of("abaqus", &["../doc/howto/abaqus"], 10_000), &[b"*"]),
            unv: beginning(of("unv", &["meshes/formats"], 20_000), &[b"    -1"]),
            tables: of("table", &[], 4000),
            surfaces: of("surface", &[], 4000),
            results: texts(&[found("results")], 20_000).into_iter().chain(report()).collect(),
            words: words(),
        }
    })
}
