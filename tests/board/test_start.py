"""Start of the image: clocks, identity, and the reason it gives for every kind of start."""

import unittest

from board import CYCLES_PER_S, Board
from chip import FUNCTIONS, RCC
from link import Link
from support import BOOT_S, HANGS, LOCKS_UP, MS, UNDEFINED, astray, start_reason
from timers import BDTR


class Start(unittest.TestCase):
    image = host_sim = None

    def booted(self, seconds=BOOT_S):
        board = Board(self.image)
        board.run(seconds)
        return board

    def test_clock_tree_is_that_of_the_document(self):
        board = self.booted()
        registers = board.chip.registers
        source = registers[RCC + 0x28]
        divisors = registers[RCC + 0x30]
        self.assertEqual(source & 3, 2, "the PLL is fed by the ST-LINK")
        vco_mhz = 8 / (source >> 4 & 0x3F) * ((divisors & 0x1FF) + 1)
        core_mhz = vco_mhz / ((divisors >> 9 & 0x7F) + 1)
        self.assertEqual((vco_mhz, core_mhz), (800, 400))
        self.assertEqual(registers[RCC + 0x10] & 7, 3, "the processor runs from the PLL")
        domains = [registers[RCC + at] for at in (0x18, 0x1C, 0x20)]
        # Half of 400 MHz for the buses, half of that for peripherals; timers get twice theirs.
        self.assertEqual([domain & 0x7FF for domain in domains], [0x48, 0x440, 0x40])
        # 921,600 baud by the nearest divider of 100 MHz.
        self.assertEqual(board.chip.link.registers[0x0C], 109)

    def test_power_on_is_told_and_the_main_loop_runs(self):
        board = Board(self.image)
        self.assertEqual(start_reason(board), ("power on", False))
        link = Link(board)
        self.assertEqual(link.name, "nucleo-h743zi")
        counters = link.counters()
        self.assertLess(counters["stack_used_bytes"], 40 * 1024)
        self.assertGreater(counters["stack_used_bytes"], 0)
        levels = set()
        for _ in range(12):
            board.run(0.1)
            levels.add(board.chip.pins.is_high("PB0"))
        self.assertEqual(levels, {False, True}, "the green light does not blink")
        self.assertEqual(board.processor.resets, [])

    def test_no_force_and_no_light_before_anything_is_asked(self):
        board = self.booted(0.6)
        self.assertEqual(board.bench.enables, [(0, False)])
        self.assertEqual(board.bench.commands, [])
        self.assertEqual(board.bench.stage.position_mm, 0.0)

    def test_every_pin_has_its_peripheral(self):
        pins = self.booted().chip.pins
        for name in FUNCTIONS:
            self.assertTrue(pins.has_function(name), name)
        for name in ("PE10", "PB0", "PB14"):
            self.assertTrue(pins.is_output(name), name)
        # Resistors inside the chip: up for the link and tracks, down for edges.
        down = ("PA0", "PB3", "PB10", "PB11", "PD14", "PE15")
        up = ("PD12", "PD13", "PC8", "PC9", "PD9", "PD6", "PE7")
        for name, pull in [(name, 2) for name in down] + [(name, 1) for name in up]:
            self.assertEqual(pins.pull(name), pull, name)

    def test_main_loop_that_hangs_is_restarted_by_the_watchdog(self):
        board = self.booted()
        hung = board.now
        astray(board, HANGS)
        board.run(0.6)
        ((time, cause),) = board.processor.resets
        self.assertEqual(cause, "watchdog")
        # The last feeding was at most a round before; 512 ms of the oscillator.
        self.assertTrue(510 * MS <= time - hung <= 513 * MS, (time - hung) / MS)
        self.assertEqual(start_reason(board), ("watchdog", True))

    def test_rounds_that_fail_are_restarted_by_the_watchdog(self):
        board = self.booted()
        stopped = board.now
        board.processor.stop_systick()
        # The link keeps the main loop awake.
        while board.now < stopped + CYCLES_PER_S and not board.processor.resets:
            board.chip.link.put(b"\0")
            board.run(0.002)
        ((time, cause),) = board.processor.resets
        self.assertEqual(cause, "watchdog")
        self.assertTrue(510 * MS <= time - stopped <= 520 * MS, (time - stopped) / MS)
        self.assertEqual(start_reason(board), ("watchdog", True))

    def test_fault_of_the_processor_restarts_after_its_log(self):
        board = self.booted()
        before = board.now
        astray(board, UNDEFINED)
        board.run(0.06)
        ((time, cause),) = board.processor.resets
        self.assertEqual(cause, "software")
        self.assertTrue(10 * MS <= time - before <= 45 * MS, (time - before) / MS)
        self.assertEqual(start_reason(board), ("fault", True))
        # The mark is gone: the next start is told as it is.
        board.processor.reset("pin")
        self.assertEqual(start_reason(board), ("requested", False))

    def test_lock_up_is_restarted_by_the_watchdog(self):
        board = self.booted()
        before = board.now
        astray(board, LOCKS_UP)
        board.run(0.01)
        self.assertTrue(board.processor.locked)
        board.run(0.6)
        ((time, cause),) = board.processor.resets
        self.assertEqual(cause, "watchdog")
        self.assertTrue(510 * MS <= time - before <= 513 * MS)
        self.assertEqual(start_reason(board), ("watchdog", True))

    def test_brown_out_counts_as_power_on_whatever_memory_holds(self):
        board = self.booted()
        astray(board, UNDEFINED)
        # The mark of the fault is in memory when the power fails.
        board.run(0.01)
        board.processor.reset("brown-out")
        self.assertEqual(start_reason(board), ("power on", False))
        board.forget()
        board.processor.reset("power")
        self.assertEqual(start_reason(board), ("power on", False))

    def test_reset_by_pin_is_told_as_requested(self):
        board = self.booted()
        board.processor.reset("pin")
        self.assertEqual(start_reason(board), ("requested", False))
        self.assertEqual(board.chip.motor.registers[BDTR] >> 15 & 1, 1)
