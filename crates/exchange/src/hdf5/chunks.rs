//! Datasets in chunks, possibly compressed, as written by general tools.

use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

use super::Hdf5Error;
use super::bytes::Bytes;

/// The largest number of levels of a tree of chunks.
const LEVELS: u8 = 8;

/// The largest number of bytes that a byte of deflated data can expand to.
const EXPANSION: usize = 1032;

/// The filters of chunks, in the order of writing.
#[derive(Debug, Default)]
pub(super) struct Filters(Vec<usize>);

const DEFLATE: usize = 1;
const SHUFFLE: usize = 2;
/// A checksum of four bytes at the end of a chunk, which is ignored.
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

    /// Undoes the filters of a chunk of `length` bytes, except those excluded by `mask`.
    fn undo(
        &self,
        stored: &[u8],
        mask: u64,
        length: usize,
        size: usize,
        here: &Bytes<'_>,
    ) -> Result<Vec<u8>, Hdf5Error> {
        let wrong = || here.damaged("a chunk has a wrong length");
        // No memory is reserved for more than the bytes can contain.
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

/// Returns the bytes of elements that were stored by byte position, all first bytes first.
fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size;
    let whole = (0..count).flat_map(|k| (0..size).map(move |b| bytes[b * count + k]));
    whole.chain(bytes[count * size..].iter().copied()).collect()
}

/// Larger chunks are accepted only if the dataset, or the file, is of similar size. Chunks within the default cache of
/// HDF5 are at most this large.
const USUAL_CHUNK: usize = 1 << 20;
/// A dataset that may grow has chunks with room for up to this multiple of its content.
const ROOM_TO_GROW: usize = 16;

/// The storage of a dataset of one dimension.
pub(super) struct Chunks {
    tree: u64,
    /// The number of elements per chunk.
    elements: usize,
    /// The bytes per element.
    size: usize,
    filters: Filters,
}

impl Chunks {
    /// Returns the chunks of a dataset with elements of `size` bytes, whose layout continues in `layout`. `None` if no
    /// chunk was ever written.
    pub(super) fn read(mut layout: Bytes<'_>, filters: Filters, size: usize) -> Result<Option<Self>, Hdf5Error> {
        if layout.u8()? != 2 {
            return Err(Hdf5Error::Unsupported { what: "a dataset of several dimensions in chunks".to_string() });
        }
        let tree = layout.offset()?;
        let elements = layout.u32()?;
        if elements == 0 || layout.u32()? != size {
            return Err(layout.damaged("the chunks of a dataset have no size"));
        }
        Ok(if layout.is_undefined(tree) { None } else { Some(Chunks { tree, elements, size, filters }) })
    }

    /// Returns the bytes of the first `count` elements. Elements that were not written have the bytes `fill`.
    pub(super) fn bytes(&self, file: Bytes<'_>, count: usize, fill: &[u8]) -> Result<Vec<u8>, Hdf5Error> {
        let Chunks { tree, elements, size, .. } = *self;
        let (chunk, needed) = (elements.saturating_mul(size), count.saturating_mul(size));
        if needed == 0 {
            return Ok(Vec::new());
        }
        if chunk > needed.saturating_mul(ROOM_TO_GROW).max(file.file_length()).max(USUAL_CHUNK) {
            let what = format!("a dataset of {needed} bytes in chunks of {chunk} bytes");
            return Err(Hdf5Error::Unsupported { what });
        }
        let mut found = Vec::new();
        collect(file, tree, LEVELS, &mut found)?;
        found.sort_by_key(|stored| stored.first);
        let elements = elements as u64;
        if let Some(pair) = found.windows(2).find(|pair| pair[1].first - pair[0].first < elements) {
            return Err(pair[1].here.damaged("the chunks of a dataset overlap"));
        }
        if let Some(stored) = found.iter().find(|stored| stored.first % elements != 0) {
            return Err(stored.here.damaged("a chunk begins within another"));
        }
        let mut bytes = Vec::new();
        let firsts = (0..count as u64).step_by(elements as usize);
        for first in firsts {
            match found.binary_search_by_key(&first, |stored| stored.first) {
                Ok(k) => {
                    let Stored { mask, bytes: stored, here, .. } = &found[k];
                    bytes.extend(self.filters.undo(stored, *mask, chunk, size, here)?);
                }
                Err(_) => bytes.extend(fill.repeat(elements.min(count as u64 - first) as usize)),
            }
        }
        bytes.truncate(needed);
        Ok(bytes)
    }
}

/// A chunk as stored in the file.
struct Stored<'a> {
    /// The index of its first element.
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
        return Err(node.damaged("a tree contains no chunks"));
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
        // Chunks do not overlap, and each has at least one byte.
        if found.len() >= file.file_length() {
            return Err(node.damaged("a dataset has too many chunks"));
        }
        found.push(Stored { first, mask, bytes, here });
    }
    Ok(())
}
