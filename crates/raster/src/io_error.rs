//! What the system says about a file, in words.

use std::io::{Error, ErrorKind};

/// An error of the system as part of a line, without its number: "there is no such file" for a name that leads nowhere.
/// Errors that carry a text of their own keep it.
pub fn in_words(error: &Error) -> String {
    if error.get_ref().is_some() {
        return error.to_string();
    }
    let known = match error.kind() {
        ErrorKind::NotFound => "there is no such file",
        ErrorKind::PermissionDenied => "access is not permitted",
        ErrorKind::IsADirectory => "is a folder; name a file in it",
        ErrorKind::NotADirectory => "a part of its path is a file, not a folder",
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::UnexpectedEof => "the file ends too early",
        ErrorKind::InvalidFilename => "the system allows no such name",
        _ => return without_number(&error.to_string()),
    };
    String::from(known)
}

/// "No space left on device (os error 28)" without its end.
fn without_number(text: &str) -> String {
    let end = text.find(" (os error").unwrap_or(text.len());
    text[..end].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_says_has_no_number() {
        let missing = std::fs::read("/no/such/file").expect_err("nothing is there");
        assert_eq!(in_words(&missing), "there is no such file");
        for code in 1..40 {
            let text = in_words(&Error::from_raw_os_error(code));
            assert!(
                !text.contains("os error") && !text.is_empty(),
                "{code}: {text}"
            );
        }
        assert_eq!(
            in_words(&Error::other("is a pipe")),
            "is a pipe",
            "its own text"
        );
    }
}
