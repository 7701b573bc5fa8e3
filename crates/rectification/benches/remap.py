"""Processor time of OpenCV's remap, on request: maps come in once, then the name of an interpolation per line."""

import sys
import time

try:
    import cv2
    import numpy
except ImportError as missing:
    print(missing, file=sys.stderr)
    print()
    sys.exit(3)

width, height = (int(side) for side in sys.argv[1:3])
print(cv2.__version__, flush=True)
cv2.setNumThreads(1)
maps = []
for axis in range(2):
    one = numpy.empty((height, width), numpy.float32)
    view = memoryview(one.reshape(-1).view(numpy.uint8))
    done = 0
    while done < len(view):
        count = sys.stdin.buffer.readinto(view[done:])
        if not count:
            sys.exit(2)
        done += count
    maps.append(one)
block = numpy.random.default_rng(1).integers(0, 65536, (height, 64, 3), dtype=numpy.uint16)
source = numpy.tile(block, (1, -(-width // 64), 1))[:, :width].copy()
out = numpy.ones_like(source)
KERNELS = {"nearest": cv2.INTER_NEAREST, "linear": cv2.INTER_LINEAR, "cubic": cv2.INTER_CUBIC,
           "lanczos4": cv2.INTER_LANCZOS4}
while (name := sys.stdin.buffer.readline().decode().strip()) in KERNELS:
    start = time.process_time()
    cv2.remap(source, maps[0], maps[1], KERNELS[name], dst=out, borderMode=cv2.BORDER_REPLICATE)
    print(time.process_time() - start, flush=True)
