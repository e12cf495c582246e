//! The error of every way to find coverage, in figures.

use super::named;
use crate::{Exhibit, GalleryError, Piece, Request};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::antialias::accuracy::{
    CoverageError, Method, ZonePlateError, coverage_error, near_level_bars, triangles,
    zone_plate_error,
};
use std::fmt::Write as _;

pub(super) const COVERAGE_ERROR: Exhibit = Exhibit {
    name: "coverage-error",
    about: "Coverage against exact area for every pattern and filter: RMS, largest, bias; near-level edges; moiré or noise left",
    needs: &[],
    draw,
};

const TRIANGLES: usize = 200;
const BARS: usize = 60;
const ZONE_PLATE: usize = 192;

/// Samples, then what weights them.
const WAYS: [&str; 20] = [
    "1x1",
    "2x2",
    "3x3",
    "4x4",
    "8x8",
    "16x16",
    "1x1-jittered@0.5",
    "2x2-jittered@0.25",
    "3x3-jittered",
    "4x4-jittered@0.125",
    "8x8-jittered@0.0625",
    "2x2:bartlett",
    "3x3:bartlett",
    "4x4:bartlett",
    "4x4:bartlett-3x3",
    "4x4-jittered@0.125:bartlett",
    "4x4:gaussian",
    "4x4:mitchell",
    "4x4:blackman-harris",
    "4x4:lanczos",
];

/// The errors of one way.
struct Row {
    name: &'static str,
    triangles: CoverageError,
    bars: CoverageError,
    zone_plate: Option<ZonePlateError>,
}

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = request.size.unwrap_or((900, 520));
    let rows = rows(TRIANGLES, BARS, request.seed);
    Ok(vec![
        Piece::csv("", table(&rows)),
        Piece::chart("", &chart(request.seed), size),
    ])
}

fn rows(triangle_count: usize, bar_count: usize, seed: u64) -> Vec<Row> {
    let triangles = triangles(triangle_count, seed);
    let bars = near_level_bars(bar_count, seed);
    let row = |name, method, zone_plate| Row {
        name,
        triangles: coverage_error(method, &triangles),
        bars: coverage_error(method, &bars),
        zone_plate,
    };
    let sampled = WAYS.map(|name| {
        let antialiasing = named(name);
        let pattern = antialiasing.pattern.with_seed(seed);
        let antialiasing = antialiasing.with_pattern(pattern);
        let zone_plate = zone_plate_error(antialiasing, ZONE_PLATE);
        row(name, Method::Samples(antialiasing), Some(zone_plate))
    });
    let areas = [
        row("area", Method::Area, None),
        row("area, 8 bits", Method::Area8, None),
    ];
    sampled.into_iter().chain(areas).collect()
}

fn table(rows: &[Row]) -> String {
    let mut csv = String::from(
        "antialiasing,pixels,rms,rms_255,largest,bias,near_level_rms,near_level_largest,moire_or_noise_rms,contrast_kept\n",
    );
    for row in rows {
        let t = row.triangles;
        let zone_plate = row.zone_plate.map_or(String::from(","), |error| {
            format!("{:.5},{:.5}", error.moire, error.kept)
        });
        let _ = writeln!(
            csv,
            "\"{}\",{},{:.7},{:.4},{:.6},{:.7},{:.7},{:.6},{zone_plate}",
            row.name,
            t.pixels,
            t.rms,
            t.rms * 255.0,
            t.largest,
            t.bias,
            row.bars.rms,
            row.bars.largest
        );
    }
    csv
}

/// RMS error over the number of samples in a row of a pixel.
fn chart(seed: u64) -> Chart {
    let (triangles, bars) = (triangles(60, seed), near_level_bars(30, seed));
    let curve = |name: &str, jitter: bool, polygons: &[_]| {
        let point = |k: u32| {
            let bound = 0.5 / f64::from(k);
            let way = match jitter {
                true => named(&format!("{k}x{k}-jittered@{bound}")),
                false => named(&format!("{k}x{k}")),
            };
            let error = coverage_error(Method::Samples(way), polygons);
            (f64::from(k), error.rms)
        };
        Curve::new(name, (1..=12).map(point).collect())
    };
    Chart {
        title: String::from("RMS error of coverage (1 / 255 = 0.4 %)"),
        x_label: String::from("samples per pixel in each direction"),
        y_label: String::from("RMS error at edges"),
        x_scale: Scale::Linear,
        y_scale: Scale::Logarithmic,
        curves: vec![
            curve("regular", false, &triangles),
            curve("jittered", true, &triangles),
            curve("regular, near level", false, &bars),
            curve("jittered, near level", true, &bars),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_has_every_way_and_areas_are_exact() {
        let rows = rows(6, 2, 1);
        let csv = table(&rows);
        assert_eq!(csv.lines().count(), WAYS.len() + 3, "{csv}");
        let columns = |line: &str| line.replace("area, 8", "area 8").split(',').count();
        assert!(csv.lines().all(|line| columns(line) == 10), "{csv}");
        let area = &rows[WAYS.len()];
        assert!(
            area.triangles.rms < 1e-5 && area.bars.largest < 1e-5,
            "{csv}"
        );
        assert!(
            rows[0].triangles.rms > 10.0 * rows[4].triangles.rms,
            "{csv}"
        );
    }
}
