//! Maps in files: one picture, or one for each face.

use super::{EnvironmentError, EnvironmentMap, FACE_NAMES, Projection, projection_of_size};
use crate::image::{Picture, ReadError, ReadOptions, open_picture};
use crate::{Image, Rgb, io_error};
use core::fmt;
use std::path::{Path, PathBuf};

/// What stands for the name of a face in the name of its file.
pub const FACE_PLACEHOLDER: &str = "{face}";

/// Names of the halves of a paraboloid in files.
pub const HALF_NAMES: [&str; 2] = ["front", "back"];

/// Names under which the six faces of a cube are found, in the order of [`FACE_NAMES`].
const SCHEMES: [[&str; 6]; 3] = [
    FACE_NAMES,
    ["posx", "negx", "posy", "negy", "posz", "negz"],
    ["right", "left", "top", "bottom", "front", "back"],
];

/// Endings of pictures that a folder of faces may have.
const ENDINGS: [&str; 6] = ["hdr", "exr", "png", "jpg", "jpeg", "webp"];

/// A map from files, and what its pictures were.
#[derive(Debug, Clone, PartialEq)]
pub struct MapFile {
    /// The map, all of whose texels are finite: NaN has become 0, and infinities the largest half float, 65,504, with
    /// their sign. Negative texels stay as they are.
    pub map: EnvironmentMap,
    /// The pictures: one, or those of the faces in their order.
    pub files: Vec<PathBuf>,
    /// Whether all pictures had 8 bits a sample, of sRGB.
    pub is_8_bit: bool,
    /// Pixels with a band that was NaN or infinite.
    pub non_finite: Option<Flaw>,
    /// Pixels with a finite band below 0.
    pub negative: Option<Flaw>,
}

/// Pixels that no light has.
#[derive(Debug, Clone, PartialEq)]
pub struct Flaw {
    /// How many there are, in all pictures.
    pub pixels: usize,
    /// The picture of the first one.
    pub file: PathBuf,
    /// Its column in the picture, from 0.
    pub x: usize,
    /// Its row, from 0.
    pub y: usize,
    /// What is there.
    pub value: [f32; 3],
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.value;
        let (n, x, y) = (self.pixels, self.x, self.y);
        let file = self.file.file_name().unwrap_or_default().display();
        write!(
            f,
            "{n} {}, the first of {file} in column {x}, row {y}: {r} {g} {b}",
            if n == 1 { "pixel" } else { "pixels" }
        )
    }
}

/// A map could not be read; one line that starts with the file's name.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenMapError {
    /// A picture could not be read.
    #[error(transparent)]
    Picture(#[from] ReadError),
    /// The pictures make no map.
    #[error("{}: {error}", path.display())]
    Map {
        /// What was to be read.
        path: PathBuf,
        /// What is wrong.
        error: EnvironmentError,
    },
    /// Sides that do not tell the projection.
    #[error(
        "{}: {width} x {height} pixels are neither a panorama (2:1) nor a cube (4:3, 3:4, 6:1, 1:6)",
        path.display()
    )]
    Unclear {
        /// The picture.
        path: PathBuf,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Another projection was asked for than the pictures have.
    #[error("{}: {pictures} pictures are a {projection} map, not a {wanted} map", path.display())]
    Count {
        /// What was to be read.
        path: PathBuf,
        /// Pictures found.
        pictures: usize,
        /// What so many are.
        projection: Projection,
        /// What was asked for.
        wanted: Projection,
    },
    /// A name with a placeholder for which the files are missing.
    #[error(
        "{0}: there are no such files with px, nx, py, ny, pz, nz (or posx, ... or right, ...) for {FACE_PLACEHOLDER}"
    )]
    Pattern(String),
    /// A folder in which faces are missing, or found twice.
    #[error(
        "{}: no six pictures whose names end in px, nx, py, ny, pz, nz (or posx, ... or right, ...), each once, nor two in front and back",
        .0.display()
    )]
    Folder(PathBuf),
    /// A folder that cannot be read.
    #[error("{}: {}", path.display(), io_error::in_words(source))]
    Io {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// Reads a map: a picture, a folder with all of them, or a name with [`FACE_PLACEHOLDER`] in it.
///
/// Faces are called px, nx, py, ny, pz, nz; posx, negx, ... and right, left, top, bottom, front, back are understood too. In
/// a folder it is how their names end, without the ending of the format. Two pictures, front and back, are the halves of a
/// paraboloid. What a single picture is, `from` says, or its sides ([`projection_of_size`]).
///
/// # Errors
/// Pictures that cannot be read, are missing, or make no map.
pub fn open_map(path: &Path, from: Option<Projection>) -> Result<MapFile, OpenMapError> {
    let files = map_files(path, from)?;
    let options = ReadOptions::default().with_non_finite(true);
    let pictures = files.iter().map(|file| open_picture(file, &options));
    let pictures: Vec<Picture> = pictures.collect::<Result<_, _>>()?;
    let images: Vec<Image<Rgb>> = pictures.iter().map(Picture::rgb).collect();
    let mended: Vec<Image<Rgb>> = images.iter().map(|image| image.map(mended)).collect();
    let made = match (mended.as_slice(), pictures.len()) {
        ([image], _) => {
            let projection = from.map_or_else(|| guessed(path, image), Ok)?;
            EnvironmentMap::from_image(projection, image)
        }
        (faces, count) => EnvironmentMap::new(of_count(path, count, from)?, faces),
    };
    Ok(MapFile {
        map: made.map_err(|error| OpenMapError::Map {
            path: path.to_path_buf(),
            error,
        })?,
        is_8_bit: pictures.iter().all(Picture::is_8_bit),
        non_finite: flaw(&files, &images, |c| !c.is_finite()),
        negative: flaw(&files, &images, |c| c.is_finite() && is_negative(c)),
        files,
    })
}

/// The pictures that [`open_map`] would read; a single one need not exist.
///
/// # Errors
/// Pictures of faces that are missing.
pub fn map_files(path: &Path, from: Option<Projection>) -> Result<Vec<PathBuf>, OpenMapError> {
    if path.to_string_lossy().contains(FACE_PLACEHOLDER) {
        of_pattern(path, from)
    } else if path.is_dir() {
        of_folder(path)
    } else {
        Ok(vec![path.to_path_buf()])
    }
}

fn is_negative(color: &Rgb) -> bool {
    color.to_array().iter().any(|&band| band < 0.0)
}

/// A pixel that is finite, see [`MapFile::map`].
fn mended(color: &Rgb) -> Rgb {
    const LARGEST_HALF: f32 = 65_504.0;
    color.map(|band| match band {
        band if band.is_finite() => band,
        band if band.is_nan() => 0.0,
        band => LARGEST_HALF.copysign(band),
    })
}

/// The pixels of which something is true.
fn flaw(files: &[PathBuf], images: &[Image<Rgb>], is_flawed: fn(&Rgb) -> bool) -> Option<Flaw> {
    let pixels = |image: &Image<Rgb>| image.pixels().iter().filter(|c| is_flawed(c)).count();
    let first = |(file, image): (&PathBuf, &Image<Rgb>)| {
        let at = image.pixels().iter().position(is_flawed)?;
        Some(Flaw {
            pixels: images.iter().map(pixels).sum(),
            file: file.clone(),
            x: at % image.width(),
            y: at / image.width(),
            value: image.pixels()[at].to_array(),
        })
    };
    files.iter().zip(images).find_map(first)
}

/// What a picture's sides say it is.
fn guessed(path: &Path, image: &Image<Rgb>) -> Result<Projection, OpenMapError> {
    let (width, height) = (image.width(), image.height());
    projection_of_size(width, height).ok_or_else(|| OpenMapError::Unclear {
        path: path.to_path_buf(),
        width,
        height,
    })
}

/// What two pictures are, or six.
fn of_count(
    path: &Path,
    pictures: usize,
    from: Option<Projection>,
) -> Result<Projection, OpenMapError> {
    let projection = if pictures == 2 {
        Projection::Paraboloid
    } else {
        Projection::Cube
    };
    match from {
        Some(wanted) if wanted != projection => Err(OpenMapError::Count {
            path: path.to_path_buf(),
            pictures,
            projection,
            wanted,
        }),
        _ => Ok(projection),
    }
}

/// The files of a name with a placeholder.
fn of_pattern(path: &Path, from: Option<Projection>) -> Result<Vec<PathBuf>, OpenMapError> {
    let pattern = path.to_string_lossy().into_owned();
    let with = |name: &&str| PathBuf::from(pattern.replace(FACE_PLACEHOLDER, name));
    let is_cube = from != Some(Projection::Paraboloid);
    let cubes = SCHEMES.iter().map(|names| names.iter().map(with).collect());
    let mut all: Vec<Vec<PathBuf>> = cubes.filter(|_| is_cube).collect();
    all.push(HALF_NAMES.iter().map(with).collect());
    all.into_iter()
        .find(|files| files.iter().all(|file| file.is_file()))
        .ok_or(OpenMapError::Pattern(pattern))
}

/// The six faces in a folder: pictures whose names end in those of the faces.
fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, OpenMapError> {
    let failed = |source| OpenMapError::Io {
        path: folder.to_path_buf(),
        source,
    };
    let mut pictures = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if ending.is_some_and(|e| ENDINGS.contains(&e.as_str())) {
            pictures.push(path);
        }
    }
    let find = |name: &&str| {
        let ends = |path: &&PathBuf| {
            let stem = path.file_stem().map(|s| s.to_string_lossy().to_lowercase());
            stem.is_some_and(|stem| stem.ends_with(name))
        };
        let mut found = pictures.iter().filter(ends);
        found.next().filter(|_| found.next().is_none()).cloned()
    };
    let cubes = SCHEMES.iter().map(|names| names.as_slice());
    let mut sets = cubes.chain([HALF_NAMES.as_slice()]);
    let found = sets.find_map(|names| names.iter().map(find).collect());
    found.ok_or_else(|| OpenMapError::Folder(folder.to_path_buf()))
}
