//! Maps in files: one picture, or one for each face.

use crate::args::TonesArgs;
use crate::failure::Failure;
use crate::output::{Target, write_together};
use hemicube::raster::environment::{
    EnvironmentMap, FACE_NAMES, FACE_PLACEHOLDER, HALF_NAMES, Layout, MapFile, OpenMapError,
    Projection, map_files, open_map,
};
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::raster::{Image, Rgb};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Endings of pictures that can be written.
const WRITTEN: &[&str] = &["hdr", "exr", "png"];

/// Reads a map; `from` is what the user says it is.
pub fn read(path: &Path, from: Option<Projection>) -> Result<MapFile, Failure> {
    open_map(path, from).map_err(failure)
}

/// The pictures of a map.
pub fn pictures(path: &Path, from: Option<Projection>) -> Result<Vec<PathBuf>, Failure> {
    map_files(path, from).map_err(failure)
}

fn failure(error: OpenMapError) -> Failure {
    match error {
        OpenMapError::Unclear {
            path,
            width,
            height,
        } => Failure::Usage(format!(
            "{}: {width} x {height} pixels may be any of several projections; say which with --from sphere, angular, octahedral or fisheye",
            path.display()
        )),
        OpenMapError::Count { .. } => Failure::Usage(format!("{error}; leave --from out")),
        error => Failure::Failed(error.to_string()),
    }
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
        if name.contains(FACE_PLACEHOLDER) {
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
                "{name}: a {projection} map has one face; leave {FACE_PLACEHOLDER} out of the name"
            )));
        }
        if let Some(layout) = layout {
            return Err(Failure::Usage(format!(
                "--layout {layout}: with {FACE_PLACEHOLDER} in the name each face has a file of its own; leave one of them out"
            )));
        }
        let names: &[&str] = if projection.faces() == 2 {
            &HALF_NAMES
        } else {
            &FACE_NAMES
        };
        let target = |face: &&str| {
            Target::check(
                &PathBuf::from(name.replace(FACE_PLACEHOLDER, face)),
                WRITTEN,
            )
        };
        let targets: Result<Vec<Target>, Failure> = names.iter().map(target).collect();
        Ok(Self {
            targets: targets?,
            layout: None,
        })
    }

    /// Refuses to write over what is read: it would be lost, and reading it again would give less.
    pub fn refuse_inputs(&self, inputs: &[PathBuf]) -> Result<(), Failure> {
        let is_input = |target: &&Target| inputs.iter().any(|input| target.is(input));
        match self.targets.iter().find(is_input) {
            Some(target) => Err(Failure::Usage(format!(
                "-o {}: is read from, and would be lost; choose another name",
                target.path.display()
            ))),
            None => Ok(()),
        }
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
