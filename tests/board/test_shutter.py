"""The shutter's command: set by the timer at its own time, and the interrupt after it."""

import unittest

from support import MS, UNDEFINED, Flight, astray
from timers import CCR1

# Number of the timer's interrupt, and its channel.
INTERRUPT, CHANNEL = 50, 3
EXPOSURE_US = 4000
STEP_S, LONGEST_S = 1e-5, 0.5


class Shutter(unittest.TestCase):
    image = host_sim = None

    def armed(self):
        """Returns a flight whose next command is set and has not left, and the timer's time of it."""
        flight = Flight(self.image, self.host_sim)
        flight.arm()
        board = flight.board
        board.bench.trigger(board.now + MS)
        timer = board.chip.shutter
        self.run_until(board, lambda: timer.mode == timer.ACTIVE_ON_MATCH)
        self.assertFalse(board.bench.is_open)
        return flight, timer.registers[CCR1 + 4 * CHANNEL]

    def run_until(self, board, condition):
        end = board.now + round(LONGEST_S * 1000 * MS)
        while not condition():
            self.assertLess(board.now, end)
            board.run(STEP_S)

    def test_command_leaves_and_ends_at_its_microsecond_however_late_the_interrupt_is(self):
        flight, planned_us = self.armed()
        board, bench, timer = flight.board, flight.board.bench, flight.board.chip.shutter
        board.processor.enabled.discard(INTERRUPT)
        self.run_until(board, lambda: bench.is_open)
        opened, _ = bench.commands[-1]
        self.assertEqual((timer.count(opened - 1), timer.count(opened)), (planned_us - 1, planned_us))
        # The interrupt is served within the exposure, which is counted from the command all the same.
        board.run(0.002)
        board.processor.enabled.add(INTERRUPT)
        self.run_until(board, lambda: not bench.is_open)
        closed, _ = bench.commands[-1]
        self.assertEqual(timer.count(closed) - planned_us, EXPOSURE_US)
        self.assertEqual(timer.count(closed - 1) - planned_us, EXPOSURE_US - 1)
        self.assertEqual(len(bench.commands), 2)
        board.run(0.1)
        (record,) = flight.records()
        self.assertEqual(record["outcome"], "exposed", record["reason"])

    def test_exposure_that_no_interrupt_ends_is_ended_by_the_controller_and_named(self):
        flight, _ = self.armed()
        board, bench = flight.board, flight.board.bench
        board.processor.enabled.discard(INTERRUPT)
        board.run(0.1)
        (opened, _), (closed, _) = bench.commands
        self.assertLess((closed - opened) / MS, 10.0)
        (record,) = flight.records()
        self.assertIn("shutter long", record["faults"])

    def test_fault_of_the_processor_takes_back_a_command_that_has_not_left(self):
        flight, _ = self.armed()
        board = flight.board
        astray(board, UNDEFINED)
        self.assertEqual(board.bench.commands, [])
        board.run(0.015)
        self.assertEqual(board.processor.resets, [], "the handler waits for its log")
        self.assertEqual(board.chip.shutter.mode, board.chip.shutter.FORCED_INACTIVE)
        board.run(0.1)
        self.assertEqual(len(board.processor.resets), 1)
        self.assertEqual(board.bench.commands, [])
