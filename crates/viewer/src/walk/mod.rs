//! Moving through a scene: the eye, the body that carries it, and paths that are recorded.

mod body;
mod eye;
mod film;
mod path;

pub use body::{Body, Step};
pub use eye::{Eye, EyeMode};
pub use film::{FRAMES_PER_SECOND, Film, FilmError, FilmFormat, save_png};
pub use path::Path;
