//! Pictures that others made go through the whole chain of levels.
//!
//! They are not part of the project: `HEMICUBE_TESTDATA` or the folder `shared/testdata` beside the workspace has them.

use glam::Vec2;
use hemicube_raster::Image;
use hemicube_raster::texture::{
    Encoding, Minify, MipFilter, NormalMap, Sampler, Texture, TextureOptions,
};
use std::path::{Path, PathBuf};

/// The files of folders with one of these endings, sorted; `None` if there is no test data here.
fn files(folders: &[&str], endings: &[&str]) -> Option<Vec<PathBuf>> {
    let root = std::env::var_os("HEMICUBE_TESTDATA").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../../shared/testdata"
            ))
        },
        PathBuf::from,
    );
    if !root.is_dir() {
        println!("skipped: no test data at {}", root.display());
        return None;
    }
    let mut open: Vec<PathBuf> = folders.iter().map(|folder| root.join(folder)).collect();
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let ending = path
                .extension()
                .and_then(|e| e.to_str())
                .unwrap_or_default()
                .to_lowercase();
            if path.is_dir() {
                open.push(path);
            } else if endings.contains(&ending.as_str()) {
                found.push(path);
            }
        }
    }
    found.sort();
    Some(found)
}

fn mean(image: &Image<[f32; 4]>) -> [f64; 4] {
    let sum = |k: usize| image.pixels().iter().map(|t| f64::from(t[k])).sum::<f64>();
    std::array::from_fn(|k| sum(k) / image.pixels().len() as f64)
}

/// Levels down to one texel, all finite, of one mean.
fn check_levels(path: &Path, texture: &Texture, error: f64) {
    let base = texture.level(0);
    let (expected, size) = (mean(&base), mean(&base.map(|t| t.map(f32::abs))));
    for level in 0..texture.levels() {
        for ((found, expected), size) in mean(&texture.level(level))
            .into_iter()
            .zip(expected)
            .zip(size)
        {
            let error = error * size.max(1.0);
            assert!(
                (found - expected).abs() < error,
                "{} level {level}: {found}, not {expected}",
                path.display()
            );
        }
    }
    let sampler = Sampler::default().with_minify(Minify::Ewa);
    let seen = sampler.sample_grad(
        texture,
        Vec2::splat(0.4),
        Vec2::new(0.1, 0.02),
        Vec2::new(0.0, 0.01),
    );
    assert!(seen.is_finite(), "{}: {seen}", path.display());
}

#[test]
fn levels_of_pictures_keep_their_mean() {
    let Some(files) = files(&["images", "textures", "env"], &["png", "jpg", "jpeg"]) else {
        return;
    };
    let mut count = 0;
    for path in files {
        let Ok(picture) = image::open(&path) else {
            continue;
        };
        let picture = picture.into_rgba8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let texels = picture
            .into_raw()
            .chunks_exact(4)
            .map(|t| [t[0], t[1], t[2], t[3]])
            .collect();
        let picture = Image::from_pixels(width, height, texels).expect("four bytes per texel");
        let bytes = Texture::from_rgba8(&picture, Encoding::Srgb, &TextureOptions::default())
            .expect("texels");
        // Rounding to codes: at most half a step of 0.0088 where one texel is left.
        check_levels(&path, &bytes, 0.005);
        let floats = Texture::new(&bytes.level(0), &TextureOptions::default()).expect("texels");
        check_levels(&path, &floats, 2e-6);
        count += 1;
    }
    println!("{count} pictures");
    assert!(count >= 20, "{count} pictures");
}

#[test]
fn levels_of_high_dynamic_range_keep_their_mean() {
    let Some(files) = files(&["images", "env"], &["exr"]) else {
        return;
    };
    let (mut count, mut mended) = (0, 0);
    for path in files {
        use exr::prelude::{ReadChannels, ReadLayers};
        let read = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| Image::filled(size.width(), size.height(), [0.0; 4]),
                |image, at, (r, g, b, a): (f32, f32, f32, f32)| {
                    *image.pixel_mut(at.x(), at.y()) = [r, g, b, a];
                },
            )
            .first_valid_layer()
            .all_attributes()
            .from_file(&path);
        let Ok(read) = read else {
            continue;
        };
        let picture = read.layer_data.channel_data.pixels;
        let texture = Texture::new(&picture, &TextureOptions::default()).expect("texels");
        check_levels(&path, &texture, 1e-5);
        mended += texture.mended();
        count += 1;
    }
    println!("{count} files, {mended} texels mended");
    assert!(count >= 5, "{count} files");
}

#[test]
fn normal_maps_grow_rougher_with_distance() {
    let Some(files) = files(&["textures/parallax"], &["png"]) else {
        return;
    };
    for path in files.iter().filter(|p| p.ends_with("cube_normal.png")) {
        let picture = image::open(path).expect("a PNG file").into_rgb8();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let texels = picture
            .into_raw()
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect();
        let picture = Image::from_pixels(width, height, texels).expect("three bytes per texel");
        let options = TextureOptions::default().with_filter(MipFilter::Box);
        let map = NormalMap::from_rgb8(&picture, &options).expect("texels");
        let spread = |lod: f32| {
            let places = (0..64_u8).map(|i| Vec2::new(f32::from(i % 8), f32::from(i / 8)) / 8.0);
            places
                .map(|uv| {
                    map.sample_lod(&Sampler::default(), uv, lod)
                        .roughness(0.0)
                        .powi(2)
                })
                .sum::<f32>()
                / 64.0
        };
        assert!(
            spread(0.0) < spread(4.0) && spread(4.0) < spread(9.0),
            "{} {} {}",
            spread(0.0),
            spread(4.0),
            spread(9.0)
        );
        let far = map.sample_lod(&Sampler::default(), Vec2::ZERO, 9.0);
        assert!(far.normal().z > 0.9 && far.mean.length() < 1.0, "{far:?}");
    }
}
