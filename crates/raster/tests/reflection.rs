//! Reflection models against integrals over the hemisphere and against reciprocity.

use glam::{DVec3, Vec3};
use hemicube_raster::reflection::{BlinnPhong, Phong, mirrored};

fn direction(theta: f64, phi: f64) -> Vec3 {
    DVec3::new(
        theta.sin() * phi.cos(),
        theta.sin() * phi.sin(),
        theta.cos(),
    )
    .as_vec3()
}

/// The share of light from a direction that comes back: the reflectance against the cosine, by the midpoint rule.
fn albedo(reflectance: impl Fn(Vec3, Vec3) -> f32, light_angle: f64) -> f64 {
    let light = direction(light_angle, 0.0);
    let (rows, columns) = (600_u16, 600_u16);
    let d_theta = core::f64::consts::FRAC_PI_2 / f64::from(rows);
    let d_phi = core::f64::consts::TAU / f64::from(columns);
    let mut sum = 0.0;
    for i in 0..rows {
        let theta = (f64::from(i) + 0.5) * d_theta;
        for j in 0..columns {
            let view = direction(theta, f64::from(j) * d_phi);
            sum += f64::from(reflectance(light, view)) * theta.cos() * theta.sin();
        }
    }
    sum * d_theta * d_phi
}

#[test]
fn normalised_models_keep_energy() {
    for exponent in [0.0, 1.0, 10.0, 100.0] {
        let phong = |l: Vec3, v: Vec3| Phong::new(exponent).reflectance(Vec3::Z, l, v);
        let blinn = |l: Vec3, v: Vec3| BlinnPhong::new(exponent).reflectance(Vec3::Z, l, v);
        // 600 rows across a lobe a tenth of a radian wide: the midpoint rule is off by 1e-3.
        assert!((albedo(phong, 0.0) - 1.0).abs() < 2e-3, "Phong {exponent}");
        assert!(
            (albedo(blinn, 0.0) - 1.0).abs() < 2e-3,
            "Blinn-Phong {exponent}"
        );
        for angle in [0.5, 1.2] {
            let (phong, blinn) = (albedo(phong, angle), albedo(blinn, angle));
            assert!(
                phong < 1.002 && blinn < 1.002,
                "{exponent}, {angle}: {phong}, {blinn}"
            );
        }
    }
}

#[test]
fn models_are_reciprocal_and_peak_at_the_mirror() {
    let (n, l) = (Vec3::Z, direction(0.7, 0.3));
    let v = mirrored(n, l);
    assert!((v - direction(0.7, 0.3 + core::f64::consts::PI)).length() < 1e-6);
    let (phong, blinn) = (Phong::new(20.0), BlinnPhong::new(80.0));
    assert!((phong.lobe(n, l, v) - 1.0).abs() < 1e-5);
    assert!((blinn.lobe(n, l, v) - 1.0).abs() < 1e-5);
    let w = direction(0.4, 2.0);
    assert!((phong.lobe(n, l, w) - phong.lobe(n, w, l)).abs() < 1e-6);
    assert!((blinn.lobe(n, l, w) - blinn.lobe(n, w, l)).abs() < 1e-6);
    assert_eq!(phong.lobe(n, -l, v), 0.0);
    assert_eq!(blinn.lobe(n, l, -v), 0.0);
}

/// Four times Phong's exponent gives Blinn-Phong's highlight the same width in the plane of incidence.
#[test]
fn blinn_phong_is_as_wide_at_four_times_the_exponent() {
    let (n, l) = (Vec3::Z, direction(0.3, 0.0));
    for off in [0.05, 0.1] {
        let v = direction(0.3 + off, core::f64::consts::PI);
        let (phong, blinn) = (
            Phong::new(30.0).lobe(n, l, v),
            BlinnPhong::new(120.0).lobe(n, l, v),
        );
        assert!((phong - blinn).abs() < 2e-3, "{phong} {blinn}");
    }
}

#[test]
fn facets_add_up_to_the_surface() {
    for exponent in [0.0, 5.0, 60.0] {
        let model = BlinnPhong::new(exponent);
        let steps = 4000_u16;
        let d = core::f64::consts::FRAC_PI_2 / f64::from(steps);
        let sum: f64 = (0..steps)
            .map(|i| {
                let (sin, cos) = ((f64::from(i) + 0.5) * d).sin_cos();
                let facets = model.normal_distribution(glam::DVec2::splat(cos).as_vec2().x);
                f64::from(facets) * cos * sin * d * core::f64::consts::TAU
            })
            .sum();
        assert!((sum - 1.0).abs() < 1e-4, "{exponent}: {sum}");
    }
    assert!((BlinnPhong::from_roughness(0.5).exponent - 6.0).abs() < 1e-5);
    assert_eq!(BlinnPhong::from_roughness(3.0).exponent, 0.0);
}
