"""Times of the wheel, as CSV, beside the kernel in Rust and OpenCV; a time over its limit is an error.

Each is the fastest of several calls: of short calls by the clock, which no other program has
interrupted then; of long ones the CPU time of the thread.
"""

import pathlib
import sys
import time

import cv2
import numpy as np
import pyarrow as pa

import fmc_camera
from fmc_camera import arrow

ROOT = pathlib.Path(__file__).resolve().parents[3]
CAMERA = ROOT / "host-sim/cameras/phase-one-ixm-rs150f-50.toml"

MANY, FEW, FRAMES, EACH = 100_000, 1_000, 10_000, 1_000
ARROW_FRAMES, ARROW_EACH = 100, 10_000


def fastest(call, calls, clock=time.perf_counter):
    best = float("inf")
    for _ in range(calls):
        start = clock()
        call()
        best = min(best, clock() - start)
    return best


def cpu_time(call, calls):
    return fastest(call, calls, time.thread_time)


def opencv(points):
    """cv2.undistortPoints of a polynomial of five coefficients."""
    matrix = np.array([[13662.0, 0, 7102], [0, 13662.0, 5326], [0, 0, 1]])
    pixels = np.ascontiguousarray(points * np.float32(1000 / 3.76) + np.float32(5000))[:, None]
    coefficients = np.array([-0.04, 0.04, 0.0, 0.0, -0.02])
    cv2.setNumThreads(1)
    return lambda: cv2.undistortPoints(pixels, matrix, coefficients)


def main():
    random = np.random.default_rng(0)
    camera = fmc_camera.Camera.from_toml(CAMERA)
    frame = camera.frame(0.17, 1 / 200)
    rows, failed = [], False

    def row(what, seconds, points, relative, limit=None, is_least=False):
        nonlocal failed
        if limit is None:
            rows.append(f"{what},{1e9 * seconds / points:.3f},{relative:.3f},,")
            return
        is_over = relative < limit if is_least else relative > limit
        failed |= is_over
        mark = "OVER" if is_over else "ok"
        sign = ">=" if is_least else "<="
        rows.append(f"{what},{1e9 * seconds / points:.3f},{relative:.3f},{sign}{limit},{mark}")

    points = random.uniform(-20, 20, (MANY, 2)).astype(np.float32)
    out = np.empty_like(points)
    ours = fastest(lambda: frame.correct(points, out=out), 300)
    kernel = frame._kernel_seconds(points, out, 300)
    row("1e5 points float32 / kernel", ours, MANY, ours / kernel, 1.2)
    theirs = cpu_time(opencv(points), 10)
    row("cv2.undistortPoints / 1e5 points float32", theirs, MANY, theirs / ours, 75, True)
    few, few_out = points[:FEW].copy(), out[:FEW].copy()
    call = fastest(lambda: frame.correct(few, out=few_out), 20_000)
    row("1e3 points float32 in us", call, FEW, 1e6 * call, 1.0)
    doubles, doubles_out = points.astype(np.float64), np.empty((MANY, 2))
    taken = fastest(lambda: frame.correct(doubles, out=doubles_out), 100)
    row("1e5 points float64 in ns a point", taken, MANY, 1e9 * taken / MANY, 10)

    table = {
        "sequence": np.arange(FRAMES),
        "vh_per_s": random.uniform(0.05, 0.17, FRAMES),
        "exposure_s": np.full(FRAMES, 0.004),
    }
    frames = camera.frames(table)
    all_points = random.uniform(-20, 20, (FRAMES * EACH, 2)).astype(np.float32)
    all_out = np.empty_like(all_points)
    one = cpu_time(lambda: frame.correct(all_points, out=all_out), 7)
    shaped, shaped_out = (array.reshape(FRAMES, EACH, 2) for array in (all_points, all_out))
    index = np.arange(FRAMES)
    many = cpu_time(lambda: frames.correct(shaped, index, out=shaped_out), 7)
    row("1e4 frames x 1e3 / one frame of 1e7", many, FRAMES * EACH, many / one, 1.3)
    repeated = np.repeat(index, EACH)
    each = cpu_time(lambda: frames.correct(all_points, repeated, out=all_out), 7)
    row("the same with a number for each point", each, FRAMES * EACH, each / one, 3)
    mixed = random.permutation(repeated)
    each = cpu_time(lambda: frames.correct(all_points, mixed, out=all_out), 2)
    row("the same in random order in ns a point", each, FRAMES * EACH, 1e9 * each / (FRAMES * EACH), 100)
    doubles, doubles_out = all_points.astype(np.float64), np.empty(all_points.shape)
    each = cpu_time(lambda: frames.correct(doubles, mixed, out=doubles_out), 1)
    row("the same in float64 in ns a point", each, FRAMES * EACH, 1e9 * each / (FRAMES * EACH), 1000)

    count = ARROW_FRAMES * ARROW_EACH
    batch = pa.RecordBatch.from_pydict(
        {
            "frame": np.repeat(np.arange(ARROW_FRAMES), ARROW_EACH),
            "x": random.uniform(-20, 20, count),
            "y": random.uniform(-20, 20, count),
        }
    )
    taken = cpu_time(lambda: arrow.correct(batch, frames), 10)
    row("arrow.correct in ns a point", taken, count, 1e9 * taken / count, 25)

    print("what,ns_per_point,relative,limit,verdict")
    print("\n".join(rows))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
