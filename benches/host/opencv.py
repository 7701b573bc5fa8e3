"""Time per point of OpenCV's undistortPoints, as the rows of host-benches: python3 opencv.py SIZE...

It takes five iterations in double precision inside, pixels in single precision outside, in one thread. The exit code is
3 if Python has no OpenCV.
"""

import statistics
import sys
import time

try:
    import cv2
    import numpy
except ImportError as missing:
    print(missing, file=sys.stderr)
    sys.exit(3)

POINT_ROUNDS = 20_000_000
FOCAL_PX, CENTRE_PX, PIXEL_MM = 18_857.0, 4_607.5, 0.00875
DISTORTION = numpy.array([-0.1, 0.05, 1e-4, 1e-4, 0.01])
CAMERA = numpy.array([[FOCAL_PX, 0, CENTRE_PX], [0, FOCAL_PX, CENTRE_PX], [0, 0, 1]])


def points(count):
    """Returns the points of host-benches, in pixels."""
    index = numpy.arange(count) % 65_536
    mm = numpy.stack([(index % 8_009) * 0.01 - 40.0, (index % 7_919) * 0.01 - 39.5], axis=1)
    return (CENTRE_PX + mm / PIXEL_MM).astype(numpy.float32).reshape(-1, 1, 2)


def main(sizes):
    cv2.setNumThreads(1)
    print("core,kernel,points,ns_per_point,median_ns_per_point,of_memcpy,clock_ghz")
    for size in sizes:
        measured = points(size)
        ideal = numpy.empty_like(measured)
        rounds = []
        for _ in range(max(5, min(1_000, POINT_ROUNDS // size))):
            start = time.perf_counter()
            cv2.undistortPoints(measured, CAMERA, DISTORTION, dst=ideal, P=CAMERA)
            rounds.append(1e9 * (time.perf_counter() - start) / size)
        name = f"OpenCV {cv2.__version__} undistortPoints"
        print(f"host,{name},{size},{min(rounds):.4f},{statistics.median(rounds):.4f},,")


if __name__ == "__main__":
    main([int(size) for size in sys.argv[1:]])
