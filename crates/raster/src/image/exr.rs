//! OpenEXR files, read block by block.
//!
//! The picture is the file's display window; what lies in it outside the data window is black and transparent. The first
//! layer with colours is read: channels `R`, `G`, `B`, else `Y`, else its only channel, in gray; `A` is alpha. All
//! compressions but HTJ2K; no deep data and no subsampled chroma (`RY`, `BY`), which are refused in a line.
//! A `chromaticities` attribute is not heeded: numbers are taken for Rec. 709.

use super::Image;
use super::read::{Format, Picture, ReadError, ReadOptions};
use ::exr::block::reader::{ChunksReader as _, Reader};
use ::exr::block::{UncompressedBlock, read as open};
use ::exr::math::Vec2;
use ::exr::meta::attribute::{ChannelDescription, SampleType};
use ::exr::meta::header::Header;
use std::io::Cursor;

/// The largest finite half float.
const HALF_MAX: f32 = 65_504.0;

/// Most bytes that the samples of all channels may take in memory, and those of one block.
const MAX_SAMPLE_BYTES: usize = 8 << 30;
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// Reads a picture; see the module.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Picture, ReadError> {
    let of_codec = |e: ::exr::error::Error| ReadError::decode(Format::Exr, e);
    let reader = open(Cursor::new(bytes), true).map_err(of_codec)?;
    let layer = choose_layer(&reader)?;
    let header = &reader.headers()[layer];
    let source = Source::new(header)?;
    let mut canvas = Canvas::new(header, options)?;
    check_blocks(header)?;
    let bits = u32::try_from(8 * source.sample_bytes()).unwrap_or(32);
    let chunks = reader.filter_chunks(true, |_, tile, block| {
        block.layer == layer && tile.level_index == Vec2(0, 0)
    });
    let mut blocks = chunks.map_err(of_codec)?.sequential_decompressor(true);
    while let Some(block) = blocks.decompress_next_block() {
        let block = block.map_err(of_codec)?;
        let header = &blocks.meta_data().headers[layer];
        source.copy(&block, header, &mut canvas);
    }
    let non_finite = clean(&mut canvas.pixels, options.keep_non_finite);
    let (width, height) = (canvas.width, canvas.height);
    Ok(Picture {
        image: Image::from_pixels(width, height, canvas.pixels).expect("a canvas of that size"),
        format: Format::Exr,
        bits,
        has_alpha: source.alpha.is_some(),
        non_finite,
    })
}

fn refused(why: impl core::fmt::Display) -> ReadError {
    ReadError::decode(Format::Exr, why)
}

/// The first layer with colours, else the first one.
fn choose_layer<R: std::io::Read + std::io::Seek>(reader: &Reader<R>) -> Result<usize, ReadError> {
    let headers = reader.headers();
    let has_color = |header: &Header| !header.deep && Source::new(header).is_ok();
    let found = headers.iter().position(has_color);
    match headers.first() {
        _ if found.is_some() => Ok(found.unwrap_or_default()),
        Some(header) if header.deep => Err(refused("deep data are not supported; flatten them")),
        Some(_) => Ok(0),
        None => Err(refused("it has no layer")),
    }
}

/// Blocks that a decoder would need too much memory for.
fn check_blocks(header: &Header) -> Result<(), ReadError> {
    let Vec2(width, height) = header.layer_size;
    let Vec2(block_width, block_height) = header.max_block_pixel_size();
    let bytes = |width: usize, height: usize| {
        let pixels = width.checked_mul(height);
        pixels.and_then(|n| n.checked_mul(header.channels.bytes_per_pixel))
    };
    let block = bytes(block_width.min(width), block_height.min(height));
    if bytes(width, height).is_none_or(|n| n > MAX_SAMPLE_BYTES)
        || block.is_none_or(|n| n > MAX_BLOCK_BYTES)
    {
        return Err(refused(format_args!(
            "{width} x {height} pixels of {} channels do not fit into memory; write fewer",
            header.channels.list.len()
        )));
    }
    Ok(())
}

/// Channels that become red, green, blue and alpha.
#[derive(Debug)]
struct Source {
    color: [Option<usize>; 3],
    alpha: Option<usize>,
    types: Vec<SampleType>,
}

impl Source {
    fn new(header: &Header) -> Result<Self, ReadError> {
        let list = &header.channels.list;
        let find = |name: &str| list.iter().position(|c| c.name.eq(name));
        if let Some(channel) = list.iter().find(|c| c.sampling != Vec2(1, 1)) {
            let Vec2(x, y) = channel.sampling;
            return Err(refused(format_args!(
                "channel {} is subsampled {x} x {y}, which is not supported; write R, G, B",
                channel.name
            )));
        }
        let rgb = ["R", "G", "B"].map(find);
        let gray = find("Y").or((list.len() == 1).then_some(0));
        let color = match gray {
            _ if rgb.iter().any(Option::is_some) => rgb,
            Some(channel) => [Some(channel); 3],
            None => {
                let names: Vec<String> = list.iter().map(|c| c.name.to_string()).collect();
                return Err(refused(format_args!(
                    "no channel R, G, B or Y among {}; write one of them",
                    names.join(", ")
                )));
            }
        };
        Ok(Self {
            color,
            alpha: find("A"),
            types: list
                .iter()
                .map(|c: &ChannelDescription| c.sample_type)
                .collect(),
        })
    }

    fn sample_bytes(&self) -> usize {
        let used = self.color.iter().flatten();
        let sizes = used.map(|&channel| self.types[channel].bytes_per_sample());
        sizes.max().unwrap_or(4)
    }

    /// Copies the lines of a block that lie in the canvas.
    fn copy(&self, block: &UncompressedBlock, header: &Header, canvas: &mut Canvas) {
        for line in block.lines(&header.channels) {
            let channel = line.location.channel;
            let Vec2(x, y) = line.location.position;
            let bands = (0..3).filter(|&band| self.color[band] == Some(channel));
            let bands = bands.chain((self.alpha == Some(channel)).then_some(3));
            for band in bands {
                canvas.put_line(x, y, band, self.types[channel], line.value);
            }
        }
    }
}

/// The display window.
#[derive(Debug)]
struct Canvas {
    width: usize,
    height: usize,
    /// Where the data window begins in the display window.
    offset: Vec2<i64>,
    pixels: Vec<[f32; 4]>,
}

impl Canvas {
    fn new(header: &Header, options: &ReadOptions) -> Result<Self, ReadError> {
        let display = header.shared_attributes.display_window;
        let Vec2(width, height) = display.size;
        options.check(header.layer_size.0, header.layer_size.1)?;
        options.check(width, height)?;
        let data = header.own_attributes.layer_position;
        let offset = |data: i32, display: i32| i64::from(data) - i64::from(display);
        let offset = Vec2(
            offset(data.0, display.position.0),
            offset(data.1, display.position.1),
        );
        let mut canvas = Self {
            width,
            height,
            offset,
            pixels: vec![[0.0; 4]; width * height],
        };
        if header.channels.list.iter().all(|c| !c.name.eq("A")) {
            canvas.make_opaque(header.layer_size);
        }
        Ok(canvas)
    }

    /// Columns or rows of the data window that lie in the display window.
    fn visible(offset: i64, length: usize, side: usize) -> core::ops::Range<usize> {
        let inside = |x: i64| usize::try_from(x.max(0)).unwrap_or(usize::MAX);
        let first = inside(-offset).min(length);
        let end = inside(side as i64 - offset).min(length);
        first..end.max(first)
    }

    fn make_opaque(&mut self, Vec2(width, height): Vec2<usize>) {
        for y in Self::visible(self.offset.1, height, self.height) {
            for x in Self::visible(self.offset.0, width, self.width) {
                if let Some(at) = self.index(x, y) {
                    self.pixels[at][3] = 1.0;
                }
            }
        }
    }

    /// Where a pixel of the data window is on the canvas.
    fn index(&self, x: usize, y: usize) -> Option<usize> {
        let x = usize::try_from(x as i64 + self.offset.0).ok()?;
        let y = usize::try_from(y as i64 + self.offset.1).ok()?;
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }

    fn put_line(&mut self, x: usize, y: usize, band: usize, kind: SampleType, bytes: &[u8]) {
        let size = kind.bytes_per_sample();
        for (i, sample) in bytes.chunks_exact(size).enumerate() {
            if let Some(at) = self.index(x + i, y) {
                self.pixels[at][band] = value(kind, sample);
            }
        }
    }
}

/// A sample in the machine's byte order.
fn value(kind: SampleType, bytes: &[u8]) -> f32 {
    match (kind, bytes) {
        (SampleType::F16, &[a, b]) => ::exr::prelude::f16::from_ne_bytes([a, b]).to_f32(),
        (SampleType::F32, &[a, b, c, d]) => f32::from_ne_bytes([a, b, c, d]),
        (SampleType::U32, &[a, b, c, d]) => u32::from_ne_bytes([a, b, c, d]) as f32,
        _ => 0.0,
    }
}

/// Counts what is not finite, and mends it unless it is to be kept.
fn clean(pixels: &mut [[f32; 4]], keep: bool) -> usize {
    let mut count = 0;
    for sample in pixels.as_flattened_mut() {
        if !sample.is_finite() {
            count += 1;
            if !keep {
                *sample = if sample.is_nan() {
                    0.0
                } else {
                    HALF_MAX.copysign(*sample)
                };
            }
        }
    }
    count
}
