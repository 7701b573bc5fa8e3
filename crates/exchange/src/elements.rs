//! Elements of XML files, with messages that name them.

use fmc_camera_file::InputError;
use fmc_camera_file::number::finite;
use roxmltree::Node;

use crate::fields::pixel_count;
use crate::source::Source;

/// Returns the children of a name, in any namespace.
pub(crate) fn children<'a>(node: Node<'a, 'a>, name: &str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children()
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// Returns the first child of a name.
pub(crate) fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}

/// Returns the number of a child.
pub(crate) fn number_text(
    source: &Source<'_>,
    node: Node<'_, '_>,
    name: &str,
) -> Result<f64, InputError> {
    let child = child(node, name).ok_or_else(|| source.invalid(format!("{name} is missing")))?;
    let text = child.text().unwrap_or_default();
    finite(text).map_err(|fault| source.invalid(format!("{name}: {text:?} is {fault}")))
}

/// Returns the number of a child, or `otherwise` where there is none.
pub(crate) fn number_or(
    source: &Source<'_>,
    node: Node<'_, '_>,
    name: &str,
    otherwise: f64,
) -> Result<f64, InputError> {
    if child(node, name).is_some() {
        number_text(source, node, name)
    } else {
        Ok(otherwise)
    }
}

/// Returns the number of pixels of a child.
pub(crate) fn pixels(
    source: &Source<'_>,
    node: Node<'_, '_>,
    name: &str,
) -> Result<u32, InputError> {
    let number = number_text(source, node, name)?;
    pixel_count(number)
        .ok_or_else(|| source.invalid(format!("{name}: {number} is not a number of pixels")))
}

/// Returns the numbers of a text, separated by spaces or commas.
pub(crate) fn numbers(source: &Source<'_>, name: &str, text: &str) -> Result<Vec<f64>, InputError> {
    text.split([' ', ',', '\t', '\n', '\r'])
        .filter(|word| !word.is_empty())
        .map(|word| {
            finite(word).map_err(|fault| source.invalid(format!("{name}: {word:?} is {fault}")))
        })
        .collect()
}
