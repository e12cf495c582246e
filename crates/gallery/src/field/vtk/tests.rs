use super::*;

const CUBE: &str = "# vtk DataFile Version 3.0\na cube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n\
    0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n\
    CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n\
    CELL_DATA 1\nSCALARS load int 1\nLOOKUP_TABLE default\n5\n\
    POINT_DATA 8\nVECTORS way float\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n\
    FIELD FieldData 2\nheat%20flow 1 8 double\n1 2 3 4 5 6 7 8\nMETADATA\nINFORMATION 0\n\nway 2 8 float\n\
    0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

#[test]
fn text_is_read() {
    let cube = Dataset::parse(CUBE.as_bytes()).expect("a cube");
    assert_eq!(cube.points.len(), 8, "points");
    assert_eq!(cube.points[6], Vec3::ONE, "a corner");
    let Cells::Unstructured(cells) = &cube.cells else {
        panic!("unstructured");
    };
    assert_eq!(
        cells[..],
        [(12, vec![0, 1, 2, 3, 4, 5, 6, 7])],
        "one hexahedron"
    );
    assert_eq!(cube.cell_scalars[0].values, [5.0], "of the cell");
    assert_eq!(cube.point_scalars.len(), 1, "only arrays of one component");
    assert_eq!(cube.point_scalars[0].name, "heat flow", "its name");
    assert_eq!(cube.point_scalars[0].values[7], 8.0, "its last value");
}

#[test]
fn version_5_is_read() {
    let text = CUBE.replace(
        "CELLS 1 9\n8 0 1 2 3 4 5 6 7",
        "CELLS 2 8\nOFFSETS vtktypeint64\n0 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 5 6 7",
    );
    let cube = Dataset::parse(text.as_bytes()).expect("a cube");
    assert_eq!(cube.cell_count(), 1, "cells");
    let descending = text.replace("\n0 8\n", "\n8 0\n");
    let line = Dataset::parse(descending.as_bytes()).expect_err("no cell");
    assert!(line.contains("descend"), "{line}");
}

#[test]
fn binary_is_read() {
    let mut bytes = b"# vtk DataFile Version 3.0\nbox\nBINARY\nDATASET STRUCTURED_POINTS\n\
        DIMENSIONS 2 3 1\nSPACING 1 2 1\nORIGIN 5 0 0\nPOINT_DATA 6\nSCALARS s short\nLOOKUP_TABLE default\n"
        .to_vec();
    for value in [1_i16, -2, 300, 4, 5, 10] {
        bytes.extend(value.to_be_bytes());
    }
    let grid = Dataset::parse(&bytes).expect("a grid");
    assert_eq!(grid.points[5], Vec3::new(6.0, 4.0, 0.0), "the last point");
    assert_eq!(
        grid.point_scalars[0].values,
        [1.0, -2.0, 300.0, 4.0, 5.0, 10.0],
        "values"
    );
    let line = Dataset::parse(&bytes[..bytes.len() - 1]).expect_err("cut off");
    assert!(line.contains("cut off"), "{line}");
}

#[test]
fn what_is_broken_is_refused_in_one_line() {
    let edits = [
        ("# vtk", "# xml", "no legacy VTK"),
        ("ASCII", "TEXT", "where ASCII or BINARY"),
        (
            "UNSTRUCTURED_GRID",
            "POLYDATA",
            "a dataset of kind 'POLYDATA'",
        ),
        ("POINTS 8", "POINTS 99999999999999999999", "from 0 to"),
        ("POINTS 8", "POINTS 1000000", "it was cut off"),
        ("POINTS 8", "POINTS 2000000", "at most 1048576"),
        ("POINTS 8", "POINTS 9", "is no finite number"),
        ("POINTS 8 float", "POINTS 8 color", "type 'color'"),
        ("1 0 0 1 1 0", "1 0 0 1 NaN 0", "'NaN' is no finite number"),
        ("1 0 0 1 1 0", "1 0 0 1 1e30 0", "a point at"),
        (
            "CELLS 1 9\n8 0",
            "CELLS 2 9\n8 0",
            "2 cells announced, 1 are there",
        ),
        (
            "CELLS 1 9\n8 0",
            "CELLS 1 9\n-1 0",
            "a number of corners of -1",
        ),
        (
            "5 6 7\nCELL",
            "5 6 8\nCELL",
            "a cell with point 8, there are 8",
        ),
        ("5 6 7\nCELL", "5 6 -1\nCELL", "a cell with point -1"),
        ("CELL_TYPES 1", "CELL_TYPES 2", "2 cell types for 1 cells"),
        ("CELL_DATA 1", "CELL_DATA 3", "data of 3 cells, there are 1"),
        (
            "POINT_DATA 8",
            "POINT_DATA 7",
            "data of 7 points, there are 8",
        ),
        ("FieldData 2", "FieldData 900000", "cut off"),
        ("VECTORS", "GARBAGE", "'GARBAGE' is not known"),
    ];
    for (from, to, word) in edits {
        let text = CUBE.replacen(from, to, 1);
        assert_ne!(text, CUBE, "{from} is there");
        let line = Dataset::parse(text.as_bytes()).expect_err(to);
        assert!(line.contains(word), "{to}: {line}");
        assert!(!line.contains('\n') && line.len() < 160, "{line}");
    }
}

#[test]
fn no_cut_and_no_changed_byte_breaks_the_reader() {
    for end in 0..CUBE.len() {
        let _ = Dataset::parse(&CUBE.as_bytes()[..end]);
    }
    for i in 0..CUBE.len() {
        for byte in [0, b'9', b'-', b' ', b'\n', 0xff] {
            let mut bytes = CUBE.as_bytes().to_vec();
            bytes[i] = byte;
            let _ = Dataset::parse(&bytes);
        }
    }
}

#[test]
fn grids_that_promise_too_much_are_refused() {
    let grid = |dimensions: &str| {
        format!(
            "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {dimensions}\n\
             POINT_DATA 1\nSCALARS s float\nLOOKUP_TABLE default\n1\n"
        )
    };
    for (dimensions, word) in [
        ("4000000 4000000 4000000", "points"),
        ("2000 2000 2000", "points"),
        ("2 2 2", "scalars of another number"),
        ("0 2 2", "scalars of another number"),
        ("9999999999 1 1", "from 0 to"),
    ] {
        let line = Dataset::parse(grid(dimensions).as_bytes()).expect_err(dimensions);
        assert!(line.contains(word), "{line}");
    }
    assert!(
        Dataset::parse(grid("1 1 1").as_bytes()).is_ok(),
        "one point"
    );
}
