//! Arrays of numbers inside buffers: strided, normalized, sparse.

use super::super::error::{Fault, malformed};
use super::super::limits::Budget;
use super::Document;

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    pub(super) fn from_code(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// In bytes.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    pub(super) fn is_index(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// How many numbers an element of this type has; the padding of matrix columns not counted, as
/// matrices are never read.
pub(super) fn component_count(kind: &str) -> Option<u64> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => return None,
    })
}

/// Elements at a constant distance.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Strided<'a> {
    /// Element `i`, `size` bytes. The file was checked to hold it.
    fn at(&self, i: usize, size: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..size]
    }
}

/// Replaces some elements of an accessor.
struct Replaced<'a> {
    indices: Strided<'a>,
    index: Component,
    values: Strided<'a>,
    count: usize,
}

/// The elements of an accessor, each read when it is asked for.
pub(super) struct Elements<'a> {
    /// Absent where all elements that are not replaced are zero.
    base: Option<Strided<'a>>,
    replaced: Option<Replaced<'a>>,
    component: Component,
    components: usize,
    normalized: bool,
    count: usize,
}

impl<'a> Elements<'a> {
    /// The elements of accessor `index`.
    ///
    /// # Errors
    ///
    /// When the accessor holds no data, only compressed data, or replaces elements out of order.
    pub(super) fn of(
        document: &'a Document<'_>,
        index: usize,
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let accessor = &document.root.accessors[index];
        let known = Component::from_code(accessor.component_type);
        let (component, components) =
            known.zip(component_count(&accessor.kind)).expect("accessors are checked");
        let size = (component.size() * components) as usize;
        let base = match accessor.buffer_view {
            Some(view) => {
                let stride = document.root.buffer_views[view].byte_stride;
                let stride = stride.map_or(size, |stride| stride as usize);
                let bytes = document.buffers.view(&document.root, view)?;
                Some(Strided { bytes: tail(bytes, accessor.byte_offset), stride })
            }
            None => None,
        };
        let replaced = match &accessor.sparse {
            Some(sparse) => {
                // Their order is checked at every use: time, bounded like memory.
                budget.memory(sparse.count.saturating_mul(4), "sparse accessors")?;
                let view = |view| document.buffers.view(&document.root, view);
                let (indices, values) = (&sparse.indices, &sparse.values);
                let index = Component::from_code(indices.component_type);
                let index = index.expect("accessors are checked");
                let index_bytes = tail(view(indices.buffer_view)?, indices.byte_offset);
                let value_bytes = tail(view(values.buffer_view)?, values.byte_offset);
                Some(Replaced {
                    indices: Strided { bytes: index_bytes, stride: index.size() as usize },
                    index,
                    values: Strided { bytes: value_bytes, stride: size },
                    count: sparse.count as usize,
                })
            }
            None => None,
        };
        if base.is_none() && replaced.is_none() {
            return Err(malformed(format!("accessors[{index}] holds no data")));
        }
        let count = usize::try_from(accessor.count).map_err(|_| {
            Fault::TooLarge(format!("accessors[{index}] has more elements than memory"))
        })?;
        let normalized = accessor.normalized;
        let components = components as usize;
        let elements = Self { base, replaced, component, components, normalized, count };
        if !elements.replaced_in_order() {
            let place = format!("accessors[{index}].sparse");
            return Err(malformed(format!("{place}: indices do not increase or are out of range")));
        }
        Ok(elements)
    }

    fn replaced_in_order(&self) -> bool {
        let Some(replaced) = &self.replaced else { return true };
        let index = |k| unsigned(replaced.indices.at(k, replaced.indices.stride), replaced.index);
        let increasing = (1..replaced.count).all(|k| index(k - 1) < index(k));
        let last = replaced.count.checked_sub(1).map(index);
        increasing && last.is_none_or(|last| (last as usize) < self.count)
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Numbers per element.
    pub(super) fn components(&self) -> usize {
        self.components
    }

    pub(super) fn component(&self) -> Component {
        self.component
    }

    /// The bytes of element `i` below `count`, `None` where it is zero.
    fn bytes(&self, i: usize) -> Option<&'a [u8]> {
        let size = self.component.size() as usize * self.components;
        if let Some(replaced) = &self.replaced {
            let index =
                |k| unsigned(replaced.indices.at(k, replaced.indices.stride), replaced.index);
            let (mut low, mut high) = (0, replaced.count);
            while low < high {
                let middle = low + (high - low) / 2;
                match (index(middle) as usize).cmp(&i) {
                    std::cmp::Ordering::Less => low = middle + 1,
                    std::cmp::Ordering::Equal => return Some(replaced.values.at(middle, size)),
                    std::cmp::Ordering::Greater => high = middle,
                }
            }
        }
        self.base.map(|base| base.at(i, size))
    }

    /// Element `i` below `count` as an unsigned integer; for accessors of one such number.
    pub(super) fn index(&self, i: usize) -> u32 {
        self.bytes(i).map_or(0, |bytes| unsigned(bytes, self.component))
    }

    /// The first `N` numbers of element `i` below `count`; those that it has not are zero.
    pub(super) fn floats<const N: usize>(&self, i: usize) -> [f32; N] {
        let mut numbers = [0.0; N];
        if let Some(bytes) = self.bytes(i) {
            let size = self.component.size() as usize;
            for (number, bytes) in numbers.iter_mut().zip(bytes.chunks_exact(size)) {
                *number = self.float(bytes);
            }
        }
        numbers
    }

    fn float(&self, bytes: &[u8]) -> f32 {
        let scale = |value: f32, largest: f32| {
            if self.normalized { (value / largest).max(-1.0) } else { value }
        };
        match (self.component, bytes) {
            (Component::I8, &[a]) => scale(f32::from(a as i8), 127.0),
            (Component::U8, &[a]) => scale(f32::from(a), 255.0),
            (Component::I16, &[a, b]) => scale(f32::from(i16::from_le_bytes([a, b])), 32_767.0),
            (Component::U16, &[a, b]) => scale(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            (Component::U32, _) => unsigned(bytes, Component::U32) as f32,
            (Component::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            _ => unreachable!("an element has the size of its type"),
        }
    }
}

fn unsigned(bytes: &[u8], component: Component) -> u32 {
    match (component, bytes) {
        (Component::U8, &[a]) => a.into(),
        (Component::U16, &[a, b]) => u16::from_le_bytes([a, b]).into(),
        (Component::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => unreachable!("indices are checked to be unsigned integers"),
    }
}

/// What follows `offset`, which is inside unless the accessor is empty.
fn tail(bytes: &[u8], offset: u64) -> &[u8] {
    usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).unwrap_or_default()
}
