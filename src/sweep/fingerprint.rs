//! What a result belongs to: the scene to the last letter, the files that it names, and the program.

use std::io;
use std::path::PathBuf;

use crate::input;
use crate::scene::Scene;

/// The offset and the prime of the hash FNV-1a of 128 bits.
const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

/// 32 hexadecimal digits that change with the text of `scene`, with the content of any file that it names, and with the
/// `program`.
///
/// # Errors
/// The file that cannot be read, and why.
pub fn fingerprint(scene: &Scene, program: &str) -> Result<String, (PathBuf, io::Error)> {
    let mut hash = OFFSET;
    // Lengths stand before what they are of, so that no two lists run into the same.
    let mut take = |bytes: &[u8]| {
        for &byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    };
    take(program.as_bytes());
    take(scene.text().as_bytes());
    for file in scene.files() {
        take(&input::bytes(&file).map_err(|error| (file, error))?);
    }
    Ok(format!("{hash:032x}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "mesh = { kind = 'gmsh', file = 'bar.msh' }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'left', fix = ['x', 'y'] }]
        time = { end = 1, increments = 1 }";

    #[test]
    fn it_changes_with_all_that_it_is_of() {
        let folder = std::env::temp_dir().join(format!("stickslip-fingerprint-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = folder.join("scene.toml").display().to_string();
        let of = |text: &str, program: &str| fingerprint(&Scene::parse(&name, text, &[]).unwrap(), program).unwrap();
        let mesh = |content: &str| std::fs::write(folder.join("bar.msh"), content).unwrap();
        mesh("one");
        let first = of(TEXT, "0.1");
        assert_eq!((of(TEXT, "0.1"), first.len()), (first.clone(), 32));
        assert_ne!(of(&TEXT.replace("0.3", "0.2"), "0.1"), first);
        assert_ne!(of(TEXT, "0.2"), first);
        mesh("two");
        assert_ne!(of(TEXT, "0.1"), first);
        mesh("one");
        assert_eq!(of(TEXT, "0.1"), first);
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(fingerprint(&Scene::parse(&name, TEXT, &[]).unwrap(), "0.1").unwrap_err().0, folder.join("bar.msh"));
    }
}
