//! Opening what the user names: a scene, or a lit `.glb` with its solution.

use crate::args::SceneArgs;
use crate::failure::Failure;
use hemicube::radiosity::Solution;
use hemicube::radiosity::export::lit_glb;
use hemicube::raster::io_error::in_words;
use hemicube::scene::{Scene, open, open_bytes};
use std::fs;
use std::io::{self, Read};
use std::path::Path;

/// Largest file that is read.
const MAX_BYTES: u64 = 2 << 30;

/// What a name stands for.
#[derive(Debug)]
pub enum Input {
    /// A scene as it came from its file, or a built-in one.
    Scene(Box<Scene>),
    /// A solved scene.
    Lit(Box<Solution>),
}

impl Input {
    /// Opens a file or a built-in scene.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        if !path.is_file() {
            return Ok(Self::Scene(Box::new(open(&path.to_string_lossy())?)));
        }
        let bytes = read(path)?;
        let name = path.to_string_lossy();
        if lit_glb::is_lit(&bytes) {
            let solution =
                lit_glb::read(&bytes).map_err(|e| Failure::Failed(format!("{name}: {e}")))?;
            return Ok(Self::Lit(Box::new(solution)));
        }
        let folder = path
            .parent()
            .filter(|folder| !folder.as_os_str().is_empty())
            .unwrap_or(Path::new("."));
        Ok(Self::Scene(Box::new(open_bytes(
            &bytes,
            &name,
            Some(folder),
        )?)))
    }

    /// Opens a lit `.glb`.
    pub fn open_lit(path: &Path) -> Result<Solution, Failure> {
        let refused = |why: &str| Failure::Failed(format!("{}: {why}", path.display()));
        if !path.exists() {
            return Err(refused(
                "there is no such file; name a lit .glb that `hemicube solve -o` wrote",
            ));
        }
        match Self::open(path)? {
            Self::Lit(solution) => Ok(*solution),
            Self::Scene(_) => Err(refused(
                "holds no solution; solve it first, with `hemicube solve -o`",
            )),
        }
    }

    /// The scene, adjusted; that of a lit `.glb` has lost its light.
    pub fn into_scene(self, options: &SceneArgs) -> Result<Scene, Failure> {
        let mut scene = match self {
            Self::Scene(scene) => *scene,
            Self::Lit(solution) => Scene::clone(solution.mesh().scene()),
        };
        options.apply(&mut scene)?;
        Ok(scene)
    }
}

/// The bytes of a file of a bearable size; `-` is standard input.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    read_or_error(path)
        .map_err(|e| Failure::Failed(format!("{}: {}", path.display(), in_words(&e))))
}

fn read_or_error(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        io::stdin()
            .lock()
            .take(MAX_BYTES + 1)
            .read_to_end(&mut bytes)?;
    } else {
        let file = fs::File::open(path)?;
        if file.metadata()?.is_dir() {
            return Err(io::Error::other("it is a folder; name a file in it"));
        }
        if file.metadata()?.len() <= MAX_BYTES {
            file.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
        } else {
            return Err(too_large());
        }
    }
    if bytes.len() as u64 > MAX_BYTES {
        return Err(too_large());
    }
    Ok(bytes)
}

fn too_large() -> io::Error {
    io::Error::other("it is larger than 2 GiB; split it")
}
