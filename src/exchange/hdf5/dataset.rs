//! Datasets: what they are of, how they lie in the file, and their values.

use std::borrow::Cow;

use super::Hdf5Error;
use super::bytes::Bytes;
use super::chunks::{Filters, chunked};
use super::header::Message;

/// Messages of object headers.
const DATASPACE: usize = 0x01;
const DATATYPE: usize = 0x03;
const LAYOUT: usize = 0x08;
const FILTERS: usize = 0x0b;

/// What the elements of a dataset are.
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
    /// Bytes of an element.
    size: usize,
    big_endian: bool,
}

/// A dataset with its bytes.
struct Dataset<'a> {
    element: Type,
    bytes: Cow<'a, [u8]>,
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
                // Offset and precision; places and sizes of exponent and mantissa; bias: the formats of IEEE 754.
                let ieee: [[usize; 4]; 2] = [[0, 64, 0x3400_0b34, 1023], [0, 32, 0x1700_0817, 127]];
                bits & 0x40 == 0 && (size == 8 && fields == ieee[0] || size == 4 && fields == ieee[1])
            }
            Kind::Text | Kind::Other(_) => size > 0,
        };
        if sound { Ok(Type { kind, size, big_endian }) } else { Err(body.damaged("a datatype is none that there is")) }
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

/// The number of elements of a dataspace.
fn count(mut body: Bytes<'_>) -> Result<u64, Hdf5Error> {
    let version = body.u8()?;
    let rank = body.u8()?;
    match version {
        1 => body.skip(6)?,
        2 => {
            body.u8()?;
            // Null: no element at all.
            if body.u8()? == 2 {
                return Ok(0);
            }
        }
        _ => return Err(body.damaged("a dataspace has no version that there is")),
    }
    let mut count = 1_u64;
    for _ in 0..rank {
        let dimension = body.length()?;
        count = count.checked_mul(dimension).ok_or_else(|| body.damaged("a dataset is larger than any memory"))?;
    }
    Ok(count)
}

impl<'a> Dataset<'a> {
    fn read(file: Bytes<'a>, object: &[Message<'a>]) -> Result<Self, Hdf5Error> {
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
        let length = length.ok_or_else(|| space.damaged("a dataset is larger than any memory"))?;
        let version = layout.u8()?;
        if !matches!(version, 3 | 4) {
            return Err(Hdf5Error::Unsupported { what: format!("a dataset with a layout of version {version}") });
        }
        let (short, beyond) =
            ("a dataset has fewer values than its size says", "a dataset ends beyond the end of the file");
        let bytes = match layout.u8()? {
            0 => {
                let stored = layout.u16()?;
                let mut body = layout.part(stored)?;
                if stored < length {
                    return Err(layout.damaged(short));
                }
                Cow::Borrowed(body.take(length)?)
            }
            1 => {
                let address = layout.offset()?;
                let stored = layout.length()?;
                if length == 0 {
                    Cow::Borrowed(&[][..])
                } else if layout.is_undefined(address) {
                    return Err(Hdf5Error::NotWritten);
                } else if stored < length as u64 {
                    return Err(layout.damaged(short));
                } else {
                    Cow::Borrowed(file.at(address)?.take(length).map_err(|_| layout.damaged(beyond))?)
                }
            }
            2 if version == 3 => {
                let filters = object.iter().find(|message| message.kind == FILTERS);
                let filters = filters.map_or(Ok(Filters::default()), |message| Filters::read(message.body))?;
                Cow::Owned(chunked(file, layout, &filters, length, element.size)?)
            }
            _ => return Err(Hdf5Error::Unsupported { what: "a dataset in chunks of a new file".to_string() }),
        };
        Ok(Dataset { element, bytes })
    }

    /// The elements, each as its bytes with the lowest first.
    fn elements(&self) -> impl Iterator<Item = [u8; 8]> + '_ {
        let Type { size, big_endian, .. } = self.element;
        self.bytes.chunks_exact(size).map(move |bytes| {
            let mut element = [0; 8];
            let here = element.iter_mut();
            if big_endian {
                here.zip(bytes.iter().rev()).for_each(|(to, from)| *to = *from);
            } else {
                here.zip(bytes).for_each(|(to, from)| *to = *from);
            }
            element
        })
    }

    /// The integers that it is of, which are taken to fit 64 bits with a sign.
    fn integers(&self, signed: bool) -> impl Iterator<Item = i64> + '_ {
        let unused = 64 - 8 * self.element.size.min(8);
        self.elements().map(move |bytes| {
            let number = i64::from_le_bytes(bytes);
            if signed { number << unused >> unused } else { number }
        })
    }
}

pub(super) fn is_written(file: Bytes<'_>, object: &[Message<'_>]) -> Result<bool, Hdf5Error> {
    match Dataset::read(file, object) {
        Err(Hdf5Error::NotWritten) => Ok(false),
        read => read.map(|_| true),
    }
}

pub(super) fn integers(file: Bytes<'_>, object: &[Message<'_>]) -> Result<Vec<i64>, Hdf5Error> {
    let dataset = Dataset::read(file, object)?;
    match dataset.element.kind {
        Kind::Integer { signed } => Ok(dataset.integers(signed).collect()),
        _ => Err(Hdf5Error::Type { found: dataset.element.describe(), expected: "integers" }),
    }
}

pub(super) fn numbers(file: Bytes<'_>, object: &[Message<'_>]) -> Result<Vec<f64>, Hdf5Error> {
    let dataset = Dataset::read(file, object)?;
    let double = |bytes: [u8; 8]| f64::from_le_bytes(bytes);
    let single = |[a, b, c, d, ..]: [u8; 8]| f64::from(f32::from_le_bytes([a, b, c, d]));
    match dataset.element.kind {
        Kind::Float if dataset.element.size == 8 => Ok(dataset.elements().map(double).collect()),
        Kind::Float => Ok(dataset.elements().map(single).collect()),
        Kind::Integer { signed } => Ok(dataset.integers(signed).map(|number| number as f64).collect()),
        _ => Err(Hdf5Error::Type { found: dataset.element.describe(), expected: "floating-point numbers" }),
    }
}

pub(super) fn text(file: Bytes<'_>, object: &[Message<'_>]) -> Result<Option<String>, Hdf5Error> {
    let dataset = Dataset::read(file, object)?;
    if dataset.element.kind != Kind::Text {
        return Ok(None);
    }
    let text = dataset.bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    Ok(Some(String::from_utf8_lossy(text).trim_end().to_string()))
}
