//! Depth and ID buffers from files.

use std::ops::Range;
use std::path::Path;

use crate::Error;
use crate::picture::{self, Format};
use crate::values::MAX_SIZE;

/// The longest header of an .npy file that describes a plain array.
const MAX_NPY_HEADER: usize = 4_096;

/// Numbers per pixel, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Whether the first row is the bottom one.
    pub bottom_up: bool,
    /// Numbers per pixel.
    channels: usize,
    numbers: Numbers,
}

/// The numbers of a file, whole numbers kept whole: object IDs need all their bits.
#[derive(Clone, Debug, PartialEq)]
enum Numbers {
    Floats(Vec<f32>),
    /// A picture's, and what stands for 1.
    Whole(Vec<u32>, f32),
    /// As they stand at the end of an .npy file. They are decoded where they are needed, row by
    /// row: large arrays are slow to make.
    Npy {
        file: Vec<u8>,
        start: usize,
        element: Element,
    },
}

/// The number types of NumPy that are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    F32,
    F32BigEndian,
    F64,
    F64BigEndian,
    U8,
    U16,
    U16BigEndian,
    U32,
    I32,
    I64,
}

/// The kinds of files that hold a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// NumPy's: any plain number type, shape (height, width, channels); one channel may be left
    /// out.
    Npy,
    /// Grey of 8 or 16 bits.
    Png,
    /// Floats in a picture.
    Picture(Format),
}

impl Kind {
    /// By the ending of the file's name; `None` for all but .npy, .pfm, .exr and .png.
    #[must_use]
    pub fn of(path: &Path) -> Option<Kind> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "npy" => Some(Kind::Npy),
            "png" => Some(Kind::Png),
            "pfm" => Some(Kind::Picture(Format::Pfm)),
            "exr" => Some(Kind::Picture(Format::Exr)),
            _ => None,
        }
    }
}

impl Buffer {
    /// Reads a file of a [`Kind`] that its name tells, with that many channels.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, is of no such kind, has another number of channels or needs more
    /// than `max_memory` bytes; the message names it.
    pub fn read(path: &Path, channels: usize, max_memory: u64) -> Result<Buffer, Error> {
        let wrong = |why: String| Error::new(format_args!("{}: {why}", path.display()));
        let Some(kind) = Kind::of(path) else {
            return Err(wrong("a buffer must end in .npy, .pfm, .exr or .png".into()));
        };
        let bytes = picture::read_bytes(path, max_memory)?;
        Buffer::decode(kind, bytes, channels, max_memory).map_err(wrong)
    }

    /// The buffer in the bytes of a file, as [`Buffer::read`].
    ///
    /// # Errors
    ///
    /// If they are no file of that kind, have another number of channels, or need more than
    /// `max_memory` bytes.
    pub fn decode(
        kind: Kind,
        bytes: Vec<u8>,
        channels: usize,
        max_memory: u64,
    ) -> Result<Buffer, String> {
        let buffer = match kind {
            Kind::Npy => decode_npy(bytes)?,
            Kind::Png => decode_png(&bytes, max_memory)?,
            Kind::Picture(format) => {
                let picture = picture::decode(format, &bytes, max_memory)?;
                let (width, height) = sides(picture.width.into(), picture.height.into())?;
                let numbers = Numbers::Floats(picture.to_floats());
                Buffer { width, height, bottom_up: false, channels: picture.channels, numbers }
            }
        };
        if buffer.channels != channels {
            let found = buffer.channels;
            return Err(format!("it has {found} numbers per pixel, not {channels}"));
        }
        Ok(buffer)
    }

    /// Writes the numbers of a row, counted from the top; those of a .png are divided by their
    /// greatest.
    ///
    /// # Panics
    ///
    /// If the buffer has no such row, or `out` is no row of it.
    pub fn floats(&self, y: u32, out: &mut [f32]) {
        let row = self.row(y);
        assert_eq!(out.len(), row.len(), "a row of the buffer");
        match &self.numbers {
            Numbers::Floats(values) => out.copy_from_slice(&values[row]),
            Numbers::Whole(values, one) => {
                out.iter_mut().zip(&values[row]).for_each(|(out, &v)| *out = v as f32 / one);
            }
            Numbers::Npy { file, start, element } => element.floats(&file[*start..], row, out),
        }
    }

    /// Writes the numbers of a row, counted from the top, as object IDs; what is negative or no
    /// number is 0.
    ///
    /// # Panics
    ///
    /// If the buffer has no such row, or `out` is no row of it.
    pub fn ids(&self, y: u32, out: &mut [u32]) {
        let row = self.row(y);
        assert_eq!(out.len(), row.len(), "a row of the buffer");
        match &self.numbers {
            Numbers::Floats(values) => {
                out.iter_mut().zip(&values[row]).for_each(|(out, &value)| *out = value as u32);
            }
            Numbers::Whole(values, _) => out.copy_from_slice(&values[row]),
            Numbers::Npy { file, start, element } => element.ids(&file[*start..], row, out),
        }
    }

    fn row(&self, y: u32) -> Range<usize> {
        assert!(y < self.height, "row {y} of {}", self.height);
        let y = if self.bottom_up { self.height - 1 - y } else { y } as usize;
        let len = self.width as usize * self.channels;
        y * len..(y + 1) * len
    }
}

impl Element {
    fn of(kind: &str) -> Option<Element> {
        Some(match kind {
            "<f4" => Element::F32,
            ">f4" => Element::F32BigEndian,
            "<f8" => Element::F64,
            ">f8" => Element::F64BigEndian,
            "|u1" | "|b1" => Element::U8,
            "<u2" => Element::U16,
            ">u2" => Element::U16BigEndian,
            "<u4" => Element::U32,
            "<i4" => Element::I32,
            "<i8" => Element::I64,
            _ => return None,
        })
    }

    /// Bytes of one number.
    fn size(self) -> usize {
        match self {
            Element::U8 => 1,
            Element::U16 | Element::U16BigEndian => 2,
            Element::F32 | Element::F32BigEndian | Element::U32 | Element::I32 => 4,
            Element::F64 | Element::F64BigEndian | Element::I64 => 8,
        }
    }

    fn floats(self, bytes: &[u8], range: Range<usize>, out: &mut [f32]) {
        match self {
            Element::F32 => each(bytes, range, out, f32::from_le_bytes),
            Element::F32BigEndian => each(bytes, range, out, f32::from_be_bytes),
            Element::F64 => each(bytes, range, out, |b| f64::from_le_bytes(b) as f32),
            Element::F64BigEndian => each(bytes, range, out, |b| f64::from_be_bytes(b) as f32),
            Element::U8 => each(bytes, range, out, |[b]: [u8; 1]| f32::from(b)),
            Element::U16 => each(bytes, range, out, |b| f32::from(u16::from_le_bytes(b))),
            Element::U16BigEndian => each(bytes, range, out, |b| f32::from(u16::from_be_bytes(b))),
            Element::U32 => each(bytes, range, out, |b| u32::from_le_bytes(b) as f32),
            Element::I32 => each(bytes, range, out, |b| i32::from_le_bytes(b) as f32),
            Element::I64 => each(bytes, range, out, |b| i64::from_le_bytes(b) as f32),
        }
    }

    fn ids(self, bytes: &[u8], range: Range<usize>, out: &mut [u32]) {
        let whole = |value: i64| u32::try_from(value).unwrap_or(0);
        match self {
            Element::F32 => each(bytes, range, out, |b| f32::from_le_bytes(b) as u32),
            Element::F32BigEndian => each(bytes, range, out, |b| f32::from_be_bytes(b) as u32),
            Element::F64 => each(bytes, range, out, |b| f64::from_le_bytes(b) as u32),
            Element::F64BigEndian => each(bytes, range, out, |b| f64::from_be_bytes(b) as u32),
            Element::U8 => each(bytes, range, out, |[b]: [u8; 1]| u32::from(b)),
            Element::U16 => each(bytes, range, out, |b| u32::from(u16::from_le_bytes(b))),
            Element::U16BigEndian => each(bytes, range, out, |b| u32::from(u16::from_be_bytes(b))),
            Element::U32 => each(bytes, range, out, u32::from_le_bytes),
            Element::I32 => each(bytes, range, out, |b| whole(i64::from(i32::from_le_bytes(b)))),
            Element::I64 => each(bytes, range, out, |b| whole(i64::from_le_bytes(b))),
        }
    }
}

/// Decodes the numbers of a range, of N bytes each.
fn each<const N: usize, T>(
    bytes: &[u8],
    range: Range<usize>,
    out: &mut [T],
    decode: impl Fn([u8; N]) -> T,
) {
    let numbers = &bytes.as_chunks::<N>().0[range];
    out.iter_mut().zip(numbers).for_each(|(out, &number)| *out = decode(number));
}

fn sides(width: u64, height: u64) -> Result<(u32, u32), String> {
    let side = |side: u64| u32::try_from(side).ok().filter(|side| (1..=MAX_SIZE).contains(side));
    side(width)
        .zip(side(height))
        .ok_or_else(|| format!("{width} x {height} pixels: a side must be from 1 to {MAX_SIZE}"))
}

fn decode_png(bytes: &[u8], max_memory: u64) -> Result<Buffer, String> {
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes));
    reader.set_format(image::ImageFormat::Png);
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(max_memory);
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIZE), Some(MAX_SIZE));
    reader.limits(limits);
    let image = reader.decode().map_err(|error| error.to_string())?;
    let (width, height) = (image.width(), image.height());
    let (values, full_scale): (Vec<u32>, f32) = match image {
        image::DynamicImage::ImageLuma8(grey) => {
            (grey.into_raw().into_iter().map(u32::from).collect(), 255.0)
        }
        image::DynamicImage::ImageLuma16(grey) => {
            (grey.into_raw().into_iter().map(u32::from).collect(), 65_535.0)
        }
        other => return Err(format!("it holds {:?}, not one grey channel", other.color())),
    };
    let numbers = Numbers::Whole(values, full_scale);
    Ok(Buffer { width, height, bottom_up: false, channels: 1, numbers })
}

fn decode_npy(bytes: Vec<u8>) -> Result<Buffer, String> {
    // The length of the header stands in two bytes (version 1) or four.
    let length = match bytes[..] {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, _, a, b, ..] => {
            usize::from(u16::from_le_bytes([a, b]))
        }
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, _, a, b, c, d, ..] => {
            u32::from_le_bytes([a, b, c, d]) as usize
        }
        _ => return Err("it is no .npy file".into()),
    };
    if length > MAX_NPY_HEADER {
        return Err(format!("its header has {length} bytes, more than {MAX_NPY_HEADER}"));
    }
    let mut rest = &bytes[..];
    let header = npyz::NpyHeader::from_reader(&mut rest).map_err(|error| error.to_string())?;
    let (width, height, channels) = match *header.shape() {
        [height, width] => (width, height, 1),
        [height, width, channels @ 1..=4] => (width, height, channels as usize),
        ref shape => return Err(format!("its shape is {shape:?}, not (height, width)")),
    };
    let (width, height) = sides(width, height)?;
    if header.order() != npyz::Order::C {
        return Err("it is in Fortran order: save numpy.ascontiguousarray of it".into());
    }
    let npyz::DType::Plain(kind) = header.dtype() else {
        return Err("it holds records, not numbers".into());
    };
    let kind = kind.to_string();
    let kind = kind.trim_matches('\'');
    let element = Element::of(kind).ok_or_else(|| format!("it holds numbers of type {kind}"))?;
    let needed = width as usize * height as usize * channels;
    if rest.len() != needed * element.size() {
        let found = rest.len() / element.size();
        return Err(format!("{width} x {height} needs {needed} numbers, there are {found}"));
    }
    let start = bytes.len() - rest.len();
    let numbers = Numbers::Npy { file: bytes, start, element };
    Ok(Buffer { width, height, bottom_up: false, channels, numbers })
}
