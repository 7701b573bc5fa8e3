"""Reads exported camera files with the programs themselves and projects points.

Usage: readers.py HOST_SIM CAMERA.toml...

Each camera is exported in every format that OpenCV and COLMAP read. Their own readers and their own
projection give the measured points of rays, which are computed here from the camera file. The
largest difference over the sensor must be what export.json states, within 10 %.
"""

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
    camera = pycolmap.Reconstruction(str(folder)).cameras[1]
    points = numpy.column_stack([rays, numpy.ones(len(rays))])
    return numpy.array([camera.img_from_cam(point) for point in points]) - 0.5


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
    print(f"{checked} exports read by OpenCV {cv2.__version__} and COLMAP {pycolmap.__version__}")
    return 1 if failures or checked == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
