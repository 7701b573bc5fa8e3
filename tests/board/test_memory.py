"""Memory that the firmware never reaches: each stray access is a fault of the processor."""

import struct
import unittest

from board import Board
from processor import ACCESS_FAULT, FETCH_FAULT
from support import BOOT_S, MS, astray, start_reason

CFSR = 0xE000_ED28

# Thumb instructions: an address in r0, and an access to it.
NULL, FLASH_START = (0x2000,), (0x2001, 0x06C0)
# 0x2000_0000 plus 64 KB, among the statics.
STATICS = (0x2002, 0x0700, 0x2101, 0x0409, 0x4308)
LOAD, STORE, JUMP = (0x6800,), (0x6000,), (0x3001, 0x4700)


def code(*instructions):
    """Returns instructions, with a loop behind them."""
    return struct.pack(f"<{len(instructions) + 1}H", *instructions, 0xE7FE)


class Memory(unittest.TestCase):
    image = host_sim = None

    def fault_of(self, *instructions):
        """Returns the fault that instructions lead to; the firmware is restarted after it."""
        board = Board(self.image)
        board.run(BOOT_S)
        before = board.now
        astray(board, code(*instructions))
        board.run(0.001)
        status = board.processor.private.get(CFSR, 0)
        board.run(0.05)
        ((time, cause),) = board.processor.resets
        self.assertEqual(cause, "software")
        self.assertLess(time - before, 45 * MS)
        self.assertEqual(start_reason(board), ("fault", True))
        return status

    def test_null_pointer_is_a_fault(self):
        self.assertEqual(self.fault_of(*NULL, *LOAD), ACCESS_FAULT)
        self.assertEqual(self.fault_of(*NULL, *STORE), ACCESS_FAULT)
        self.assertEqual(self.fault_of(*NULL, *JUMP), FETCH_FAULT)

    def test_image_in_flash_is_not_written(self):
        self.assertEqual(self.fault_of(*FLASH_START, *STORE), ACCESS_FAULT)

    def test_data_are_not_executed(self):
        self.assertEqual(self.fault_of(*STATICS, *JUMP), FETCH_FAULT)

    def test_flash_and_memory_in_use_are_reached(self):
        board = Board(self.image)
        board.run(BOOT_S)
        astray(board, code(*FLASH_START, *LOAD, *STATICS, *LOAD))
        board.run(0.0005)
        self.assertEqual(board.processor.private.get(CFSR, 0), 0)
