"""Import, processes and signals."""

import multiprocessing
import signal
import subprocess
import sys
import time

import flights
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import fmc_camera

# CPU time of the import, s, and the fastest of this many tries, since the machine does other things.
LONGEST_IMPORT_S, TRIES = 0.05, 5


def test_import_takes_less_than_50_ms_and_no_table_library():
    code = (
        "import sys, time; start = time.process_time(); import fmc_camera; "
        "print(time.process_time() - start); "
        "print([name for name in ('pandas', 'polars', 'pyarrow') if name in sys.modules])"
    )
    taken = []
    for _ in range(TRIES):
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        seconds, modules = done.stdout.splitlines()
        assert modules == "[]"
        taken.append(float(seconds))
    assert min(taken) < LONGEST_IMPORT_S


def corrected(frames, points, index):
    return frames.correct(points, index)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_other_processes_have_the_same_bits(method):
    frames = flights.frames()
    points = np.random.default_rng(4).uniform(-30, 30, (400_000, 2))
    index = np.arange(400_000) % 15
    # The parent has computed before it forks.
    expected = corrected(frames, points, index)
    with multiprocessing.get_context(method).Pool(2) as pool:
        answers = pool.starmap_async(corrected, [(frames, points, index)] * 2).get(timeout=120)
    for answer in answers:
        assert_array_equal(answer, expected)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="interval timers")
def test_interrupt_ends_a_long_call():
    frame = flights.camera().frame(0.1, 0.004)
    points = np.zeros((60_000_000, 2))
    start = time.process_time()
    frame.distort(points, inplace=True)
    whole = time.process_time() - start
    # Ctrl-C after a tenth of the processor time, however busy the machine is.
    before = signal.signal(signal.SIGVTALRM, signal.default_int_handler)
    start = time.process_time()
    try:
        with pytest.raises(KeyboardInterrupt):
            signal.setitimer(signal.ITIMER_VIRTUAL, 0.1 * whole)
            frame.distort(points, inplace=True)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
    assert time.process_time() - start < 0.8 * whole
    assert np.isfinite(points).all()


def test_version_is_that_of_the_library():
    assert fmc_camera.__version__ == "0.1.0"
