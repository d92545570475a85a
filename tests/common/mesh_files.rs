//! Writers of mesh files in all formats that are read, for comparisons.

use std::fmt::Write as _;

use stickslip::body::mesh::{Cell, CellKind, Mesh};

/// Elements of one type and one group: the dimension, the type of Gmsh, the name of the group, the nodes of each.
pub struct Block {
    pub dimension: usize,
    pub kind: i32,
    pub group: String,
    pub elements: Vec<Vec<usize>>,
}

pub fn gmsh_type(kind: CellKind) -> i32 {
    match kind {
        CellKind::Triangle => 2,
        CellKind::Quadrilateral => 3,
        CellKind::Tetrahedron => 4,
        CellKind::Hexahedron => 5,
        CellKind::Prism => 6,
        CellKind::Triangle6 => 9,
        CellKind::Tetrahedron10 => 11,
        CellKind::Quadrilateral8 => 16,
        CellKind::Quadrilateral9 => 10,
        CellKind::Hexahedron20 => 17,
        CellKind::Prism15 => 18,
    }
}

/// The nodes of a facet: first the corners, then the others.
fn corners_first(quadratic: bool, facet: &[usize]) -> Vec<usize> {
    let (first, step) = if quadratic { (facet.len().div_ceil(2), 2) } else { (facet.len(), 1) };
    let corners = facet.iter().step_by(step).take(first).copied();
    corners.chain(facet.iter().skip(1).step_by(2).take(facet.len() - first).copied()).collect()
}

/// The nodes of a cell in the order of Gmsh: the last two nodes of a tetrahedron of second order are in the other order,
/// the edges of hexahedra and prisms in that of their first corner, then of their second.
pub fn in_gmsh_order(kind: CellKind, nodes: &[usize]) -> Vec<usize> {
    let places: &[usize] = match kind {
        CellKind::Tetrahedron10 => &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
        CellKind::Hexahedron20 => &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14],
        CellKind::Prism15 => &[0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10],
        _ => return nodes.to_vec(),
    };
    places.iter().map(|&k| nodes[k]).collect()
}

/// The facets of the boundaries and the cells, in the order of the mesh.
pub fn blocks(mesh: &Mesh) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut add = |dimension: usize, kind: i32, group: &str, nodes: Vec<usize>| match blocks.last_mut() {
        Some(last) if (last.dimension, last.kind, last.group.as_str()) == (dimension, kind, group) => {
            last.elements.push(nodes);
        }
        _ => blocks.push(Block { dimension, kind, group: group.to_string(), elements: vec![nodes] }),
    };
    let quadratic = mesh.cells[0].kind.is_quadratic();
    for boundary in &mesh.boundaries {
        for facet in &boundary.facets {
            let kind = match (mesh.dimension, facet.len()) {
                (2, 2) => 1,
                (2, _) => 8,
                (_, 3) => 2,
                (_, 4) => 3,
                (_, 6) => 9,
                _ => 16,
            };
            add(mesh.dimension - 1, kind, &boundary.name, corners_first(quadratic, facet));
        }
    }
    for Cell { kind, nodes, group } in &mesh.cells {
        add(mesh.dimension, gmsh_type(*kind), &mesh.groups[*group], in_gmsh_order(*kind, nodes));
    }
    blocks
}

/// The versions of Gmsh's format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Msh {
    Text22,
    Binary22,
    Text40,
    Text41,
    Binary41,
}

impl Msh {
    pub const ALL: [Msh; 5] = [Msh::Text22, Msh::Binary22, Msh::Text40, Msh::Text41, Msh::Binary41];

    fn version(self) -> &'static str {
        match self {
            Msh::Text22 => "2.2 0 8\n",
            Msh::Binary22 => "2.2 1 8\n\u{1}\0\0\0\n",
            Msh::Text40 => "4 0 8\n",
            Msh::Text41 => "4.1 0 8\n",
            Msh::Binary41 => "4.1 1 8\n\u{1}\0\0\0\n",
        }
    }
}

/// A file that is written: words of a text, or bytes.
struct File {
    bytes: Vec<u8>,
    binary: bool,
}

impl File {
    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn put(&mut self, word: &str, bytes: &[u8]) {
        if self.binary {
            self.bytes.extend(bytes);
        } else {
            self.text(&format!("{word} "));
        }
    }

    fn ints(&mut self, values: &[i32]) {
        for value in values {
            self.put(&value.to_string(), &value.to_le_bytes());
        }
    }

    fn sizes(&mut self, values: &[usize]) {
        for value in values {
            self.put(&value.to_string(), &(*value as u64).to_le_bytes());
        }
    }

    fn doubles(&mut self, values: &[f64]) {
        for value in values {
            self.put(&format!("{value:?}"), &value.to_le_bytes());
        }
    }

    fn line(&mut self) {
        if !self.binary {
            self.text("\n");
        }
    }
}

/// Writes a mesh in a version of Gmsh's format. The number of a node is its index and 1.
pub fn msh(mesh: &Mesh, version: Msh) -> Vec<u8> {
    let blocks = blocks(mesh);
    let mut file = File { bytes: Vec::new(), binary: matches!(version, Msh::Binary22 | Msh::Binary41) };
    file.text(&format!("$MeshFormat\n{}$EndMeshFormat\n", version.version()));
    let mut names: Vec<(usize, &str)> = Vec::new();
    for block in &blocks {
        if !block.group.is_empty() && !names.contains(&(block.dimension, &block.group)) {
            names.push((block.dimension, &block.group));
        }
    }
    // The number of a group; 0 without one.
    let tag = |block: &Block| {
        names.iter().position(|name| *name == (block.dimension, block.group.as_str())).map_or(0, |k| k as i32 + 1)
    };
    file.text(&format!("$PhysicalNames\n{}\n", names.len()));
    for (k, (dimension, name)) in names.iter().enumerate() {
        file.text(&format!("{dimension} {} \"{name}\"\n", k + 1));
    }
    file.text("$EndPhysicalNames\n");
    let all: usize = blocks.iter().map(|block| block.elements.len()).sum();
    let n = mesh.nodes.len();
    if matches!(version, Msh::Text22 | Msh::Binary22) {
        tagged(&mut file, mesh, &blocks, &tag);
        return file.bytes;
    }
    let old = version == Msh::Text40;
    file.text("$Entities\n");
    file.sizes(&[0, 1, 2, 3].map(|d| blocks.iter().filter(|block| block.dimension == d).count()));
    file.line();
    for dimension in 0..4 {
        for (k, block) in blocks.iter().enumerate().filter(|(_, block)| block.dimension == dimension) {
            file.ints(&[k as i32 + 1]);
            file.doubles(&[0.0; 6]);
            let groups = [tag(block)];
            let groups = if groups == [0] { &[] } else { &groups[..] };
            file.sizes(&[groups.len()]);
            file.ints(groups);
            file.sizes(&[2]);
            file.ints(&[7, -8]);
            file.line();
        }
    }
    file.text("\n$EndEntities\n$Nodes\n");
    let d = mesh.dimension as i32;
    if old {
        file.text(&format!("1 {n}\n1 {d} 0 {n}\n"));
        for (k, x) in mesh.nodes.iter().enumerate() {
            file.ints(&[k as i32 + 1]);
            file.doubles(x);
            file.line();
        }
    } else {
        file.sizes(&[1, n, 1, n]);
        file.line();
        file.ints(&[d, 1, 0]);
        file.sizes(&[n]);
        file.line();
        for k in 0..n {
            file.sizes(&[k + 1]);
            file.line();
        }
        for x in &mesh.nodes {
            file.doubles(x);
            file.line();
        }
    }
    file.text("\n$EndNodes\n$Elements\n");
    file.sizes(&[blocks.len(), all, 1, all][..if old { 2 } else { 4 }]);
    file.line();
    let mut number = 0;
    for (k, block) in blocks.iter().enumerate() {
        let entity = [block.dimension as i32, k as i32 + 1];
        file.ints(&if old { [entity[1], entity[0]] } else { entity });
        file.ints(&[block.kind]);
        file.sizes(&[block.elements.len()]);
        file.line();
        for nodes in &block.elements {
            number += 1;
            file.sizes(&[number]);
            file.sizes(&nodes.iter().map(|node| node + 1).collect::<Vec<_>>());
            file.line();
        }
    }
    file.text("\n$EndElements\n");
    file.bytes
}

/// Writes nodes and elements of MSH 2.2, whose tags are the number of the group and that of the block.
fn tagged(file: &mut File, mesh: &Mesh, blocks: &[Block], tag: &dyn Fn(&Block) -> i32) {
    file.text(&format!("$Nodes\n{}\n", mesh.nodes.len()));
    for (k, x) in mesh.nodes.iter().enumerate() {
        file.ints(&[k as i32 + 1]);
        file.doubles(x);
        file.line();
    }
    let all: usize = blocks.iter().map(|block| block.elements.len()).sum();
    file.text(&format!("\n$EndNodes\n$Elements\n{all}\n"));
    let mut number = 0;
    for (k, block) in blocks.iter().enumerate() {
        if file.binary {
            file.ints(&[block.kind, block.elements.len() as i32, 2]);
        }
        for nodes in &block.elements {
            number += 1;
            file.ints(&[number]);
            if !file.binary {
                file.ints(&[block.kind, 2]);
            }
            file.ints(&[tag(block), k as i32 + 1]);
            file.ints(&nodes.iter().map(|node| *node as i32 + 1).collect::<Vec<_>>());
            file.line();
        }
    }
    file.text("\n$EndElements\n");
}

/// Writes a mesh as an input file of Abaqus, with boundaries by the sides S1, S2, ... of their elements.
pub fn inp(mesh: &Mesh) -> String {
    let mut text = "*HEADING\nwritten by a test\n*NODE, NSET=Nall\n".to_string();
    for (k, [x, y, z]) in mesh.nodes.iter().enumerate() {
        writeln!(text, "{}, {x:?}, {y:?}, {z:?}", k + 1).unwrap();
    }
    for (e, Cell { kind, nodes, group }) in mesh.cells.iter().enumerate() {
        let kind = match kind {
            CellKind::Triangle => "CPS3",
            CellKind::Quadrilateral => "CPE4R",
            CellKind::Tetrahedron => "C3D4",
            CellKind::Hexahedron => "C3D8I",
            CellKind::Prism => "C3D6",
            CellKind::Triangle6 => "CAX6M",
            CellKind::Tetrahedron10 => "C3D10H",
            CellKind::Quadrilateral8 => "CPS8R",
            CellKind::Quadrilateral9 => panic!("Abaqus has none"),
            CellKind::Hexahedron20 => "C3D20R",
            CellKind::Prism15 => "C3D15",
        };
        let group = &mesh.groups[*group];
        let set = if group.is_empty() { String::new() } else { format!(", ELSET={group}") };
        let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
        writeln!(text, "*ELEMENT, TYPE={kind}{set}\n{}, {}", e + 1, nodes.join(", ")).unwrap();
    }
    for boundary in &mesh.boundaries {
        writeln!(text, "*SURFACE, NAME={}, TYPE=ELEMENT", boundary.name).unwrap();
        for facet in &boundary.facets {
            let (e, side) = side(mesh, facet);
            writeln!(text, "{}, S{side}", e + 1).unwrap();
        }
    }
    text
}

/// The corners of the sides S1, S2, ... in Abaqus's manual, from 1.
fn sides_of(kind: CellKind) -> &'static [&'static str] {
    match kind {
        CellKind::Triangle | CellKind::Triangle6 => &["12", "23", "31"],
        CellKind::Quadrilateral | CellKind::Quadrilateral8 | CellKind::Quadrilateral9 => &["12", "23", "34", "41"],
        CellKind::Tetrahedron | CellKind::Tetrahedron10 => &["123", "142", "243", "341"],
        CellKind::Hexahedron | CellKind::Hexahedron20 => &["1234", "5876", "1562", "2673", "3784", "4851"],
        CellKind::Prism | CellKind::Prism15 => &["123", "465", "1452", "2563", "3641"],
    }
}

/// The cell and the side that have all corners of a facet.
fn side(mesh: &Mesh, facet: &[usize]) -> (usize, usize) {
    let corners = |cell: &Cell, side: &str| -> Vec<usize> {
        side.bytes().map(|digit| cell.nodes[usize::from(digit - b'1')]).collect()
    };
    let found = mesh.cells.iter().enumerate().find_map(|(e, cell)| {
        let sides = sides_of(cell.kind);
        let k = sides.iter().position(|side| corners(cell, side).iter().all(|node| facet.contains(node)))?;
        Some((e, k + 1))
    });
    found.unwrap()
}

/// The finite element descriptor of a kind in a universal file.
fn descriptor(kind: CellKind) -> usize {
    match kind {
        CellKind::Triangle => 41,
        CellKind::Quadrilateral => 94,
        CellKind::Tetrahedron => 111,
        CellKind::Hexahedron => 115,
        CellKind::Prism => 112,
        CellKind::Triangle6 => 92,
        CellKind::Tetrahedron10 => 118,
        CellKind::Quadrilateral8 => 95,
        CellKind::Prism15 => 113,
        CellKind::Hexahedron20 => 116,
        CellKind::Quadrilateral9 => panic!("a universal file has no quadrilateral of nine nodes"),
    }
}

/// The order of the nodes of a kind in a universal file: those at the middles of edges are between the corners.
fn in_unv_order(kind: CellKind, nodes: &[usize]) -> Vec<usize> {
    let places: &[usize] = match kind {
        CellKind::Triangle6 => &[0, 3, 1, 4, 2, 5],
        CellKind::Quadrilateral8 => &[0, 4, 1, 5, 2, 6, 3, 7],
        CellKind::Prism15 => &[0, 6, 1, 7, 2, 8, 12, 13, 14, 3, 9, 4, 10, 5, 11],
        CellKind::Hexahedron20 => &[0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15],
        CellKind::Tetrahedron10 => &[0, 4, 1, 5, 2, 6, 7, 8, 9, 3],
        _ => return nodes.to_vec(),
    };
    places.iter().map(|&k| nodes[k]).collect()
}

/// Writes a mesh as a universal file, with boundaries as groups of edges or faces.
pub fn unv(mesh: &Mesh) -> String {
    let mut text = "    -1\n  2411\n".to_string();
    for (k, [x, y, z]) in mesh.nodes.iter().enumerate() {
        writeln!(text, "{:10}{:10}{:10}{:10}\n{}", k + 1, 1, 1, 11, fortran(&[*x, *y, *z])).unwrap();
    }
    text += "    -1\n    -1\n  2412\n";
    let (mut number, mut groups) = (0, Vec::<(String, Vec<usize>)>::new());
    let mut element = |descriptor: usize, nodes: &[usize], group: &str| {
        number += 1;
        writeln!(text, "{number:10}{descriptor:10}{:10}{:10}{:10}{:10}", 2, 1, 7, nodes.len()).unwrap();
        if matches!(descriptor, 11 | 22) {
            writeln!(text, "{:10}{:10}{:10}", 0, 1, 1).unwrap();
        }
        for row in nodes.chunks(8) {
            let row: Vec<String> = row.iter().map(|node| format!("{:10}", node + 1)).collect();
            writeln!(text, "{}", row.concat()).unwrap();
        }
        match groups.iter_mut().find(|(known, _)| known == group) {
            Some((_, members)) => members.push(number),
            None => groups.push((group.to_string(), vec![number])),
        }
    };
    for boundary in &mesh.boundaries {
        for facet in &boundary.facets {
            let descriptor = match (mesh.dimension, facet.len()) {
                (2, 2) => 11,
                (2, _) => 22,
                (_, 3) => 41,
                (_, 4) => 44,
                (_, 6) => 42,
                _ => 45,
            };
            element(descriptor, facet, &boundary.name);
        }
    }
    for Cell { kind, nodes, group } in &mesh.cells {
        element(descriptor(*kind), &in_unv_order(*kind, nodes), &mesh.groups[*group]);
    }
    text += "    -1\n    -1\n  2467\n";
    for (k, (name, members)) in groups.iter().filter(|(name, _)| !name.is_empty()).enumerate() {
        let zeros = format!("{:10}", 0).repeat(6);
        writeln!(text, "{:10}{zeros}{:10}\n{name}", k + 1, members.len()).unwrap();
        for row in members.chunks(2) {
            let row: Vec<String> = row.iter().map(|member| format!("{:10}{member:10}{:10}{:10}", 8, 0, 0)).collect();
            writeln!(text, "{}", row.concat()).unwrap();
        }
    }
    text + "    -1\n"
}

/// The numbers with exponents as Fortran writes them, with all digits.
fn fortran(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:25.17e}").replace('e', "D")).collect()
}
