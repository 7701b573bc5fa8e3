//! Metashape: a sensor per camera, which is held, and the script that hands them out.

use std::io::{self, Write};

use super::cameras::Cameras;
use crate::decimal::number;
use crate::program::metashape::elements;

/// Script for the program's console: it finds the cameras by their labels.
const SCRIPT: &str = include_str!("metashape_frames.py");

/// Returns the label that the program gives to an image: its name without folder and extension.
pub(super) fn label(image: &str) -> &str {
    let name = image.rsplit(['/', '\\']).next().unwrap_or(image);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem,
        _ => name,
    }
}

pub(super) fn cameras(cameras: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    let camera = cameras.camera;
    let [width, height] = camera.size_px;
    let pitch = number(camera.pixel_mm);
    write!(
        sink,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.4.0\">\n \
         <chunk label=\"{}\" enabled=\"true\">\n  <sensors>\n",
        escaped(&camera.name)
    )?;
    cameras.each(|frame, _| {
        let id = frame.sequence;
        let pinhole = cameras.pinhole(frame);
        let [_, focal_px] = pinhole.focal_px;
        write!(
            sink,
            "   <sensor id=\"{id}\" label=\"frame {id}\" type=\"frame\">\n    \
             <resolution width=\"{width}\" height=\"{height}\"/>\n    \
             <property name=\"pixel_width\" value=\"{pitch}\"/>\n    \
             <property name=\"pixel_height\" value=\"{pitch}\"/>\n    \
             <property name=\"focal_length\" value=\"{}\"/>\n    \
             <property name=\"fixed\" value=\"true\"/>\n    \
             <calibration type=\"frame\" class=\"initial\">\n     \
             <resolution width=\"{width}\" height=\"{height}\"/>\n",
            number(focal_px * camera.pixel_mm)
        )?;
        for (name, value) in elements(camera, &pinhole) {
            writeln!(sink, "     <{name}>{}</{name}>", number(value))?;
        }
        sink.write_all(b"    </calibration>\n   </sensor>\n")
    })?;
    sink.write_all(b"  </sensors>\n  <cameras>\n")?;
    cameras.each(|frame, image| {
        let id = frame.sequence;
        let label = escaped(label(image));
        writeln!(
            sink,
            "   <camera id=\"{id}\" sensor_id=\"{id}\" label=\"{label}\" enabled=\"true\"/>"
        )
    })?;
    sink.write_all(b"  </cameras>\n </chunk>\n</document>\n")
}

pub(super) fn script(_: &Cameras<'_>, sink: &mut dyn Write) -> io::Result<()> {
    sink.write_all(SCRIPT.as_bytes())
}

/// Returns a text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn label_is_the_name_without_folder_and_extension() {
        for (image, expected) in [
            ("IMG_1.tif", "IMG_1"),
            ("a/b.c/IMG.1.tif", "IMG.1"),
            ("C:\\flight\\7.iiq", "7"),
            (".tif", ".tif"),
            ("7", "7"),
        ] {
            assert_eq!(label(image), expected);
        }
    }

    #[test]
    fn label_can_hold_any_character() {
        let text = format!("<a b=\"{}\"/>", escaped("<\"&'>"));
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("b"), Some("<\"&'>"));
    }
}
