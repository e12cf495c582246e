//! Exact form factors against reference values: polygons, boxes and differential elements.
//!
//! `data/view_factors.json` holds values of closed forms and of quadrature in 25 digits, each checked by independent
//! methods; `data/view_factors_external.json` what other programs expect, beside the value of the closed form. Not here:
//! round bodies; the tests count them.

use glam::DVec3;
use hemicube::radiosity::form_factor::{analytic, nusselt};
use serde_json::Value;
use std::collections::BTreeMap;

/// Asked of every polygon pair, absolute. No entry needs an exception.
const PAIRS: f64 = 1e-8;
/// What is reached; where it grows, something broke.
const PAIRS_REACHED: f64 = 1e-13;
/// Asked of every element.
const ELEMENTS: f64 = 1e-12;

fn entries(text: &str, list: &str) -> Vec<Value> {
    let root: Value = serde_json::from_str(text).expect("the reference data is JSON");
    root[list].as_array().expect("a list of entries").clone()
}

fn references() -> Vec<Value> {
    entries(include_str!("../data/view_factors.json"), "references")
}

fn external() -> Vec<Value> {
    entries(include_str!("../data/view_factors_external.json"), "cases")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| number(&value[i])))
}

/// The corners of a surface that is a polygon.
fn polygon(surface: &Value) -> Option<Vec<DVec3>> {
    (surface["type"] == "polygon").then(|| {
        let vertices = surface["vertices"]
            .as_array()
            .expect("polygons have corners");
        vertices.iter().map(vector).collect()
    })
}

fn kind(surface: &Value) -> &str {
    surface["type"].as_str().unwrap_or("other")
}

fn occluded(entry: &Value) -> bool {
    entry["occluders"].as_array().is_some_and(|o| !o.is_empty())
}

fn name(entry: &Value) -> &str {
    entry["id"].as_str().expect("entries have an id")
}

/// The six inward faces of a box, z0, z1, x0, x1, y0, y1 as in the data.
fn box_faces(size: DVec3) -> [[DVec3; 4]; 6] {
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    // u × v points inwards.
    let face = |origin: DVec3, u: DVec3, v: DVec3| [origin, origin + u, origin + u + v, origin + v];
    [
        face(DVec3::ZERO, x, y),
        face(z, y, x),
        face(DVec3::ZERO, y, z),
        face(x, z, y),
        face(DVec3::ZERO, z, x),
        face(y, x, z),
    ]
}

/// Largest error of each kind of entry, and where.
#[derive(Default)]
struct Errors(BTreeMap<String, (usize, f64, String)>);

impl Errors {
    fn add(&mut self, kind: &str, name: &str, error: f64) {
        let entry = self.0.entry(kind.into()).or_default();
        entry.0 += 1;
        if error >= entry.1 {
            (entry.1, entry.2) = (error, name.into());
        }
    }

    fn print(&self) {
        for (kind, (count, error, name)) in &self.0 {
            println!("{kind}: {count} values, largest error {error:.1e} ({name})");
        }
    }
}

#[test]
fn polygon_pairs_are_exact() {
    let (mut errors, mut pairs) = (Errors::default(), 0);
    for entry in references() {
        let (Some(a), Some(b)) = (polygon(&entry["surf1"]), polygon(&entry["surf2"])) else {
            continue;
        };
        // What an occluder hides is not ours here, but the data has the pair without it, too.
        let key = if occluded(&entry) {
            "F12_unoccluded"
        } else {
            "F12"
        };
        let exact = number(&entry[key]);
        let found = analytic::form_factor(&a, &b);
        let error = (found - exact).abs();
        let name = name(&entry);
        pairs += 1;
        errors.add(key, name, error);
        assert!(
            error < PAIRS,
            "{name}: {found} is not {exact}, off by {error:.1e}"
        );
        assert!(
            error < PAIRS_REACHED,
            "{name}: off by {error:.1e}, it was better"
        );
        errors.add(&format!("{key}, relative"), name, error / exact);

        let estimate = analytic::exchange(&a, &b).error / analytic::area(&a);
        // The reference values themselves have 16 digits.
        assert!(
            error < estimate + 1e-15,
            "{name}: error {error:.1e} above its estimate {estimate:.1e}"
        );
        errors.add(&format!("{key}, estimate"), name, estimate);
        let back = analytic::form_factor(&b, &a);
        let reciprocal = analytic::reciprocal(found, analytic::area(&a), analytic::area(&b));
        assert!(
            (back - reciprocal).abs() < 1e-12,
            "{name}: backwards {back}, by reciprocity {reciprocal}"
        );
    }
    errors.print();
    assert_eq!(pairs, 53, "38 free pairs and 15 with occluders");
}

/// Asked of every pair with occluders, absolute.
const OCCLUDED: f64 = 1e-5;

#[test]
fn occluded_pairs_are_exact() {
    let (mut errors, mut pairs) = (Errors::default(), 0);
    for entry in references().iter().filter(|entry| occluded(entry)) {
        let (a, b) = (polygon(&entry["surf1"]), polygon(&entry["surf2"]));
        let (a, b) = (a.expect("a polygon"), b.expect("a polygon"));
        let occluders = entry["occluders"].as_array().expect("they are occluded");
        let occluders: Vec<Vec<DVec3>> = occluders.iter().filter_map(polygon).collect();
        let occluders: Vec<&[DVec3]> = occluders.iter().map(Vec::as_slice).collect();
        let (area, name, exact) = (analytic::area(&a), name(entry), number(&entry["F12"]));
        let found = analytic::occluded_exchange(&a, &b, &occluders, 1e-6 * area);
        let error = (found.area / area - exact).abs();
        pairs += 1;
        errors.add("occluded", name, error);
        errors.add("occluded, estimate", name, found.error / area);
        assert!(error < OCCLUDED, "{name}: off by {error:.1e}");
        let back = analytic::occluded_exchange(&b, &a, &occluders, 1e-6 * area);
        let difference = (back.area - found.area).abs() / area;
        assert!(
            difference < OCCLUDED,
            "{name}: both ways differ by {difference:.1e}"
        );
        let unoccluded = analytic::exchange_area(&a, &b);
        assert!(
            found.area <= unoccluded * (1.0 + 1e-8),
            "{name}: more than without occluders"
        );
    }
    errors.print();
    assert_eq!(pairs, 15, "occluded entries");
}

#[test]
fn boxes_are_exact_and_closed() {
    let mut boxes = 0;
    let mut errors = Errors::default();
    for entry in references() {
        if kind(&entry["surf1"]) != "box_inside" {
            continue;
        }
        boxes += 1;
        let faces = box_faces(vector(&entry["surf1"]["size"]));
        for (i, from) in faces.iter().enumerate() {
            let row = faces.each_ref().map(|to| analytic::form_factor(from, to));
            for (j, found) in row.into_iter().enumerate() {
                let exact = number(&entry["F_matrix"][i][j]);
                let error = (found - exact).abs();
                errors.add("boxes", name(&entry), error);
                assert!(
                    error < PAIRS_REACHED,
                    "faces {i}, {j}: {found} is not {exact}"
                );
            }
            let sum: f64 = row.iter().sum();
            assert!((sum - 1.0).abs() < 1e-12, "row {i} sums to {sum}");
        }
    }
    errors.print();
    assert_eq!(boxes, 2, "boxes in the data");
}

#[test]
fn elements_are_exact() {
    let mut errors = Errors::default();
    for entry in references() {
        let (from, Some(to)) = (&entry["surf1"], polygon(&entry["surf2"])) else {
            continue;
        };
        if kind(from) != "point" || occluded(&entry) {
            continue;
        }
        let (point, normal) = (vector(&from["position"]), vector(&from["normal"]));
        let exact = number(&entry["F12"]);
        let found = nusselt::element_to_polygon(point, normal, &to);
        let error = (found - exact).abs();
        errors.add("elements", name(&entry), error);
        assert!(error < ELEMENTS, "{}: {found} is not {exact}", name(&entry));
        let counted = nusselt::counted(point, normal, &to, 512);
        // The outlines are convex; bound of `counted`.
        let error = (counted - exact).abs();
        errors.add("elements, counted in 512² cells", name(&entry), error);
        assert!(
            error < 12.0 / 512.0,
            "{}: counted {counted} for {exact}",
            name(&entry)
        );
    }
    errors.print();
    assert_eq!(errors.0["elements"].0, 11, "elements in the data");
}

/// Entries of Howell's table A2 that are misprinted: the closed form is right.
const MISPRINTED: [&str; 3] = [
    "HOWELL_A2_a0.02_c0.4",
    "HOWELL_A2_a0.05_c0.05",
    "HOWELL_A2_a2.0_c10.0",
];

#[test]
fn polygon_cases_of_other_programs_agree() {
    let mut errors = Errors::default();
    for case in external() {
        let geometry = &case["geometry"];
        let (Some(a), Some(b)) = (polygon(&geometry["surf1"]), polygon(&geometry["surf2"])) else {
            continue;
        };
        let name = name(&case);
        // The table has A F over the square of the common edge, which is 1.
        let (found, expected, source) = match case["expected_F12"].as_f64() {
            Some(expected) => (analytic::form_factor(&a, &b), expected, "programs"),
            None => (
                analytic::exchange_area(&a, &b),
                number(&case["expected_A1F12_over_b2"]),
                "table A2",
            ),
        };
        let closed = number(&case["our_closed_form"]);
        let error = (found - closed).abs();
        errors.add(&format!("{source}, closed form"), name, error);
        assert!(error < PAIRS_REACHED, "{name}: {found} is not {closed}");
        let agrees = (found - expected).abs() <= number(&case["tolerance"]);
        assert_eq!(
            agrees,
            !MISPRINTED.contains(&name),
            "{name}: {found}, expected {expected}"
        );
    }
    errors.print();
    assert_eq!(
        errors.0["programs, closed form"].0, 25,
        "pairs of other programs"
    );
    assert_eq!(
        errors.0["table A2, closed form"].0, 67,
        "pairs of the table"
    );
}

#[test]
fn the_cube_of_a_manual_agrees() {
    let cases = external();
    let cube = cases.iter().find(|c| name(c) == "VIEW3D_manual_cube");
    let cube = cube.expect("the cube is in the data");
    let faces = box_faces(DVec3::ONE);
    // Its faces are z0, x0, y0, z1, x1, y1.
    let order = [0, 2, 4, 1, 3, 5];
    for (i, row) in cube["expected_rows"]
        .as_array()
        .expect("rows")
        .iter()
        .enumerate()
    {
        for (j, expected) in row.as_array().expect("a row").iter().enumerate() {
            let found = analytic::form_factor(&faces[order[i]], &faces[order[j]]);
            assert!(
                (found - number(expected)).abs() <= number(&cube["tolerance"]),
                "faces {i}, {j}: {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn what_is_left_out_is_counted() {
    let mut skipped = BTreeMap::new();
    for entry in references() {
        let kinds = [kind(&entry["surf1"]), kind(&entry["surf2"])];
        if kinds
            .iter()
            .all(|k| ["polygon", "point", "box_inside", "self"].contains(k))
        {
            continue;
        }
        let why = kinds.join(" to ");
        *skipped.entry(why).or_insert(0) += 1;
    }
    for case in external() {
        let geometry = &case["geometry"];
        let pair = [kind(&geometry["surf1"]), kind(&geometry["surf2"])];
        if pair == ["polygon"; 2] || name(&case) == "VIEW3D_manual_cube" {
            continue;
        }
        *skipped
            .entry(format!("other programs: {}", pair.join(" to ")))
            .or_insert(0) += 1;
    }
    for (why, count) in &skipped {
        println!("left out: {count} {why}");
    }
    assert!(
        !skipped.keys().any(|why| why == "polygon to polygon"),
        "{skipped:?}"
    );
}
