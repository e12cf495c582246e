//! Radiance pictures: three mantissas that share an exponent, in run lengths (G. Ward, "Real Pixels", Graphics Gems II,
//! 1991; the file is described in the Radiance Reference Manual).
//!
//! A value is `(m + 1/2) 2^(e - 136)`, as Radiance itself reads it: encoders cut mantissas off, so half a step up is where
//! the true value lies on average. Programs that leave the half out read values lower by 0.2 % to 0.4 %. `EXPOSURE` and
//! `COLORCORR` are divided out, so numbers are radiance again in W/(m² sr); `XYZE` becomes Rec. 709.

use super::Image;
use super::read::{Format, Picture, ReadError, ReadOptions};
use crate::Rgb;
use std::io::{self, Write};

/// Longest header that is read; those of long renderings list many commands.
const MAX_HEADER: usize = 1 << 20;

/// Widths of which scanlines are stored component by component.
const RUN_LENGTH_WIDTHS: core::ops::Range<usize> = 8..0x8000;

fn refused(why: impl core::fmt::Display) -> ReadError {
    ReadError::decode(Format::Hdr, why)
}

/// Reads a picture; see the module.
pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Picture, ReadError> {
    let mut input = Input { bytes };
    let header = Header::read(&mut input)?;
    let layout = Layout::read(input.line()?)?;
    let (width, height) = layout.size();
    options.check(width, height)?;
    // A scanline is no shorter than its four components in longest runs, or one pixel repeated.
    let least = layout.scanlines * (layout.length / 127).max(1);
    if least > input.bytes.len() {
        return Err(ReadError::Hollow {
            format: Format::Hdr,
            bytes: bytes.len(),
            width,
            height,
        });
    }
    let mut pixels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    let mut scanline = vec![[0_u8; 4]; layout.length];
    for y in 0..layout.scanlines {
        input.scanline(&mut scanline).ok_or_else(|| {
            refused(format_args!(
                "scanline {y} of {} is cut off or damaged",
                layout.scanlines
            ))
        })?;
        for (x, &code) in scanline.iter().enumerate() {
            let [r, g, b] = header.radiance(code).to_array();
            pixels[layout.index(x, y)] = [r, g, b, 1.0];
        }
    }
    Ok(Picture {
        image: Image::from_pixels(width, height, pixels).expect("one colour for each pixel"),
        format: Format::Hdr,
        bits: 32,
        has_alpha: false,
        non_finite: 0,
    })
}

/// What the lines before the pixels say of them.
#[derive(Debug)]
struct Header {
    /// What pixels are multiplied by to be radiance.
    scale: Rgb,
    is_xyz: bool,
}

impl Header {
    fn read(input: &mut Input<'_>) -> Result<Self, ReadError> {
        let mut header = Self {
            scale: Rgb::WHITE,
            is_xyz: false,
        };
        let before = input.bytes.len();
        loop {
            let line = input.line()?;
            if before - input.bytes.len() > MAX_HEADER {
                return Err(refused("its header does not end"));
            }
            match line.split_once('=') {
                _ if line.trim().is_empty() => return Ok(header),
                Some(("EXPOSURE", number)) => header.divide(&numbers::<1>(number)?)?,
                Some(("COLORCORR", list)) => header.divide(&numbers::<3>(list)?)?,
                Some(("FORMAT", name)) => header.is_xyz = is_xyz(name.trim())?,
                _ => {}
            }
        }
    }

    fn divide(&mut self, by: &[f32]) -> Result<(), ReadError> {
        if by.iter().any(|&x| !x.is_normal() || x < 0.0) {
            return Err(refused(format_args!("an exposure of {by:?}")));
        }
        let band = |band: usize| self.scale[band] / by[band % by.len()];
        self.scale = Rgb::new(band(0), band(1), band(2));
        Ok(())
    }

    fn radiance(&self, [r, g, b, e]: [u8; 4]) -> Rgb {
        if e == 0 {
            return Rgb::BLACK;
        }
        let step = power_of_two(i32::from(e) - 136);
        let value = |m: u8| (f32::from(m) + 0.5) * step;
        let color = Rgb::new(value(r), value(g), value(b)) * self.scale;
        if self.is_xyz {
            rec709_from_xyz(color)
        } else {
            color
        }
    }
}

fn is_xyz(format: &str) -> Result<bool, ReadError> {
    match format {
        "32-bit_rle_rgbe" => Ok(false),
        "32-bit_rle_xyze" => Ok(true),
        _ => Err(refused(format_args!(
            "format {format} is not 32-bit_rle_rgbe or 32-bit_rle_xyze"
        ))),
    }
}

fn numbers<const N: usize>(text: &str) -> Result<[f32; N], ReadError> {
    let found: Option<Vec<f32>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
    found
        .and_then(|found| found.try_into().ok())
        .ok_or_else(|| refused(format_args!("'{}' is not {N} numbers", text.trim())))
}

/// Exact for all exponents of normal numbers, which those of pixels are.
fn power_of_two(exponent: i32) -> f32 {
    2.0_f32.powi(exponent)
}

/// IEC 61966-2-1, white D65.
fn rec709_from_xyz(c: Rgb) -> Rgb {
    Rgb::new(
        3.240_97 * c.r - 1.537_383 * c.g - 0.498_611 * c.b,
        -0.969_244 * c.r + 1.875_967 * c.g + 0.041_555 * c.b,
        0.055_63 * c.r - 0.203_977 * c.g + 1.056_972 * c.b,
    )
}

/// Where the pixels of scanlines go: scanlines may be rows or columns, in either direction.
#[derive(Debug)]
struct Layout {
    scanlines: usize,
    length: usize,
    rows: bool,
    flip_scanlines: bool,
    flip_pixels: bool,
}

impl Layout {
    /// Such as `-Y 512 +X 1024`: rows from the top, pixels from the left.
    fn read(line: &str) -> Result<Self, ReadError> {
        let wanted = || {
            refused(format_args!(
                "'{}' is not a size as in -Y 512 +X 1024",
                line.trim()
            ))
        };
        let words: Vec<&str> = line.split_whitespace().collect();
        let &[slow, scanlines, fast, length] = words.as_slice() else {
            return Err(wanted());
        };
        let rows = match (slow, fast) {
            ("-Y" | "+Y", "+X" | "-X") => true,
            ("+X" | "-X", "-Y" | "+Y") => false,
            _ => return Err(wanted()),
        };
        let number = |text: &str| text.parse::<u32>().map_err(|_| wanted());
        Ok(Self {
            scanlines: number(scanlines)? as usize,
            length: number(length)? as usize,
            rows,
            // Y goes up in the file and down in an image.
            flip_scanlines: matches!(slow, "+Y" | "-X"),
            flip_pixels: matches!(fast, "+Y" | "-X"),
        })
    }

    fn size(&self) -> (usize, usize) {
        if self.rows {
            (self.length, self.scanlines)
        } else {
            (self.scanlines, self.length)
        }
    }

    fn index(&self, x: usize, y: usize) -> usize {
        let flipped = |i: usize, count: usize, flip: bool| if flip { count - 1 - i } else { i };
        let x = flipped(x, self.length, self.flip_pixels);
        let y = flipped(y, self.scanlines, self.flip_scanlines);
        if self.rows {
            y * self.length + x
        } else {
            x * self.scanlines + y
        }
    }
}

/// What has not been read yet.
#[derive(Debug)]
struct Input<'a> {
    bytes: &'a [u8],
}

impl<'a> Input<'a> {
    /// The next line, without its end.
    fn line(&mut self) -> Result<&'a str, ReadError> {
        let end = self.bytes.iter().take(MAX_HEADER).position(|&b| b == b'\n');
        let end = end.ok_or_else(|| refused("its header is cut off"))?;
        let (line, rest) = self.bytes.split_at(end);
        self.bytes = &rest[1..];
        // What is not text is of no interest: a command with a name in another encoding.
        Ok(core::str::from_utf8(line)
            .unwrap_or("?")
            .trim_end_matches('\r'))
    }

    fn byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(first)
    }

    fn pixel(&mut self) -> Option<[u8; 4]> {
        let (&first, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(first)
    }

    fn scanline(&mut self, pixels: &mut [[u8; 4]]) -> Option<()> {
        let length = pixels.len();
        match self.bytes {
            &[2, 2, high, low, ..] if RUN_LENGTH_WIDTHS.contains(&length) && high < 128 => {
                if usize::from(high) << 8 | usize::from(low) != length {
                    return None;
                }
                self.pixel()?;
                (0..4).try_for_each(|component| self.component(pixels, component))
            }
            _ => self.old_scanline(pixels),
        }
    }

    /// One component of a scanline, in runs (more than 128) and copies.
    fn component(&mut self, pixels: &mut [[u8; 4]], component: usize) -> Option<()> {
        let mut rest = pixels;
        while !rest.is_empty() {
            let code = usize::from(self.byte()?);
            let is_run = code > 128;
            let count = if is_run { code - 128 } else { code };
            let (now, later) = rest.split_at_mut_checked(count)?;
            if count == 0 {
                return None;
            }
            let run = if is_run { Some(self.byte()?) } else { None };
            for pixel in now {
                pixel[component] = match run {
                    Some(value) => value,
                    None => self.byte()?,
                };
            }
            rest = later;
        }
        Some(())
    }

    /// Pixel by pixel; `1 1 1 n` repeats the one before, and such codes in a row are digits of a larger `n`.
    fn old_scanline(&mut self, pixels: &mut [[u8; 4]]) -> Option<()> {
        let (mut at, mut shift) = (0, 0);
        while at < pixels.len() {
            let code = self.pixel()?;
            if let [1, 1, 1, n] = code {
                let count = usize::from(n).checked_shl(shift)?;
                let before = *pixels.get(at.checked_sub(1)?)?;
                pixels.get_mut(at..at.checked_add(count)?)?.fill(before);
                (at, shift) = (at + count, (shift + 8).min(24));
            } else {
                pixels[at] = code;
                (at, shift) = (at + 1, 0);
            }
        }
        Some(())
    }
}

impl Image<Rgb> {
    /// Writes a Radiance picture (RGBE, run lengths). A band keeps 8 bits relative to the brightest one of its pixel, so
    /// its error is at most 1/256 of that; negative values become 0, NaN too, and what is too bright 1.7e38.
    pub fn write_hdr(&self, mut out: impl Write) -> io::Result<()> {
        let (width, height) = (self.width(), self.height());
        let header = "#?RADIANCE\nSOFTWARE=Hemicube\nFORMAT=32-bit_rle_rgbe\n";
        write!(out, "{header}\n-Y {height} +X {width}\n")?;
        let mut bytes = Vec::new();
        for row in self.pixels().chunks(width.max(1)) {
            bytes.clear();
            let codes: Vec<[u8; 4]> = row.iter().map(|&c| rgbe(c)).collect();
            if RUN_LENGTH_WIDTHS.contains(&width) {
                let [.., high, low] = width.to_be_bytes();
                bytes.extend([2, 2, high, low]);
                for component in 0..4 {
                    let values: Vec<u8> = codes.iter().map(|code| code[component]).collect();
                    write_runs(&values, &mut bytes);
                }
            } else {
                bytes.extend_from_slice(codes.as_flattened());
            }
            out.write_all(&bytes)?;
        }
        Ok(())
    }
}

/// Mantissas cut off at the exponent of the brightest band.
fn rgbe(c: Rgb) -> [u8; 4] {
    // A maximum with 0 is 0 for NaN.
    let c = c
        .map(|x| x.max(0.0))
        .map(|x| if x > 1.7e38 { 1.7e38 } else { x });
    let brightest = c.max_band();
    if brightest < 1e-38 {
        return [0; 4];
    }
    // brightest = f 2^exponent with f in [1/2, 1), which are the bits of a normal number.
    let exponent = i32::try_from(brightest.to_bits() >> 23).unwrap_or_default() - 126;
    let scale = power_of_two((8 - exponent).min(127));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to below 256"
    )]
    let mantissa = |x: f32| (x * scale) as u8;
    let shared = u8::try_from(exponent + 128).unwrap_or_default();
    [mantissa(c.r), mantissa(c.g), mantissa(c.b), shared]
}

/// Runs of at least 4 equal bytes, and copies between them.
fn write_runs(values: &[u8], out: &mut Vec<u8>) {
    let mut at = 0;
    while at < values.len() {
        let start = next_run(values, at);
        for copy in values[at..start].chunks(128) {
            out.push(count(copy.len()));
            out.extend_from_slice(copy);
        }
        let length = run_length(&values[start..]).min(127);
        if length > 0 {
            out.extend([128 + count(length), values[start]]);
        }
        at = start + length;
    }
}

/// Where the next run worth its two bytes begins.
fn next_run(values: &[u8], from: usize) -> usize {
    let mut at = from;
    while at < values.len() {
        let length = run_length(&values[at..]);
        if length >= 4 {
            return at;
        }
        at += length;
    }
    values.len()
}

/// Equal bytes at the start, up to the longest run of the format.
fn run_length(values: &[u8]) -> usize {
    let Some(first) = values.first() else {
        return 0;
    };
    values.iter().take(127).take_while(|&v| v == first).count()
}

fn count(n: usize) -> u8 {
    u8::try_from(n).expect("at most 128")
}
