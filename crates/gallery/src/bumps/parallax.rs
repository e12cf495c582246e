//! A colour, a depth and a normal picture of one surface, put on in turn.

use super::{BACKGROUND, shaded};
use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Fragment, Mesh, Sampling, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use glam::{Quat, Vec2, Vec3};
use hemicube_raster::bump::{
    HeightMap, Parallax, SurfaceGradient, decode_normal, sight_slope, tangents,
};
use hemicube_raster::image::{Picture, ReadOptions, Values, open_picture};
use hemicube_raster::texture::{Alpha, Minify, Sampler, Texture, TextureOptions};
use hemicube_raster::{Image, Rgb};
use std::path::Path;

/// Depth of what is white in the depth picture, in sides of the cube.
const DEPTH: f32 = 0.09;

/// Sides of a picture that is read.
const MAX_SIDE: usize = 4096;

struct Textures {
    color: Texture,
    depth: HeightMap,
    normal: Texture,
}

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (1300, 400), (4, 1), 2)?;
    let textures = Textures::read(&request.files)?;
    let cube = Mesh::cube(1.0).moved(
        Quat::from_rotation_x(0.42) * Quat::from_rotation_y(0.7),
        Vec3::ZERO,
    );
    let ways: [(&str, &str, Shade); 4] = [
        ("colour", "flat", Textures::flat),
        (
            "depth as height map",
            "normals from its slopes",
            Textures::by_depth,
        ),
        (
            "normal map",
            "with MikkTSpace tangents",
            Textures::by_normals,
        ),
        ("parallax", "and the normal map", Textures::by_parallax),
    ];
    let cells = ways.map(|(name, how, shade)| Cell {
        image: picture(&cube, cell_size, |f| shade(&textures, f)),
        lines: vec![name.to_owned(), how.to_owned()],
    });
    Ok(vec![Piece::sheet("", &sheet(&cells, 4))?])
}

type Shade = fn(&Textures, &Fragment) -> Rgb;

fn picture(
    mesh: &Mesh,
    size: (usize, usize),
    shade: impl Fn(&Fragment) -> Rgb + Sync,
) -> Image<Rgb> {
    let camera = Camera::new(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 20.0);
    let sampling = Sampling { size, per_side: 3 };
    draw_stage(&camera, sampling, &[mesh], BACKGROUND, shade)
}

impl Textures {
    fn read(files: &[std::path::PathBuf]) -> Result<Self, GalleryError> {
        let [color, depth, normal] = files else {
            return Err(GalleryError::File {
                path: files.first().cloned().unwrap_or_default(),
                why: format!("{} files; give three: colour, depth, normals", files.len()),
            });
        };
        let depths = read(depth, Values::Data)?;
        let heights = depths.image.map(|&[r, ..]| -DEPTH * r);
        Ok(Self {
            color: texture(color, Values::Color, Alpha::Coverage)?,
            depth: HeightMap::new(heights).map_err(|error| refused(depth, &error))?,
            normal: texture(normal, Values::Data, Alpha::Independent)?,
        })
    }

    fn color(&self, texcoord: Vec2, f: &Fragment) -> Rgb {
        let [dx, dy] = f.d_texcoord;
        let sampler = Sampler::default().with_minify(Minify::Ewa);
        let texel = sampler.sample_grad(&self.color, texcoord, dx, dy);
        Rgb::new(texel.x, texel.y, texel.z)
    }

    fn flat(&self, f: &Fragment) -> Rgb {
        shaded(self.color(f.texcoord, f), f.normal, f.view)
    }

    /// A unit of u and v is a side of the cube, of length 1.
    fn by_depth(&self, f: &Fragment) -> Rgb {
        let slopes = self.depth.sample(f.texcoord).slopes;
        let gradient = SurfaceGradient::from_texture(f.normal, f.d_position, f.d_texcoord, slopes);
        shaded(self.color(f.texcoord, f), gradient.apply(f.normal), f.view)
    }

    fn by_normals(&self, f: &Fragment) -> Rgb {
        self.with_normal_at(f.texcoord, f)
    }

    fn with_normal_at(&self, texcoord: Vec2, f: &Fragment) -> Rgb {
        let [dx, dy] = f.d_texcoord;
        let texel = Sampler::default().sample_grad(&self.normal, texcoord, dx, dy);
        let m = decode_normal([texel.x, texel.y, texel.z]);
        let bitangent = tangents::bitangent(f.normal, f.tangent);
        let gradient = SurfaceGradient::from_tangent_space(m, f.tangent.truncate(), bitangent);
        shaded(self.color(texcoord, f), gradient.apply(f.normal), f.view)
    }

    fn by_parallax(&self, f: &Fragment) -> Rgb {
        let slope = f
            .d_position_by_texcoord()
            .and_then(|by| sight_slope(f.normal, by, f.view, DEPTH));
        let depth = |at: Vec2| -self.depth.sample(at).height / DEPTH;
        let seen = slope.map_or(f.texcoord, |slope| {
            Parallax::default().meet(depth, f.texcoord, slope).0
        });
        self.with_normal_at(seen, f)
    }
}

fn refused(path: &Path, error: &dyn std::error::Error) -> GalleryError {
    GalleryError::File {
        path: path.to_path_buf(),
        why: error.to_string(),
    }
}

fn read(path: &Path, values: Values) -> Result<Picture, GalleryError> {
    let options = ReadOptions::default()
        .with_values(values)
        .with_max_side(MAX_SIDE);
    open_picture(path, &options).map_err(|error| match error {
        hemicube_raster::image::ReadError::File { error, .. } => refused(path, &error),
        error => refused(path, &error),
    })
}

fn texture(path: &Path, values: Values, alpha: Alpha) -> Result<Texture, GalleryError> {
    let image = read(path, values)?.image;
    let options = TextureOptions::default().with_alpha(alpha);
    Texture::new(&image, &options).map_err(|error| refused(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// The folder of real files beside the project, from `HEMICUBE_TESTDATA` or `../shared/testdata`.
    fn real_files() -> Option<Vec<PathBuf>> {
        let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/testdata");
        let root =
            std::env::var_os("HEMICUBE_TESTDATA").map_or(PathBuf::from(beside), PathBuf::from);
        let folder = root.join("textures/parallax");
        let files =
            ["color", "depth", "normal"].map(|name| folder.join(format!("cube_{name}.png")));
        if files[0].exists() {
            return Some(files.to_vec());
        }
        eprintln!(
            "skipped: there is no {}; set HEMICUBE_TESTDATA",
            folder.display()
        );
        None
    }

    #[test]
    fn real_textures_are_drawn() {
        let Some(files) = real_files() else { return };
        let request = Request {
            size: Some((160, 120)),
            files,
            ..Request::default()
        };
        assert_eq!(draw(&request).expect("a sheet").len(), 1);
    }

    /// Their normals are those of their depth: it is the scale that is not known, so directions are compared.
    #[test]
    fn real_normals_lean_as_their_depth_says() {
        let Some(files) = real_files() else { return };
        let textures = Textures::read(&files).expect("good files");
        let (mut alike, mut count) = (0.0, 0.0);
        for i in 0_u16..4096 {
            let uv = Vec2::new(f32::from(i % 64), f32::from(i / 64)) / 64.0 + 1.0 / 128.0;
            let texel = Sampler::default().sample(&textures.normal, uv);
            let m = decode_normal([texel.x, texel.y, texel.z]);
            let from_depth = textures.depth.normal(uv, Vec2::ONE);
            let (a, b) = (m.truncate(), from_depth.truncate());
            if a.length() > 0.1 && b.length() > 0.1 {
                alike += a.normalize().dot(b.normalize());
                count += 1.0;
            }
        }
        assert!(
            count > 100.0 && alike / count > 0.7,
            "{} of {count}",
            alike / count
        );
    }

    #[test]
    fn wrong_files_are_named() {
        let error = draw(&Request::default()).expect_err("no files");
        assert!(error.to_string().contains("give three"), "{error}");
        let files = vec![PathBuf::from("no-such.png"); 3];
        let request = Request {
            files,
            ..Request::default()
        };
        let error = draw(&request).expect_err("no such file").to_string();
        assert!(
            error.starts_with("no-such.png: ") && error.lines().count() == 1,
            "{error}"
        );
    }
}
