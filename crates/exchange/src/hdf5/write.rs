//! Writes the oldest layout of HDF5: superblock of version 0, groups with symbol tables, contiguous datasets.

use super::SIGNATURE;

/// Half of the capacity of a leaf of a group, in names.
const HALF_A_LEAF: usize = 8;
/// Half of the capacity of the tree of a group, in leaves.
const HALF_A_TREE: usize = 16;
/// The largest number of names in a group.
const NAMES: usize = 2 * HALF_A_LEAF;
/// The length of the superblock.
const SUPERBLOCK: usize = 96;
/// The undefined address.
const NONE: u64 = u64::MAX;

/// A group or a dataset to write.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    /// At most 16 names with their objects.
    Group(Vec<(String, Node)>),
    /// 32-bit integers.
    Integers(Vec<i32>),
    /// Double precision.
    Numbers(Vec<f64>),
    /// A text.
    Text(String),
}

impl Node {
    /// Creates a group.
    pub(crate) fn group<const N: usize>(children: [(&str, Node); N]) -> Self {
        Node::Group(children.map(|(name, node)| (name.to_string(), node)).into())
    }
}

/// Returns the bytes of the file whose root group is `root`.
pub(crate) fn write(root: &Node) -> Vec<u8> {
    let mut file = vec![0; SUPERBLOCK];
    let (header, table) = object(&mut file, root);
    let [tree, heap] = table.unwrap_or([NONE; 2]);
    let mut head = SIGNATURE.to_vec();
    head.extend([0, 0, 0, 0, 0, 8, 8, 0]);
    put(&mut head, 2, &[HALF_A_LEAF as u64, HALF_A_TREE as u64]);
    put(&mut head, 4, &[0]);
    put(&mut head, 8, &[0, NONE, file.len() as u64, NONE]);
    // The root group: no name, its header, and a hint to its table.
    put(&mut head, 8, &[0, header, 1, tree, heap]);
    file[..SUPERBLOCK].copy_from_slice(&head);
    file
}

/// Appends `numbers` in `size` bytes each.
fn put(to: &mut Vec<u8>, size: usize, numbers: &[u64]) {
    for number in numbers {
        to.extend(&number.to_le_bytes()[..size]);
    }
}

fn align(to: &mut Vec<u8>) {
    to.resize(to.len().next_multiple_of(8), 0);
}

/// Appends an object. Returns its address, and the addresses of the tree and the names of a group.
fn object(file: &mut Vec<u8>, node: &Node) -> (u64, Option<[u64; 2]>) {
    match node {
        Node::Group(children) => {
            let table = table(file, children);
            let mut body = Vec::new();
            put(&mut body, 8, &table);
            (header(file, &[(0x11, body)]), Some(table))
        }
        Node::Integers(values) => {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            // Class 0, signed; four bytes, all 32 bits of them.
            let datatype = [&[0x10, 8, 0, 0, 4, 0, 0, 0][..], &[0, 0, 32, 0]].concat();
            (dataset(file, Some(values.len()), datatype, &bytes), None)
        }
        Node::Numbers(values) => {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            // Class 1, the sign in bit 63; eight bytes, the rest of IEEE 754.
            let datatype =
                [&[0x11, 0x20, 63, 0, 8, 0, 0, 0][..], &[0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0]].concat();
            (dataset(file, Some(values.len()), datatype, &bytes), None)
        }
        Node::Text(text) => {
            let bytes: Vec<u8> = text.bytes().filter(|byte| *byte != 0).chain([0]).collect();
            let mut datatype = vec![0x13, 0, 0, 0];
            put(&mut datatype, 4, &[bytes.len() as u64]);
            (dataset(file, None, datatype, &bytes), None)
        }
    }
}

/// Appends the children of a group, and the tables that refer to them.
fn table(file: &mut Vec<u8>, children: &[(String, Node)]) -> [u64; 2] {
    let mut children: Vec<&(String, Node)> = children.iter().take(NAMES).collect();
    children.sort_by(|a, b| a.0.as_bytes().cmp(b.0.as_bytes()));
    let objects: Vec<(u64, Option<[u64; 2]>)> = children.iter().map(|(_, node)| object(file, node)).collect();
    // The empty name comes first.
    let mut names = vec![0; 8];
    let mut offsets = Vec::new();
    for (name, _) in &children {
        offsets.push(names.len() as u64);
        names.extend(name.bytes().chain([0]));
        align(&mut names);
    }
    let heap = file.len() as u64;
    file.extend(b"HEAP\0\0\0\0");
    // There is no free block.
    put(file, 8, &[names.len() as u64, 1, heap + 32]);
    file.extend(&names);

    let leaf = file.len() as u64;
    file.extend(b"SNOD\x01\0");
    put(file, 2, &[children.len() as u64]);
    for (place, (address, table)) in offsets.iter().zip(&objects) {
        let [tree, heap] = table.unwrap_or_default();
        put(file, 8, &[*place, *address, u64::from(table.is_some()), tree, heap]);
    }
    file.resize(leaf as usize + 8 + 40 * NAMES, 0);

    let tree = file.len();
    file.extend(b"TREE\0\0");
    put(file, 2, &[u64::from(!children.is_empty())]);
    put(file, 8, &[NONE, NONE, 0, leaf, offsets.last().copied().unwrap_or(0)]);
    file.resize(tree + 24 + 8 * (4 * HALF_A_TREE + 1), 0);
    [tree as u64, heap]
}

/// Appends a dataset of one dimension, or of a single element.
fn dataset(file: &mut Vec<u8>, count: Option<usize>, datatype: Vec<u8>, bytes: &[u8]) -> u64 {
    let address = if bytes.is_empty() { NONE } else { file.len() as u64 };
    file.extend(bytes);
    align(file);
    let mut space = vec![1, u8::from(count.is_some()), 0, 0, 0, 0, 0, 0];
    if let Some(count) = count {
        put(&mut space, 8, &[count as u64]);
    }
    // Space is allocated when needed, and unwritten elements are zero.
    let fill = vec![2, 2, 2, 1, 0, 0, 0, 0];
    let mut layout = vec![3, 1];
    put(&mut layout, 8, &[address, bytes.len() as u64]);
    header(file, &[(0x01, space), (0x03, datatype), (0x05, fill), (0x08, layout)])
}

/// Appends an object header of version 1 with these messages.
fn header(file: &mut Vec<u8>, messages: &[(u64, Vec<u8>)]) -> u64 {
    let mut body = Vec::new();
    for (kind, message) in messages {
        put(&mut body, 2, &[*kind, message.len().next_multiple_of(8) as u64]);
        put(&mut body, 4, &[0]);
        body.extend(message);
        align(&mut body);
    }
    let address = file.len() as u64;
    put(file, 2, &[1, messages.len() as u64]);
    put(file, 4, &[1]);
    put(file, 8, &[body.len() as u64]);
    file.extend(body);
    address
}
