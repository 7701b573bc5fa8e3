"""Force on the stage: what takes it away, and how soon."""

import unittest

from support import HANGS, MS, OVERFLOWS, UNDEFINED, Flight, astray


class Force(unittest.TestCase):
    image = host_sim = None

    def setUp(self):
        self.flight = Flight(self.image, self.host_sim)
        self.board = self.flight.board
        self.flight.arm()
        self.assertTrue(self.board.bench.is_enabled, "the stage stands under force")

    def off_after_ms(self, seconds=0.6):
        """Runs on; returns after how many milliseconds the enable has gone low."""
        start, known = self.board.now, len(self.board.bench.enables)
        self.board.run(seconds)
        changes = self.board.bench.enables[known:]
        self.assertTrue(changes, "the enable stays high")
        time, is_enabled = changes[0]
        self.assertFalse(is_enabled)
        return (time - start) / MS

    def test_guard_takes_it_when_the_main_loop_hangs(self):
        astray(self.board, HANGS)
        # 5 ms after the last round, at the next tick.
        self.assertTrue(4.0 <= self.off_after_ms() <= 6.1)
        self.assertEqual(self.board.processor.resets[0][1], "watchdog")

    def test_fault_of_the_processor_takes_it_at_once(self):
        astray(self.board, UNDEFINED)
        self.assertLess(self.off_after_ms(0.05), 0.1)

    def test_lock_up_leaves_it_until_the_watchdog(self):
        astray(self.board, OVERFLOWS)
        self.assertTrue(510 <= self.off_after_ms() <= 513)

    def test_limit_switch_takes_it_within_three_rounds_and_a_spike_does_not(self):
        inputs = self.board.chip.pins.inputs
        inputs["PC9"] = True
        self.board.run(0.0008)
        inputs["PC9"] = False
        self.board.run(0.01)
        self.assertTrue(self.board.bench.is_enabled)
        inputs["PC9"] = True
        self.assertLess(self.off_after_ms(0.02), 3.1)
        status = self.flight.status()
        self.assertEqual((status["state"], status["fault"]), ("fault", "limit switch"))

    def test_low_supply_takes_it_and_a_good_one_arms_again(self):
        self.board.chip.supply_is_low = True
        self.assertLess(self.off_after_ms(0.02), 2.1)
        status = self.flight.status()
        self.assertEqual((status["state"], status["fault"]), ("fault", "brown-out"))
        self.board.chip.supply_is_low = False
        self.board.run(1.5)
        self.assertTrue(self.board.bench.is_enabled)
        self.assertEqual(self.flight.status()["fault"], "V/H lost", "armed, without V/H")

    def test_request_to_restart_takes_it_and_the_place_is_lost(self):
        # As the button on the board.
        self.board.processor.reset("pin")
        self.assertFalse(self.board.bench.is_enabled)
        self.board.run(0.05)
        self.flight.prepare()
        self.assertTrue(self.flight.status()["is_place_lost"])
