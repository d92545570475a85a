//! Datasets in chunks, each of which may be compressed, as general tools write them.

use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

use super::Hdf5Error;
use super::bytes::Bytes;

/// Levels that a tree of chunks may have.
const LEVELS: u8 = 8;

/// A byte of deflated data stands for at most so many.
const EXPANSION: usize = 1032;

/// What is done to chunks, in the order of writing.
#[derive(Debug, Default)]
pub(super) struct Filters(Vec<usize>);

const DEFLATE: usize = 1;
const SHUFFLE: usize = 2;
/// Four bytes at the end of a chunk, which are left out.
const CHECKSUM: usize = 3;

impl Filters {
    pub(super) fn read(mut body: Bytes<'_>) -> Result<Self, Hdf5Error> {
        let version = body.u8()?;
        let count = body.u8()?;
        if version == 1 {
            body.skip(6)?;
        }
        let mut filters = Vec::new();
        for _ in 0..count {
            let filter = body.u16()?;
            let name = if version == 1 || filter >= 256 { body.u16()? } else { 0 };
            body.skip(2)?;
            let values = body.u16()?;
            let padding = if version == 1 { 4 * (values % 2) } else { 0 };
            body.skip(name + 4 * values + padding)?;
            if ![DEFLATE, SHUFFLE, CHECKSUM].contains(&filter) {
                return Err(Hdf5Error::Unsupported { what: format!("a dataset with the filter {filter}") });
            }
            filters.push(filter);
        }
        Ok(Filters(filters))
    }

    /// What a chunk of `length` bytes was, before the filters that `mask` does not leave out.
    fn undo(
        &self,
        stored: &[u8],
        mask: u64,
        length: usize,
        size: usize,
        here: &Bytes<'_>,
    ) -> Result<Vec<u8>, Hdf5Error> {
        let wrong = || here.damaged("a chunk is not as long as it should be");
        // Nothing is reserved for what the bytes cannot hold.
        if length > stored.len().saturating_mul(EXPANSION) {
            return Err(wrong());
        }
        let mut chunk = stored.to_vec();
        for (k, filter) in self.0.iter().enumerate().rev() {
            match *filter {
                _ if mask >> k & 1 == 1 => {}
                DEFLATE => {
                    let most = length.saturating_add(4);
                    chunk = decompress_to_vec_zlib_with_limit(&chunk, most).map_err(|_| wrong())?;
                }
                SHUFFLE => chunk = unshuffled(&chunk, size),
                _ => chunk.truncate(chunk.len().saturating_sub(4)),
            }
        }
        if chunk.len() == length { Ok(chunk) } else { Err(wrong()) }
    }
}

/// The bytes of elements that were stored first bytes first.
fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size;
    let whole = (0..count).flat_map(|k| (0..size).map(move |b| bytes[b * count + k]));
    whole.chain(bytes[count * size..].iter().copied()).collect()
}

/// The `length` bytes of a dataset of one dimension, elements of `size` bytes, whose layout goes on in `layout`.
pub(super) fn chunked(
    file: Bytes<'_>,
    mut layout: Bytes<'_>,
    filters: &Filters,
    length: usize,
    size: usize,
) -> Result<Vec<u8>, Hdf5Error> {
    if layout.u8()? != 2 {
        return Err(Hdf5Error::Unsupported { what: "a dataset of several dimensions in chunks".to_string() });
    }
    let tree = layout.offset()?;
    let elements = layout.u32()?;
    let chunk = elements.saturating_mul(size);
    if chunk == 0 || layout.u32()? != size {
        return Err(layout.damaged("the chunks of a dataset have no size"));
    }
    let mut found = Vec::new();
    if length > 0 {
        if layout.is_undefined(tree) {
            return Err(Hdf5Error::NotWritten);
        }
        collect(file, tree, LEVELS, &mut found)?;
    }
    found.sort_by_key(|stored| stored.first);
    let mut bytes = Vec::new();
    for (k, Stored { first, mask, bytes: stored, here }) in found.iter().enumerate() {
        if *first != (k as u64).saturating_mul(elements as u64) {
            return Err(here.damaged("a chunk of a dataset is missing"));
        }
        bytes.extend(filters.undo(stored, *mask, chunk, size, here)?);
    }
    if bytes.len() < length {
        return Err(layout.damaged("a dataset has fewer values than its size says"));
    }
    bytes.truncate(length);
    Ok(bytes)
}

/// A chunk as it stands in the file.
struct Stored<'a> {
    /// Its first element.
    first: u64,
    mask: u64,
    bytes: &'a [u8],
    here: Bytes<'a>,
}

fn collect<'a>(file: Bytes<'a>, address: u64, levels: u8, found: &mut Vec<Stored<'a>>) -> Result<(), Hdf5Error> {
    let mut node = file.at(address)?;
    node.expect(b"TREE", "a tree of chunks is missing")?;
    let kind = node.u8()?;
    let level = node.u8()?;
    if kind != 1 || level >= levels {
        return Err(node.damaged("a tree is not one of chunks"));
    }
    let count = node.u16()?;
    node.offset()?;
    node.offset()?;
    for _ in 0..count {
        let (stored, mask, first) = (node.u32()?, node.number(4)?, node.number(8)?);
        node.skip(8)?;
        let child = node.offset()?;
        if level > 0 {
            collect(file, child, level, found)?;
            continue;
        }
        let here = file.at(child)?;
        let bytes = file.at(child)?.take(stored)?;
        // Chunks do not overlap, and each has a byte at least.
        if found.len() >= file.file_length() {
            return Err(node.damaged("a dataset has chunks for ever"));
        }
        found.push(Stored { first, mask, bytes, here });
    }
    Ok(())
}
