"""Reads exported camera files with the programs themselves and projects points.

Usage: readers.py HOST_SIM CAMERA.toml...

Each camera is exported in every format that OpenCV and COLMAP read. Their own readers and their own
projection give the measured points of rays, which are computed here from the camera file. The
largest difference over the sensor must be what export.json states, within 10 %.

Frames of a flight, from rest and with a focus shift, are exported along each of the four axes. What
COLMAP projects with the camera of each image must be the measured point of the strict solver, as
well as the export of the calibrated camera has it, within 5 nm. The script for Metashape runs
against a stand-in for Metashape's own module. A bundle that is handed over projects in COLMAP with
the residuals of the bundle.
"""

import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import cv2
import numpy
import pycolmap

# Share of the stated residual, and rounding of the projection, in micrometres.
TOLERANCE = 0.1
ROUNDING_UM = 2e-6

# Points along each side, edges of the sensor included, as the export has them.
GRID = 41


def strict(camera):
    """Returns rays (z = 1, y down) and their measured pixels."""
    sensor, lens = camera["sensor"], camera.get("distortion", {})
    pitch = sensor["pixel_um"] / 1000
    width, height = sensor["width_px"], sensor["height_px"]
    sign = -1 if lens.get("sign") == "correction" else 1
    k0, k1, k2, k3, p1, p2, b1, b2 = (
        sign * lens.get(key, 0) for key in ("k0", "k1", "k2", "k3", "p1", "p2", "b1", "b2")
    )
    side = numpy.linspace(-0.5, 0.5, GRID)
    x, y = (axis.ravel() for axis in numpy.meshgrid(side * width * pitch, side * height * pitch))
    x0, y0 = camera.get("principal_point_mm", (0, 0))
    dx, dy = x - x0, y - y0
    r2 = dx * dx + dy * dy
    radial = k0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    ideal_x = dx - dx * radial - p1 * (r2 + 2 * dx * dx) - 2 * p2 * dx * dy - b1 * dx - b2 * dy
    ideal_y = dy - dy * radial - p2 * (r2 + 2 * dy * dy) - 2 * p1 * dx * dy
    f = camera["principal_distance_mm"]
    rays = numpy.stack([ideal_x / f, -ideal_y / f], axis=1)
    pixels = numpy.stack([(width - 1) / 2 + x / pitch, (height - 1) / 2 - y / pitch], axis=1)
    return rays, pixels


def by_opencv(path, rays):
    """Projects with OpenCV what its FileStorage reads."""
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    matrix = storage.getNode("camera_matrix").mat()
    coefficients = storage.getNode("distortion_coefficients").mat()
    storage.release()
    points = numpy.column_stack([rays, numpy.ones(len(rays))])
    nowhere = numpy.zeros(3)
    pixels, _ = cv2.projectPoints(points, nowhere, nowhere, matrix, coefficients)
    return pixels.reshape(-1, 2)


def by_colmap(folder, rays):
    """Projects with COLMAP what it reads; its first pixel centre is at (0.5, 0.5)."""
    return by_colmap_camera(pycolmap.Reconstruction(str(folder)).cameras[1], rays)


def by_colmap_camera(camera, rays):
    """Projects with a camera of COLMAP."""
    points = numpy.column_stack([rays, numpy.ones(len(rays))])
    return numpy.array([camera.img_from_cam(point) for point in points]) - 0.5


# Exposures of a flight, as options of host-sim.
SHOTS = [
    ["--focus-shift-um", "10"],
    ["--opening-offset-mm", "0.145", "--focus-shift-um", "-10"],
]
EXPOSURE = ["--vh", "0.17", "--exposure", "1/100"]

# What a frame may add to the residual of the calibrated camera, micrometres.
FRAME_UM = 0.005


def along(text, axis):
    """Returns a camera file whose principal point moves along an axis, from rest."""
    fmc = f'[fmc]\naxis = "{axis}"\nstrategy = "from-rest"\n'
    kept = text.replace('strategy = "from-rest"', "").replace("[fmc]", "")
    head, tables = kept.split("[sensor]")
    return f"{head}{fmc}[sensor]{tables}"


# Numbers that a record and host-sim frame have by the same name.
SAME = (
    "exposure_s", "principal_distance_mm", "enlargement", "focus_convention", "model", "kernel",
    "left_out_nm", "opening_offset_mm", "travel_mm", "centroid_offset_mm",
)


def record(sequence, frame, crc):
    """Returns the record of an exposure that host-sim frame has computed."""
    x, y = frame["principal_point_mm"]
    own = {
        "sequence": sequence, "trigger_us": 0, "outcome": "exposed", "centroid_us": 5000,
        "principal_point_x_mm": x, "principal_point_y_mm": y,
        "principal_point_frame_sigma_mm": 1e-5, "principal_point_common_sigma_mm": 0,
        "focus_shift_mm": frame["focus_shift_um"] / 1000, "compensated_vh_per_s": frame["vh_per_s"],
        "centroid_after_opening_s": frame["centroid_time_s"],
        "variance_mm2": frame["travel_variance_mm2"], "third_moment_mm3": 0,
        "fourth_moment_mm4": 0, "calibration_crc32": crc,
    }
    return {**no_exposure(), **{key: frame.get(key) for key in SAME}, **own}


def no_exposure():
    """Returns the fields of a record, without values."""
    unknown = (
        "reason opened_us closed_us centroid_unix_us utc_sigma_s principal_point_sigma_mm "
        "planned_opening_mm planned_travel_mm vh_per_s vh_sigma_per_s vh_age_s vh_source "
        "vh_extrapolated predicted_smear_um predicted_smear_px calibration_serial "
        "calibration_version calibration_storage"
    )
    return {**dict.fromkeys(unknown.split()), "faults": [], "flags": [], "fault_codes": ""}


def frames(host_sim, file):
    """Yields what is wrong with the frames of a camera, or None, for each frame."""
    for axis in ("+x", "-x", "+y", "-y"):
        with tempfile.TemporaryDirectory() as place:
            place = pathlib.Path(place)
            camera_file = place / "camera.toml"
            camera_file.write_text(along(pathlib.Path(file).read_text(), axis))
            camera = tomllib.loads(camera_file.read_text())

            def run(*arguments):
                command = [host_sim, arguments[0], "--camera", camera_file, *arguments[1:]]
                return subprocess.run(command, check=True, capture_output=True, text=True).stdout

            run("export", "colmap", "--out", place / "rest")
            rest = json.loads((place / "rest/export.json").read_text())
            shots = [json.loads(run("frame", *EXPOSURE, *shot, "--json")) for shot in SHOTS]
            crc = rest["calibration_crc32"]
            records = [record(number, shot, crc) for number, shot in enumerate(shots, 1)]
            (place / "records.json").write_text(json.dumps({"records": records}))
            pixels, points = measured(camera)
            (place / "points.csv").write_text(points)
            for binary in ([], ["--binary"]):
                run(
                    "export", "colmap", "--records", place / "records.json", "--out",
                    place / "frames", *binary,
                )
                images = pycolmap.Reconstruction(str(place / "frames"))
                for one, options in zip(records, SHOTS):
                    ideal = run("reference", *EXPOSURE, *options, place / "points.csv")
                    rays = strict_rays(camera, one, ideal)
                    image = images.images[one["sequence"]]
                    found = by_colmap_camera(images.cameras[image.camera_id], rays)
                    pitch_um = camera["sensor"]["pixel_um"]
                    largest_um = numpy.abs(found - pixels).max() * pitch_um
                    most_um = rest["residual_max_um"] + FRAME_UM
                    text = f"{file}: {axis} {options} {image.name}: {largest_um:.6f} µm"
                    yield None if largest_um <= most_um else f"{text}, more than {most_um:.6f} µm"


# What frames.py uses of Metashape: cameras with labels in a chunk, and sensors for them.
METASHAPE = """
import types


class Calibration:
    pass


class Sensor:
    type, fixed_calibration = "frame", False


class Chunk:
    addSensor = staticmethod(Sensor)


chunk = Chunk()
chunk.cameras = [
    types.SimpleNamespace(label=label, sensor=Sensor()) for label in ("IMG_00002", "IMG_00007")
]
app = types.SimpleNamespace(document=types.SimpleNamespace(chunk=chunk))
"""


def script(host_sim, file):
    """Runs frames.py on a camera with and one without a frame; returns what is wrong."""
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        export = [host_sim, "export", "metashape", "--camera", file, "--out", place]
        frame = [host_sim, "frame", "--camera", file, *EXPOSURE, *SHOTS[1], "--json"]
        frame = json.loads(subprocess.run(frame, check=True, capture_output=True).stdout)
        records = {"records": [record(2, frame, "00000000")]}
        (place / "records.json").write_text(json.dumps(records))
        export = [*export, "--records", place / "records.json"]
        subprocess.run(export, check=True, capture_output=True)
        (place / "Metashape.py").write_text(METASHAPE)
        text = (place / "frames.py").read_text() + SEEN
        (place / "frames.py").write_text(text)
        seen = subprocess.run(
            [sys.executable, place / "frames.py", place / "cameras.xml"], check=True,
            capture_output=True, text=True,
        ).stdout.splitlines()
        sensor = tomllib.loads(pathlib.Path(file).read_text())["sensor"]
        cx, cy = (value / sensor["pixel_um"] * 1000 for value in frame["principal_point_mm"])
        found = [float(number) for number in seen[-1].split()[:2]]
        is_moved = abs(found[0] - cx) < 1e-5 and abs(found[1] + cy) < 1e-5
        is_held = seen[-1].split()[2:] == ["True", "False"]
        is_told = seen[0] == "cameras without a frame: IMG_00007"
        return None if is_moved and is_held and is_told else f"{file}: frames.py: {seen}"


# Shows the camera that has a frame, and that the other one is left alone.
SEEN = """
one, other = (camera.sensor for camera in Metashape.app.document.chunk.cameras)
print(one.user_calib.cx, one.user_calib.cy, one.fixed_calibration, other.fixed_calibration)
"""


def measured(camera):
    """Returns points over the sensor in pixels, and as a table in mm."""
    sensor = camera["sensor"]
    pitch = sensor["pixel_um"] / 1000
    # The edges themselves are within the rounding of the table.
    side = numpy.linspace(-0.4999999, 0.4999999, 21)
    x, y = (
        axis.ravel()
        for axis in numpy.meshgrid(
            side * sensor["width_px"] * pitch, side * sensor["height_px"] * pitch
        )
    )
    lines = [f"{index},{a!r},{b!r}" for index, (a, b) in enumerate(zip(x.tolist(), y.tolist()))]
    pixels = [(sensor["width_px"] - 1) / 2 + x / pitch, (sensor["height_px"] - 1) / 2 - y / pitch]
    return numpy.stack(pixels, axis=1), "id,x_mm,y_mm\n" + "\n".join(lines) + "\n"


def strict_rays(camera, one, ideal):
    """Returns the rays of ideal points about the principal point of a record."""
    rows = list(csv.DictReader(io.StringIO(ideal)))
    x, y = (numpy.array([float(row[name]) for row in rows]) for name in ("x_mm", "y_mm"))
    f = camera["principal_distance_mm"]
    x, y = x - one["principal_point_x_mm"], y - one["principal_point_y_mm"]
    return numpy.stack([x / f, -y / f], axis=1)


# Published images of a printed sheet, in crates/adjustment/tests/data, and their camera.
SHEET = "crates/adjustment/tests/data/camcal"
SHEET_CAMERA = """name = "Olympus C4040Z"
principal_distance_mm = 7.5
[sensor]
width_px = 2272
height_px = 1704
pixel_um = 3.1911032863849766
[fmc]
stroke_mm = 0.1
"""

# Rounding of residuals.csv, micrometres.
RESIDUAL_UM = 2e-6


def handed_over(host_sim, root):
    """Returns what is wrong with a bundle handed over to COLMAP, or None.

    What COLMAP projects with its camera, poses and points must be off the coordinates by the
    residuals of the bundle, and its distances those that points3D.txt states.
    """
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        (place / "camera.toml").write_text(SHEET_CAMERA)
        data = root / SHEET
        bundle = [
            host_sim, "calibrate", "bundle", data / "image_points.csv", "--points",
            data / "object_points.csv", "--camera", place / "camera.toml", "--out", place / "out",
            "--export", "colmap",
        ]
        subprocess.run(bundle, check=True, capture_output=True)
        with (place / "out/residuals.csv").open() as file:
            rows = [row for row in csv.DictReader(file) if row["rejected"] == "false"]
        residuals = {
            (row["image"], row["point"], row["observation"]): float(row["residual"])
            for row in rows if row["group"] == "image"
        }
        with (place / "out/points.csv").open() as file:
            names = [row["point"] for row in csv.DictReader(file)]
        block = pycolmap.Reconstruction(str(place / "out"))
        compared, largest_um, largest_px = 0, 0.0, 0.0
        distances = {}
        for image in block.images.values():
            for seen in image.points2D:
                number = seen.point3D_id
                off = seen.xy - image.project_point(block.points3D[number].xyz)
                distances.setdefault(number, []).append(numpy.hypot(*off))
                for name, value in (("x_um", off[0]), ("y_um", -off[1])):
                    expected = residuals[image.name, names[number - 1], name]
                    largest_um = max(largest_um, abs(value * 3.1911032863849766 - expected))
                    compared += 1
        for number, of_point in distances.items():
            stated = block.points3D[number].error
            largest_px = max(largest_px, abs(numpy.mean(of_point) - stated))
        is_good = compared == len(residuals) > 4000
        is_good &= largest_um <= RESIDUAL_UM and largest_px <= 1e-9
        text = f"{compared} of {len(residuals)} residuals, {largest_um} um, {largest_px} px"
        return None if is_good else f"bundle for COLMAP: {text}"


OPENCV = [
    ["--model", model, "--as", container]
    for model in ("opencv5", "opencv8", "opencv14")
    for container in ("yaml", "json", "xml")
]
COLMAP = [
    ["--model", model, *binary]
    for model in ("PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "FULL_OPENCV")
    for binary in ([], ["--binary"])
]


def main():
    host_sim, *files = sys.argv[1:]
    failures = checked = 0
    for file in files:
        camera = tomllib.loads(pathlib.Path(file).read_text())
        rays, expected = strict(camera)
        for program, choices in (("opencv", OPENCV), ("colmap", COLMAP)):
            for options in choices:
                with tempfile.TemporaryDirectory() as out:
                    export = [host_sim, "export", program, "--camera", file, "--out", out]
                    subprocess.run(
                        [*export, *options], check=True, stdout=subprocess.DEVNULL,
                        stderr=subprocess.DEVNULL,
                    )
                    folder = pathlib.Path(out)
                    stated = json.loads((folder / "export.json").read_text())
                    if program == "opencv":
                        found = by_opencv(folder / stated["files"][0], rays)
                    else:
                        found = by_colmap(folder, rays)
                largest_um = numpy.abs(found - expected).max() * camera["sensor"]["pixel_um"]
                stated_um = stated["residual_max_um"]
                checked += 1
                if abs(largest_um - stated_um) > TOLERANCE * stated_um + ROUNDING_UM:
                    failures += 1
                    what = f"{file}: {program} {' '.join(options)}"
                    print(f"{what}: {largest_um:.6f} µm, but {stated_um:.6f} µm are stated")
    of_flights = [fault for file in files for fault in frames(host_sim, file)]
    root = pathlib.Path(__file__).resolve().parents[3]
    others = [script(host_sim, files[0]), handed_over(host_sim, root)]
    faults = [fault for fault in [*of_flights, *others] if fault]
    print(*faults, sep="\n", end="\n" if faults else "")
    failures += len(faults)
    print(f"{len(of_flights)} cameras of single frames compared with the strict solver")
    print(f"{checked} exports read by OpenCV {cv2.__version__} and COLMAP {pycolmap.__version__}")
    return 1 if failures or checked == 0 or not of_flights else 0


if __name__ == "__main__":
    sys.exit(main())
