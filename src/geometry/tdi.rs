//! Time delay and integration: the staircase in which the charge follows the image.

use super::range::{OutOfRange, Quantity};
use super::shutter::Shutter;

/// Returns the mean number of rows by which the charge has been moved, over the light of one
/// exposure.
///
/// # Model
/// The charge moves one row every row period p/v; the first transfer comes `first_transfer` row
/// periods after the shutter opens. The row count is the staircase `⌊u - φ⌋ + 1`, and its mean over
/// the light is the sum over all transfers of the share of light that arrives after the transfer.
/// For a whole number of rows N and a uniform shutter it is `N/2 + 1/2 - φ`: with the first
/// transfer after a full row period the image lags by half a pixel, after half a period not at all.
///
/// # Units and frames
/// `rows` = δ/p, the travel of the image in rows; `first_transfer` φ in row periods, 0 to 1; the
/// result is in rows along the FMC axis.
///
/// # Accuracy
/// 0.002 rows at [`MAX_ROWS`](super::range::MAX_ROWS) (rounding of the sum), 1e-5 rows at 100 rows.
///
/// # Errors
/// [`OutOfRange`] for a phase outside 0 to 1 row periods or for more rows than
/// [`MAX_ROWS`](super::range::MAX_ROWS).
///
/// # Examples
/// ```
/// use fmc_camera::geometry::{shutter::{Shutter, ShutterProfile}, tdi::mean_transfers};
/// let shutter = Shutter::new(ShutterProfile::Uniform)?;
/// assert_eq!(mean_transfers(10.0, 1.0, &shutter)?, 4.5); // half a pixel behind the image
/// assert_eq!(mean_transfers(10.0, 0.5, &shutter)?, 5.0); // none
/// # Ok::<(), fmc_camera::geometry::range::OutOfRange>(())
/// ```
pub fn mean_transfers(
    rows: f32,
    first_transfer: f32,
    shutter: &Shutter,
) -> Result<f32, OutOfRange> {
    let first_transfer = Quantity::FirstTransfer.check(first_transfer)?;
    let rows = Quantity::TdiRows.check(rows)?;
    let mut mean = 0.0;
    let mut transfer = first_transfer;
    while transfer < rows {
        mean += 1.0 - shutter.light_until(transfer / rows);
        transfer += 1.0;
    }
    Ok(mean)
}

/// Returns the way of an image point to and fro on the charge in one exposure, rows.
///
/// # Model
/// The image has moved on by u rows after u row periods, the charge by the staircase `⌊u - φ⌋ + 1`
/// of [`mean_transfers`]. The image runs ahead by φ rows until each transfer and lies `1 - φ`
/// behind after it: a whole row to both sides together, whatever the phase. Without a transfer it
/// moves by all of its travel.
///
/// # Units and frames
/// `rows` = |δ|/p, the travel of the image in rows; `first_transfer` φ in row periods, 0 to 1.
#[must_use]
pub(crate) fn largest_lag(rows: f32, first_transfer: f32) -> f32 {
    if first_transfer < rows { 1.0 } else { rows }
}

/// Returns the number of transfers in an exposure.
///
/// # Units and frames
/// As in [`largest_lag`].
#[must_use]
pub(crate) fn transfers(rows: f32, first_transfer: f32) -> f32 {
    libm::ceilf((rows - first_transfer).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::range::MAX_ROWS;
    use crate::geometry::shutter::ShutterProfile;

    fn lag(rows: f32, first_transfer: f32) -> f32 {
        let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
        rows / 2.0 - mean_transfers(rows, first_transfer, &shutter).unwrap()
    }

    #[test]
    fn whole_rows_lag_half_a_pixel_or_nothing() {
        for rows in [1.0, 2.0, 7.0, 100.0, MAX_ROWS] {
            assert!((lag(rows, 1.0) - 0.5).abs() < 2e-3, "{rows}");
            assert!(lag(rows, 0.5).abs() < 2e-3, "{rows}");
        }
        assert!((lag(100.0, 1.0) - 0.5).abs() < 1e-5);
    }

    #[test]
    fn one_and_a_half_rows_lag_as_computed_independently() {
        assert!((lag(1.5, 1.0) - 0.416_667).abs() < 1e-5);
        assert!((lag(1.5, 0.5) - 0.083_333).abs() < 1e-5);
    }

    #[test]
    fn image_moves_on_the_charge_by_a_row_or_by_its_travel_without_a_transfer() {
        for rows in [0.0_f32, 0.2, 0.5, 0.9, 1.0, 1.7, 4.0, 33.3] {
            for first_transfer in [0.0_f32, 0.25, 0.5, 1.0] {
                // Places of the image on the charge, 1000 of them in a row period.
                let (mut least, mut most, mut last) = (0.0_f32, 0.0_f32, 0.0_f32);
                let images = (0..=u16::MAX).map(|step| f32::from(step) / 1000.0);
                for image in images.take_while(|image| *image <= rows) {
                    let transfers = if image > first_transfer {
                        libm::floorf(image - first_transfer) + 1.0
                    } else {
                        0.0
                    };
                    least = least.min(image - transfers);
                    most = most.max(image - transfers);
                    last = transfers;
                }
                // A transfer at last light itself may count or not.
                let most_off = if (rows - first_transfer).fract() < 1e-3 {
                    1.5
                } else {
                    0.5
                };
                let found = transfers(rows, first_transfer);
                assert!((last - found).abs() < most_off, "{rows}: {found}, {last}");
                let found = largest_lag(rows, first_transfer);
                let expected = most - least;
                // At phase 0 the first transfer is that of an image that has not moved yet.
                let is_at_once = first_transfer == 0.0 && rows < 1.0;
                assert!(
                    (found - expected).abs() < 0.003 || is_at_once && found >= expected,
                    "{rows} rows, {first_transfer}: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn a_leaf_shutter_weights_the_staircase() {
        let leaf = Shutter::new(ShutterProfile::Trapezoid {
            opening_fraction: 0.3,
            closing_fraction: 0.1,
        })
        .unwrap();
        let mean = mean_transfers(40.0, 0.5, &leaf).unwrap();
        assert!((mean - 40.0 * leaf.centroid()).abs() < 1e-3);
    }

    #[test]
    fn a_still_image_moves_no_charge_and_bad_input_is_refused() {
        let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
        assert_eq!(mean_transfers(0.0, 0.5, &shutter), Ok(0.0));
        assert!(mean_transfers(10.0, 1.5, &shutter).is_err());
        assert!(mean_transfers(f32::NAN, 0.5, &shutter).is_err());
        assert!(mean_transfers(2.0 * MAX_ROWS, 0.5, &shutter).is_err());
    }
}
