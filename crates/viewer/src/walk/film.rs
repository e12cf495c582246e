//! Moving pictures: numbered PNG files, uncompressed y4m, animated PNG.

use hemicube_raster::Image;
use serde::{Deserialize, Serialize};
use std::fs::{File, create_dir_all};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// How frames are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum FilmFormat {
    /// A folder of `00000.png`, `00001.png` and so on.
    #[default]
    PngFrames,
    /// YUV4MPEG2, 4:4:4 and 8 bits, which ffmpeg and mpv read. BT.709 from 720 rows on, else BT.601, limited range.
    Y4m,
    /// One PNG file that browsers play, over and over.
    Apng,
}

impl FilmFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::PngFrames, Self::Y4m, Self::Apng];

    /// As a panel shows it.
    pub fn label(self) -> &'static str {
        match self {
            Self::PngFrames => "PNG frames",
            Self::Y4m => "y4m video",
            Self::Apng => "animated PNG",
        }
    }

    /// Ending of the file; frames go to a folder.
    pub fn ending(self) -> Option<&'static str> {
        match self {
            Self::PngFrames => None,
            Self::Y4m => Some("y4m"),
            Self::Apng => Some("png"),
        }
    }
}

/// Why a film could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", path.display())]
pub struct FilmError {
    /// The file or folder.
    pub path: PathBuf,
    /// In one line.
    pub why: String,
}

/// A film that is being written. A file appears whole, when it is [finished](Self::finish), or not at all.
pub struct Film {
    path: PathBuf,
    size: [usize; 2],
    frames: u32,
    output: Output,
}

enum Output {
    Folder,
    Y4m(BufWriter<tempfile::NamedTempFile>),
    Apng {
        writer: Box<png::Writer<BufWriter<File>>>,
        temporary: tempfile::TempPath,
    },
}

/// Frames of a second.
pub const FRAMES_PER_SECOND: u32 = 30;

impl Film {
    /// Starts a film of that many frames, each of that many pixels. (Of all formats only animated PNG has to know how
    /// many frames will come.)
    ///
    /// # Errors
    /// The folder or the file cannot be made.
    pub fn create(
        path: &Path,
        format: FilmFormat,
        size: [usize; 2],
        frames: u32,
    ) -> Result<Self, FilmError> {
        let output = match format {
            FilmFormat::PngFrames => create_dir_all(path).map(|()| Output::Folder),
            FilmFormat::Apng => start_apng(path, size, frames),
            FilmFormat::Y4m => start_y4m(path, size).map(Output::Y4m),
        };
        match output {
            Ok(output) => Ok(Self {
                path: path.to_path_buf(),
                size,
                frames: 0,
                output,
            }),
            Err(error) => Err(failed(path, error)),
        }
    }

    /// Adds a frame, sRGB-encoded.
    ///
    /// # Errors
    /// It has another size, or cannot be written.
    pub fn push(&mut self, frame: &Image<[u8; 3]>) -> Result<(), FilmError> {
        if [frame.width(), frame.height()] != self.size {
            let [width, height] = self.size;
            let why = format!(
                "a frame of {} x {} in a film of {width} x {height}",
                frame.width(),
                frame.height()
            );
            return Err(failed(&self.path, why));
        }
        let number = self.frames;
        self.frames += 1;
        let written = match &mut self.output {
            Output::Folder => {
                let file = File::create(self.path.join(format!("{number:05}.png")));
                file.map_err(Into::into)
                    .and_then(|file| write_png(BufWriter::new(file), frame))
            }
            Output::Y4m(out) => write_y4m_frame(out, frame).map_err(Into::into),
            Output::Apng { writer, .. } => writer.write_image_data(frame.pixels().as_flattened()),
        };
        written.map_err(|error: png::EncodingError| failed(&self.path, error))
    }

    /// Ends the film.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<PathBuf, FilmError> {
        let path = self.path;
        let done = match self.output {
            Output::Folder => Ok(()),
            Output::Y4m(out) => persist(out, &path),
            Output::Apng { writer, temporary } => writer
                .finish()
                .map_err(io::Error::other)
                .and_then(|()| temporary.persist(&path).map_err(|error| error.error)),
        };
        done.map_err(|error| failed(&path, error)).map(|()| path)
    }
}

fn failed(path: &Path, why: impl core::fmt::Display) -> FilmError {
    FilmError {
        path: path.to_path_buf(),
        why: why.to_string(),
    }
}

/// Writes a picture, sRGB-encoded, as a PNG file that appears whole or not at all.
pub fn save_png(path: &Path, picture: &Image<[u8; 3]>) -> Result<(), FilmError> {
    let write = || -> Result<(), String> {
        let mut out = temporary(path).map_err(|e| e.to_string())?;
        write_png(&mut out, picture).map_err(|e| e.to_string())?;
        persist(out, path).map_err(|e| e.to_string())
    };
    write().map_err(|why| failed(path, why))
}

/// A file beside the one that it will become.
fn temporary(path: &Path) -> io::Result<BufWriter<tempfile::NamedTempFile>> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new("."))).map(BufWriter::new)
}

fn persist(out: BufWriter<tempfile::NamedTempFile>, path: &Path) -> io::Result<()> {
    let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

fn encoder<W: Write>(
    out: W,
    size: [usize; 2],
) -> Result<png::Encoder<'static, W>, png::EncodingError> {
    let side = |n: usize| u32::try_from(n).map_err(|_| io::Error::other("a side beyond 32 bits"));
    let mut encoder = png::Encoder::new(out, side(size[0])?, side(size[1])?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    Ok(encoder)
}

fn write_png(out: impl Write, frame: &Image<[u8; 3]>) -> Result<(), png::EncodingError> {
    let mut writer = encoder(out, [frame.width(), frame.height()])?.write_header()?;
    writer.write_image_data(frame.pixels().as_flattened())?;
    writer.finish()
}

fn start_apng(path: &Path, size: [usize; 2], frames: u32) -> io::Result<Output> {
    let (file, temporary) = temporary(path)?
        .into_inner()
        .map_err(io::IntoInnerError::into_error)?
        .into_parts();
    let start = || -> Result<_, png::EncodingError> {
        let mut encoder = encoder(BufWriter::new(file), size)?;
        encoder.set_animated(frames, 0)?;
        #[expect(clippy::cast_possible_truncation, reason = "30 fits 16 bits")]
        encoder.set_frame_delay(1, FRAMES_PER_SECOND as u16)?;
        encoder.write_header()
    };
    let writer = Box::new(start().map_err(io::Error::other)?);
    Ok(Output::Apng { writer, temporary })
}

fn start_y4m(
    path: &Path,
    [width, height]: [usize; 2],
) -> io::Result<BufWriter<tempfile::NamedTempFile>> {
    let mut out = temporary(path)?;
    writeln!(
        out,
        "YUV4MPEG2 W{width} H{height} F{FRAMES_PER_SECOND}:1 Ip A1:1 C444 XCOLORRANGE=LIMITED"
    )?;
    Ok(out)
}

fn write_y4m_frame(out: &mut impl Write, frame: &Image<[u8; 3]>) -> io::Result<()> {
    out.write_all(b"FRAME\n")?;
    let luma = if frame.height() >= 720 {
        BT_709
    } else {
        BT_601
    };
    let planes = |i: usize| -> Vec<u8> {
        frame
            .pixels()
            .iter()
            .map(|&rgb| yuv(rgb, luma)[i])
            .collect()
    };
    (0..3).try_for_each(|i| out.write_all(&planes(i)))
}

/// Weights of red and blue in luma.
const BT_601: [f32; 2] = [0.299, 0.114];
const BT_709: [f32; 2] = [0.2126, 0.0722];

/// Luma from 16 to 235, chroma from 16 to 240.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 16 to 240"
)]
fn yuv(rgb: [u8; 3], [red, blue]: [f32; 2]) -> [u8; 3] {
    let [r, g, b] = rgb.map(|c| f32::from(c) / 255.0);
    let y = red * r + (1.0 - red - blue) * g + blue * b;
    let u = 0.5 * (b - y) / (1.0 - blue);
    let v = 0.5 * (r - y) / (1.0 - red);
    [16.0 + 219.0 * y, 128.0 + 224.0 * u, 128.0 + 224.0 * v].map(|x| (x + 0.5) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(value: u8) -> Image<[u8; 3]> {
        Image::filled(6, 4, [value, 10, 200])
    }

    fn film(format: FilmFormat, name: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().expect("there is room");
        let path = folder.path().join(name);
        let mut film = Film::create(&path, format, [6, 4], 5).expect("it can be made");
        for i in 0..5 {
            film.push(&frame(i * 40)).expect("it can be written");
        }
        film.finish().expect("it can be ended");
        (folder, path)
    }

    fn pixels(path: &Path) -> Vec<Vec<u8>> {
        let file = io::BufReader::new(File::open(path).expect("it is there"));
        let mut reader = png::Decoder::new(file)
            .read_info()
            .expect("it is a PNG file");
        let frames = reader
            .info()
            .animation_control()
            .map_or(1, |a| a.num_frames);
        let size = reader.output_buffer_size().expect("it fits");
        let mut read = || {
            let mut buffer = vec![0; size];
            reader
                .next_frame(&mut buffer)
                .expect("it has that many frames");
            buffer
        };
        (0..frames).map(|_| read()).collect()
    }

    #[test]
    fn frames_are_numbered_files() {
        let (_folder, path) = film(FilmFormat::PngFrames, "frames");
        for i in 0..5_u8 {
            let pixels = pixels(&path.join(format!("0000{i}.png")));
            assert_eq!(pixels[0][..3], [i * 40, 10, 200], "frame {i}");
        }
    }

    #[test]
    fn an_animated_png_has_all_frames() {
        let (_folder, path) = film(FilmFormat::Apng, "film.png");
        let frames = pixels(&path);
        let reds: Vec<u8> = frames.iter().map(|frame| frame[0]).collect();
        assert_eq!(reds, [0, 40, 80, 120, 160], "in their order");
    }

    #[test]
    fn y4m_has_a_header_and_whole_planes() {
        let (_folder, path) = film(FilmFormat::Y4m, "film.y4m");
        let bytes = std::fs::read(path).expect("it is there");
        let header = bytes.iter().position(|&b| b == b'\n').expect("a line");
        assert!(bytes.starts_with(b"YUV4MPEG2 W6 H4 F30:1 "), "the header");
        assert_eq!(bytes.len() - header - 1, 5 * (6 + 3 * 24), "five frames");
    }

    #[test]
    fn grey_has_no_chroma() {
        for luma in [BT_601, BT_709] {
            assert_eq!(yuv([0; 3], luma), [16, 128, 128], "black");
            assert_eq!(yuv([255; 3], luma), [235, 128, 128], "white");
        }
        assert_eq!(
            yuv([255, 0, 0], BT_601),
            [81, 90, 240],
            "the red of colour bars"
        );
    }

    #[test]
    fn what_cannot_be_written_says_where() {
        let folder = tempfile::tempdir().expect("there is room");
        let missing = folder.path().join("no/such/film.y4m");
        let error = Film::create(&missing, FilmFormat::Y4m, [6, 4], 5)
            .err()
            .expect("no folder");
        assert!(error.to_string().contains("film.y4m: "), "{error}");
        let path = folder.path().join("a.png");
        assert!(
            Film::create(&path, FilmFormat::Apng, [6, 4], 0).is_err(),
            "no frames"
        );
        let mut film = Film::create(&path, FilmFormat::Apng, [6, 4], 2).expect("it can be made");
        let other = Image::filled(5, 4, [0; 3]);
        assert!(film.push(&other).is_err(), "another size");
        drop(film);
        assert!(!folder.path().join("a.png").exists(), "nothing half made");
    }
}
