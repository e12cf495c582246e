//! Maps in files: one picture, or one for each face.

use crate::args::TonesArgs;
use crate::failure::Failure;
use crate::output::{Target, write_together};
use hemicube::raster::environment::{
    EnvironmentError, EnvironmentMap, FACE_NAMES, Layout, Projection, projection_of_size,
};
use hemicube::raster::image::{Picture, ReadOptions, open_picture};
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::raster::{Image, Rgb};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Endings of pictures that can be written.
const WRITTEN: &[&str] = &["hdr", "exr", "png"];

/// Endings of pictures that a folder of faces may have.
const READ: [&str; 6] = ["hdr", "exr", "png", "jpg", "jpeg", "webp"];

/// What stands for the name of a face in a file's name.
const PLACEHOLDER: &str = "{face}";

/// Names of the two halves of a paraboloid.
const HALVES: [&str; 2] = ["front", "back"];

/// Names under which the six faces of a cube are found, in the order of [`FACE_NAMES`].
const SCHEMES: [[&str; 6]; 3] = [
    FACE_NAMES,
    ["posx", "negx", "posy", "negy", "posz", "negz"],
    ["right", "left", "top", "bottom", "front", "back"],
];

/// A map that was read.
#[derive(Debug)]
pub struct Loaded {
    pub map: EnvironmentMap,
    /// Whether its pictures had 8 bits a sample, of sRGB.
    pub is_8_bit: bool,
}

/// Reads a map; `from` is what the user says it is.
pub fn read(path: &Path, from: Option<Projection>) -> Result<Loaded, Failure> {
    let faces = if path.to_string_lossy().contains(PLACEHOLDER) {
        Some(of_pattern(path, from)?)
    } else if path.is_dir() {
        Some(of_folder(path)?)
    } else {
        None
    };
    let of_map = |error: EnvironmentError| Failure::Failed(format!("{}: {error}", path.display()));
    let options = ReadOptions::default();
    let Some(files) = faces else {
        let picture = open_picture(path, &options)?;
        let projection = match from {
            Some(projection) => projection,
            None => guessed(path, &picture)?,
        };
        return Ok(Loaded {
            map: EnvironmentMap::from_image(projection, &picture.rgb()).map_err(of_map)?,
            is_8_bit: picture.is_8_bit(),
        });
    };
    let projection = if files.len() == 2 {
        Projection::Paraboloid
    } else {
        Projection::Cube
    };
    if from.is_some_and(|from| from != projection) {
        return Err(Failure::Usage(format!(
            "{}: {} pictures are a {projection} map; leave --from out",
            path.display(),
            files.len()
        )));
    }
    let pictures: Result<Vec<Picture>, _> =
        files.iter().map(|f| open_picture(f, &options)).collect();
    let pictures = pictures?;
    let images: Vec<Image<Rgb>> = pictures.iter().map(Picture::rgb).collect();
    Ok(Loaded {
        map: EnvironmentMap::new(projection, &images).map_err(of_map)?,
        is_8_bit: pictures.iter().all(Picture::is_8_bit),
    })
}

/// What a picture's sides say it is.
fn guessed(path: &Path, picture: &Picture) -> Result<Projection, Failure> {
    let (width, height) = (picture.image.width(), picture.image.height());
    projection_of_size(width, height).ok_or_else(|| {
        Failure::Usage(format!(
            "{}: {width} x {height} pixels may be any of several projections; say which with --from sphere, angular, octahedral or fisheye",
            path.display()
        ))
    })
}

/// The files of a name with a placeholder.
fn of_pattern(path: &Path, from: Option<Projection>) -> Result<Vec<PathBuf>, Failure> {
    let pattern = path.to_string_lossy().into_owned();
    let with = |name: &&str| PathBuf::from(pattern.replace(PLACEHOLDER, name));
    let is_cube = from.is_none_or(|from| from == Projection::Cube);
    let cubes = SCHEMES.iter().map(|names| names.iter().map(with).collect());
    let mut all: Vec<Vec<PathBuf>> = cubes.filter(|_| is_cube).collect();
    all.push(HALVES.iter().map(with).collect());
    let found = all
        .into_iter()
        .find(|files| files.iter().all(|file| file.is_file()));
    found.ok_or_else(|| {
        Failure::Failed(format!(
            "{pattern}: there are no such files with px, nx, py, ny, pz, nz (or posx, ... or right, ...) for {PLACEHOLDER}"
        ))
    })
}

/// The six faces in a folder: pictures whose names end in those of the faces.
fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |why: &str| Failure::Failed(format!("{}: {why}", folder.display()));
    let entries = std::fs::read_dir(folder).map_err(|e| failed(&e.to_string()))?;
    let mut pictures: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| ending(path).is_some_and(|e| READ.contains(&e.as_str())))
        .collect();
    pictures.sort();
    let find = |name: &&str| {
        let ends = |path: &&PathBuf| {
            let stem = path.file_stem().map(|s| s.to_string_lossy().to_lowercase());
            stem.is_some_and(|stem| stem.ends_with(name))
        };
        let mut found = pictures.iter().filter(ends);
        found.next().filter(|_| found.next().is_none()).cloned()
    };
    let sets = SCHEMES.iter().map(|names| names.iter().map(find).collect());
    sets.into_iter().find_map(|set: Option<Vec<PathBuf>>| set).ok_or_else(|| {
        failed("no six pictures whose names end in px, nx, py, ny, pz, nz (or posx, ... or right, ...), each once")
    })
}

fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_string_lossy().to_lowercase())
}

/// How light becomes colour in a .png.
#[derive(Debug, Clone, Copy)]
pub struct Tones {
    exposure: Exposure,
    tonemap: ToneMap,
}

impl Tones {
    /// What was asked for; what had 8 bits is kept as it is, other light made to fit a display.
    pub fn new(args: TonesArgs, is_8_bit: bool) -> Self {
        let (exposure, tonemap) = if is_8_bit {
            (Exposure::Ev(0.0), ToneMap::None)
        } else {
            (Exposure::Auto, ToneMap::default())
        };
        Self {
            exposure: args.exposure.unwrap_or(exposure),
            tonemap: args.tonemap.unwrap_or(tonemap),
        }
    }

    fn applied(self, map: &EnvironmentMap) -> EnvironmentMap {
        let luminances = map.texels().iter().map(|c| c.luminance());
        let factor = self.exposure.factor(luminances);
        map.map(|&light| self.tonemap.apply(light, factor))
    }
}

/// Where a map goes, checked before the work begins.
#[derive(Debug)]
pub struct Outputs {
    targets: Vec<Target>,
    /// How faces lie in one picture; `None` where each has its own.
    layout: Option<Layout>,
}

impl Outputs {
    /// Checks that the files can be written, without touching them.
    pub fn check(
        path: &Path,
        projection: Projection,
        layout: Option<Layout>,
    ) -> Result<Self, Failure> {
        let name = path.to_string_lossy();
        if name.contains(PLACEHOLDER) {
            return Self::of_faces(&name, projection, layout);
        }
        let chosen = layout.unwrap_or(Layout::default_of(projection));
        if !chosen.fits(projection) {
            return Err(Failure::Usage(format!(
                "--layout {chosen}: a {projection} map has {} and cannot lie like that",
                if projection.faces() == 1 {
                    "one face"
                } else {
                    "several faces"
                }
            )));
        }
        Ok(Self {
            targets: vec![Target::check(path, WRITTEN)?],
            layout: Some(chosen),
        })
    }

    fn of_faces(
        name: &str,
        projection: Projection,
        layout: Option<Layout>,
    ) -> Result<Self, Failure> {
        if projection.faces() == 1 {
            return Err(Failure::Usage(format!(
                "{name}: a {projection} map has one face; leave {PLACEHOLDER} out of the name"
            )));
        }
        if let Some(layout) = layout {
            return Err(Failure::Usage(format!(
                "--layout {layout}: with {PLACEHOLDER} in the name each face has a file of its own; leave one of them out"
            )));
        }
        let names: &[&str] = if projection.faces() == 2 {
            &HALVES
        } else {
            &FACE_NAMES
        };
        let target =
            |face: &&str| Target::check(&PathBuf::from(name.replace(PLACEHOLDER, face)), WRITTEN);
        let targets: Result<Vec<Target>, Failure> = names.iter().map(target).collect();
        Ok(Self {
            targets: targets?,
            layout: None,
        })
    }

    /// Writes all files or none; their names.
    pub fn write(&self, map: &EnvironmentMap, tones: Tones) -> Result<Vec<String>, Failure> {
        let is_png = self.targets.iter().any(|target| target.ends_in("png"));
        let shown = if is_png {
            Some(tones.applied(map))
        } else {
            None
        };
        let map = shown.as_ref().unwrap_or(map);
        let images = match self.layout {
            Some(layout) => vec![map.to_image(layout)],
            None => map.faces(),
        };
        let mut files = Vec::new();
        for (target, image) in self.targets.iter().zip(&images) {
            files.push((target.clone(), encoded(image, target)?));
        }
        write_together(&files)?;
        Ok(self
            .targets
            .iter()
            .map(|t| t.path.display().to_string())
            .collect())
    }
}

fn encoded(image: &Image<Rgb>, target: &Target) -> Result<Vec<u8>, Failure> {
    let mut file = Cursor::new(Vec::new());
    if target.ends_in("exr") {
        image.write_exr(&mut file)?;
    } else if target.ends_in("hdr") {
        let failed = |e| Failure::Failed(format!("{}: {e}", target.path.display()));
        image.write_hdr(&mut file).map_err(failed)?;
    } else {
        image.write_png(&mut file)?;
    }
    Ok(file.into_inner())
}
