//! The disk space predicted by `stickslip check`, compared with that of a run.

#![allow(clippy::unwrap_used)]

use std::fs;

use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip_output::bytes_on_disk;

use crate::program::{Folder, assert_exit, stdout, stickslip};

/// Returns the size of the files of a folder, bytes.
fn size(folder: &str) -> u64 {
    fs::read_dir(folder).unwrap().map(|file| file.unwrap().metadata().unwrap().len()).sum()
}

#[test]
fn the_disk_is_told_beforehand() {
    const BLOCK: &str = include_str!("../../../../data/scenes/block.toml");
    const CUBE: &str = include_str!("../../../../data/scenes/cube.toml");
    let cases: [(&str, &[&str]); 4] = [
        (BLOCK, &["mesh.elements=[2,2]", "time.increments=2000", "output.times=[]"]),
        (BLOCK, &["mesh.elements=[40,40]", "time.increments=4", "output.times=\"all\"", "output.fields=true"]),
        (CUBE, &["mesh.elements=[8,8,8]", "time.increments=3", "output.times=\"all\"", "output.fields=true"]),
        (CUBE, &["mesh.elements=[8,8,8]", "time.increments=3", "output.times=\"all\"", "output.deformed=true"]),
    ];
    for (text, set) in cases {
        let (folder, path) = Folder::with_scene(text);
        let overrides: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let out = folder.join("out");
        assert_exit(&stickslip(&[&["run", &path, "--setting", "default", "--out", &out], &overrides[..]].concat()), 0);
        let scene =
            Scene::read(path.as_ref(), &set.iter().map(|set| set.parse().unwrap()).collect::<Vec<_>>()).unwrap();
        let (estimated, used) = (bytes_on_disk(&scene, &discretise(&scene).unwrap()) as f64, size(&out) as f64);
        assert!(used < 1.2 * estimated && estimated < 4.0 * used, "{set:?}: {estimated} bytes told, {used} taken");
        let check = stickslip(&[&["check", &path], &overrides[..]].concat());
        assert!(stdout(&check).contains("\ndisk         about "), "{}", stdout(&check));
    }
}
