//! `map.png`: the picture in pixels, made from the SVG by resvg. The SVG letters its labels with
//! strokes, so no font is needed.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// Width of the picture, pixels.
pub const WIDTH: u32 = 1600;

/// Highest picture, pixels; keeps a corridor stood on end from filling the memory.
const HIGHEST: f32 = 6000.0;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The SVG is not one.
    #[error("the drawing cannot be read: {reason}")]
    Drawing {
        /// What the parser said.
        reason: String,
    },
    /// The picture has no size or cannot be packed.
    #[error("the picture cannot be made: {reason}")]
    Picture {
        /// What went wrong.
        reason: String,
    },
}

/// The bytes of a PNG file of the drawing `svg`, `width` pixels wide.
///
/// # Errors
/// When the drawing is no SVG or has no size.
pub fn render(svg: &str, width: u32) -> Result<Vec<u8>, PngError> {
    let tree = Tree::from_str(svg, &Options::default())
        .map_err(|error| PngError::Drawing { reason: error.to_string() })?;
    let size = tree.size();
    let scale = (width as f32 / size.width()).min(HIGHEST / size.height());
    let pixels = |extent: f32| (extent * scale).ceil().max(1.0) as u32;
    let mut picture = Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| PngError::Picture { reason: "it has no size".to_owned() })?;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(|error| PngError::Picture { reason: error.to_string() })
}
