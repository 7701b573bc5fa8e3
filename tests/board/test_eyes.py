"""Triggers all through a reset: those without a record fall into the time that the camera tells."""

import unittest

from board import CYCLES_PER_S
from link import Link
from processor import CYCLES_PER_US
from support import HANGS, MS, OVERFLOWS, UNDEFINED, Flight, astray

# Time from one trigger to the next: few enough in a start for a line's places, and, with those of
# the flight around it, for whole records.
SPACING = 5 * MS
BEFORE_S, AFTER_S = 0.03, 0.06
# The request to start again, though the camera is armed.
FORCED_RESET = bytes([9, 1])


class Eyes(unittest.TestCase):
    image = host_sim = None

    def flown(self, goes_wrong, longest_s):
        """Flies through a reset with triggers; returns the flight, the times of the triggers, and
        those of the records."""
        flight = Flight(self.image, self.host_sim)
        flight.arm()
        board, clock = flight.board, flight.board.chip.clock
        begin = board.now + MS // 3
        times = range(begin, begin + round((BEFORE_S + longest_s) * CYCLES_PER_S), SPACING)
        for time in times:
            board.bench.trigger(time)
        board.run(BEFORE_S)
        starts = {1: clock.start_time}
        goes_wrong(board)
        board.processor.run(times[-1] + round(AFTER_S * CYCLES_PER_S))
        starts[2] = clock.start_time
        recorded = [
            starts[int(record["boot"])] + int(record["trigger_us"]) * CYCLES_PER_US
            for record in flight.records()
        ]
        return flight, times, starts, recorded

    def check(self, goes_wrong, cause, longest_s, at_most_ms):
        flight, times, starts, recorded = self.flown(goes_wrong, longest_s)
        board = flight.board
        self.assertEqual([of for _, of in board.processor.resets], [cause])
        status = flight.status()
        found = status["after_reset"]
        parts = found["without_eyes"]["AtMost"]
        told = sum(parts.values()) * MS
        self.assertLessEqual(sum(parts.values()), at_most_ms)
        # Each record is that of a trigger.
        seen = [time for time in times if any(0 <= time - at < CYCLES_PER_US for at in recorded)]
        self.assertEqual(len(seen), len(recorded))
        without = [time for time in times if time not in seen]
        # They follow each other: from the last round on, for no longer than the camera tells.
        last_round = starts[1] + found["last_round"]["us"] * CYCLES_PER_US
        self.assertEqual(without, [time for time in times if without[0] <= time <= without[-1]])
        self.assertGreater(without[0], last_round)
        self.assertLess(without[-1], last_round + told)
        first_round = starts[2] + parts["start_up_ms"] * MS
        self.assertLess(without[-1], first_round)
        # The parts hold, too; edges that were stamped before the first round have records.
        self.assertLess(starts[2] - last_round, parts["before_clock_ms"] * MS)
        self.assertEqual(status["lost_events"], 0)
        return len(without), told / MS, (first_round - last_round) / MS

    def test_triggers_without_a_record_after_a_watchdog_are_those_of_the_time_told(self):
        without, told_ms, true_ms = self.check(
            lambda board: astray(board, HANGS), "watchdog", longest_s=0.6, at_most_ms=620
        )
        # The interval is 512 ms, which may be a tenth longer.
        self.assertGreater(without * SPACING, 500 * MS)
        self.assertLess(told_ms - true_ms, 80)

    def test_triggers_without_a_record_after_a_fault_are_those_of_the_time_told(self):
        for code in (UNDEFINED, OVERFLOWS):
            with self.subTest(code=code):
                without, told_ms, true_ms = self.check(
                    lambda board: astray(board, code), "software", longest_s=0.1, at_most_ms=90
                )
                self.assertGreater(without, 2)
                self.assertLess(told_ms - true_ms, 50)

    def test_time_of_a_reset_by_the_pin_is_unknown(self):
        flight = Flight(self.image, self.host_sim)
        flight.arm()
        flight.board.processor.reset("pin")
        flight.board.run(AFTER_S)
        found = flight.status()["after_reset"]
        self.assertEqual((found["outcome"], found["without_eyes"]), ("FliesOn", "Unknown"))
        # One that a message asks for is bounded.
        Link(flight.board).send(FORCED_RESET)
        flight.board.run(AFTER_S)
        self.assertEqual([cause for _, cause in flight.board.processor.resets], ["pin", "software"])
        flight.board.chip.link.sent.clear()
        found = flight.status()["after_reset"]
        self.assertLess(sum(found["without_eyes"]["AtMost"].values()), 90)
