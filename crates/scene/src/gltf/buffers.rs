//! The bytes of buffers and buffer views.

use super::{Source, uri};
use gltf::json::Root;
use std::borrow::Cow;
use std::path::Path;

/// All buffers together may have so many bytes.
const MAX_TOTAL: u64 = 4 << 30;

/// Every buffer of the document, cut to the length it states.
pub fn load<'a>(
    root: &Root,
    binary: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<Vec<Cow<'a, [u8]>>, String> {
    let mut buffers = Vec::new();
    let mut total = 0;
    for (i, buffer) in root.buffers.iter().enumerate() {
        let mut bytes: Cow<'a, [u8]> = match (&buffer.uri, binary) {
            (Some(uri), _) => uri::bytes(uri, folder)
                .map_err(|e| format!("buffer {i}: {e}"))?
                .into(),
            (None, Some(binary)) if i == 0 => binary.into(),
            (None, _) if is_fallback(buffer) => Cow::default(),
            (None, _) => {
                return Err(format!(
                    "buffer {i}: it names no data (no uri, no BIN chunk); export the file again"
                ));
            }
        };
        let stated = buffer.byte_length.0;
        if stated == 0 {
            return Err(format!(
                "buffer {i}: it is empty (byteLength 0 or missing); export the file again"
            ));
        }
        if (bytes.len() as u64) < stated && !is_fallback(buffer) {
            let there = bytes.len();
            return Err(format!(
                "buffer {i}: {stated} bytes are stated, {there} are there; export or copy it again"
            ));
        }
        total += bytes.len() as u64;
        if total > MAX_TOTAL {
            return Err(format!(
                "buffer {i}: the buffers have more than 4 GiB together; split the scene"
            ));
        }
        if let (Ok(stated), Cow::Borrowed(all)) = (usize::try_from(stated), &bytes) {
            bytes = Cow::Borrowed(all.get(..stated).unwrap_or(all));
        } else if let (Ok(stated), Cow::Owned(all)) = (usize::try_from(stated), &mut bytes) {
            all.truncate(stated);
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// A placeholder of `EXT_meshopt_compression` that has no bytes.
fn is_fallback(buffer: &gltf::json::Buffer) -> bool {
    buffer
        .extensions
        .as_ref()
        .is_some_and(|e| e.others.contains_key("EXT_meshopt_compression"))
}

impl<'a> Source<'a> {
    /// The bytes of a buffer view and the stride it states.
    pub fn view(self, index: usize) -> Result<(&'a [u8], Option<usize>), String> {
        let views = &self.root.buffer_views;
        let view = views
            .get(index)
            .ok_or_else(|| format!("buffer view {index} of {}", views.len()))?;
        let number = view.buffer.value();
        let buffer: &'a [u8] = self.buffers.get(number).ok_or_else(|| {
            format!(
                "buffer view {index}: buffer {number} of {}",
                self.buffers.len()
            )
        })?;
        let (offset, length) = (view.byte_offset.unwrap_or_default().0, view.byte_length.0);
        let bytes = part(buffer, offset, length).ok_or_else(|| {
            let there = buffer.len();
            format!("buffer view {index}: bytes {offset} + {length} of buffer {number}, which has {there}")
        })?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// A range of bytes if all of it is there.
pub fn part(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let end = offset.checked_add(length)?;
    bytes.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?)
}
