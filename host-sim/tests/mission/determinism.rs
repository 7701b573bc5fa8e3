//! Repeated flights with one seed.

use fmc_report::records::crc32;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::flown;

#[test]
fn same_seed_gives_the_same_records_bit_for_bit_and_another_seed_others() {
    let scenario = MissionScenario::nominal(Some(8)).unwrap();
    let records = |seed| {
        let records: Vec<_> = flown(&scenario, seed)
            .frames
            .iter()
            .map(|frame| frame.record)
            .collect();
        crc32(&records)
    };
    assert_eq!(records(5), records(5));
    assert_ne!(records(5), records(6));
}
