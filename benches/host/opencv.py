"""Times OpenCV's functions for host-benches: python3 opencv.py FUNCTION POINTS

It prints the version, and for every line on standard input calls the function once to warm the caches and once more, and
prints the seconds of that call. In one thread, single precision outside, double inside. The exit code is 3 if Python has
no OpenCV.
"""

import sys
import time

try:
    import cv2
    import numpy
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(3)

FOCAL_PX, CENTRE_PX, PIXEL_MM = 18_857.0, 4_607.5, 0.00875
DISTORTION = numpy.array([-0.1, 0.05, 1e-4, 1e-4, 0.01])
CAMERA = numpy.array([[FOCAL_PX, 0, CENTRE_PX], [0, FOCAL_PX, CENTRE_PX], [0, 0, 1]])


def points(count):
    """Returns the points of host-benches, in pixels."""
    index = numpy.arange(count) % 65_536
    mm = numpy.stack([(index % 8_009) * 0.01 - 40.0, (index % 7_919) * 0.01 - 39.5], axis=1)
    return (CENTRE_PX + mm / PIXEL_MM).astype(numpy.float32).reshape(-1, 1, 2)


def undistort_points(count):
    """Measured to ideal, five iterations."""
    measured = points(count)
    ideal = numpy.empty_like(measured)
    return lambda: cv2.undistortPoints(measured, CAMERA, DISTORTION, dst=ideal, P=CAMERA)


def project_points(count):
    """Directions in the camera to measured pixels."""
    directions = numpy.ones((count, 1, 3), numpy.float32)
    directions[:, :, :2] = (points(count) - CENTRE_PX) / FOCAL_PX
    measured = numpy.empty((count, 1, 2), numpy.float32)
    still = numpy.zeros(3)
    return lambda: cv2.projectPoints(directions, still, still, CAMERA, DISTORTION, imagePoints=measured)


def init_undistort_rectify_map(count):
    """Measured pixels of an ideal image of so many, a row of up to 4000."""
    width = min(count, 4_000)
    size = (width, count // width)
    maps = [numpy.empty(size[::-1], numpy.float32) for _ in range(2)]
    return lambda: cv2.initUndistortRectifyMap(CAMERA, DISTORTION, None, CAMERA, size, cv2.CV_32FC1, *maps)


FUNCTIONS = {
    "undistortPoints": undistort_points,
    "projectPoints": project_points,
    "initUndistortRectifyMap": init_undistort_rectify_map,
}


def main(name, count):
    cv2.setNumThreads(1)
    work = FUNCTIONS[name](int(count))
    print(cv2.__version__, flush=True)
    for _ in sys.stdin:
        work()
        start = time.perf_counter()
        work()
        print(time.perf_counter() - start, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
