"""Exports, read by the programs for which they are."""

import json
import sys
import types

import cv2
import flights
import gridded
import numpy as np
import pandas
import pycolmap
import pytest
from test_camera import BARE
from test_points import grid

import fmc_camera

OF_CAMERA = (
    "opencv ros kalibr colmap metashape opensfm opf pix4d opentrackio micmac australis photomodeler"
).split()
OF_FRAMES = "colmap metashape opensfm opf opentrackio arcgis frames".split()


def rays(camera, points):
    """Ideal rays (x/z, y/z) of measured points, y down as images have it."""
    frame = camera.frame(
        camera.keys()["limits"]["vh_per_s"][0],
        camera.keys()["limits"]["exposure_s"][0],
        model="static",
    )
    ideal = frame.correct(points) - camera.principal_point_mm
    return ideal / camera.principal_distance_mm * [1, -1]


def pixels(camera, points):
    columns, rows = camera.size_px
    pitch = camera.pixel_um / 1000
    return np.stack(
        [points[:, 0] / pitch + (columns - 1) / 2, (rows - 1) / 2 - points[:, 1] / pitch], axis=1
    )


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_opencv_projects_to_the_measured_points(camera, tmp_path):
    stated = camera.export("opencv", tmp_path)
    (name,) = stated["files"]
    storage = cv2.FileStorage(str(tmp_path / name), cv2.FILE_STORAGE_READ)
    matrix = storage.getNode("camera_matrix").mat()
    coefficients = storage.getNode("distortion_coefficients").mat()
    points = grid(camera, 15) * 0.98
    spatial = np.column_stack([rays(camera, points), np.ones(len(points))])
    found, _ = cv2.projectPoints(spatial, np.zeros(3), np.zeros(3), matrix, coefficients)
    error = np.abs(found[:, 0] - pixels(camera, points)).max()
    assert error <= stated["residual_max_px"] + 1e-3


def test_colmap_projects_to_the_measured_points(camera, tmp_path):
    stated = camera.export("colmap", tmp_path)
    assert set(stated["files"]) >= {"cameras.txt"}
    (line,) = [
        line for line in (tmp_path / "cameras.txt").read_text().splitlines() if line[0] != "#"
    ]
    _, model, width, height, *numbers = line.split()
    theirs = pycolmap.Camera(
        model=model, width=int(width), height=int(height), params=[float(one) for one in numbers]
    )
    points = grid(camera, 15) * 0.98
    spatial = np.column_stack([rays(camera, points), np.ones(len(points))])
    found = np.array([theirs.img_from_cam(one) for one in spatial])
    # COLMAP counts from the corner of the first pixel.
    error = np.abs(found - 0.5 - pixels(camera, points)).max()
    assert error <= stated["residual_max_px"] + 1e-3


@pytest.mark.parametrize("program", OF_CAMERA)
def test_files_of_the_camera_are_those_of_host_sim(program, ixm, root, host_sim, tmp_path):
    path = root / "host-sim/cameras/phase-one-ixm-rs150f-50.toml"
    host_sim("export", program, "--camera", path, "--out", tmp_path / "theirs")
    stated = ixm.export(program, tmp_path / "ours")
    assert stated == json.loads((tmp_path / "theirs/export.json").read_text())
    assert set(files(tmp_path / "ours")) == {"export.json", *stated["files"]}
    assert files(tmp_path / "ours") == files(tmp_path / "theirs")


@pytest.mark.parametrize("program", OF_FRAMES)
def test_files_of_the_frames_are_those_of_host_sim(program, host_sim, tmp_path):
    arguments = ["--camera", flights.CAMERA, "--records", flights.RECORDS]
    host_sim("export", program, *arguments, "--out", tmp_path / "theirs")
    stated = flights.camera().export(program, tmp_path / "ours", records=flights.RECORDS)
    assert stated["frames"]["exposures"] == flights.frames().is_exposed.sum() > 0
    assert files(tmp_path / "ours") == files(tmp_path / "theirs")
    table = flights.camera().export(
        program, tmp_path / "table", records=pandas.read_csv(flights.RECORDS)
    )
    assert table["frames"].pop("records") == "records"
    assert stated["frames"].pop("records") == str(flights.RECORDS)
    assert table == stated


def test_options_are_those_of_host_sim(ixm, root, host_sim, tmp_path):
    path = root / "host-sim/cameras/phase-one-ixm-rs150f-50.toml"
    key = "v2 make model 14204 10652 brown 0.96"
    for number, (program, theirs, ours) in enumerate([
        ("opencv", ["--as", "json"], {"container": "json"}),
        ("opencv", ["--model", "opencv8"], {"model": "opencv8"}),
        ("colmap", ["--binary"], {"binary": True}),
        ("opensfm", ["--id", key], {"id": key}),
    ]):  # fmt: skip
        folders = [tmp_path / f"{number}-{one}" for one in ("theirs", "ours")]
        host_sim("export", program, "--camera", path, *theirs, "--out", folders[0])
        ixm.export(program, folders[1], **ours)
        assert files(folders[0]) == files(folders[1]), program


def test_images_have_the_names_of_a_pattern_or_of_a_dictionary(tmp_path):
    camera, frames = flights.camera(), flights.frames()
    exposed = [int(one) for one in frames.sequence[frames.is_exposed]]
    names = {sequence: f"P{sequence}.jpg" for sequence in exposed}
    for folder, images in [("pattern", "P{sequence}.jpg"), ("names", names)]:
        camera.export("frames", tmp_path / folder, records=flights.RECORDS, images=images)
    table = pandas.read_csv(tmp_path / "names/frames.csv")
    assert list(table["image"]) == list(names.values())
    one, other = [(tmp_path / name / "frames.csv").read_bytes() for name in ("pattern", "names")]
    assert one == other
    with pytest.raises(fmc_camera.Error, match="images = 'P.jpg': no {sequence}"):
        camera.export("frames", tmp_path, records=flights.RECORDS, images="P.jpg")
    for images in (5, {-1: "a"}, {1: 2}):
        with pytest.raises(TypeError, match="images of the type .* must be a pattern of names"):
            camera.export("frames", tmp_path, records=flights.RECORDS, images=images)
    del names[exposed[0]]
    with pytest.raises(fmc_camera.InvalidFile, match=f"images: .*{exposed[0]} is missing"):
        camera.export("frames", tmp_path, records=flights.RECORDS, images=names)


def test_residual_grids_that_no_file_holds_are_stated_and_warned_of(host_sim, tmp_path):
    path = gridded.write(tmp_path)
    camera = fmc_camera.Camera.from_toml(path)
    host_sim("export", "colmap", "--camera", path, "--out", tmp_path / "theirs")
    with pytest.warns(UserWarning, match="largest residual is 0.* px, not below 0.01 px"):
        stated = camera.export("colmap", tmp_path / "ours")
    assert files(tmp_path / "ours") == files(tmp_path / "theirs")
    (held,) = [one for one in stated["not_held"] if one["term"] == "residual grids"]
    # The polynomials follow the waves of the grids in part, least squares over the whole sensor.
    assert 1.0 < stated["residual_rms_um"] < held["size_um"]


@pytest.mark.parametrize(
    ("program", "options", "sentence"),
    [
        ("inpho", {}, "program = 'inpho': must be one of opencv, ros"),
        ("COLMAP", {}, "program = 'COLMAP': must be one of"),
        ("colmap", {"container": "xml"}, "container: an option of opencv"),
        ("opencv", {"container": "bin"}, "container = 'bin': must be 'yaml', 'json' or"),
        ("opencv", {"binary": True}, "binary: an option of colmap"),
        ("opencv", {"id": "a"}, "id: an option of opensfm"),
        ("arcgis", {}, "records: missing, and arcgis is a format of frames"),
        ("opencv", {"records": flights.RECORDS}, "records: opencv has one camera for all images"),
        ("opensfm", {"records": flights.RECORDS, "id": "a"}, "id: names one camera"),
        ("colmap", {"images": "{sequence}"}, "images: given without records"),
        ("colmap", {"model": "FISHEYE"}, "colmap has no such model"),
        ("frames", {"records": "nowhere.csv"}, "nowhere.csv: cannot be read"),
        ("frames", {"records": 5}, "records of the type"),
        ("colmap", {"max_residual_um": float("nan")}, "max_residual_um = NaN is not above 0"),
        ("colmap", {"max_residual_um": 0.0}, "max_residual_um = 0 is not above 0"),
    ],
)
def test_arguments_that_do_not_fit_are_refused_before_anything_is_written(
    program, options, sentence, tmp_path
):
    with pytest.raises(fmc_camera.Error, match=sentence):
        flights.camera().export(program, tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_residual_above_the_one_that_is_asked_for_is_an_error_with_its_numbers(tmp_path):
    camera = fmc_camera.Camera.from_text(BARE + "[distortion]\nk1 = 1e-6\nk2 = 4e-10\n")
    with pytest.raises(fmc_camera.OutOfRange) as caught:
        camera.export("colmap", tmp_path / "out", model="SIMPLE_RADIAL", max_residual_um=1e-3)
    error = caught.value
    assert str(error).endswith("above max_residual_um = 0.001")
    assert (error.quantity, error.most) == ("residual_max_um", 1e-3)
    assert error.value > 1e-3
    assert not (tmp_path / "out").exists()


def test_files_are_replaced_only_with_overwrite_and_all_or_none(ixm, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "cameras.txt").write_text("older")
    before = files(tmp_path)
    sentence = "exists, and overwrite is not True: .*cameras.txt"
    with pytest.raises(FileExistsError, match=sentence) as caught:
        ixm.export("colmap", tmp_path)
    assert caught.value.filename == str(tmp_path / "cameras.txt")
    assert files(tmp_path) == before
    stated = ixm.export("colmap", tmp_path, overwrite=True)
    assert set(files(tmp_path)) == {"mine.txt", "export.json", *stated["files"]}
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert (tmp_path / "cameras.txt").read_text() != "older"
    # The statement of another program's files is in the way, too.
    with pytest.raises(FileExistsError, match="exists, .*export.json"):
        ixm.export("opencv", tmp_path)
    # The last of the files cannot be written: none of them is replaced.
    before = files(tmp_path)
    (tmp_path / "camera.yaml").mkdir()
    with pytest.raises(OSError, match="camera.yaml"):
        ixm.export("opencv", tmp_path, overwrite=True)
    (tmp_path / "camera.yaml").rmdir()
    assert files(tmp_path) == before


def test_folder_that_cannot_be_written_is_an_error_of_the_system(ixm, tmp_path):
    file = tmp_path / "file"
    file.write_text("a file")
    with pytest.raises(FileExistsError) as caught:
        ixm.export("colmap", file)
    assert caught.value.filename == str(file)
    with pytest.raises(NotADirectoryError):
        ixm.export("colmap", file / "below")
    with pytest.raises(FileNotFoundError):
        ixm.export("colmap", "/proc/nowhere")
    assert file.read_text() == "a file"


def test_records_are_not_replaced_by_the_table_of_their_frames(tmp_path):
    records = tmp_path / "frames.csv"
    records.write_bytes(flights.RECORDS.read_bytes())
    with pytest.raises(fmc_camera.Error, match="would be replaced, which is read"):
        flights.camera().export("frames", tmp_path, records=records, overwrite=True)
    assert records.read_bytes() == flights.RECORDS.read_bytes()


def test_without_the_other_package_the_error_says_what_to_install(ixm, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fmc_camera_export", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "fmc-camera\[export\]"'):
        ixm.export("colmap", tmp_path)
    other = types.SimpleNamespace(__version__="0.0.1")
    monkeypatch.setitem(sys.modules, "fmc_camera_export", other)
    sentence = "fmc-camera-export 0.0.1 is of another version than fmc-camera"
    with pytest.raises(ImportError, match=sentence):
        ixm.export("colmap", tmp_path)
    assert not list(tmp_path.iterdir())
