//! The radial distortion printed in the three USGS reports.

use fmc_reference::lens::Lens;

use crate::reference::support::published;

#[test]
fn polynomials_reproduce_eighteen_of_eighteen_printed_values() {
    let mut table = csv::Reader::from_reader(include_str!("../../data/usgs_radial.csv").as_bytes());
    let cameras = published();
    let mut agreeing = 0;
    for row in table.records() {
        let row = row.unwrap();
        let name = match &row[0] {
            "OSL/2985" => "RC30 5368",
            "OSL/3030" => "RC30 5324",
            "OSL/3221" => "RC30 5282",
            other => panic!("unknown report {other}"),
        };
        let camera = cameras.iter().find(|camera| camera.name == name).unwrap();
        let angle_deg: f64 = row[1].parse().unwrap();
        let printed_um: f64 = row[2].parse().unwrap();
        let r = camera.principal_distance_mm * angle_deg.to_radians().tan();
        let [k0, k1, k2, k3] = Lens::of(camera).k;
        let r2 = r * r;
        let radial_um = 1e3 * r * (k0 + r2 * (k1 + r2 * (k2 + r2 * k3)));
        // The reports print whole micrometres.
        assert!(
            (radial_um - printed_um).abs() <= 0.5,
            "{name} at {angle_deg}°: {radial_um} µm"
        );
        agreeing += 1;
    }
    assert_eq!(agreeing, 18);
}
