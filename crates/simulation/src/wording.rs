//! Wording of numbers in findings and reports.

/// Formats digits in groups of three: `264,600`.
#[must_use]
pub fn count(number: u64) -> String {
    grouped(&number.to_string())
}

/// Groups the digits before the point in threes.
#[must_use]
pub fn grouped(number: &str) -> String {
    let (whole, rest) = number.split_at(number.find('.').unwrap_or(number.len()));
    let mut text = String::new();
    for (index, digit) in whole.chars().enumerate() {
        if index > 0 && (whole.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text + rest
}

/// Formats a number of things, with their name in the singular or plural.
#[must_use]
pub fn counted(number: usize, noun: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(number as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_grouped_by_thousands() {
        assert_eq!(count(264_600), "264,600");
        assert_eq!(count(441), "441");
        assert_eq!(counted(1, "camera"), "1 camera");
        assert_eq!(counted(1_234_567, "camera"), "1,234,567 cameras");
    }
}
