//! The dictionary of Python in the header of an array.

use super::{NpyHeader, shown};

/// A reason why a header's text is not the dictionary of an array.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DictionaryError {
    /// Something else stands where this is required.
    #[error("{expected} is missing at character {at}")]
    Missing {
        /// Required text.
        expected: &'static str,
        /// Number of characters before it.
        at: usize,
    },
    /// The key is not one of an array.
    #[error("key \"{0}\" is not one of descr, fortran_order, shape")]
    UnknownKey(String),
    /// The key is given twice.
    #[error("key {0:?} stands there twice")]
    Twice(String),
    /// The key is missing.
    #[error("key {0:?} is missing")]
    MissingKey(&'static str),
    /// An axis has a negative length.
    #[error("an axis has the length -{0}")]
    Negative(String),
    /// An axis is longer than any array.
    #[error("an axis has the length {0}, more than 64 bits")]
    TooLarge(String),
}

/// The unread part of a text.
pub(super) struct Reader<'a> {
    text: &'a str,
    rest: &'a str,
}

/// Parses the whole text of a header: a dictionary, and blanks around it.
pub(super) fn parse(text: &str) -> Result<NpyHeader, DictionaryError> {
    let mut reader = Reader::new(text);
    let mut description = None;
    let mut is_fortran_order = None;
    let mut shape = None;
    reader.expect('{', "{")?;
    while !reader.take('}') {
        let key = reader.string()?;
        reader.expect(':', ":")?;
        let is_again = match key {
            "descr" => description.replace(reader.value()?.to_owned()).is_some(),
            "fortran_order" => is_fortran_order.replace(reader.truth()?).is_some(),
            "shape" => shape.replace(reader.shape()?).is_some(),
            _ => return Err(DictionaryError::UnknownKey(shown(key))),
        };
        if is_again {
            return Err(DictionaryError::Twice(key.to_owned()));
        }
        reader.separate('}')?;
    }
    reader.skip_blanks();
    if !reader.rest.is_empty() {
        return Err(reader.missing("the end"));
    }
    Ok(NpyHeader {
        description: description.ok_or(DictionaryError::MissingKey("descr"))?,
        is_fortran_order: is_fortran_order.ok_or(DictionaryError::MissingKey("fortran_order"))?,
        shape: shape.ok_or(DictionaryError::MissingKey("shape"))?,
    })
}

impl<'a> Reader<'a> {
    pub(super) const fn new(text: &'a str) -> Self {
        Self { text, rest: text }
    }

    pub(super) fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.rest.is_empty()
    }

    pub(super) fn missing(&self, expected: &'static str) -> DictionaryError {
        let before = self.text.len() - self.rest.len();
        let before = self.text.get(..before).unwrap_or_default();
        DictionaryError::Missing {
            expected,
            at: before.chars().count(),
        }
    }

    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_ascii_start();
    }

    /// Takes a character with the blanks before it, if it is next; returns true if it was.
    pub(super) fn take(&mut self, next: char) -> bool {
        self.skip_blanks();
        let rest = self.rest.strip_prefix(next);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    pub(super) fn expect(&mut self, next: char, name: &'static str) -> Result<(), DictionaryError> {
        if self.take(next) {
            Ok(())
        } else {
            Err(self.missing(name))
        }
    }

    /// Takes a comma, or leaves the character that closes the entries; one of the two must follow
    /// an entry.
    pub(super) fn separate(&mut self, close: char) -> Result<(), DictionaryError> {
        if self.take(',') || self.rest.starts_with(close) {
            Ok(())
        } else {
            Err(self.missing("a comma"))
        }
    }

    /// Takes the next `bytes`, which end at a character.
    fn split(&mut self, bytes: usize) -> &'a str {
        let (taken, rest) = self.rest.split_at_checked(bytes).unwrap_or((self.rest, ""));
        self.rest = rest;
        taken
    }

    /// Takes a string and returns the text between its quotes, with escapes as they are written.
    pub(super) fn string(&mut self) -> Result<&'a str, DictionaryError> {
        self.skip_blanks();
        let start = self.rest;
        let Some(quote @ ('\'' | '"')) = start.chars().next() else {
            return Err(self.missing("a string"));
        };
        let mut is_escaped = false;
        let within = start.strip_prefix(quote).unwrap_or_default();
        for (length, character) in within.char_indices() {
            if is_escaped {
                is_escaped = false;
            } else if character == '\\' {
                is_escaped = true;
            } else if character == quote {
                self.split(length + 2);
                return Ok(within.get(..length).unwrap_or_default());
            }
        }
        self.rest = "";
        Err(self.missing("the end of a string"))
    }

    /// Takes a string, or a list or tuple of a structured type, and returns it as it is written.
    pub(super) fn value(&mut self) -> Result<&'a str, DictionaryError> {
        self.skip_blanks();
        let start = self.rest;
        let mut open = Vec::new();
        loop {
            match self.rest.chars().next() {
                Some('\'' | '"') => {
                    self.string()?;
                }
                Some('[') => {
                    open.push(']');
                    self.split(1);
                }
                Some('(') => {
                    open.push(')');
                    self.split(1);
                }
                Some(_) if open.is_empty() => return Err(self.missing("a type")),
                Some(close @ (']' | ')')) => {
                    if open.pop() != Some(close) {
                        return Err(self.missing("the other bracket"));
                    }
                    self.split(1);
                }
                Some(other) => {
                    self.split(other.len_utf8());
                }
                None => return Err(self.missing("the end of a type")),
            }
            if open.is_empty() {
                break;
            }
        }
        let length = start.len() - self.rest.len();
        Ok(start.get(..length).unwrap_or_default())
    }

    fn truth(&mut self) -> Result<bool, DictionaryError> {
        self.skip_blanks();
        for (word, truth) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(truth);
            }
        }
        Err(self.missing("True or False"))
    }

    /// Takes a tuple of lengths.
    pub(super) fn shape(&mut self) -> Result<Vec<u64>, DictionaryError> {
        let close = ')';
        self.expect('(', "a tuple")?;
        let mut shape = Vec::new();
        let mut has_comma = false;
        while !self.take(close) {
            shape.push(self.length()?);
            self.skip_blanks();
            has_comma |= self.rest.starts_with(',');
            self.separate(close)?;
        }
        // In Python a number in parentheses without a comma is not a tuple.
        if shape.len() == 1 && !has_comma {
            return Err(self.missing("the comma of a tuple"));
        }
        Ok(shape)
    }

    /// Takes a whole number.
    fn length(&mut self) -> Result<u64, DictionaryError> {
        let is_negative = self.take('-');
        self.skip_blanks();
        let count = self.rest.bytes().take_while(u8::is_ascii_digit).count();
        // Python does not write numbers with a leading zero, except zero itself.
        let begins_with_nought = self.rest.starts_with('0') && self.rest.get(..count) != Some("0");
        if count == 0 || begins_with_nought {
            return Err(self.missing("a whole number"));
        }
        let digits = self.split(count);
        // Python 2 marks long numbers.
        self.rest = self.rest.strip_prefix('L').unwrap_or(self.rest);
        if is_negative && digits.bytes().any(|digit| digit != b'0') {
            return Err(DictionaryError::Negative(shown(digits)));
        }
        digits
            .parse()
            .map_err(|_| DictionaryError::TooLarge(shown(digits)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_stand_in_any_order_with_either_quote_and_any_blanks() {
        let expected = NpyHeader {
            description: "'<f4'".to_owned(),
            is_fortran_order: true,
            shape: vec![12, 2],
        };
        for text in [
            "{'descr':'<f4','fortran_order':True,'shape':(12,2)}",
            "{'shape': (12, 2), 'fortran_order': True, 'descr': '<f4'}\n",
            "  { \"fortran_order\" : True ,\n \"descr\":'<f4', 'shape' : ( 12 , 2 , ) , }\t\n",
            "{'descr': '<f4', 'fortran_order': True, 'shape': (12L, 2L), }",
        ] {
            assert_eq!(parse(text).unwrap(), expected, "{text}");
        }
        let double = parse("{'descr': \"<f4\", 'fortran_order': False, 'shape': (-0,)}").unwrap();
        assert_eq!(double.description, "\"<f4\"");
        assert_eq!(double.shape, [0]);
    }

    #[test]
    fn description_of_a_structured_type_is_kept_as_it_stands() {
        for description in [
            "[('x', '<f4'), ('y', '<f4', (2, 3))]",
            "[((']', 'a\\'b'), [('c', '|S7')])]",
        ] {
            let text = format!("{{'descr': {description}, 'fortran_order': False, 'shape': ()}}");
            assert_eq!(parse(&text).unwrap().description, description);
        }
    }

    #[test]
    fn what_is_no_dictionary_of_an_array_is_refused_with_the_reason() {
        let with = |descr: &str, order: &str, shape: &str| {
            format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}}}")
        };
        let shaped = |shape: &str| with("'<f8'", "False", shape);
        for (text, expected) in [
            (String::new(), "{ is missing at character 0"),
            ("[]".to_owned(), "{ is missing at character 0"),
            ("{}".to_owned(), "key \"descr\" is missing"),
            (
                "{'descr': '<f8'".to_owned(),
                "a comma is missing at character 15",
            ),
            ("{'descr' '<f8'}".to_owned(), ": is missing at character 9"),
            (
                "{'ä".to_owned(),
                "the end of a string is missing at character 3",
            ),
            ("{3: 4}".to_owned(), "a string is missing at character 1"),
            (
                "{'descr': '<f8', 'fortran_order': False}".to_owned(),
                "key \"shape\" is missing",
            ),
            (
                "{'descr': '<f8', 'shape': (3, 2)}".to_owned(),
                "key \"fortran_order\" is missing",
            ),
            (
                "{'descr': '<f8', 'units': 'mm'}".to_owned(),
                "key \"units\" is not one of descr, fortran_order, shape",
            ),
            (
                "{'descr': '<f8', \"descr\": '<f8'}".to_owned(),
                "key \"descr\" stands there twice",
            ),
            (
                with("f8", "False", "(3, 2)"),
                "a type is missing at character 10",
            ),
            (
                with("[('x', '<f8']", "False", "(3, 2)"),
                "the other bracket is missing at character 22",
            ),
            (
                with("[('x', '<f8'", "False", "(3, 2)"),
                "the end of a type is missing at character 64",
            ),
            (
                with("'<f8'", "0", "(3, 2)"),
                "True or False is missing at character 34",
            ),
            (shaped("6"), "a tuple is missing at character 50"),
            (shaped("[6]"), "a tuple is missing at character 50"),
            (
                shaped("(03, 2)"),
                "a whole number is missing at character 51",
            ),
            (
                shaped("(6)"),
                "the comma of a tuple is missing at character 53",
            ),
            (shaped("(3 2)"), "a comma is missing at character 53"),
            (shaped("(3.0, 2)"), "a comma is missing at character 52"),
            (shaped("(,)"), "a whole number is missing at character 51"),
            (shaped("(3, -2)"), "an axis has the length -2"),
            (
                shaped("(18446744073709551616, 2)"),
                "an axis has the length 18446744073709551616, more than 64 bits",
            ),
            (
                shaped("(3, 2)") + " {}",
                "the end is missing at character 58",
            ),
        ] {
            assert_eq!(parse(&text).unwrap_err().to_string(), expected, "{text}");
        }
        let most = shaped("(18446744073709551615, 2)");
        assert_eq!(parse(&most).unwrap().shape, [u64::MAX, 2]);
    }

    #[test]
    fn no_text_cut_off_anywhere_is_a_dictionary() {
        let text = "{'descr': [('ä', '<f8')], 'fortran_order': False, 'shape': (3, 2), }";
        parse(text).unwrap();
        for (length, _) in text.char_indices() {
            assert!(parse(&text[..length]).is_err(), "{length}");
        }
    }
}
