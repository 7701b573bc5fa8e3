"""Tests of the board's image on the model of its chip.

Usage: run.py IMAGE HOST_SIM [TEST...]

The image is the one that is flashed, unchanged. TEST is a name as `test_flight` or
`test_force.Force.test_lock_up_leaves_it_until_the_watchdog`; without one all are run but the skips.
Several are run in processes of their own, as many at a time as there are processors.
"""

import concurrent.futures
import contextlib
import io
import multiprocessing
import os
import sys
import time
import unittest

import test_bring_up
import test_client
import test_clock
import test_edges
import test_exchange
import test_eyes
import test_flight
import test_force
import test_memory
import test_records
import test_shake
import test_shutter
import test_skips_shutter
import test_skips_signature
import test_stack
import test_start
import test_store
import test_vectors

# The longest come first.
CLASSES = (
    test_store.Store, test_force.Force, test_flight.TenSeconds, test_shake.Shaking,
    test_start.Start, test_memory.Memory, test_stack.Stack, test_edges.Edges,
    test_shutter.Shutter, test_clock.Clock, test_client.Client, test_vectors.Vectors,
    test_bring_up.BringUp, test_exchange.Exchange, test_records.Records, test_eyes.Eyes,
)  # fmt: skip
# Those whose tests share what one of them has made.
SHARING = (test_store.Store,)
# Those that are run by their names alone: they take minutes.
APART = (test_skips_shutter.ShutterSkips, test_skips_signature.SignatureSkips)


def main():
    image, host_sim, *names = sys.argv[1:]
    if len(names) == 1:
        sys.exit(run(image, host_sim, names))
    begun = time.monotonic()
    loader = unittest.defaultTestLoader
    suite = loader.loadTestsFromNames(names or [tests.__module__ for tests in CLASSES])
    groups = grouped(tests_of(suite))
    # Copies of this process: what is imported is imported once.
    fork = multiprocessing.get_context("fork")
    results = []
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count(), fork) as pool:
        running = [pool.submit(run_apart, image, host_sim, group) for group in groups]
        for done in concurrent.futures.as_completed(running):
            printed, *result = done.result()
            print(printed, end="", flush=True)
            results.append(result)
    failed = [name for _, names in results for name in names]
    number = sum(number for number, _ in results)
    print(f"\nRan {number} tests in {time.monotonic() - begun:.3f}s")
    if failed or not number:
        sys.exit(f"FAILED: {', '.join(failed)}")


def tests_of(suite):
    """Returns the tests of a suite, in order."""
    if not isinstance(suite, unittest.TestSuite):
        return [suite]
    return [test for part in suite for test in tests_of(part)]


def grouped(tests):
    """Returns the names of tests that run in one process: all of a class that shares what it has made,
    else each by itself."""
    groups = {}
    for test in tests:
        is_shared = type(test) in SHARING
        groups.setdefault(type(test) if is_shared else test.id(), []).append(test.id())
    return list(groups.values())


def run_apart(image, host_sim, names):
    """Runs tests; returns what they print, their number, and the names of those that fail."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        result = result_of(image, host_sim, names, printed)
    wrong = [test.id() for test, _ in result.failures + result.errors]
    failed = [] if result.wasSuccessful() else wrong or names
    return printed.getvalue(), result.testsRun, failed


def run(image, host_sim, names):
    """Runs tests by their names; returns an exit code, which is not 0 if there were none."""
    result = result_of(image, host_sim, names, sys.stderr)
    return 0 if result.testsRun and result.wasSuccessful() else 1


def result_of(image, host_sim, names, stream):
    for tests in CLASSES + APART:
        tests.image, tests.host_sim = image, host_sim
    suite = unittest.defaultTestLoader.loadTestsFromNames(names)
    return unittest.TextTestRunner(stream, verbosity=2).run(suite)


if __name__ == "__main__":
    main()
