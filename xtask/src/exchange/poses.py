"""Reads exported poses with COLMAP.

Usage: poses.py HOST_SIM CAMERA.toml

Exposures of a flight along a straight line with a constant attitude are exported with their
trajectory, for each of the four axes of the motion. Projection centres and rotations that COLMAP
reads must be those of the flight, which are computed here from the conventions in docs/formats.md,
and an exposure after the end of the trajectory must have a camera and no pose.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
import pycolmap

from readers import EXPOSURE, SHOTS, along, record

# Largest distance of a projection centre, m, and largest difference of an element of a rotation.
CENTRE_M = 1e-8
ROTATION = 1e-11

# Flight: time in s since 1970, place in m and velocity in m/s of a local system, angles in degrees.
START_S = 1_700_000_000.0
PLACE = numpy.array([512.25, -340.5, 1530.75])
VELOCITY = numpy.array([48.0, 51.5, -0.75])
ROLL, PITCH, YAW = 2.25, -1.5, 317.0

# Times of the centroids after the start, s; the last has no pose.
CENTROIDS_S = (2.5, 4.125, 40.0)


def turned(axis, degrees):
    """Returns the right-handed rotation about an axis of coordinates."""
    angle = numpy.radians(degrees)
    cosine, sine = numpy.cos(angle), numpy.sin(angle)
    first, second = [number for number in range(3) if number != axis]
    # The order of the other two axes is that of a right-handed turn, which is backwards about y.
    if axis == 1:
        first, second = second, first
    matrix = numpy.eye(3)
    matrix[first, first] = matrix[second, second] = cosine
    matrix[first, second], matrix[second, first] = -sine, sine
    return matrix


def camera_from_ground(axis):
    """Returns the rotation that COLMAP has: x to the right, y down, z towards the ground."""
    ground_from_body = turned(2, YAW) @ turned(0, PITCH) @ turned(1, ROLL)
    # The axis of the motion is forward, the second axis of the body.
    body_from_sensor = turned(2, {"+y": 0, "+x": 90, "-y": 180, "-x": 270}[axis])
    return numpy.diag([1.0, -1.0, -1.0]) @ (ground_from_body @ body_from_sensor).T


def trajectory():
    """Returns samples of ten seconds, four a second: their times are binary fractions."""
    lines = ["unix_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg"]
    for sample in range(41):
        seconds = sample / 4
        x, y, z = (PLACE + VELOCITY * seconds).tolist()
        lines.append(f"{START_S + seconds!r},{x!r},{y!r},{z!r},{ROLL},{PITCH},{YAW}")
    return "\n".join(lines) + "\n"


def posed(host_sim, file, axis):
    """Yields what is wrong with the poses of a flight along an axis, or None, for each frame."""
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        camera = place / "camera.toml"
        camera.write_text(along(pathlib.Path(file).read_text(), axis))

        def run(*arguments):
            command = [host_sim, arguments[0], "--camera", camera, *arguments[1:]]
            return subprocess.run(command, check=True, capture_output=True, text=True).stdout

        run("export", "colmap", "--out", place / "rest")
        crc = json.loads((place / "rest/export.json").read_text())["calibration_crc32"]
        frame = json.loads(run("frame", *EXPOSURE, *SHOTS[1], "--json"))
        records = []
        for number, seconds in enumerate(CENTROIDS_S, 1):
            of_frame = record(number, frame, crc)
            of_frame["centroid_unix_us"] = round((START_S + seconds) * 1e6)
            of_frame["utc_sigma_s"] = 1e-6
            records.append(of_frame)
        (place / "records.json").write_text(json.dumps({"records": records}))
        (place / "trajectory.csv").write_text(trajectory())
        for binary in ([], ["--binary"]):
            run(
                "export", "colmap", "--records", place / "records.json", "--trajectory",
                place / "trajectory.csv", "--off-trajectory", "skip", "--out", place / "frames",
                *binary,
            )
            block = pycolmap.Reconstruction(str(place / "frames"))
            images = block.images
            for number, seconds in enumerate(CENTROIDS_S[:-1], 1):
                image = images[number]
                centre = image.projection_center() - (PLACE + VELOCITY * seconds)
                found = image.cam_from_world().rotation.matrix() - camera_from_ground(axis)
                off_m, off = numpy.abs(centre).max(), numpy.abs(found).max()
                text = f"{axis} {binary} image {number}: {off_m} m, rotation {off}"
                yield None if off_m <= CENTRE_M and off <= ROTATION else text
            stated = json.loads((place / "frames/export.json").read_text())["frames"]["poses"]
            # The last image has a camera and no pose; the statement says so.
            last = len(CENTROIDS_S)
            is_left_out = last in block.cameras and last not in images
            is_left_out &= len(images) == stated["frames"] == last - 1
            text = f"{axis} {binary}: {stated}, images {sorted(images)}"
            yield None if is_left_out else text


def main():
    host_sim, file = sys.argv[1:]
    outcomes = [fault for axis in ("+x", "-x", "+y", "-y") for fault in posed(host_sim, file, axis)]
    faults = [fault for fault in outcomes if fault]
    print(*faults, sep="\n", end="\n" if faults else "")
    print(f"{len(outcomes)} poses read by COLMAP {pycolmap.__version__}")
    return 1 if faults or not outcomes else 0


if __name__ == "__main__":
    sys.exit(main())
