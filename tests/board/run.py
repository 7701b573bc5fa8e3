"""Tests of the board's image on the model of its chip.

Usage: run.py IMAGE HOST_SIM [TEST...]

The image is the one that is flashed, unchanged. TEST is a name as `test_flight` or
`test_force.Force.test_lock_up_leaves_it_until_the_watchdog`; without one all are run.
"""

import sys
import unittest

import test_bring_up
import test_client
import test_clock
import test_edges
import test_flight
import test_force
import test_memory
import test_records
import test_shake
import test_shutter
import test_stack
import test_start
import test_store
import test_vectors

CLASSES = (
    test_start.Start, test_force.Force, test_memory.Memory, test_stack.Stack, test_edges.Edges,
    test_shutter.Shutter, test_clock.Clock, test_store.Store, test_client.Client,
    test_vectors.Vectors, test_bring_up.BringUp, test_shake.Shaking, test_flight.TenSeconds,
    test_records.Records,
)  # fmt: skip


def main():
    image, host_sim, *names = sys.argv[1:]
    for tests in CLASSES:
        tests.image, tests.host_sim = image, host_sim
    names = names or [tests.__module__ for tests in CLASSES]
    suite = unittest.defaultTestLoader.loadTestsFromNames(names)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    if result.testsRun == 0 or not result.wasSuccessful():
        sys.exit(1)


if __name__ == "__main__":
    main()
