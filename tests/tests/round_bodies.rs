//! Form factors of disks, spheres and cylinders, made of facets.
//!
//! With `n` facets around, chords leave the circle by `1 - cos(π/n) ≈ 5/n²` of its radius. So far lengths may be off,
//! relative to themselves, and areas twice as far: the tests ask for factors within `10/n²`, and that twice as many facets
//! leave about a quarter of the error or less. Polygons of equal area instead of inscribed ones do better for disks: `1/n⁴`.

use glam::DVec3;
use hemicube::radiosity::form_factor::{analytic, nusselt};
use hemicube_tests::shapes::{Facet, Radiates, cylinder, disk, regular_polygon, sphere};
use hemicube_tests::surfaces::{corners, exchange_area, vector};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::PI;

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

fn kind(surface: &Value) -> &str {
    surface["type"].as_str().unwrap_or("other")
}

/// Which side a body says that it radiates to.
fn side(body: &Value) -> Option<Radiates> {
    match body["side"].as_str() {
        Some("inside") => Some(Radiates::Inwards),
        Some(_) => Some(Radiates::Outwards),
        None => None,
    }
}

/// A body as facets, `n` of them around.
fn facets(body: &Value, side: Radiates, n: u32) -> Vec<Facet> {
    let radius = || number(&body["radius"]);
    let place = |key: &str| body.get(key).map_or(DVec3::ZERO, vector);
    match kind(body) {
        "disk" => disk(place("center"), vector(&body["normal"]), radius(), n),
        "sphere" => sphere(place("center"), radius(), 0.0..PI, n / 2, n, side),
        "hemisphere" => sphere(place("center"), radius(), 0.0..PI / 2.0, n / 4, n, side),
        "cylinder" => {
            let axis = body
                .get("axis")
                .map_or_else(|| DVec3::Z * number(&body["height"]), vector);
            cylinder(place("base"), axis, radius(), 1, n, side)
        }
        "polygon" => vec![corners(&body["vertices"])],
        other => panic!("no facets for a {other}"),
    }
}

/// Factor between two bodies of `n` facets around.
fn factor(from: &Value, to: &Value, n: u32) -> f64 {
    if kind(from) == "point" {
        let (point, normal) = (vector(&from["position"]), vector(&from["normal"]));
        let seen = facets(to, Radiates::Outwards, n);
        // Facets of a convex body that face the point hide nothing of each other.
        let factors = seen
            .iter()
            .map(|facet| nusselt::element_to_polygon(point, normal, facet));
        return factors.sum();
    }
    let from_side = side(from).unwrap_or(Radiates::Outwards);
    // Of two bodies around one another, the other side of the second is meant where none is said.
    let opposite = match from_side {
        Radiates::Outwards => Radiates::Inwards,
        Radiates::Inwards => Radiates::Outwards,
    };
    let mut all = facets(from, from_side, n);
    let mut target = facets(to, side(to).unwrap_or(opposite), n);
    if kind(from) == "hemisphere" {
        // Its base has the corners of its rim.
        let step = 2.0 * PI / f64::from(n);
        let inscribed = number(&to["radius"]) * (step.sin() / step).sqrt();
        let outline = regular_polygon(vector(&to["center"]), vector(&to["normal"]), inscribed, n);
        target = vec![outline];
    }
    if kind(to) != "polygon" && kind(from) != "hemisphere" {
        // Round about one axis: what is true of one sector is true of all.
        let sector = (0..all.len()).step_by(n as usize);
        all = sector.map(|i| all[i].clone()).collect();
    }
    let area: f64 = all.iter().map(|f| analytic::area(f)).sum();
    exchange_area(&all, &target) / area
}

/// Numbers of facets around at which a pair is computed, each twice the one before.
fn counts(from: &Value, to: &Value) -> &'static [u32] {
    match (kind(from), kind(to)) {
        // With fewer, the facets of the outer sphere would cut the inner one.
        ("sphere", "sphere") => &[16, 32],
        // With fewer, the error of the sphere is not yet a quadratic one.
        ("sphere", _) | ("point", "sphere") => &[16, 32, 64],
        _ => &[8, 16, 32],
    }
}

/// Asserts the bound and the order of convergence; returns the relative error with most facets.
fn assert_converges(name: &str, from: &Value, to: &Value, exact: f64) -> f64 {
    let errors: Vec<(u32, f64)> = counts(from, to)
        .iter()
        .map(|&n| (n, factor(from, to, n) / exact - 1.0))
        .collect();
    // Seen at a low angle, a ball sends most of its light from near its upper rim, which is what chords cut off.
    let is_grazing = kind(from) == "point" && kind(to) == "sphere";
    let of_areas = if is_grazing { 20.0 } else { 10.0 };
    for &(n, error) in &errors {
        let bound = of_areas / f64::from(n).powi(2);
        assert!(
            error.abs() < bound,
            "{name}, {n} facets around: off by {error:.1e}, {bound:.1e} are allowed"
        );
    }
    for pair in errors.windows(2) {
        let ((n, before), (_, after)) = (pair[0], pair[1]);
        // A quarter and something for terms of higher order; below 1e-9 it is rounding.
        assert!(
            after.abs() < 0.3 * before.abs() + 1e-9,
            "{name}: off by {before:.1e} with {n} facets, by {after:.1e} with twice as many"
        );
    }
    let [.., (_, before), (n, after)] = errors[..] else {
        unreachable!("at least two counts")
    };
    println!("{name}: {after:.1e} with {n} facets around, {before:.1e} with half of them");
    after.abs()
}

fn is_round(surface: &Value) -> bool {
    ["disk", "sphere", "cylinder", "hemisphere"].contains(&kind(surface))
}

#[test]
fn round_bodies_converge_with_the_square_of_their_facets() {
    let mut worst = BTreeMap::new();
    for entry in references() {
        let (from, to) = (&entry["surf1"], &entry["surf2"]);
        if !is_round(from) && !is_round(to) {
            continue;
        }
        let name = entry["id"].as_str().expect("entries have an id");
        let error = assert_converges(name, from, to, number(&entry["F12"]));
        let pair = format!("{} to {}", kind(from), kind(to));
        let (count, most) = worst.entry(pair).or_insert((0, 0.0));
        *count += 1;
        *most = f64::max(*most, error);
    }
    let total: i32 = worst.values().map(|&(count, _)| count).sum();
    for (pair, (count, error)) in &worst {
        println!("{pair}: {count} entries, at most {error:.1e} off");
    }
    assert_eq!(total, 18, "round entries of the data");
}

#[test]
fn round_bodies_of_other_programs_converge_too() {
    let mut count = 0;
    for case in external() {
        let geometry = &case["geometry"];
        let (from, to) = (&geometry["surf1"], &geometry["surf2"]);
        if !is_round(from) || !is_round(to) || geometry.get("occluders").is_some() {
            continue;
        }
        count += 1;
        let name = case["id"].as_str().expect("cases have an id");
        assert_converges(name, from, to, number(&case["our_closed_form"]));
    }
    assert_eq!(count, 21, "8 pairs of disks, 7 of cylinders, 6 of spheres");
}
