"""Force on the stage: what takes it away, and how soon."""

import tempfile
import unittest

from support import HANGS, LOCKS_UP, MS, UNDEFINED, Flight, astray, settings, start_reason


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

    def goes_off_now(self, happens):
        """Checks that enable and pulses are low as soon as something happens, without an instruction
        of the processor."""
        self.assertTrue(self.board.bench.is_enabled)
        happens()
        self.assertEqual(self.board.bench.enables[-1], (self.board.now, False))
        self.assertEqual(self.board.bench.duty, 0.0)

    def test_lock_up_takes_it_at_once_and_the_watchdog_restarts(self):
        astray(self.board, LOCKS_UP)
        self.assertLess(self.off_after_ms(), 0.1)
        self.assertEqual(self.board.bench.duty, 0.0)
        ((_, cause),) = self.board.processor.resets
        self.assertEqual(cause, "watchdog")

    def test_brake_takes_it_without_software_and_a_broken_wire_is_a_brake(self):
        board, chip = self.board, self.board.chip
        for number, (level, pulled) in enumerate((("High", True), ("Low", False))):
            with self.subTest(level), tempfile.TemporaryDirectory() as folder:
                self.flight.camera("disarm")
                board.run(0.5)
                chip.set_brake(not pulled)
                path = settings(folder, f'[inputs]\nbrake = "{level}"\n')
                self.flight.prepare(path)
                self.flight.camera("arm")
                self.goes_off_now(lambda: chip.set_brake(pulled))
                board.run(0.002)
                self.assertEqual(self.flight.status()["fault"], "drive")
                # It does not come back by itself, and not while the brake is pulled.
                self.flight.camera("clear-fault")
                board.run(0.4)
                self.assertFalse(board.bench.is_enabled)
                chip.set_brake(not pulled)
                board.run(0.4)
                self.assertFalse(board.bench.is_enabled)
                self.flight.camera("clear-fault")
                self.flight.camera("arm")
                board.run(0.4)
                self.assertTrue(board.bench.is_enabled, self.flight.status())
                # A spike that the filter rejects is none.
                chip.set_brake(pulled, width_ns=30.0)
                self.assertTrue(board.bench.is_enabled)
                # The main loop has nothing to do with it.
                if number == 0:
                    self.goes_off_now(lambda: chip.set_brake(None))
                else:
                    astray(board, HANGS)
                    self.goes_off_now(lambda: chip.set_brake(None))

    def test_brake_without_a_setting_is_no_input(self):
        for level in (True, False, None):
            self.board.chip.set_brake(level)
            self.board.run(0.01)
            self.assertTrue(self.board.bench.is_enabled, level)

    def test_clock_that_fails_takes_it_and_the_firmware_waits_for_the_clock(self):
        board, chip = self.board, self.board.chip
        self.goes_off_now(chip.fail_clock)
        board.run(2.0)
        causes = [cause for _, cause in board.processor.resets]
        self.assertEqual(causes[:3], ["software", "watchdog", "watchdog"])
        self.assertFalse(board.bench.is_enabled)
        chip.clock_has_failed = False
        board.run(0.6)
        self.assertEqual(start_reason(board), ("watchdog", True))

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

    def test_low_supply_takes_it_without_software_and_a_good_one_arms_again(self):
        self.goes_off_now(lambda: setattr(self.board.chip, "supply_is_low", True))
        self.board.run(0.02)
        status = self.flight.status()
        self.assertEqual((status["state"], status["fault"]), ("fault", "brown-out"))
        self.board.chip.supply_is_low = False
        self.board.run(1.5)
        self.assertTrue(self.board.bench.is_enabled)
        self.assertEqual(self.flight.status()["fault"], "V/H lost", "armed, without V/H")

    def test_dip_of_the_supply_between_two_rounds_makes_the_camera_arm_anew(self):
        board, chip = self.board, self.board.chip
        self.goes_off_now(lambda: setattr(chip, "supply_is_low", True))
        board.run(0.0001)
        chip.supply_is_low = False
        self.assertFalse(board.bench.is_enabled, "it comes back without the control loop")
        board.run(0.01)
        # The brown-out is over as soon as it is seen; the stage makes its strokes again.
        status = self.flight.status()
        self.assertEqual((status["state"], status["fault"]), ("fly-back", None))
        board.run(1.5)
        self.assertTrue(board.bench.is_enabled)
        self.assertEqual(self.flight.status()["fault"], "V/H lost", "armed, without V/H")

    def test_request_to_restart_takes_it_and_the_place_is_lost(self):
        # As the button on the board.
        self.board.processor.reset("pin")
        self.assertFalse(self.board.bench.is_enabled)
        # The flight goes on by itself, without force.
        self.board.run(0.2)
        status = self.flight.status()
        self.assertTrue(status["is_place_lost"])
        self.assertEqual((status["state"], status["fault"]), ("degraded", "encoder"))
        self.assertFalse(self.board.bench.is_enabled)
