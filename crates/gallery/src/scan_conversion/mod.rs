//! Scan conversion: lines, circles, ellipses, strokes and polygons, pixel by pixel.

mod curves;
mod figure;
mod fills;
mod lines;

use crate::Exhibit;

pub(crate) const EXHIBITS: &[Exhibit] = &[
    lines::LINES,
    curves::CIRCLES,
    curves::ELLIPSES,
    fills::THICK_AND_DASHED,
    fills::FILL_RULES,
    lines::ANTIALIASED_LINES,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Request;

    #[test]
    fn every_exhibit_draws_at_a_small_and_at_its_own_size() {
        for exhibit in EXHIBITS {
            for size in [Some((640, 360)), None] {
                let request = Request {
                    size,
                    ..Request::default()
                };
                let pieces = (exhibit.draw)(&request).expect("it needs no files");
                assert!(!pieces.is_empty(), "{}", exhibit.name);
                assert!(
                    pieces.iter().all(|p| p.bytes.len() > 500),
                    "{}",
                    exhibit.name
                );
            }
        }
    }
}
