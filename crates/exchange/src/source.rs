//! Files of other programs, read within bounds.

use fmc_camera_file::InputError;
use serde_json::{Map, Value};

/// Largest file that is read, bytes.
pub const MAX_BYTES: u64 = 64 << 20;

/// Deepest nesting of a file.
const MAX_DEPTH: usize = 64;

/// Most elements of a file.
const MAX_ELEMENTS: usize = 4_000_000;

/// A file in memory, and the name that messages use for it.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Its bytes.
    pub bytes: &'a [u8],
}

impl<'a> Source<'a> {
    /// Creates the error of a file with a wrong content.
    pub(crate) fn invalid(&self, fault: impl std::fmt::Display) -> InputError {
        InputError::invalid(format!("{}: {fault}", self.file))
    }

    /// Returns the text without a byte-order mark.
    pub(crate) fn text(&self) -> Result<&'a str, InputError> {
        if self.bytes.is_empty() {
            return Err(self.invalid("the file is empty"));
        }
        let text =
            std::str::from_utf8(self.bytes).map_err(|_| self.invalid("not a text file (UTF-8)"))?;
        if text.contains('\0') {
            return Err(self.invalid("not a text file: it holds bytes of zero"));
        }
        Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
    }

    /// Reads JSON.
    pub(crate) fn json(&self) -> Result<Value, InputError> {
        let text = self.text()?;
        if text.bytes().filter(|byte| *byte == b',').count() > MAX_ELEMENTS {
            return Err(self.invalid("JSON: too many elements"));
        }
        serde_json::from_str(text).map_err(|error| self.invalid(format!("JSON: {error}")))
    }

    /// Reads XML without a document type, and so without entities of its own.
    pub(crate) fn xml(&self) -> Result<roxmltree::Document<'a>, InputError> {
        let options = roxmltree::ParsingOptions {
            allow_dtd: false,
            nodes_limit: u32::try_from(MAX_ELEMENTS).unwrap_or(u32::MAX),
            ..roxmltree::ParsingOptions::default()
        };
        roxmltree::Document::parse_with_options(self.text()?, options).map_err(|error| {
            let fault = match error {
                roxmltree::Error::DtdDetected => {
                    "XML: a document type with entities is not read".to_owned()
                }
                other => format!("XML: {other}"),
            };
            self.invalid(fault)
        })
    }

    /// Reads YAML without anchors; tags such as `!!opencv-matrix` are left out.
    pub(crate) fn yaml(&self) -> Result<Value, InputError> {
        // OpenCV's directive is not YAML's, which has a space in it.
        let text = self.text()?;
        let body = match text.strip_prefix("%YAML:1.0") {
            Some(rest) => rest.trim_start().strip_prefix("---").unwrap_or(rest),
            None => text,
        };
        YamlTree::default().read(self, body)
    }
}

/// A collection of a YAML file that is being read.
enum Open {
    List(Vec<Value>),
    Table(Map<String, Value>, Option<String>),
}

/// Builds the tree of a YAML file from its events.
#[derive(Default)]
struct YamlTree {
    open: Vec<Open>,
    root: Option<Value>,
    elements: usize,
}

impl YamlTree {
    fn read(mut self, source: &Source<'_>, text: &str) -> Result<Value, InputError> {
        use saphyr_parser::{Event, Parser};

        for event in Parser::new_from_str(text) {
            let (event, place) = event.map_err(|error| source.invalid(format!("YAML: {error}")))?;
            let line = place.start.line();
            let refuse = |fault: &str| Err(source.invalid(format!("line {line}: YAML: {fault}")));
            match event {
                Event::Alias(_) => return refuse("an anchor is not read"),
                Event::Scalar(_, _, anchor, _)
                | Event::SequenceStart(anchor, _)
                | Event::MappingStart(anchor, _)
                    if anchor != 0 =>
                {
                    return refuse("an anchor is not read");
                }
                Event::Scalar(text, style, _, _) => {
                    let is_plain = style == saphyr_parser::ScalarStyle::Plain;
                    let value = scalar(&text, is_plain);
                    if let Err(fault) = self.put(value, &text) {
                        return refuse(fault);
                    }
                }
                Event::SequenceStart(..) => self.open.push(Open::List(Vec::new())),
                Event::MappingStart(..) => self.open.push(Open::Table(Map::new(), None)),
                Event::SequenceEnd | Event::MappingEnd => {
                    let closed = match self.open.pop() {
                        Some(Open::List(list)) => Value::Array(list),
                        Some(Open::Table(table, _)) => Value::Object(table),
                        None => return refuse("a collection ends that has not begun"),
                    };
                    if let Err(fault) = self.put(closed, "") {
                        return refuse(fault);
                    }
                }
                Event::DocumentStart(_) if self.root.is_some() => {
                    return refuse("a second document");
                }
                _ => {}
            }
            if self.open.len() > MAX_DEPTH {
                return refuse("nested too deeply");
            }
        }
        self.root
            .ok_or_else(|| source.invalid("YAML: the file holds nothing"))
    }

    /// Adds a value, which in a table is first a key.
    fn put(&mut self, value: Value, text: &str) -> Result<(), &'static str> {
        self.elements += 1;
        if self.elements > MAX_ELEMENTS {
            return Err("too many elements");
        }
        match self.open.last_mut() {
            None => self.root = Some(value),
            Some(Open::List(list)) => list.push(value),
            Some(Open::Table(table, key)) => match key.take() {
                None if value.is_array() || value.is_object() => {
                    return Err("a key that is a collection");
                }
                None => *key = Some(text.to_owned()),
                Some(key) => {
                    if table.insert(key, value).is_some() {
                        return Err("a key that occurs twice");
                    }
                }
            },
        }
        Ok(())
    }
}

/// Returns a scalar: a plain one that is a number is a number.
fn scalar(text: &str, is_plain: bool) -> Value {
    if is_plain {
        if let Ok(whole) = text.parse::<i64>() {
            return Value::from(whole);
        }
        // A word such as `nan` stays one, and is refused where a number is expected.
        if text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'))
            && let Ok(number) = text.parse::<f64>()
            && number.is_finite()
        {
            return Value::from(number);
        }
    }
    Value::from(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yaml(text: &str) -> Result<Value, InputError> {
        Source {
            file: "a.yaml",
            bytes: text.as_bytes(),
        }
        .yaml()
    }

    #[test]
    fn yaml_of_opencv_is_a_tree_of_numbers() {
        let tree = yaml(
            "%YAML:1.0\n---\nimage_width: 14204\nm: !!opencv-matrix\n   rows: 1\n   dt: d\n   data: [ 1., -2.5e-05,\n       0. ]\n",
        )
        .unwrap();
        assert_eq!(tree["image_width"], 14204);
        assert_eq!(tree["m"]["data"], serde_json::json!([1.0, -2.5e-5, 0.0]));
        assert_eq!(tree["m"]["dt"], "d");
    }

    #[test]
    fn anchors_and_depth_and_second_documents_are_refused() {
        for (text, word) in [
            ("a: &x 1\nb: 2\n", "anchor"),
            ("a: &x [1, 2]\nb: *x\n", "anchor"),
            (&"[".repeat(100), "deep"),
            ("a: 1\n---\nb: 2\n", "second document"),
            ("a: 1\na: 2\n", "twice"),
            ("", "empty"),
            ("# nothing\n", "nothing"),
            ("a: [1, 2", "YAML"),
        ] {
            let error = yaml(text).unwrap_err().to_string();
            assert!(
                error.contains(word) && error.starts_with("a.yaml: "),
                "{error}"
            );
        }
    }

    #[test]
    fn entities_and_deep_nesting_of_xml_are_refused() {
        let refused = |text: &str| {
            let source = Source {
                file: "a.xml",
                bytes: text.as_bytes(),
            };
            source.xml().map(|_| ()).unwrap_err().to_string()
        };
        let bomb = "<!DOCTYPE a [<!ENTITY b \"bbbb\">]><a>&b;</a>";
        assert!(refused(bomb).contains("document type"));
        assert!(refused("<a>").contains("XML"));
        let deep = "<a>".repeat(200_000);
        assert!(refused(&deep).contains("XML"));
    }
}
