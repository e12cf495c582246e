use super::*;
use core::f64::consts::PI;

fn atoms(places: &[([f64; 3], f64)]) -> Vec<Atom> {
    let atom = |&(centre, radius): &([f64; 3], f64)| Atom {
        centre: centre.into(),
        charge: 0.0,
        radius,
    };
    places.iter().map(atom).collect()
}

/// A small crowd, always the same.
fn crowd() -> Vec<Atom> {
    let place = |i: i32| {
        let x = |k: f64| (f64::from(i) * k).fract() * 9.0;
        (
            [x(0.618_034), x(0.754_878), x(0.569_84)],
            1.2 + 0.1 * f64::from(i % 7),
        )
    };
    atoms(&(0..40).map(place).collect::<Vec<_>>())
}

#[test]
fn areas_of_one_and_two_balls_are_those_of_caps() {
    let one = Balls::new(&atoms(&[([3.0, 4.0, 5.0], 1.6)])).expect("a ball");
    let exact = 4.0 * PI * 9.0;
    let twice = Balls::new(&atoms(&[([3.0, 4.0, 5.0], 1.6); 2])).expect("balls");
    assert_eq!(
        twice.counted_area(100),
        one.counted_area(100),
        "the same atom twice"
    );
    assert!(
        (one.counted_area(1000) / exact - 1.0).abs() < 1e-12,
        "all points are free"
    );
    let area = one.mesh(0.4).area();
    assert!((area / exact - 1.0).abs() < 0.01, "{area} of {exact}");
    // Two balls of radius 3 at distance 3: each loses a cap of height 1.5.
    let two = Balls::new(&atoms(&[([0.0; 3], 1.6), ([0.0, 0.0, 3.0], 1.6)])).expect("balls");
    let exact = 2.0 * (4.0 * PI * 9.0 - 2.0 * PI * 3.0 * 1.5);
    let (counted, meshed) = (two.counted_area(2000), two.mesh(0.3).area());
    assert!(
        (counted / exact - 1.0).abs() < 2e-3,
        "{counted} counted of {exact}"
    );
    assert!(
        (meshed / exact - 1.0).abs() < 0.01,
        "{meshed} meshed of {exact}"
    );
}

#[test]
fn meshes_and_counts_agree_and_get_closer() {
    let balls = Balls::new(&crowd()).expect("balls");
    let counted = balls.counted_area(2000);
    let error = |spacing: f64| (balls.mesh(spacing).area() / counted - 1.0).abs();
    assert!(error(0.8) < 0.05, "{}", error(0.8));
    assert!(
        error(0.3) < 0.01 && error(0.3) < error(0.8),
        "{}",
        error(0.3)
    );
}

#[test]
fn corners_lie_on_balls_and_in_none() {
    let balls = Balls::new(&crowd()).expect("balls");
    let mesh = balls.mesh(0.5);
    let mut off_surface = 0;
    for p in &mesh.positions {
        let p = p.as_dvec3();
        let off = balls.balls.iter().map(|b| b.off(p));
        let depth = off.fold(f64::INFINITY, f64::min);
        off_surface += usize::from(depth.abs() > 1e-5);
        assert!(depth.abs() < 0.02, "{depth} from the surface");
    }
    assert!(
        off_surface * 100 < mesh.positions.len(),
        "{off_surface} of {}",
        mesh.positions.len()
    );
}

#[test]
fn meshes_are_closed_and_turned_outwards() {
    let mesh = Balls::new(&crowd()).expect("balls").mesh(0.5);
    let mut edges: Vec<[u32; 2]> = Vec::new();
    let mut volume = 0.0;
    for t in &mesh.triangles {
        edges.extend([[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        volume += a.dot(b.cross(c)) / 6.0;
    }
    assert!(volume > 300.0, "turned outwards: volume {volume}");
    let mut back: Vec<[u32; 2]> = edges.iter().map(|&[a, b]| [b, a]).collect();
    edges.sort_unstable();
    back.sort_unstable();
    assert_eq!(edges, back, "each edge has its opposite");
}

#[test]
fn atoms_too_far_apart_or_too_near_are_refused() {
    let far = atoms(&[([0.0; 3], 1.0), ([9e4, 9e4, 9e4], 1.0)]);
    let line = Balls::new(&far).expect_err("too far");
    let near = |i: u32| ([f64::from(i) * 1e-4, 0.0, 0.0], 1.0);
    let crowd = atoms(&(0..1000).map(near).collect::<Vec<_>>());
    let crowded = Balls::new(&crowd).expect_err("too near");
    assert!(crowded.contains("1000 atoms in a cube"), "{crowded}");
    assert!(
        line.contains("Å around the atoms") && !line.contains('\n'),
        "{line}"
    );
}

#[test]
fn normals_point_away_from_the_nearest_ball() {
    let balls = Balls::new(&atoms(&[([0.0; 3], 1.6), ([0.0, 0.0, 4.0], 0.6)])).expect("balls");
    let normal = balls.normal(DVec3::new(3.0, 0.0, 0.0));
    assert!((normal - DVec3::X).length() < 1e-12, "{normal}");
    let normal = balls.normal(DVec3::new(0.0, 0.0, 6.0));
    assert!((normal - DVec3::Z).length() < 1e-12, "{normal}");
}
