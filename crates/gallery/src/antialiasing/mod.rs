//! Antialiasing: what it is against, what it costs, and how the ways to do it differ.

mod coverage_error;
mod filters;
mod horizon;
mod phrase;
mod tiny_polygons;
mod zone_plate;

use crate::{Exhibit, GalleryError, Request};

/// From the phrase of the first lesson to the table of the last.
pub(crate) const EXHIBITS: &[Exhibit] = &[
    phrase::PHRASE,
    phrase::PHRASE_IN_FONT,
    tiny_polygons::TINY_POLYGONS,
    horizon::CHECKERBOARD_HORIZON,
    zone_plate::ZONE_PLATE,
    filters::FILTERS,
    coverage_error::COVERAGE_ERROR,
];

/// An antialiasing that this module names itself.
fn named(name: &str) -> hemicube_raster::antialias::Antialiasing {
    name.parse().expect("names of this module are right")
}

/// The size asked for, or the exhibit's own.
fn picture_size(
    request: &Request,
    default: (usize, usize),
) -> Result<(usize, usize), GalleryError> {
    crate::sheet::picture_size(request, default, 64..=8192)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exhibits_that_need_no_file_draw_small() {
        let request = Request {
            size: Some((96, 96)),
            ..Request::default()
        };
        for exhibit in EXHIBITS.iter().filter(|exhibit| exhibit.needs.is_empty()) {
            let pieces = (exhibit.draw)(&request);
            let pieces = pieces.unwrap_or_else(|error| panic!("{}: {error}", exhibit.name));
            let mut suffixes: Vec<&str> = pieces.iter().map(|p| p.suffix.as_str()).collect();
            suffixes.sort_unstable();
            suffixes.dedup();
            assert_eq!(suffixes.len(), pieces.len(), "files of {}", exhibit.name);
            let is_full = pieces.iter().all(|piece| !piece.bytes.is_empty());
            assert!(is_full && !pieces.is_empty(), "{}", exhibit.name);
        }
    }

    #[test]
    fn sizes_that_make_no_sense_are_refused() {
        for size in [(0, 0), (10, 500), (100_000, 100)] {
            let request = Request {
                size: Some(size),
                ..Request::default()
            };
            let error = picture_size(&request, (1, 1)).expect_err("no size to draw");
            assert!(error.to_string().contains("ask for"), "{error}");
        }
    }

    #[test]
    fn font_that_is_not_there_is_named() {
        let request = Request {
            files: vec!["no such font.ttf".into()],
            ..Request::default()
        };
        let error = (phrase::PHRASE_IN_FONT.draw)(&request).expect_err("no file");
        assert!(
            error.to_string().starts_with("no such font.ttf: "),
            "{error}"
        );
    }
}
