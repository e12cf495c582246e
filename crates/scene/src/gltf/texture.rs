//! Textures and pictures. A picture that cannot be used costs its slot and a warning, not the scene.

use super::extension::{self, TextureInfo, TextureTransform};
use super::{Source, name_or, uri};
use crate::open::one_line;
use crate::{ImportReport, Magnify, Minify, Scene, Texture, TextureImage, TextureSlot, Wrap};
use glam::{Affine2, Vec2};
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;
use std::collections::HashMap;

/// All pictures together may have so many bytes once decoded.
const MAX_DECODED: usize = 4 << 30;

/// Reads textures at their first use and each only once.
pub struct Textures<'a> {
    source: Source<'a>,
    /// What became of each texture and each image of the file that was asked for.
    textures: HashMap<usize, Option<usize>>,
    images: HashMap<usize, Option<usize>>,
    decoded_bytes: usize,
}

impl<'a> Textures<'a> {
    /// Nothing read yet.
    pub fn new(source: Source<'a>) -> Self {
        Self {
            source,
            textures: HashMap::new(),
            images: HashMap::new(),
            decoded_bytes: 0,
        }
    }

    /// The slot for a reference; `None`, with a warning, if its picture cannot be used.
    pub fn slot(
        &mut self,
        info: &TextureInfo,
        place: &str,
        scene: &mut Scene,
    ) -> Option<TextureSlot> {
        let transform: Option<TextureTransform> = extension::read(
            Some(&info.extensions),
            "KHR_texture_transform",
            place,
            &mut scene.report,
        );
        let transform = transform.unwrap_or_default();
        let set = transform.tex_coord.unwrap_or(info.tex_coord);
        let transform = texture_from_mesh(&transform, place, &mut scene.report);
        let texture = self.texture(info.index as usize, place, scene)?;
        Some(TextureSlot {
            texture,
            texcoord_set: set as usize,
            transform,
        })
    }

    fn texture(&mut self, index: usize, place: &str, scene: &mut Scene) -> Option<usize> {
        if let Some(&known) = self.textures.get(&index) {
            return known;
        }
        let read = self.read_texture(index, place, scene);
        self.textures.insert(index, read);
        read
    }

    fn read_texture(&mut self, index: usize, place: &str, scene: &mut Scene) -> Option<usize> {
        let root = self.source.root;
        let Some(texture) = root.textures.get(index) else {
            let count = root.textures.len();
            scene.report.warn(
                place,
                format!("texture {index} of {count}; left out, the factor alone counts"),
            );
            return None;
        };
        let image = texture.source.value();
        if image == u32::MAX as usize {
            let others: Vec<&str> = texture
                .extensions
                .iter()
                .flat_map(|e| e.others.keys())
                .map(String::as_str)
                .collect();
            let kind = if others.is_empty() {
                String::new()
            } else {
                format!(" except by {}", others.join(", "))
            };
            scene.report.warn(
                place,
                format!("texture {index} has no picture{kind}; left out, the factor alone counts"),
            );
            return None;
        }
        let image = self.image(image, place, scene)?;
        let mut read = Texture::new(image, [Wrap::Repeat; 2]);
        if let Some(sampler) = texture.sampler {
            self.sampler(sampler.value(), index, &mut read, &mut scene.report);
        }
        scene.textures.push(read);
        Some(scene.textures.len() - 1)
    }

    /// Wraps and filters as the file has them.
    fn sampler(&self, sampler: usize, texture: usize, to: &mut Texture, report: &mut ImportReport) {
        let Some(sampler) = self.source.root.samplers.get(sampler) else {
            let count = self.source.root.samplers.len();
            report.warn(
                format!("texture {texture}"),
                format!("sampler {sampler} of {count}; the picture repeats"),
            );
            return;
        };
        to.wrap = [&sampler.wrap_s, &sampler.wrap_t].map(|mode| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
            Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
        });
        to.magnify = match sampler.mag_filter {
            Some(Checked::Valid(MagFilter::Nearest)) => Magnify::Nearest,
            _ => Magnify::Linear,
        };
        to.minify = match sampler.min_filter {
            Some(Checked::Valid(MinFilter::Nearest)) => Minify::Nearest,
            Some(Checked::Valid(MinFilter::Linear)) => Minify::Linear,
            _ => Minify::Mipmap,
        };
    }

    fn image(&mut self, index: usize, place: &str, scene: &mut Scene) -> Option<usize> {
        if let Some(&known) = self.images.get(&index) {
            return known;
        }
        let read = match self.read_image(index) {
            Ok(image) => {
                scene.images.push(image);
                Some(scene.images.len() - 1)
            }
            Err(what) => {
                scene.report.warn(
                    place,
                    format!(
                        "image {index}: {}; left out, the factor alone counts",
                        one_line(&what)
                    ),
                );
                None
            }
        };
        self.images.insert(index, read);
        read
    }

    fn read_image(&mut self, index: usize) -> Result<TextureImage, String> {
        let images = &self.source.root.images;
        let image = images
            .get(index)
            .ok_or_else(|| format!("there are {}", images.len()))?;
        let encoded = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => uri::bytes(uri, self.source.folder)?,
            (None, Some(view)) => self.source.view(view.value())?.0.to_vec(),
            (None, None) => return Err(String::from("it names no data")),
        };
        let image = TextureImage::decode(name_or(image.name.as_ref(), "image", index), encoded)?;
        self.decoded_bytes = self
            .decoded_bytes
            .saturating_add(image.pixels().pixels().len().saturating_mul(4));
        if self.decoded_bytes > MAX_DECODED {
            return Err(String::from("the pictures need more than 4 GiB together"));
        }
        Ok(image)
    }
}

/// `translation * rotation * scale` of `KHR_texture_transform`.
///
/// The specification turns "counter-clockwise" with v pointing down, `u' = u cos r + v sin r, v' = v cos r - u sin r`:
/// so do its worked example (the lower left quadrant for offset (0, 1), rotation 1.57, scale 0.5) and the markers of
/// Khronos' TextureTransformTest. The GLSL that it prints has the other sign; the example decides.
fn texture_from_mesh(
    transform: &TextureTransform,
    place: &str,
    report: &mut ImportReport,
) -> Affine2 {
    let (scale, offset) = (Vec2::from(transform.scale), Vec2::from(transform.offset));
    let affine = Affine2::from_scale_angle_translation(scale, -transform.rotation, offset);
    if affine.is_finite() {
        affine
    } else {
        report.warn(place, "KHR_texture_transform is not finite; left out");
        Affine2::IDENTITY
    }
}
