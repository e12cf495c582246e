//! The binary container of a `.glb` file (glTF 2.0, section 4.4).

/// The parts of a file.
#[derive(Debug)]
pub struct Container<'a> {
    /// The JSON text, not yet looked at.
    pub json: &'a [u8],
    /// The `BIN` chunk of a `.glb`.
    pub binary: Option<&'a [u8]>,
}

/// Why the container cannot be taken apart.
#[derive(Debug)]
pub enum Refusal {
    /// A `.glb` of glTF 1.0.
    Version1,
    /// What is wrong with it.
    Damaged(String),
}

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// Splits a `.glb`; anything that does not begin with its magic is taken as JSON.
pub fn split(bytes: &[u8]) -> Result<Container<'_>, Refusal> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container {
            json: bytes,
            binary: None,
        });
    }
    let damaged = |message: String| Err(Refusal::Damaged(message));
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return damaged(format!(
            "a .glb of {} bytes is cut off within its header; copy it again",
            bytes.len()
        ));
    };
    match version {
        1 => return Err(Refusal::Version1),
        2 => {}
        other => {
            return damaged(format!(
                "a .glb of container version {other}; export it again as glTF 2.0"
            ));
        }
    }
    let length = length as usize;
    if length > bytes.len() {
        return damaged(format!(
            "the .glb says it has {length} bytes, there are {}; copy it again",
            bytes.len()
        ));
    }
    if length < HEADER {
        return damaged(format!(
            "the .glb says it has {length} bytes, its header alone has {HEADER}; export it again"
        ));
    }
    chunks(&bytes[HEADER..length])
}

/// The JSON chunk, which must be the first, and the first binary one; chunks of other kinds are passed over.
fn chunks(mut rest: &[u8]) -> Result<Container<'_>, Refusal> {
    let (mut json, mut binary) = (None, None);
    let mut number = 0;
    while let (Some(length), Some(kind)) = (word(rest, 0), word(rest, 4)) {
        let body = &rest[CHUNK_HEADER..];
        let Some(chunk) = body.get(..length as usize) else {
            let there = body.len();
            let message = format!(
                "chunk {number} of the .glb has {length} bytes, {there} are left; copy it again"
            );
            return Err(Refusal::Damaged(message));
        };
        match kind {
            JSON if number == 0 => json = Some(chunk),
            BIN if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        rest = &body[chunk.len()..];
        number += 1;
    }
    let json = json.ok_or_else(|| {
        Refusal::Damaged(String::from(
            "the .glb does not begin with a JSON chunk; export it again",
        ))
    })?;
    Ok(Container { json, binary })
}

/// The little-endian word at a place, if it is there.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*word))
}
