"""Tests of the board's image on the model of its chip.

Usage: run.py IMAGE HOST_SIM [TEST...]

The image is the one that is flashed, unchanged. TEST is a name as `test_flight` or
`test_force.Force.test_lock_up_leaves_it_until_the_watchdog`; without one all are run but the skips.
Several are run as many at a time as there are processors.
"""

import concurrent.futures
import os
import re
import subprocess
import sys
import time
import unittest

import test_bring_up
import test_client
import test_clock
import test_edges
import test_exchange
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
    test_bring_up.BringUp, test_exchange.Exchange, test_records.Records,
)  # fmt: skip
# Those that are run by their names alone: they take minutes.
APART = (test_skips_shutter.ShutterSkips, test_skips_signature.SignatureSkips)


def main():
    image, host_sim, *names = sys.argv[1:]
    if len(names) == 1:
        sys.exit(run(image, host_sim, names))
    begun = time.monotonic()
    files = names or [tests.__module__ for tests in CLASSES]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda name: run_apart(image, host_sim, name), files))
    failed = [name for name, (code, _) in zip(files, results) if code]
    number = sum(number for _, number in results)
    print(f"\nRan {number} tests in {time.monotonic() - begun:.3f}s")
    if failed:
        sys.exit(f"FAILED in {', '.join(failed)}")


def run_apart(image, host_sim, name):
    """Runs the tests of a file in a process of its own; returns its exit code and their number."""
    command = [sys.executable, __file__, image, host_sim, name]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(done.stdout, end="", flush=True)
    ran = re.search(r"^Ran (\d+) test", done.stdout, re.MULTILINE)
    return done.returncode, int(ran[1]) if ran else 0


def run(image, host_sim, names):
    """Runs tests by their names; returns an exit code, which is not 0 if there were none."""
    for tests in CLASSES + APART:
        tests.image, tests.host_sim = image, host_sim
    suite = unittest.defaultTestLoader.loadTestsFromNames(names)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    return 0 if result.testsRun and result.wasSuccessful() else 1


if __name__ == "__main__":
    main()
