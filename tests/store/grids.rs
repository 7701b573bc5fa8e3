//! Residual grids in the store: they come back with the calibration that states them.

use fmc_camera::SensorPoint;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::grid_memory::GridMemory;
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums, GridHeader, ResidualGrid};
use fmc_camera::io::store::{NothingStored, SEAL_WORDS, SlotFault};

use crate::geometry::spline::{file, noise, wave};
use crate::store::calibrations::{calibration, flash_after, order, store_in};
use crate::store::flash_model::{Cell, Cut, FlashModel};

/// Returns the file of a grid that covers the camera and its stroke.
pub(crate) fn grid(carrier: GridCarrier, coefficient: impl Fn(u16, u16) -> [i16; 2]) -> Vec<u8> {
    let header = GridHeader {
        carrier,
        columns: 33,
        rows: 27,
        first_node: SensorPoint::new(-32.0, -26.0),
        pitch_mm: 2.0,
        scale_mm: 3e-3 / 32767.0,
    };
    file(&header, coefficient)
}

/// Returns the memory with grids in use, and the calibration that states them.
fn in_use(version: u16, lens: &[u8], sensor: &[u8]) -> (Box<GridMemory>, CameraParameters) {
    let crc32 = |file: &[u8]| ResidualGrid::parse(file).unwrap().crc32();
    let mut parameters = calibration(version);
    parameters.grids = GridChecksums {
        lens: Some(crc32(lens)),
        sensor: Some(crc32(sensor)),
    };
    let mut memory = Box::new(GridMemory::EMPTY);
    for (carrier, file) in [(GridCarrier::Lens, lens), (GridCarrier::Sensor, sensor)] {
        memory.spare_mut(carrier).add(file).unwrap();
        memory.spare_mut(carrier).check().unwrap();
    }
    let camera = Camera::new(parameters).unwrap();
    memory.put_into_use(&camera).unwrap();
    (memory, parameters)
}

/// Returns a flash with a calibration and its grids, and both.
pub(crate) fn stored(version: u16) -> (FlashModel, CameraParameters, [Vec<u8>; 2]) {
    let [lens, sensor] = [
        grid(GridCarrier::Lens, wave),
        grid(GridCarrier::Sensor, noise),
    ];
    let (mut memory, parameters) = in_use(version, &lens, &sensor);
    let mut store = store_in(flash_after(&[1]).started());
    let stored = store.store(&parameters, &order(version), Some(&mut memory));
    assert_eq!(stored.unwrap().parameters, parameters);
    (store.into_flash(), parameters, [lens, sensor])
}

#[test]
fn grids_come_back_with_their_calibration_byte_for_byte() {
    let (flash, parameters, files) = stored(2);
    let mut memory = Box::new(GridMemory::EMPTY);
    let mut store = store_in(flash);
    let stored = store.load(Some(&mut memory)).unwrap();
    assert_eq!(stored.parameters, parameters);
    let camera = Camera::new(stored.parameters).unwrap();
    memory.put_into_use(&camera).unwrap();
    let carriers = [GridCarrier::Lens, GridCarrier::Sensor];
    for (carrier, file) in carriers.into_iter().zip(&files) {
        assert_eq!(memory.file_in_use(carrier), Some(&file[..]));
    }
    // A store leaves those in use as they are.
    let again = store.store(&parameters, &order(2), Some(&mut memory));
    assert_eq!(again.unwrap().parameters, parameters);
    for (carrier, file) in carriers.into_iter().zip(&files) {
        assert_eq!(memory.file_in_use(carrier), Some(&file[..]));
    }
}

#[test]
fn camera_without_memory_for_grids_uses_the_calibration_before() {
    let (flash, ..) = stored(2);
    let stored = store_in(flash.clone()).load(None).unwrap();
    assert_eq!(stored.parameters, calibration(1));
    assert_eq!(stored.identity.other, Some(SlotFault::NoGridMemory));
    let mut alone = flash;
    alone.sectors[0].clear();
    let NothingStored { slots } = store_in(alone).load(None).unwrap_err();
    assert_eq!(slots, [SlotFault::Blank, SlotFault::NoGridMemory]);
}

#[test]
fn wrong_bits_of_a_grid_are_found() {
    let (flash, ..) = stored(2);
    let words = flash.sectors[1].len();
    assert!(words > 2 * 3500 / 32, "{words}");
    let mut memory = Box::new(GridMemory::EMPTY);
    for word in (1 + usize::from(SEAL_WORDS)..words).step_by(5) {
        let mut damaged = flash.clone();
        let Cell::Holding(bytes) = &mut damaged.sectors[1][word] else {
            panic!("word {word} is not written");
        };
        bytes[word % 32] ^= 1 << (word % 8);
        let stored = store_in(damaged).load(Some(&mut memory)).unwrap();
        assert_eq!(stored.parameters, calibration(1));
        let fault = stored.identity.other;
        assert!(matches!(fault, Some(SlotFault::Crc { .. })), "{fault:?}");
    }
}

#[test]
fn supply_that_fails_while_grids_are_written_leaves_the_calibration_before() {
    let (flash, parameters, files) = stored(2);
    let operations = flash.operations.len();
    let [lens, sensor] = &files;
    let mut tried = 0;
    for number in (0..operations).step_by(3) {
        for cut in [Cut::First(0), Cut::First(31), Cut::Unstable, Cut::Failing] {
            let (mut memory, _) = in_use(2, lens, sensor);
            let flash = flash_after(&[1]).started().cut_at(number, cut);
            let mut store = store_in(flash);
            let refused = store.store(&parameters, &order(2), Some(&mut memory));
            assert!(refused.is_err());
            let flash = store.into_flash().started();
            let mut memory = Box::new(GridMemory::EMPTY);
            let found = store_in(flash).load(Some(&mut memory)).unwrap();
            let is_behind = number + 2 >= operations;
            assert!(
                found.parameters == calibration(1) || is_behind && found.parameters == parameters,
                "operation {number} of {operations}, {cut:?}"
            );
            tried += 1;
        }
    }
    assert!(tried > 300, "{tried}");
}

#[test]
fn grid_in_use_is_in_either_buffer_and_the_other_is_the_spare_one() {
    let [first, second] = [
        grid(GridCarrier::Lens, wave),
        grid(GridCarrier::Lens, noise),
    ];
    let sensor = grid(GridCarrier::Sensor, noise);
    let (mut memory, mut parameters) = in_use(1, &first, &sensor);
    for file in [&second, &first, &second] {
        memory.spare_mut(GridCarrier::Lens).clear();
        memory.spare_mut(GridCarrier::Lens).add(file).unwrap();
        memory.spare_mut(GridCarrier::Lens).check().unwrap();
        let before = memory.file_in_use(GridCarrier::Lens).unwrap().to_vec();
        assert_ne!(&before, file);
        parameters.grids.lens = Some(ResidualGrid::parse(file).unwrap().crc32());
        let camera = Camera::new(parameters).unwrap();
        memory.put_into_use(&camera).unwrap();
        assert_eq!(memory.file_in_use(GridCarrier::Lens), Some(&file[..]));
        assert_eq!(memory.file_in_use(GridCarrier::Sensor), Some(&sensor[..]));
        assert_eq!(memory.spare_mut(GridCarrier::Lens).bytes(), before);
    }
}
