//! Object headers: the messages that describe an object.

use super::Hdf5Error;
use super::bytes::Bytes;

/// The largest number of blocks with the messages of one object.
const BLOCKS: usize = 64;

/// The message of a continuation block.
const CONTINUATION: usize = 0x10;

/// A message of an object header.
#[derive(Debug, Clone, Copy)]
pub(super) struct Message<'a> {
    pub(super) kind: usize,
    /// `true` if the content is stored elsewhere, as for a named datatype.
    pub(super) shared: bool,
    pub(super) body: Bytes<'a>,
}

/// Returns the messages of the object whose header is at `address`.
pub(super) fn messages(file: Bytes<'_>, address: u64) -> Result<Vec<Message<'_>>, Hdf5Error> {
    let mut head = file.at(address)?;
    let is_new = head.take(4)? == b"OHDR";
    if is_new { new(file, head) } else { old(file, file.at(address)?) }
}

/// Reads a header of version 1.
fn old<'a>(file: Bytes<'a>, mut head: Bytes<'a>) -> Result<Vec<Message<'a>>, Hdf5Error> {
    if head.u8()? != 1 {
        return Err(head.damaged("no object header is here"));
    }
    head.skip(7)?;
    let length = head.u32()?;
    head.skip(4)?;
    let mut blocks = vec![head.part(length)?];
    let mut found = Vec::new();
    let mut next = 0;
    while let Some(&block) = blocks.get(next) {
        next += 1;
        let mut block = block;
        while block.left() >= 8 {
            let (kind, length) = (block.u16()?, block.u16()?);
            let flags = block.u8()?;
            block.skip(3)?;
            take(file, &mut blocks, &mut found, Message { kind, shared: flags & 2 != 0, body: block.part(length)? })?;
        }
    }
    Ok(found)
}

/// Reads a header of version 2.
fn new<'a>(file: Bytes<'a>, mut head: Bytes<'a>) -> Result<Vec<Message<'a>>, Hdf5Error> {
    if head.u8()? != 2 {
        return Err(head.damaged("an object header has an unknown version"));
    }
    let flags = head.u8()?;
    let times = if flags & 0x20 == 0 { 0 } else { 16 };
    let limits = if flags & 0x10 == 0 { 0 } else { 4 };
    head.skip(times + limits)?;
    let length = head.number(1 << (flags & 3))?;
    let length = usize::try_from(length).map_err(|_| head.damaged("the file ends too early"))?;
    let mut blocks = vec![head.part(length)?];
    let mut found = Vec::new();
    let mut next = 0;
    while let Some(&block) = blocks.get(next) {
        let mut block = block;
        if next > 0 {
            block.expect(b"OCHK", "the continuation of an object header is missing")?;
            let length = block.left().saturating_sub(4);
            block = block.part(length)?;
        }
        next += 1;
        let head = if flags & 4 == 0 { 4 } else { 6 };
        while block.left() >= head {
            let kind = usize::from(block.u8()?);
            let length = block.u16()?;
            let flags = block.u8()?;
            block.skip(head - 4)?;
            take(file, &mut blocks, &mut found, Message { kind, shared: flags & 2 != 0, body: block.part(length)? })?;
        }
    }
    Ok(found)
}

/// Keeps `message`, or the continuation block that it refers to.
fn take<'a>(
    file: Bytes<'a>,
    blocks: &mut Vec<Bytes<'a>>,
    found: &mut Vec<Message<'a>>,
    message: Message<'a>,
) -> Result<(), Hdf5Error> {
    if message.kind != CONTINUATION {
        found.push(message);
        return Ok(());
    }
    let mut body = message.body;
    if blocks.len() == BLOCKS {
        return Err(body.damaged("an object header has too many blocks"));
    }
    let (address, length) = (body.offset()?, body.length()?);
    let length = usize::try_from(length).map_err(|_| body.damaged("the file ends too early"))?;
    blocks.push(file.at(address)?.part(length)?);
    Ok(())
}
