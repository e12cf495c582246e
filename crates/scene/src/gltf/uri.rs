//! References from a scene file to the files beside it.

use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use hemicube_raster::io_error::in_words;
use percent_encoding::percent_decode_str;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// Largest file that is read.
const MAX_FILE_BYTES: u64 = 2 << 30;

/// The bytes of a URI: a `data:` URI or a file relative to the folder.
pub fn bytes(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        return inline(data);
    }
    if has_scheme(uri) {
        return Err(format!(
            "'{}' is not a file beside this one; put a copy there",
            short(uri)
        ));
    }
    let name = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("'{}' is not UTF-8", short(uri)))?;
    read(&relative(&name, folder)?).map_err(|e| unread(&name, &e))
}

/// Whether a name begins with a scheme (RFC 3986, section 3.1) or with a drive letter.
pub fn has_scheme(name: &str) -> bool {
    let is_scheme = |scheme: &str| {
        !scheme.is_empty()
            && scheme
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b"+-.".contains(&b))
    };
    name.split_once(':')
        .is_some_and(|(scheme, _)| is_scheme(scheme))
}

/// The path of a relative name inside a folder; absolute paths are refused.
///
/// Backslashes, which some exporters write, count as slashes.
pub fn relative(name: &str, folder: Option<&Path>) -> Result<PathBuf, String> {
    let name = name.replace('\\', "/");
    let path = Path::new(&name);
    if name.is_empty() || name.starts_with('/') || path.is_absolute() {
        return Err(format!(
            "'{}' is not a relative file name; put a copy beside this file",
            short(&name)
        ));
    }
    let folder = folder.ok_or_else(|| {
        format!(
            "'{}' is a file of its own and no folder is known",
            short(&name)
        )
    })?;
    Ok(folder.join(path))
}

/// The bytes of a regular file of a bearable size.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let facts = std::fs::metadata(path)?;
    if facts.is_dir() {
        return Err(io::Error::other(
            "it is a folder; name the scene file in it",
        ));
    }
    if !facts.is_file() {
        return Err(io::Error::other(
            "it is not a regular file; make a copy that is",
        ));
    }
    if facts.len() > MAX_FILE_BYTES {
        return Err(io::Error::other(format!(
            "its {} bytes are more than 2 GiB; split the scene",
            facts.len()
        )));
    }
    let mut bytes = Vec::new();
    // The limit holds even if the file grows meanwhile.
    std::fs::File::open(path)?
        .take(MAX_FILE_BYTES)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Why a file beside this one is not there, and what to do.
pub fn unread(name: &str, error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => {
            format!("'{}' is not there; put it beside this file", short(name))
        }
        _ => format!("'{}': {}", short(name), in_words(error)),
    }
}

/// The bytes after `data:` (RFC 2397).
fn inline(data: &str) -> Result<Vec<u8>, String> {
    let (kind, body) = data
        .split_once(',')
        .ok_or("its data URI has no comma, so no data")?;
    if kind.ends_with(";base64") {
        let config =
            GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let engine = GeneralPurpose::new(&STANDARD, config);
        engine
            .decode(body)
            .map_err(|e| format!("its data URI is not base64: {e}"))
    } else {
        Ok(percent_decode_str(body).collect())
    }
}

/// The beginning of a name that may be a megabyte of something else.
fn short(name: &str) -> String {
    name.chars().take(120).collect()
}
