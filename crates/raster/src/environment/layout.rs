//! Several faces in one picture.

use super::{EnvironmentError, EnvironmentMap, Projection};
use crate::{Image, Rgb};
use core::fmt;

/// How the faces of a map lie in one picture; in words as an eye in the middle would see them.
///
/// ```text
/// horizontal cross      vertical cross      row                       column
///    . py .  .             . py .           px nx py ny pz nz         the same, one below the other
///   nx pz px nz           nx pz px
///    . ny .  .             . ny .
///                          . nz .   upside down
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Layout {
    /// Six faces beside each other; the two halves of a paraboloid too.
    Row,
    /// Faces one below the other.
    Column,
    /// Four faces around the horizon, with the upper and the lower one at the face ahead.
    HorizontalCross,
    /// As above, with the face behind below the lower one, upside down.
    VerticalCross,
    /// One picture, for projections with one face.
    Single,
}

impl Layout {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Row,
        Self::Column,
        Self::HorizontalCross,
        Self::VerticalCross,
        Self::Single,
    ];

    /// Name in options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Row => "row",
            Self::Column => "column",
            Self::HorizontalCross => "cross",
            Self::VerticalCross => "vertical-cross",
            Self::Single => "single",
        }
    }

    /// The layout that a projection has unless another one is asked for: row of two halves, horizontal cross of a cube.
    pub const fn default_of(projection: Projection) -> Self {
        match projection {
            Projection::Cube => Self::HorizontalCross,
            Projection::Paraboloid => Self::Row,
            _ => Self::Single,
        }
    }

    /// Whether faces of a projection can lie like this.
    pub const fn fits(self, projection: Projection) -> bool {
        match projection.faces() {
            1 => matches!(self, Self::Single),
            2 => matches!(self, Self::Row | Self::Column),
            _ => !matches!(self, Self::Single),
        }
    }

    /// Columns and rows of the grid, in faces.
    const fn grid(self, faces: usize) -> (usize, usize) {
        match self {
            Self::Row => (faces, 1),
            Self::Column => (1, faces),
            Self::HorizontalCross => (4, 3),
            Self::VerticalCross => (3, 4),
            Self::Single => (1, 1),
        }
    }

    /// Column and row of a face in the grid, and whether it is turned by 180 degrees.
    const fn place(self, face: usize) -> (usize, usize, bool) {
        const CROSS: [(usize, usize); 6] = [(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1)];
        match self {
            Self::Row => (face, 0, false),
            Self::Column => (0, face, false),
            Self::Single => (0, 0, false),
            Self::VerticalCross if face == 5 => (1, 3, true),
            Self::HorizontalCross | Self::VerticalCross => (CROSS[face].0, CROSS[face].1, false),
        }
    }

    /// The layout of a cube, or of two halves, whose picture has these sides; `None` if none fits.
    fn of_size(projection: Projection, width: usize, height: usize) -> Option<Self> {
        let faces = projection.faces();
        Self::ALL.into_iter().find(|layout| {
            let (columns, rows) = layout.grid(faces);
            let fits = width * rows == height * columns && width.is_multiple_of(columns);
            layout.fits(projection) && fits
        })
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What a picture's sides say it is: 2:1 a panorama, 6:1, 1:6, 4:3 or 3:4 a cube. `None` for squares, which may be any of
/// five projections, and for all others.
pub fn projection_of_size(width: usize, height: usize) -> Option<Projection> {
    if width == 2 * height {
        return Some(Projection::LatLong);
    }
    Layout::of_size(Projection::Cube, width, height).map(|_| Projection::Cube)
}

impl EnvironmentMap {
    /// All faces in one picture; what no face covers is black. A layout that does not fit is taken for
    /// [`Layout::default_of`].
    pub fn to_image(&self, layout: Layout) -> Image<Rgb> {
        let projection = self.projection();
        let layout = if layout.fits(projection) {
            layout
        } else {
            Layout::default_of(projection)
        };
        let (columns, rows) = layout.grid(projection.faces());
        let (width, height) = (self.width(), self.height());
        let mut image = Image::filled(columns * width, rows * height, Rgb::BLACK);
        for face in 0..projection.faces() {
            let (column, row, is_turned) = layout.place(face);
            for y in 0..height {
                for x in 0..width {
                    let (fx, fy) = turned(is_turned, x, y, width, height);
                    *image.pixel_mut(column * width + x, row * height + y) =
                        self.texel(face, fx, fy);
                }
            }
        }
        image
    }

    /// A map from one picture with all its faces, their layout told by its sides.
    ///
    /// A picture with one disc that is not quite square, as renderers crop them, is centred in a square; what it does
    /// not show is black.
    ///
    /// # Errors
    /// Sides that fit no layout, and what [`Self::new`] refuses.
    pub fn from_image(
        projection: Projection,
        image: &Image<Rgb>,
    ) -> Result<Self, EnvironmentError> {
        let (width, height) = (image.width(), image.height());
        if projection.faces() == 1 {
            let is_disc = projection.disc().is_some();
            let is_almost_square = width.abs_diff(height) * 8 < width.max(height);
            return if is_disc && width != height && is_almost_square {
                Self::new(projection, &[squared(image)])
            } else {
                Self::new(projection, core::slice::from_ref(image))
            };
        }
        let layout =
            Layout::of_size(projection, width, height).ok_or(EnvironmentError::Layout {
                projection,
                width,
                height,
            })?;
        let (columns, rows) = layout.grid(projection.faces());
        let (width, height) = (width / columns, height / rows);
        let face = |face: usize| {
            let (column, row, is_turned) = layout.place(face);
            let pixels = (0..width * height).map(|i| {
                let (x, y) = turned(is_turned, i % width, i / width, width, height);
                *image.pixel(column * width + x, row * height + y)
            });
            Image::from_pixels(width, height, pixels.collect()).expect("a face of that size")
        };
        let faces: Vec<Image<Rgb>> = (0..projection.faces()).map(face).collect();
        Self::new(projection, &faces)
    }
}

fn turned(is_turned: bool, x: usize, y: usize, width: usize, height: usize) -> (usize, usize) {
    if is_turned {
        (width - 1 - x, height - 1 - y)
    } else {
        (x, y)
    }
}

/// A picture in the middle of a black square.
fn squared(image: &Image<Rgb>) -> Image<Rgb> {
    let (width, height) = (image.width(), image.height());
    let side = width.max(height);
    let (left, top) = ((side - width) / 2, (side - height) / 2);
    let mut square = Image::filled(side, side, Rgb::BLACK);
    for y in 0..height {
        for x in 0..width {
            *square.pixel_mut(left + x, top + y) = *image.pixel(x, y);
        }
    }
    square
}
