//! Datasets: their types, their storage, and their values.

use std::borrow::Cow;

use super::Hdf5Error;
use super::bytes::Bytes;
use super::chunks::{Chunks, Filters};
use super::header::Message;

/// The types of messages in object headers.
const DATASPACE: usize = 0x01;
const DATATYPE: usize = 0x03;
const LAYOUT: usize = 0x08;
const FILTERS: usize = 0x0b;
/// The fill value of unwritten elements, and its older form.
const FILL: usize = 0x05;
const OLD_FILL: usize = 0x04;

/// The kind of the elements of a dataset.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Integer { signed: bool },
    Float,
    Text,
    Other(u8),
}

/// The type of an element.
#[derive(Debug, Clone, Copy)]
struct Type {
    kind: Kind,
    /// The bytes per element.
    size: usize,
    big_endian: bool,
}

/// The storage of the values of a dataset.
enum Storage<'a> {
    /// Contiguous.
    Contiguous(&'a [u8]),
    Chunks(Chunks),
    /// Never written.
    Nowhere,
}

/// A dataset, whose values are read on request.
pub(crate) struct Dataset<'a> {
    file: Bytes<'a>,
    element: Type,
    /// The number of elements.
    count: usize,
    storage: Storage<'a>,
    /// The bytes of an unwritten element, if the file defines them.
    fill: Option<&'a [u8]>,
}

impl Type {
    fn read(mut body: Bytes<'_>) -> Result<Self, Hdf5Error> {
        let class = body.u8()? & 0x0f;
        let bits = body.number(3)?;
        let size = body.u32()?;
        let big_endian = bits & 1 != 0;
        let kind = match class {
            0 => Kind::Integer { signed: bits & 8 != 0 },
            1 => Kind::Float,
            3 => Kind::Text,
            other => Kind::Other(other),
        };
        let sound = match kind {
            Kind::Integer { .. } => {
                let (offset, precision) = (body.u16()?, body.u16()?);
                matches!(size, 1 | 2 | 4 | 8) && offset == 0 && precision == 8 * size
            }
            Kind::Float => {
                let fields = [body.u16()?, body.u16()?, body.number(4)? as usize, body.u32()?];
                // The formats of IEEE 754: offset and precision; positions and sizes of exponent and mantissa; bias.
                let ieee: [[usize; 4]; 2] = [[0, 64, 0x3400_0b34, 1023], [0, 32, 0x1700_0817, 127]];
                bits & 0x40 == 0 && (size == 8 && fields == ieee[0] || size == 4 && fields == ieee[1])
            }
            Kind::Text | Kind::Other(_) => size > 0,
        };
        if sound { Ok(Type { kind, size, big_endian }) } else { Err(body.damaged("a datatype is unknown")) }
    }

    fn describe(self) -> String {
        let bits = 8 * self.size;
        match self.kind {
            Kind::Integer { signed } => {
                format!("{} integers of {bits} bits", if signed { "signed" } else { "unsigned" })
            }
            Kind::Float => format!("floating-point numbers of {bits} bits"),
            Kind::Text => "text".to_string(),
            Kind::Other(class) => format!("elements of the class {class}"),
        }
    }
}

/// Reads the number of elements of a dataspace.
fn count(mut body: Bytes<'_>) -> Result<u64, Hdf5Error> {
    let version = body.u8()?;
    let rank = body.u8()?;
    match version {
        1 => body.skip(6)?,
        2 => {
            body.u8()?;
            // A null dataspace has no elements.
            if body.u8()? == 2 {
                return Ok(0);
            }
        }
        _ => return Err(body.damaged("a dataspace has an unknown version")),
    }
    let mut count = 1_u64;
    for _ in 0..rank {
        let dimension = body.length()?;
        count = count.checked_mul(dimension).ok_or_else(|| body.damaged("a dataset is impossibly large"))?;
    }
    Ok(count)
}

/// Returns the bytes of an unwritten element of a dataset with these messages. `None` if the file does not define them.
fn fill<'a>(object: &[Message<'a>], size: usize) -> Result<Option<&'a [u8]>, Hdf5Error> {
    let sound = |kind| object.iter().find(|message| message.kind == kind && !message.shared);
    let (mut body, has_value) = match (sound(FILL), sound(OLD_FILL)) {
        (Some(message), _) => {
            let mut body = message.body;
            let version = body.u8()?;
            let has_value = match version {
                1 | 2 => {
                    body.skip(2)?;
                    body.u8()? != 0 || version == 1
                }
                _ => body.u8()? & 0x20 != 0,
            };
            (body, has_value)
        }
        (None, Some(message)) => (message.body, true),
        (None, None) => return Ok(None),
    };
    let length = if has_value { body.u32()? } else { 0 };
    Ok(if length == size { Some(body.take(length)?) } else { None })
}

impl<'a> Dataset<'a> {
    /// Creates the dataset with the messages of `object`.
    pub(super) fn new(file: Bytes<'a>, object: &[Message<'a>]) -> Result<Self, Hdf5Error> {
        let get = |kind: usize, what: &'static str| {
            let message = object.iter().find(|message| message.kind == kind);
            match message {
                Some(message) if message.shared => {
                    Err(Hdf5Error::Unsupported { what: "a datatype that several datasets share".to_string() })
                }
                Some(message) => Ok(message.body),
                None => Err(Hdf5Error::Type {
                    found: format!("no {what}, as groups do"),
                    expected: "the values of a dataset",
                }),
            }
        };
        let element = Type::read(get(DATATYPE, "datatype")?)?;
        let space = get(DATASPACE, "dataspace")?;
        let count = count(space)?;
        let mut layout = get(LAYOUT, "layout")?;
        let length = count.checked_mul(element.size as u64).and_then(|length| usize::try_from(length).ok());
        let length = length.ok_or_else(|| space.damaged("a dataset is impossibly large"))?;
        let version = layout.u8()?;
        if !matches!(version, 3 | 4) {
            return Err(Hdf5Error::Unsupported { what: format!("a dataset with a layout of version {version}") });
        }
        let (short, beyond) =
            ("a dataset has fewer values than its size says", "a dataset ends beyond the end of the file");
        let storage = match layout.u8()? {
            0 => {
                let stored = layout.u16()?;
                let mut body = layout.part(stored)?;
                if stored < length {
                    return Err(layout.damaged(short));
                }
                Storage::Contiguous(body.take(length)?)
            }
            1 => {
                let address = layout.offset()?;
                let stored = layout.length()?;
                if length == 0 {
                    Storage::Contiguous(&[])
                } else if layout.is_undefined(address) {
                    Storage::Nowhere
                } else if stored < length as u64 {
                    return Err(layout.damaged(short));
                } else {
                    Storage::Contiguous(file.at(address)?.take(length).map_err(|_| layout.damaged(beyond))?)
                }
            }
            2 if version == 3 => {
                let filters = object.iter().find(|message| message.kind == FILTERS);
                let filters = filters.map_or(Ok(Filters::default()), |message| Filters::read(message.body))?;
                match Chunks::read(layout, filters, element.size)? {
                    Some(chunks) => Storage::Chunks(chunks),
                    None if length == 0 => Storage::Contiguous(&[]),
                    None => Storage::Nowhere,
                }
            }
            _ => return Err(Hdf5Error::Unsupported { what: "a dataset in chunks of a new file".to_string() }),
        };
        let count = length / element.size;
        Ok(Dataset { file, element, count, storage, fill: fill(object, element.size)? })
    }

    /// Returns the number of elements.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Returns `true` if the dataset was ever written. A dataset without elements counts as written.
    pub(crate) fn is_written(&self) -> bool {
        !matches!(self.storage, Storage::Nowhere)
    }

    /// Returns the bytes of the `first` elements, without reading others.
    fn bytes(&self, first: usize) -> Result<Cow<'a, [u8]>, Hdf5Error> {
        let size = self.element.size;
        let first = first.min(self.count);
        match (&self.storage, self.fill) {
            (Storage::Contiguous(bytes), _) => Ok(Cow::Borrowed(&bytes[..first * size])),
            (Storage::Chunks(chunks), fill) => {
                let zero = vec![0; size];
                Ok(Cow::Owned(chunks.bytes(self.file, first, fill.unwrap_or(&zero))?))
            }
            (Storage::Nowhere, Some(fill)) => Ok(Cow::Owned(fill.repeat(first))),
            (Storage::Nowhere, None) => Err(Hdf5Error::NotWritten),
        }
    }

    /// Returns the bytes of the `first` elements, the lowest byte first.
    fn elements(&self, first: usize) -> Result<Vec<[u8; 8]>, Hdf5Error> {
        let Type { size, big_endian, .. } = self.element;
        let element = |bytes: &[u8]| {
            let mut element = [0; 8];
            let here = element.iter_mut();
            if big_endian {
                here.zip(bytes.iter().rev()).for_each(|(to, from)| *to = *from);
            } else {
                here.zip(bytes).for_each(|(to, from)| *to = *from);
            }
            element
        };
        Ok(self.bytes(first)?.chunks_exact(size).map(element).collect())
    }

    /// Converts an element to an integer, which is assumed to fit 64 bits with a sign.
    fn integer(&self, signed: bool, bytes: [u8; 8]) -> i64 {
        let unused = 64 - 8 * self.element.size.min(8);
        let number = i64::from_le_bytes(bytes);
        if signed { number << unused >> unused } else { number }
    }

    /// Returns the `first` values of a dataset of integers.
    pub(crate) fn integers(&self, first: usize) -> Result<Vec<i64>, Hdf5Error> {
        match self.element.kind {
            Kind::Integer { signed } => {
                Ok(self.elements(first)?.into_iter().map(|bytes| self.integer(signed, bytes)).collect())
            }
            _ => Err(Hdf5Error::Type { found: self.element.describe(), expected: "integers" }),
        }
    }

    /// Returns the `first` values of a dataset of numbers, including integers.
    pub(crate) fn numbers(&self, first: usize) -> Result<Vec<f64>, Hdf5Error> {
        let single = |[a, b, c, d, ..]: [u8; 8]| f64::from(f32::from_le_bytes([a, b, c, d]));
        let number: &dyn Fn([u8; 8]) -> f64 = match self.element.kind {
            Kind::Float if self.element.size == 8 => &f64::from_le_bytes,
            Kind::Float => &single,
            Kind::Integer { signed } => &move |bytes| self.integer(signed, bytes) as f64,
            _ => return Err(Hdf5Error::Type { found: self.element.describe(), expected: "floating-point numbers" }),
        };
        Ok(self.elements(first)?.into_iter().map(number).collect())
    }

    /// Returns the text of a dataset of one text of fixed length, if it is no longer than the file. Invalid UTF-8 is
    /// replaced.
    pub(crate) fn text(&self) -> Result<Option<String>, Hdf5Error> {
        if self.element.kind != Kind::Text || self.element.size.saturating_mul(self.count) > self.file.file_length() {
            return Ok(None);
        }
        let bytes = self.bytes(self.count)?;
        let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(Some(String::from_utf8_lossy(text).trim_end().to_string()))
    }
}

#[cfg(test)]
mod tests {
    use miniz_oxide::deflate::compress_to_vec_zlib;

    use super::super::bytes::Sizes;
    use super::*;

    /// A file, and the messages of a dataset in it: each with its kind and its position.
    struct Made {
        bytes: Vec<u8>,
        messages: Vec<(usize, std::ops::Range<usize>)>,
    }

    impl Made {
        /// Creates a dataset of `count` doubles in chunks of `elements` each, of which the `stored` ones are written,
        /// plain or deflated.
        fn chunked(count: u64, elements: u32, stored: &[(u64, &[u8])], is_packed: bool, fill: Option<f64>) -> Self {
            let mut bytes = Vec::new();
            let mut places = Vec::new();
            for (_, chunk) in stored {
                // A chunk with the same bytes is not stored again.
                let place = bytes.windows(chunk.len()).position(|window: &[u8]| window == *chunk);
                places.push(place.unwrap_or(bytes.len()) as u64);
                if place.is_none() {
                    bytes.extend(*chunk);
                }
            }
            let tree = bytes.len() as u64;
            bytes.extend(b"TREE\x01\0");
            bytes.extend((stored.len() as u16).to_le_bytes());
            bytes.extend([0xff; 16]);
            for ((first, chunk), place) in stored.iter().zip(places) {
                bytes.extend((chunk.len() as u32).to_le_bytes());
                bytes.extend([0; 4]);
                bytes.extend([*first, 0, place].iter().flat_map(|word| word.to_le_bytes()));
            }
            let double = [&[0x11, 0x20, 63, 0, 8, 0, 0, 0][..], &[0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0]].concat();
            let space = [&[1, 1, 0, 0, 0, 0, 0, 0][..], &count.to_le_bytes()].concat();
            let layout = [&[3, 2, 2][..], &tree.to_le_bytes(), &elements.to_le_bytes(), &8_u32.to_le_bytes()].concat();
            let mut made = Made { bytes, messages: Vec::new() };
            made.add(DATATYPE, &double);
            made.add(DATASPACE, &space);
            made.add(LAYOUT, &layout);
            if is_packed {
                made.add(FILTERS, &[2, 1, 1, 0, 0, 0, 0, 0]);
            }
            if let Some(fill) = fill {
                made.add(FILL, &[&[3, 0x20, 8, 0, 0, 0][..], &fill.to_le_bytes()].concat());
            }
            made
        }

        fn add(&mut self, kind: usize, body: &[u8]) {
            let start = self.bytes.len();
            self.bytes.extend(body);
            self.messages.push((kind, start..self.bytes.len()));
        }

        fn numbers(&self, first: usize) -> Result<Vec<f64>, Hdf5Error> {
            let file = Bytes::new(&self.bytes, 0, Sizes::default());
            let message = |(kind, place): &(usize, std::ops::Range<usize>)| {
                let body = file.at(place.start as u64).and_then(|mut body| body.part(place.len())).unwrap();
                Message { kind: *kind, shared: false, body }
            };
            Dataset::new(file, &self.messages.iter().map(message).collect::<Vec<_>>())?.numbers(first)
        }
    }

    /// Unwritten chunks contain the fill value of the dataset, zero by default.
    #[test]
    fn missing_chunks_are_filled() {
        let chunk: Vec<u8> = [1.0_f64, 2.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let values = |stored: &[(u64, &[u8])], fill| Made::chunked(5, 2, stored, false, fill).numbers(5);
        assert_eq!(values(&[(2, &chunk)], None).unwrap(), [0.0, 0.0, 1.0, 2.0, 0.0]);
        assert_eq!(values(&[(2, &chunk)], Some(7.5)).unwrap(), [7.5, 7.5, 1.0, 2.0, 7.5]);
        assert_eq!(values(&[(4, &chunk), (0, &chunk)], Some(7.5)).unwrap(), [1.0, 2.0, 7.5, 7.5, 1.0]);
        for wrong in [[(0, &chunk[..]), (0, &chunk)], [(0, &chunk), (1, &chunk)]] {
            assert!(matches!(values(&wrong, None), Err(Hdf5Error::Damaged { .. })));
        }
        // No chunk was written: the tree is undefined.
        for (fill, expected) in [(None, Err(Hdf5Error::NotWritten)), (Some(2.5), Ok(vec![2.5; 3]))] {
            let mut made = Made::chunked(3, 2, &[], false, fill);
            let layout = made.messages[2].1.start;
            made.bytes[layout + 3..layout + 11].fill(0xff);
            assert_eq!(made.numbers(3), expected);
        }
    }

    /// For a dataset that expands ten-thousandfold, only the requested part is inflated.
    #[test]
    fn only_what_is_asked_for_is_inflated() {
        let elements = 1 << 17;
        let packed = compress_to_vec_zlib(&vec![0; 8 * elements], 6);
        let stored: Vec<(u64, &[u8])> = (0..8000).map(|k| (k * elements as u64, &packed[..])).collect();
        let made = Made::chunked(8000 * elements as u64, elements as u32, &stored, true, None);
        assert!(made.bytes.len() < 300_000);
        let start = std::time::Instant::now();
        assert_eq!(made.numbers(3).unwrap(), [0.0; 3]);
        assert!(start.elapsed().as_secs_f64() < 2.0, "all 8 GB were inflated");
        // A chunk much larger than the dataset is refused before it is inflated.
        let huge = Made::chunked(3, 1 << 28, &[(0, &packed)], true, None);
        let Err(Hdf5Error::Unsupported { what }) = huge.numbers(3) else { panic!() };
        assert!(what.contains("a dataset of 24 bytes in chunks of 2147483648 bytes"), "{what}");
    }
}
