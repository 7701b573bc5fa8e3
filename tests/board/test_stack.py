"""Overflow of the stack, in the main loop and in an interrupt: what it meets, and what it leaves."""

import itertools
import unittest

from board import Board
from processor import ACCESS_FAULT, DTCM, DTCM_BYTES, FRAME_FAULT, HARD_FAULT, MPU_CTRL
from support import BOOT_S, LEAPS, MS, OVERFLOWS, Flight, astray, start_reason
from unicorn import arm_const as arm

CFSR = 0xE000_ED28
GUARD_BYTES = 1024
STACK_START = DTCM + 0xE000
# Ways to overflow: the code, and whether an interrupt does it.
WAYS = tuple(itertools.product((OVERFLOWS, LEAPS), (False, True)))


class Memory:
    """The memory of data when code goes astray, and when the handler of its fault begins."""

    def __init__(self, board, code, in_interrupt=False):
        self.processor = processor = board.processor
        enter = processor._enter

        def note(number):
            enter(number)
            if HARD_FAULT in processor.active and self.after is None:
                self.after = self.read()

        self.after = None
        processor._enter = note
        # No round comes between, which would change the statics.
        processor.stop_systick()
        astray(board, code, in_interrupt)
        self.stack = processor.uc.reg_read(arm.UC_ARM_REG_SP)
        self.before = self.read()
        board.run(0.001)
        assert self.after is not None, "no fault has come"

    def read(self):
        return bytes(self.processor.uc.mem_read(DTCM, DTCM_BYTES))

    def is_kept(self, start, end):
        """Returns whether memory between two addresses has stayed."""
        part = slice(start - DTCM, end - DTCM)
        return self.before[part] == self.after[part]


class Stack(unittest.TestCase):
    image = host_sim = None

    def booted(self):
        board = Board(self.image)
        board.run(BOOT_S)
        return board

    def test_overflow_overwrites_neither_statics_nor_what_is_on_the_stack(self):
        for code, in_interrupt in WAYS:
            with self.subTest(code=code.hex(), in_interrupt=in_interrupt):
                memory = Memory(self.booted(), code, in_interrupt)
                self.assertTrue(memory.is_kept(DTCM, DTCM + GUARD_BYTES), "guard")
                self.assertTrue(memory.is_kept(memory.stack, STACK_START), "stack")
                self.assertTrue(memory.is_kept(STACK_START, DTCM + DTCM_BYTES), "statics")
                # The stack was full: its lower end was written, or leapt over.
                if code is OVERFLOWS:
                    end = DTCM + GUARD_BYTES
                    self.assertFalse(memory.is_kept(end, end + 64))
                    status = memory.processor.private[CFSR]
                    self.assertEqual(status, ACCESS_FAULT | FRAME_FAULT)

    def test_without_the_protection_the_guard_is_overwritten(self):
        board = self.booted()
        board.processor._write_private(None, MPU_CTRL & 0xF_FFFF, 4, 0, None)
        memory = Memory(board, OVERFLOWS)
        self.assertFalse(memory.is_kept(DTCM, DTCM + GUARD_BYTES))

    def test_overflow_is_a_reason_of_the_start_of_its_own(self):
        for code, in_interrupt in WAYS:
            with self.subTest(code=code.hex(), in_interrupt=in_interrupt):
                board = self.booted()
                before = board.now
                astray(board, code, in_interrupt)
                board.run(0.06)
                ((time, cause),) = board.processor.resets
                self.assertEqual(cause, "software")
                # The handler waits for its log.
                self.assertTrue(10 * MS <= time - before <= 45 * MS, (time - before) / MS)
                self.assertEqual(start_reason(board), ("stack overflow", True))
                board.processor.reset("pin")
                self.assertEqual(start_reason(board), ("requested", False))

    def test_overflow_takes_the_force_closes_the_shutter_and_leaves_records_whole(self):
        for code, in_interrupt in WAYS:
            with self.subTest(code=code.hex(), in_interrupt=in_interrupt):
                self.overflow_in_an_exposure(code, in_interrupt)

    def overflow_in_an_exposure(self, code, in_interrupt):
        flight = Flight(self.image, self.host_sim)
        board, bench = flight.board, flight.board.bench
        flight.arm()
        bench.trigger(board.now + MS)
        board.run(0.5)
        (first,) = flight.records()
        self.assertEqual(first["outcome"], "exposed", first["reason"])
        bench.trigger(board.now + MS)
        while not bench.is_open:
            board.run(1e-4)
        self.assertTrue(bench.is_enabled)
        before = board.now
        astray(board, code, in_interrupt)
        board.run(0.06)
        for changes in (bench.enables, bench.commands):
            time, is_on = changes[-1]
            self.assertFalse(is_on)
            self.assertLess((time - before) / MS, 0.1)
        self.assertEqual(start_reason(board), ("stack overflow", True))
        self.assertFalse(bench.is_enabled or bench.is_open)
        # The flight goes on with nobody's help. The frame that was cut short has a record that says
        # so, and the next one is exposed without force.
        board.run(0.1)
        bench.trigger(board.now + MS)
        board.run(0.2)
        self.assertFalse(bench.is_enabled or bench.is_open)
        status = flight.status()
        self.assertEqual((status["state"], status["fault"]), ("degraded", "encoder"))
        found = status["after_reset"]
        self.assertEqual((found["boot"], found["outcome"]), (2, "FliesOn"))
        second, third = flight.records()
        self.assertEqual((second["outcome"], second["reason"]), ("refused", "unusable"))
        self.assertEqual(third["outcome"], "exposed", third["reason"])
        self.assertEqual(third.keys(), first.keys())
        self.assertIn("watchdog", third["faults"])
        self.assertIn("no compensation", third["flags"])
