//! Typed elements of buffers (glTF 2.0, section 3.6.2), read one by one: nothing is allocated for a stated count.

use super::Source;
use super::buffers::part;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;

/// The elements of an accessor; every one of `count` is known to lie within its bytes.
#[derive(Debug)]
pub struct Elements<'a> {
    /// Number of elements.
    pub count: usize,
    /// Components of an element: 1 to 4.
    pub width: usize,
    /// Whether there are any bytes: an accessor may be nothing but zeros.
    pub has_data: bool,
    component: ComponentType,
    normalized: bool,
    /// Bytes from the first element on and the step to the next; none are all zeros.
    dense: Option<(&'a [u8], usize)>,
    /// Elements that the sparse part replaces, ascending: `(element, place among the values)`.
    replaced: Vec<(u32, usize)>,
    values: &'a [u8],
}

impl<'a> Source<'a> {
    /// The elements of an accessor of scalars or vectors; the error says what does not fit.
    pub fn elements(self, index: usize) -> Result<Elements<'a>, String> {
        let all = &self.root.accessors;
        let accessor = all
            .get(index)
            .ok_or_else(|| format!("accessor {index} of {}", all.len()))?;
        let fail = |message: String| format!("accessor {index}: {message}");
        let Checked::Valid(component) = accessor.component_type else {
            return Err(fail(String::from("its componentType is none of glTF's")));
        };
        let width = match accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            _ => {
                return Err(fail(String::from(
                    "it is neither SCALAR nor VEC2, VEC3, VEC4",
                )));
            }
        };
        let count = u32::try_from(accessor.count.0).map_err(|_| {
            fail(format!(
                "{} elements are more than 32-bit indices reach",
                accessor.count.0
            ))
        })?;
        let mut elements = Elements {
            count: count as usize,
            width,
            has_data: accessor.buffer_view.is_some() || accessor.sparse.is_some(),
            component: component.0,
            normalized: accessor.normalized,
            dense: None,
            replaced: Vec::new(),
            values: &[],
        };
        if let Some(view) = accessor.buffer_view {
            let (bytes, stride) = self.view(view.value()).map_err(fail)?;
            let size = elements.size();
            let stride = stride.unwrap_or(size);
            let offset = accessor.byte_offset.unwrap_or_default().0;
            elements.dense = Some(strided(bytes, offset, stride, size, count).map_err(fail)?);
        }
        if let Some(sparse) = &accessor.sparse {
            self.read_sparse(sparse, &mut elements)
                .map_err(|e| fail(format!("sparse: {e}")))?;
        }
        Ok(elements)
    }

    /// Fills in which elements the sparse part replaces by what.
    fn read_sparse(
        self,
        sparse: &gltf::json::accessor::sparse::Sparse,
        to: &mut Elements<'a>,
    ) -> Result<(), String> {
        let count = sparse.count.0;
        if count > to.count as u64 {
            return Err(format!("{count} values for {} elements", to.count));
        }
        let count = u32::try_from(count).map_err(|e| e.to_string())?;
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(String::from("the type of its indices is none of glTF's"));
        };
        let (bytes, _) = self.view(sparse.indices.buffer_view.value())?;
        let size = component.0.size();
        let (indices, _) = strided(bytes, sparse.indices.byte_offset.0, size, size, count)?;
        let (bytes, _) = self.view(sparse.values.buffer_view.value())?;
        (to.values, _) = strided(
            bytes,
            sparse.values.byte_offset.0,
            to.size(),
            to.size(),
            count,
        )?;
        for (place, bytes) in indices.chunks_exact(size).take(count as usize).enumerate() {
            let element = integer(component.0, bytes);
            if element as usize >= to.count {
                return Err(format!(
                    "value {place} is for element {element} of {}",
                    to.count
                ));
            }
            to.replaced.push((element, place));
        }
        to.replaced.sort_by_key(|&(element, _)| element);
        Ok(())
    }
}

/// Bytes from an offset on that hold `count` elements, and their stride; checked.
fn strided(
    bytes: &[u8],
    offset: u64,
    stride: usize,
    size: usize,
    count: u32,
) -> Result<(&[u8], usize), String> {
    if stride < size {
        return Err(format!(
            "elements of {size} bytes do not fit a stride of {stride}"
        ));
    }
    if count == 0 {
        return Ok((&[], stride));
    }
    let length = (stride as u64)
        .checked_mul(u64::from(count) - 1)
        .and_then(|n| n.checked_add(size as u64));
    length.and_then(|length| part(bytes, offset, length)).map(|bytes| (bytes, stride)).ok_or_else(|| {
        let there = bytes.len();
        format!("{count} elements of {size} bytes every {stride} from byte {offset} need more than the {there} there are")
    })
}

impl Elements<'_> {
    /// Bytes of an element.
    fn size(&self) -> usize {
        self.width * self.component.size()
    }

    /// Whether indices can be stored like this.
    pub fn is_index(&self) -> bool {
        use ComponentType::{U8, U16, U32};
        self.width == 1 && matches!(self.component, U8 | U16 | U32)
    }

    /// Reads integers as fractions of their range, as colours are stored.
    pub fn with_normalized(self) -> Self {
        Self {
            normalized: true,
            ..self
        }
    }

    /// An element's bytes; `None` means zeros.
    fn bytes(&self, element: usize) -> Option<&[u8]> {
        let replaced = self
            .replaced
            .partition_point(|&(e, _)| e as usize <= element)
            .checked_sub(1);
        match replaced.map(|i| self.replaced[i]) {
            Some((e, place)) if e as usize == element => Some(&self.values[place * self.size()..]),
            _ => self.dense.map(|(bytes, stride)| &bytes[element * stride..]),
        }
    }

    /// The components of an element below `count`; those it does not have are 0.
    pub fn vector<const N: usize>(&self, element: usize) -> [f32; N] {
        let mut vector = [0.0; N];
        if let Some(bytes) = self.bytes(element) {
            let size = self.component.size();
            for (value, bytes) in vector
                .iter_mut()
                .zip(bytes.chunks_exact(size))
                .take(self.width)
            {
                *value = number(self.component, self.normalized, bytes);
            }
        }
        vector
    }

    /// An element below `count` as an index.
    pub fn index(&self, element: usize) -> u32 {
        self.bytes(element)
            .map_or(0, |bytes| integer(self.component, bytes))
    }
}

/// An unsigned integer; 0 for other types.
fn integer(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[a, ..]) => u32::from(a),
        (ComponentType::U16, &[a, b, ..]) => u32::from(u16::from_le_bytes([a, b])),
        (ComponentType::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

/// A component as a number; normalised integers by the formulas of glTF 2.0, section 3.6.2.2.
fn number(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, range) = match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a, ..]) => (f32::from(a.cast_signed()), 127.0),
        (ComponentType::I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), 32_767.0),
        (ComponentType::U8, _) => (integer(component, bytes) as f32, 255.0),
        (ComponentType::U16, _) => (integer(component, bytes) as f32, 65_535.0),
        _ => (integer(component, bytes) as f32, u32::MAX as f32),
    };
    if normalized {
        (value / range).max(-1.0)
    } else {
        value
    }
}
