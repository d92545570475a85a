//! The names in a group, and the addresses of their objects.

use super::Hdf5Error;
use super::bytes::Bytes;
use super::header::Message;

/// The types of messages in object headers.
const LINK_INFO: usize = 0x02;
const LINK: usize = 0x06;
const SYMBOL_TABLE: usize = 0x11;

/// The type of a soft link in a symbol table.
const SOFT: usize = 2;

/// The largest number of levels of a tree of names.
const LEVELS: u8 = 8;

/// The largest number of names in a group. Exchange files have only a few.
const NAMES: usize = 10_000;

/// Returns the address of the object `name` in the group with these messages.
pub(super) fn find(file: Bytes<'_>, group: &[Message<'_>], name: &str) -> Result<Option<u64>, Hdf5Error> {
    for message in group {
        let mut body = message.body;
        let found = match message.kind {
            SYMBOL_TABLE => {
                let (tree, heap) = (body.offset()?, body.offset()?);
                let mut search = Search { file, names: heap_data(file, heap)?, name: name.as_bytes(), seen: 0 };
                search.tree(tree, LEVELS)?
            }
            LINK => link(body, name)?,
            LINK_INFO => {
                dense(body)?;
                None
            }
            _ => None,
        };
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

/// Returns the local heap with the names of a symbol table.
fn heap_data(file: Bytes<'_>, address: u64) -> Result<Bytes<'_>, Hdf5Error> {
    let mut heap = file.at(address)?;
    heap.expect(b"HEAP", "the names of a group are missing")?;
    heap.skip(4)?;
    let length = heap.length()?;
    heap.length()?;
    let data = heap.offset()?;
    let length = usize::try_from(length).map_err(|_| heap.damaged("the file ends too early"))?;
    file.at(data)?.part(length)
}

/// A search in a tree of names.
struct Search<'a> {
    file: Bytes<'a>,
    names: Bytes<'a>,
    name: &'a [u8],
    /// The number of names and branches visited so far.
    seen: usize,
}

impl Search<'_> {
    fn tree(&mut self, address: u64, levels: u8) -> Result<Option<u64>, Hdf5Error> {
        let mut node = self.file.at(address)?;
        node.expect(b"TREE", "a tree of names is missing")?;
        let kind = node.u8()?;
        let level = node.u8()?;
        if kind != 0 || level >= levels {
            return Err(node.damaged("a tree contains no names"));
        }
        let count = node.u16()?;
        node.offset()?;
        node.offset()?;
        for _ in 0..count {
            self.count(&node)?;
            node.length()?;
            let child = node.offset()?;
            let found = if level == 0 { self.leaf(child)? } else { self.tree(child, level)? };
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }

    fn leaf(&mut self, address: u64) -> Result<Option<u64>, Hdf5Error> {
        let mut node = self.file.at(address)?;
        node.expect(b"SNOD", "a list of names is missing")?;
        node.skip(2)?;
        let count = node.u16()?;
        for _ in 0..count {
            self.count(&node)?;
            let (name, object) = (node.offset()?, node.offset()?);
            let leads_on = node.u32()? == SOFT;
            node.skip(20)?;
            let mut here = self.names;
            here.skip(usize::try_from(name).map_err(|_| node.damaged("a name is beyond the end of the file"))?)?;
            let with_end = here.left() > self.name.len();
            if with_end && here.take(self.name.len())? == self.name && here.u8()? == 0 {
                return if leads_on { Err(elsewhere(&String::from_utf8_lossy(self.name))) } else { Ok(Some(object)) };
            }
        }
        Ok(None)
    }

    fn count(&mut self, here: &Bytes<'_>) -> Result<(), Hdf5Error> {
        self.seen += 1;
        if self.seen > NAMES { Err(here.damaged("a group has too many names")) } else { Ok(()) }
    }
}

/// Returns the address in a link message if it is a hard link called `name`.
fn link(mut body: Bytes<'_>, name: &str) -> Result<Option<u64>, Hdf5Error> {
    body.skip(1)?;
    let flags = body.u8()?;
    let kind = if flags & 0x08 == 0 { 0 } else { body.u8()? };
    let order = if flags & 0x04 == 0 { 0 } else { 8 };
    let set = usize::from(flags & 0x10 != 0);
    body.skip(order + set)?;
    let length = body.number(1 << (flags & 3))?;
    let length = usize::try_from(length).map_err(|_| body.damaged("the file ends too early"))?;
    if body.take(length)? != name.as_bytes() {
        return Ok(None);
    }
    match kind {
        0 => body.offset().map(Some),
        _ => Err(elsewhere(name)),
    }
}

/// Returns the error for a name that refers to another name, here or in another file.
fn elsewhere(name: &str) -> Hdf5Error {
    Hdf5Error::Unsupported { what: format!("the link {name} to another place") }
}

/// Returns an error if the names of a group are in a fractal heap, as for large groups of new files.
fn dense(mut body: Bytes<'_>) -> Result<(), Hdf5Error> {
    body.skip(1)?;
    let flags = body.u8()?;
    body.skip(if flags & 1 == 0 { 0 } else { 8 })?;
    let heap = body.offset()?;
    if body.is_undefined(heap) {
        Ok(())
    } else {
        Err(Hdf5Error::Unsupported { what: "a group with so many names in a new file".to_string() })
    }
}
