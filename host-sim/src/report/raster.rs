//! Figures as PNG.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// The font of every text in a figure: no font need be installed.
const FONT: &str = "DejaVu Sans";

/// Why there is no PNG.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// The SVG is not one.
    #[error("cannot read the figure: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// The figure has no area, or too much.
    #[error("a figure of {width} x {height} pixels cannot be drawn")]
    Size {
        /// Width.
        width: u32,
        /// Height.
        height: u32,
    },
    /// The PNG cannot be encoded.
    #[error("cannot encode the figure: {0}")]
    Png(String),
}

/// An SVG figure as PNG, pixel for pixel.
///
/// # Errors
/// [`RasterError`] for what is no figure.
pub fn png(svg: &str) -> Result<Vec<u8>, RasterError> {
    let mut options = Options {
        font_family: FONT.to_owned(),
        ..Options::default()
    };
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family(FONT);
    let tree = Tree::from_str(svg, &options)?;
    let size = tree.size().to_int_size();
    let mut picture = Pixmap::new(size.width(), size.height()).ok_or(RasterError::Size {
        width: size.width(),
        height: size.height(),
    })?;
    resvg::render(&tree, Transform::identity(), &mut picture.as_mut());
    picture
        .encode_png()
        .map_err(|error| RasterError::Png(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(svg: &str) -> usize {
        let picture = Pixmap::decode_png(&png(svg).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (200, 50));
        picture.pixels().iter().filter(|p| p.red() < 100).count()
    }

    #[test]
    fn text_is_drawn_without_an_installed_font() {
        let svg = |text: &str| {
            format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"50\"><rect width=\"200\" height=\"50\" fill=\"#fff\"/><text x=\"5\" y=\"30\" font-family=\"sans-serif\" font-size=\"20\">{text}</text></svg>"
            )
        };
        assert_eq!(dark_pixels(&svg("")), 0);
        for text in ["K_d1", "δ, µm", "10⁻⁹ mm⁻²"] {
            assert!(dark_pixels(&svg(text)) > 100, "{text}");
        }
    }

    #[test]
    fn what_is_no_figure_is_an_error() {
        assert!(png("<html>").is_err());
    }
}
