//! What an exhibit is: a name, what it shows, and how it is drawn.

use hemicube_chart::{Canvas, Chart, Drawing};
use hemicube_raster::environment::OpenMapError;
use hemicube_raster::image::ImageError;
use hemicube_raster::{Image, Rgb};
use std::io::Cursor;
use std::path::PathBuf;

/// Something to look at, drawn on request.
#[derive(Debug, Clone, Copy)]
pub struct Exhibit {
    /// Name on the command line and start of its files' names: lower case, words joined by hyphens.
    pub name: &'static str,
    /// What it shows, in one line.
    pub about: &'static str,
    /// The files that it draws, one word or two for each (`"surface.obj"`); empty if it needs none.
    pub needs: &'static [&'static str],
    /// Draws it.
    pub draw: fn(&Request) -> Result<Vec<Piece>, GalleryError>,
}

/// What an exhibit is asked for.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Width and height of its main picture in pixels. Default value: the exhibit's own choice.
    pub size: Option<(usize, usize)>,
    /// Seed of everything random in it. Default value: 0.
    pub seed: u64,
    /// The files that it needs, in the order of [`Exhibit::needs`].
    pub files: Vec<PathBuf>,
}

/// A file of an exhibit.
#[derive(Debug, Clone)]
pub struct Piece {
    /// Ending of its name, with what tells it from the exhibit's other files: `".png"`, `"-error.svg"`.
    pub suffix: String,
    /// What the file holds.
    pub bytes: Vec<u8>,
}

impl Piece {
    /// A picture as a display shows it, linear in [0, 1]. The suffix has no ending: `""` or `"-bilinear"`.
    pub fn picture(suffix: &str, image: &Image<Rgb>) -> Result<Self, GalleryError> {
        let mut file = Cursor::new(Vec::new());
        image.write_png(&mut file)?;
        Ok(Self::new(format!("{suffix}.png"), file.into_inner()))
    }

    /// Pictures and labels on a sheet.
    pub fn sheet(suffix: &str, canvas: &Canvas) -> Result<Self, GalleryError> {
        Ok(Self::new(format!("{suffix}.png"), canvas.png()?))
    }

    /// A chart of so many pixels, as SVG.
    pub fn chart(suffix: &str, chart: &Chart, (width, height): (usize, usize)) -> Self {
        let svg = chart.draw(width, height).svg();
        Self::new(format!("{suffix}.svg"), svg.into_bytes())
    }

    /// Lines and text, as SVG.
    pub fn drawing(suffix: &str, drawing: &Drawing) -> Self {
        Self::new(format!("{suffix}.svg"), drawing.svg().into_bytes())
    }

    /// A table; the text is written as it is.
    pub fn csv(suffix: &str, text: String) -> Self {
        Self::new(format!("{suffix}.csv"), text.into_bytes())
    }

    fn new(suffix: String, bytes: Vec<u8>) -> Self {
        Self { suffix, bytes }
    }
}

/// Why an exhibit could not be drawn; one line: what, where, how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GalleryError {
    /// A picture could not be encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// An environment map cannot be read.
    #[error(transparent)]
    Map(#[from] OpenMapError),
    /// A file cannot be used.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The size asked for makes no sense for this exhibit.
    #[error("a picture of {width} x {height} pixels: {why}")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// What is wrong with it.
        why: String,
    },
}
