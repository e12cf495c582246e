//! Light that is accounted for: furnaces, shadows, mirrors.

mod common;

use common::{Numbers, tree};
use glam::DVec3;
use hemicube_csg::{Camera, CsgError, Light, Material, Pattern, Ray, Scene, Sky, Solid, View};
use hemicube_raster::Rgb;
use hemicube_raster::antialias::Antialiasing;

fn plain(color: Rgb) -> Result<Material, CsgError> {
    Ok(Material::matte(Pattern::plain(color)?))
}

#[test]
fn in_a_white_furnace_white_surfaces_vanish() -> Result<(), CsgError> {
    let mut numbers = Numbers::new(21);
    let materials = [
        plain(Rgb::WHITE)?,
        plain(Rgb::WHITE)?.with_coat(Rgb::splat(0.3))?,
        plain(Rgb::WHITE)?
            .with_highlight(0.4, 20.0)?
            .with_coat(Rgb::new(0.9, 0.1, 0.0))?,
        plain(Rgb::WHITE)?.with_bumps(0.3, 0.2)?,
    ];
    for material in materials {
        let solid = tree(&mut numbers, 3).with_material(material);
        let scene = Scene::new([solid]).with_reflections(3);
        for _ in 0..400 {
            let light = scene.radiance(&numbers.ray());
            let off = (light - Rgb::WHITE).map(f32::abs).max_band();
            assert!(off < 1e-5, "{light:?} instead of 1");
        }
    }
    Ok(())
}

#[test]
fn no_surface_returns_more_than_it_receives() -> Result<(), CsgError> {
    let mut numbers = Numbers::new(22);
    let material = Material::matte(Pattern::marble(
        Rgb::splat(0.9),
        Rgb::new(0.1, 0.2, 0.9),
        0.2,
    )?)
    .with_highlight(0.2, 40.0)?
    .with_coat(Rgb::splat(0.1))?;
    let scene = Scene::new([tree(&mut numbers, 4).with_material(material)]);
    for _ in 0..2000 {
        let light = scene.radiance(&numbers.ray());
        assert!(
            light.is_finite() && light.max_band() <= 1.0 + 1e-6,
            "{light:?}"
        );
    }
    Ok(())
}

#[test]
fn a_floor_under_a_bulb_follows_the_cosine_and_the_square() -> Result<(), CsgError> {
    let floor = Solid::half_space(DVec3::ZERO, DVec3::Y)?.with_material(plain(Rgb::splat(0.5))?);
    let bulb = Light::point(DVec3::new(0.0, 2.0, 0.0), Rgb::splat(8.0))?;
    let scene = Scene::new([floor])
        .with_lights([bulb])
        .with_sky(Sky::even(Rgb::BLACK)?);
    for x in [0.0, 1.0, 3.0_f64] {
        let ray = Ray::new(DVec3::new(x, 1.0, 0.0), DVec3::NEG_Y);
        let square = x * x + 4.0;
        let expected = 0.5 / std::f64::consts::PI * 8.0 / square * 2.0 / square.sqrt();
        let light = f64::from(scene.radiance(&ray).g);
        assert!(
            (light / expected - 1.0).abs() < 1e-5,
            "{x}: {light}, {expected}"
        );
    }
    Ok(())
}

#[test]
fn shadows_fall_through_holes_only() -> Result<(), CsgError> {
    let floor = Solid::half_space(DVec3::ZERO, DVec3::Y)?;
    let plate = Solid::cuboid(DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, 1.1, 1.0))?;
    let hole = Solid::cylinder(DVec3::Y * 0.5, DVec3::Y * 1.5, 0.3)?;
    let sun = Light::distant(DVec3::Y, Rgb::WHITE)?;
    let scene = Scene::new([floor, plate - hole])
        .with_lights([sun])
        .with_sky(Sky::even(Rgb::BLACK)?);
    let is_lit = |x: f64| {
        let eye = DVec3::new(x, 0.5, 0.0);
        !scene.radiance(&Ray::new(eye, DVec3::NEG_Y)).is_black()
    };
    assert!(is_lit(0.0) && is_lit(0.29), "below the hole");
    assert!(!is_lit(0.31) && !is_lit(0.99), "below the plate");
    assert!(is_lit(1.01), "beside it");
    Ok(())
}

#[test]
fn mirrors_show_what_is_before_them() -> Result<(), CsgError> {
    let silver = plain(Rgb::BLACK)?.with_coat(Rgb::WHITE)?;
    let mirror = Solid::half_space(DVec3::ZERO, DVec3::Y)?.with_material(silver);
    let ball = Solid::sphere(DVec3::new(2.0, 1.0, 0.0), 0.5)?
        .with_material(plain(Rgb::new(1.0, 0.0, 0.0))?);
    let scene = Scene::new([mirror, ball]);
    let seen = scene.radiance(&Ray::new(
        DVec3::new(-2.0, 1.0, 0.0),
        DVec3::new(2.0, -1.0, 0.0),
    ));
    assert!(
        (seen - Rgb::new(1.0, 0.0, 0.0)).map(f32::abs).max_band() < 1e-6,
        "{seen:?}"
    );
    Ok(())
}

#[test]
fn two_mirrors_that_face_each_other_end() -> Result<(), CsgError> {
    let silver = || plain(Rgb::BLACK)?.with_coat(Rgb::splat(0.99));
    let walls = [DVec3::NEG_X, DVec3::X]
        .map(|side| Ok::<_, CsgError>(Solid::half_space(side, -side)?.with_material(silver()?)));
    let [left, right] = walls;
    let scene = Scene::new([left?, right?]).with_reflections(200);
    let light = scene.radiance(&Ray::new(DVec3::ZERO, DVec3::X));
    // What is left after 201 mirrors is the sky's.
    assert!((light.g - 0.99_f32.powi(201)).abs() < 1e-4, "{light:?}");
    Ok(())
}

#[test]
fn mirrors_without_end_stop_at_the_most_that_the_stack_holds() -> Result<(), CsgError> {
    let silver = plain(Rgb::BLACK)?.with_coat(Rgb::splat(0.99))?;
    let wall = |side: DVec3| Ok(Solid::half_space(side, -side)?.with_material(silver.clone()));
    let room = || Ok::<_, CsgError>(Scene::new([wall(DVec3::NEG_X)?, wall(DVec3::X)?]));
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    // Followed until they count nothing, there would be 917 mirrors and no light.
    let light = room()?.with_reflections(u32::MAX).radiance(&ray);
    assert!((light.g - 0.99_f32.powi(257)).abs() < 1e-5, "{light:?}");
    let at_most = room()?.with_reflections(256).radiance(&ray);
    assert_eq!(light, at_most, "more count as 256");
    Ok(())
}

#[test]
fn nearest_hits_are_those_of_the_spans() {
    let mut numbers = Numbers::new(23);
    let solids: Vec<Solid> = (0..40).map(|_| tree(&mut numbers, 2)).collect();
    let scene = Scene::new(solids.clone());
    for _ in 0..3000 {
        let ray = numbers.ray();
        let first = |s: &Solid| {
            let ends = s.spans(&ray).into_iter().flat_map(|s| [s.start, s.end]);
            ends.filter(|&t| t > 0.0).fold(f64::INFINITY, f64::min)
        };
        let expected = solids.iter().map(first).fold(f64::INFINITY, f64::min);
        let found = scene.hit(&ray).map_or(f64::INFINITY, |hit| hit.t);
        assert!(
            found == expected || (found - expected).abs() < 1e-9,
            "{found}, {expected}"
        );
    }
}

#[test]
fn pictures_do_not_depend_on_threads() -> Result<(), CsgError> {
    let scene = Scene::new([tree(&mut Numbers::new(24), 4)]);
    let camera = Camera::new(DVec3::new(3.0, 2.0, 4.0), DVec3::ZERO, 40.0)?;
    let view = View {
        scene: &scene,
        camera: &camera,
        size: (60, 40),
    };
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let alone = alone
        .expect("one thread")
        .install(|| view.render(Antialiasing::NONE));
    assert_eq!(alone, view.render(Antialiasing::NONE), "the same bits");
    Ok(())
}

#[test]
fn normals_are_at_right_angles_to_the_surface() {
    let mut numbers = Numbers::new(25);
    let mut checked = 0;
    for _ in 0..1200 {
        let scene = Scene::new([tree(&mut numbers, 1)]);
        for _ in 0..10 {
            let ray = numbers.ray();
            let Some(hit) = scene.hit(&ray) else {
                continue;
            };
            assert!((hit.normal.length() - 1.0).abs() < 1e-12, "of length 1");
            assert!(hit.normal.dot(ray.direction()) <= 0.0, "on the ray's side");
            let aside = ray.direction().any_orthonormal_vector() * 1e-5;
            let near = scene.hit(&Ray::new(ray.origin() + aside, ray.direction()));
            let Some(way) = near.map(|near| near.point - hit.point) else {
                continue;
            };
            // Over an edge, or where the ray grazes, the way is long or the surface another one.
            let same = near.is_some_and(|near| near.normal.dot(hit.normal) > 0.9999);
            if same && way.length() < 1e-4 {
                let off = way.dot(hit.normal) / way.length();
                assert!(
                    off.abs() < 2e-3,
                    "{off} off the tangent plane at {}",
                    hit.point
                );
                checked += 1;
            }
        }
    }
    assert!(checked > 1000, "{checked} normals");
}

#[test]
fn patterns_move_with_their_solid() -> Result<(), CsgError> {
    let colors = [Rgb::splat(0.2), Rgb::splat(0.8)];
    let [dark, light] = colors.map(Pattern::plain);
    let stripes = Material::matte(Pattern::stripes(DVec3::X, dark?, light?)?);
    let floor = Solid::half_space(DVec3::ZERO, DVec3::Y)?.with_material(stripes);
    let color = |scene: &Scene, x: f64| {
        let ray = Ray::new(DVec3::new(x, 1.0, 0.2), DVec3::NEG_Y);
        scene.radiance(&ray).g
    };
    let still = Scene::new([floor.clone()]);
    let moved = Scene::new([floor.clone().moved(DVec3::X * 0.3)?]);
    let wide = Scene::new([floor.scaled(DVec3::new(4.0, 1.0, 1.0))?]);
    for i in 0..40 {
        let x = f64::from(i) * 0.0903 - 2.0;
        assert_eq!(color(&moved, x), color(&still, x - 0.3), "moved, {x}");
        assert_eq!(color(&wide, x), color(&still, x / 4.0), "stretched, {x}");
    }
    assert!(
        color(&still, 0.25) < color(&still, 0.75),
        "dark comes first"
    );
    Ok(())
}

#[test]
fn cuts_have_the_colour_of_what_cuts() -> Result<(), CsgError> {
    let red = plain(Rgb::new(1.0, 0.0, 0.0))?;
    let white = plain(Rgb::WHITE)?;
    let apple = Solid::sphere(DVec3::ZERO, 1.0)?.with_material(red);
    let bite = Solid::sphere(DVec3::Z, 0.5)?.with_material(white);
    let scene = Scene::new([apple - bite]);
    let seen = |x: f64| scene.radiance(&Ray::new(DVec3::new(x, 0.0, 5.0), DVec3::NEG_Z));
    assert_eq!(seen(0.0), Rgb::WHITE, "in the bite");
    assert_eq!(seen(0.8), Rgb::new(1.0, 0.0, 0.0), "beside it");
    Ok(())
}
