//! Numbers in reports for readers: behind the word that names them.

use fmc_camera_file::InputError;

use crate::source::Source;

/// Parses a number of a report: a finite one, Fortran's exponent included, units that stick to it
/// left out.
fn parsed(word: &str) -> Option<f64> {
    let word = word.trim_matches(|c: char| matches!(c, '(' | ')' | ';'));
    let word = word.trim_end_matches(['°', '\'', '"', 'º']);
    let number = word
        .parse::<f64>()
        .or_else(|_| word.replace(['D', 'd'], "E").parse::<f64>())
        .ok()?;
    // `inf` and `nan` are words.
    let begins = word.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'));
    (begins && number.is_finite()).then_some(number)
}

/// Returns the words of a line.
fn words(line: &str) -> Vec<&str> {
    line.split(|c: char| c.is_whitespace() || matches!(c, '=' | ':' | ','))
        .filter(|word| !word.is_empty())
        .collect()
}

/// Returns the numbers behind a word, of the first line that has the word with a number behind it.
pub(crate) fn after(text: &str, key: &str) -> Option<Vec<f64>> {
    text.lines().find_map(|line| {
        let words = words(line);
        let place = words
            .iter()
            .position(|word| word.eq_ignore_ascii_case(key))?;
        let rest = words.iter().skip(place + 1);
        let numbers: Vec<f64> = rest
            .skip_while(|word| parsed(word).is_none() && word.starts_with('('))
            .map_while(|word| parsed(word))
            .collect();
        (!numbers.is_empty()).then_some(numbers)
    })
}

/// Refuses numbers behind the words of `keys` that are not finite: they would count as words.
///
/// # Errors
/// [`InputError`] that names the key and the number.
pub(crate) fn check_finite(
    source: &Source<'_>,
    text: &str,
    keys: &[&str],
) -> Result<(), InputError> {
    for line in text.lines() {
        let words = words(line);
        for (place, key) in words.iter().enumerate() {
            if !keys.iter().any(|one| one.eq_ignore_ascii_case(key)) {
                continue;
            }
            let rest = words.iter().skip(place + 1);
            let fault = rest
                .skip_while(|word| word.starts_with('('))
                .map_while(|word| Some((word, word.parse::<f64>().ok()?)))
                .find(|(_, number)| !number.is_finite());
            if let Some((word, _)) = fault {
                return Err(source.invalid(format!("{key}: {word:?} is not a finite number")));
            }
        }
    }
    Ok(())
}

/// Returns all numbers of the first line that has the words of `phrase`, behind them.
pub(crate) fn beside(text: &str, phrase: &str) -> Option<Vec<f64>> {
    text.lines().find_map(|line| {
        let lower = line.to_lowercase();
        let place = lower.find(phrase)? + phrase.len();
        let numbers: Vec<f64> = words(lower.get(place..)?)
            .into_iter()
            .filter_map(parsed)
            .collect();
        (!numbers.is_empty()).then_some(numbers)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_stands_behind_its_word() {
        let text = "K0 = 0.3285E-04   P1 = -0.1218D-07   xp = 0.006 mm\nC (mm) 28.9 0.1 29.0\n";
        assert_eq!(after(text, "k0"), Some(vec![0.3285e-4]));
        assert_eq!(after(text, "P1"), Some(vec![-0.1218e-7]));
        assert_eq!(after(text, "xp"), Some(vec![0.006]));
        assert_eq!(after(text, "C"), Some(vec![28.9, 0.1, 29.0]));
        assert_eq!(after(text, "yp"), None);
        assert_eq!(after("K1 = nan", "K1"), None);
        let table = "Field angle: 7.5° 15° 22.7°\n";
        assert_eq!(beside(table, "field angle"), Some(vec![7.5, 15.0, 22.7]));
    }
}
