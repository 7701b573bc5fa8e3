//! Stereo check over simulated pairs.

use fmc_composition::scene::SceneRequest;
use fmc_composition::stereo::{
    BaseAlong, Layout, Repetitions, StereoRequest, StereoResult, repeated,
};

fn repetitions(layout: Layout, base: BaseAlong) -> Repetitions {
    let scene = SceneRequest {
        scale: 1,
        ..SceneRequest::default()
    };
    let rig = scene.rig();
    let request = StereoRequest {
        principal_distance_px: rig.principal_distance_px(),
        sigma_px: 0.3,
        control_sigma_m: 0.05,
        layout,
    };
    repeated(&rig, scene.height_m(), base, &request, 40, 3).unwrap()
}

/// Computed independently, at B/H 0.40: plane 0.17 and 0.15 m, height 0.36 and 0.32 m; at 0.34
/// plane 0.19 and 0.16 m, height 0.41 and 0.37 m.
#[test]
fn check_points_err_as_the_pair_lets_expect() {
    let mut planes = Vec::new();
    for (layout, base, plane_m, height_m, ratio) in [
        (Layout::FourCorners, BaseAlong::Height, 0.17, 0.36, 0.40),
        (Layout::DoubledCorners, BaseAlong::Height, 0.15, 0.32, 0.40),
        (Layout::FourCorners, BaseAlong::Width, 0.19, 0.41, 0.34),
        (Layout::DoubledCorners, BaseAlong::Width, 0.16, 0.37, 0.34),
    ] {
        let found = repetitions(layout, base);
        let [plane, of_plane] = found.root_mean_square(StereoResult::check_plane_m).unwrap();
        let [height, of_height] = found
            .root_mean_square(|one| one.check_m.map(|check| check[2]))
            .unwrap();
        println!(
            "{} {ratio}: {plane:.3} ± {of_plane:.3}, {height:.3} ± {of_height:.3}",
            layout.name()
        );
        assert!(
            (0.15 - of_plane..0.20 + of_plane).contains(&plane),
            "{plane} {plane_m}"
        );
        assert!(
            (plane - plane_m).abs() < 0.015 + of_plane,
            "{plane} {plane_m}"
        );
        assert!(
            (0.32 - of_height..0.41 + of_height).contains(&height),
            "{height}"
        );
        assert!(
            (height - height_m).abs() < 0.03 + of_height,
            "{height} {height_m}"
        );
        let [sigma0, _] = found.root_mean_square(|one| Some(one.sigma0)).unwrap();
        assert!((0.95..1.05).contains(&sigma0), "{sigma0}");
        let [base_over_height, _] = found
            .root_mean_square(|one| Some(one.base_over_height))
            .unwrap();
        assert!(
            (base_over_height - ratio).abs() < 0.01,
            "{base_over_height}"
        );
        planes.push(plane);
    }
    assert!(
        planes[1] < planes[0] && planes[3] < planes[2],
        "control improves the plane: {planes:?}"
    );
}

#[test]
fn all_marks_as_control_leave_no_check() {
    let found = repetitions(Layout::All, BaseAlong::Height);
    assert!(
        found
            .results
            .iter()
            .all(|one| one.control == 40 && one.check_m.is_none())
    );
    assert_eq!(found.root_mean_square(StereoResult::check_plane_m), None);
}
