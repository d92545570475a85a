//! Recognition of a file's kind from its first bytes, for error messages about unexpected files.

/// The kinds of files that are recognised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FileKind {
    /// A Gmsh mesh of any version.
    Gmsh,
    /// An Abaqus input file, which CalculiX also reads.
    Abaqus,
    /// The universal format of I-DEAS and Salome.
    Unv,
    /// Bulk data of Nastran.
    Nastran,
    Stl,
    /// A VTK file, with or without XML.
    Vtk,
    /// The text format of Medit, which FreeFEM and MMG write.
    Medit,
    Hdf5,
    Json,
    /// A geometry without a mesh.
    Step,
}

/// The number of bytes that are examined.
const HEAD: usize = 4096;

impl FileKind {
    /// Returns the kind of a file with these `bytes`, or `None` if it is not recognised.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"\x89HDF\r\n\x1a\n") {
            return Some(FileKind::Hdf5);
        }
        let triangles = bytes.get(80..84).map(|count| [0, 1, 2, 3].map(|k| count[k])).map(u32::from_le_bytes);
        if triangles.is_some_and(|count| bytes.len() as u64 == 84 + 50 * u64::from(count)) {
            return Some(FileKind::Stl);
        }
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
        let lines: Vec<&str> = head.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let first = *lines.first()?;
        let has_line = |starts: &[&str]| lines.iter().any(|line| starts.iter().any(|start| line.starts_with(start)));
        let keyword = lines.iter().find(|line| !line.starts_with("**")).and_then(|line| line.strip_prefix('*'));
        if ["$MeshFormat", "$Comments", "$NOD"].contains(&first) {
            Some(FileKind::Gmsh)
        } else if keyword.is_some_and(|word| word.starts_with(|c: char| c.is_ascii_alphabetic())) {
            Some(FileKind::Abaqus)
        } else if first == "-1" && lines.get(1).is_some_and(|line| line.parse::<u32>().is_ok()) {
            Some(FileKind::Unv)
        } else if first.starts_with("solid") && has_line(&["facet"]) {
            Some(FileKind::Stl)
        } else if first.starts_with("# vtk DataFile") || has_line(&["<VTKFile"]) {
            Some(FileKind::Vtk)
        } else if first.starts_with("MeshVersionFormatted") {
            Some(FileKind::Medit)
        } else if first.starts_with("ISO-10303-21") {
            Some(FileKind::Step)
        } else if first.starts_with('{') {
            Some(FileKind::Json)
        } else if has_line(&["BEGIN BULK", "CEND", "GRID,", "GRID "]) {
            Some(FileKind::Nastran)
        } else {
            None
        }
    }

    /// Returns a description of the kind.
    pub(crate) fn name(self) -> &'static str {
        match self {
            FileKind::Gmsh => "a mesh of Gmsh",
            FileKind::Abaqus => "an input of Abaqus or CalculiX",
            FileKind::Unv => "a mesh in the format UNV",
            FileKind::Nastran => "a mesh of Nastran",
            FileKind::Stl => "a surface in the format STL",
            FileKind::Vtk => "a file of VTK",
            FileKind::Medit => "a mesh in the format of Medit",
            FileKind::Hdf5 => "a file in the format HDF5",
            FileKind::Json => "a file in the format JSON",
            FileKind::Step => "a geometry in the format STEP",
        }
    }

    /// Returns advice for such a file where a scene is expected.
    pub(crate) fn as_scene(self) -> &'static str {
        match self {
            FileKind::Gmsh => {
                "write a scene, a TOML file that names this mesh under [mesh]; `stickslip init gmsh --out FOLDER` shows one"
            }
            FileKind::Stl => {
                "write a scene, a TOML file that names this file as an obstacle of the kind \"surface\"; `stickslip init block` shows one"
            }
            FileKind::Hdf5 => "a problem of FCLIB is solved by `stickslip solve FILE`",
            FileKind::Json => "a scene is a TOML file; `stickslip init block` shows one",
            FileKind::Abaqus => "write a scene, a TOML file that names this mesh under [mesh] with kind = \"abaqus\"",
            FileKind::Unv => "write a scene, a TOML file that names this mesh under [mesh] with kind = \"unv\"",
            FileKind::Nastran | FileKind::Vtk | FileKind::Medit | FileKind::Step => {
                "write a scene, a TOML file that names a mesh of Gmsh, Abaqus or CalculiX, or a UNV file; `stickslip init gmsh --out FOLDER` shows a scene with a mesh"
            }
        }
    }

    /// Returns advice for such a file where another format of meshes is expected.
    pub(crate) fn as_mesh(self) -> &'static str {
        match self {
            FileKind::Gmsh => "write kind = \"gmsh\" under [mesh]",
            FileKind::Nastran | FileKind::Vtk | FileKind::Medit => {
                "convert it: gmsh OLD -save -format msh41 -o NEW.msh; groups are lost, and doc/reference/scene/mesh.md shows under \"Other \
                 formats\" how to name boundaries by their coordinates"
            }
            FileKind::Abaqus => "write kind = \"abaqus\" under [mesh]",
            FileKind::Unv => "write kind = \"unv\" under [mesh]",
            FileKind::Step => {
                "a geometry has to be meshed: merge it in a .geo file with physical groups, then gmsh -3 PART.geo -format msh41"
            }
            FileKind::Stl => "a surface can be an obstacle of the kind \"surface\"; a body needs volume elements",
            FileKind::Hdf5 => {
                "convert a MED file with: gmsh OLD.med -save -format msh41 -o NEW.msh, or export it from Salome as UNV"
            }
            FileKind::Json => "export the mesh with: gmsh -2 part.geo -format msh41, in space -3",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::FileKind;

    #[test]
    fn files_are_known_by_their_first_bytes() {
        let mut binary = vec![b' '; 84 + 50];
        binary[80..84].copy_from_slice(&1_u32.to_le_bytes());
        let kinds: [(&[u8], FileKind); 17] = [
            (b"$MeshFormat\n2.2 0 8\n", FileKind::Gmsh),
            (b"$NOD\n3\n", FileKind::Gmsh),
            (b"** made by hand\n*HEADING\n", FileKind::Abaqus),
            (b"*Node, nset=all\n", FileKind::Abaqus),
            (b"    -1\n  2411\n", FileKind::Unv),
            (b"SOL 101\nCEND\nBEGIN BULK\n", FileKind::Nastran),
            (b"$ Created by Gmsh\nGRID,1,0,0.,0.,0.\n", FileKind::Nastran),
            (b"solid a\n facet normal 0 0 1\n", FileKind::Stl),
            (&binary, FileKind::Stl),
            (b"# vtk DataFile Version 3.0\n", FileKind::Vtk),
            (b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">\n", FileKind::Vtk),
            (b"MeshVersionFormatted 2\nDimension 3\n", FileKind::Medit),
            (b"\nMeshVersionFormatted\n1\n", FileKind::Medit),
            (b"\x89HDF\r\n\x1a\n", FileKind::Hdf5),
            (b"{ \"status\": \"converged\" }", FileKind::Json),
            (b"ISO-10303-21;\nHEADER;\n", FileKind::Step),
            (b"\n\n{", FileKind::Json),
        ];
        for (bytes, kind) in kinds {
            assert_eq!(FileKind::of(bytes), Some(kind), "{}", String::from_utf8_lossy(bytes));
        }
        for text in
            ["", "title = \"solid facet\"\n[mesh]\n", "# a comment\nyoung = 1", "2 1 0 2 2", "x,gap\n0,1\n", "solid a"]
        {
            assert_eq!(FileKind::of(text.as_bytes()), None, "{text}");
        }
    }
}
