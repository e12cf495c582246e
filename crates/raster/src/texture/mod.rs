//! Textures: pictures that are read at any place, at any size, through a filter.
//!
//! [`Texture`] is a chain of mip levels, [`Sampler`] says how it is read: addressing ([`Wrap`]), magnification
//! ([`Magnify`]) and minification ([`Minify`]), after the Vulkan specification (chapter "Image Operations", from texel
//! coordinates to level of detail). [`Ripmap`] and [`SummedAreaTable`] are the two other classical prefiltered forms;
//! [`TexcoordPlanes`] gives the derivatives that all of them want.
//!
//! # Conventions
//! Texture coordinates have their origin in the upper left corner of the picture, u points right and v down, as in glTF.
//! A picture spans [0, 1] in both, so the centre of texel `(i, j)` of `W x H` is `((i + 1/2) / W, (j + 1/2) / H)`.
//!
//! Filtering is done in linear light. With [`Alpha::Coverage`] colours are multiplied by alpha before anything is averaged,
//! and samples are premultiplied; [`straight`] divides again. Coordinates that are not finite read as 0, derivatives that
//! are not finite read the coarsest level.
//!
//! ```
//! use glam::Vec2;
//! use hemicube_raster::Image;
//! use hemicube_raster::texture::{Minify, Sampler, Texture, TextureOptions};
//!
//! let checks = (0..64 * 64).map(|i| if (i / 64 + i) % 2 == 0 { [1.0; 4] } else { [0.0, 0.0, 0.0, 1.0] });
//! let image = Image::from_pixels(64, 64, checks.collect()).unwrap();
//! let texture = Texture::new(&image, &TextureOptions::default()).unwrap();
//! let sampler = Sampler::default().with_minify(Minify::Ewa);
//! // A pixel that covers 16 x 4 texels sees grey.
//! let sample = sampler.sample_grad(&texture, Vec2::new(0.3, 0.7), Vec2::new(0.25, 0.0), Vec2::new(0.0, 0.0625));
//! assert!((sample.x - 0.5).abs() < 1e-3 && sample.w == 1.0);
//! ```

mod chain;
mod cubic;
mod ewa;
mod lod;
mod mipmap;
mod ripmap;
mod sampler;
mod summed_area;
mod texcoord;
mod texel;
mod wrap;

pub use chain::{Alpha, Encoding, Texture, TextureError, TextureOptions, straight};
pub use cubic::Cubic;
pub use lod::{AnisotropicLod, Footprint, Log2, nearest_level};
pub use mipmap::MipFilter;
pub use ripmap::Ripmap;
pub use sampler::{Magnify, Minify, Sampler, Shape};
pub use summed_area::SummedAreaTable;
pub use texcoord::{Texcoord, TexcoordPlanes};
pub use wrap::Wrap;
