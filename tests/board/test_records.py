"""Records in the second bank of the flash: found after the supply has failed in flight, and written
beside the rounds of the control loop."""

import unittest

from board import CYCLES_PER_S
from flash import SECTOR, WORD
from support import BOOT_S, MS, Flight

# The six sectors behind those of the calibration, and the words of an entry.
FIRST, ENTRY_WORDS = 2 * SECTOR, 6
# Erasure where its time is not the point, cycles.
SHORT_ERASURE = 20 * MS
# Longest erasure of a sector in the data sheet, s.
LONGEST_ERASURE_S = 4.0
# Time in which a frame ends and its record is written.
FRAME_S = 0.3


class Records(unittest.TestCase):
    image = host_sim = None

    def armed(self, erasure_cycles=SHORT_ERASURE, **board):
        """Returns a flight that is armed, with what its prepared camera has written."""
        flight = Flight(self.image, self.host_sim, **board)
        flight.board.chip.bank.erasure_cycles = erasure_cycles
        flight.arm()
        flight.board.run(0.1)
        return flight

    def expose(self, flight):
        board = flight.board
        board.bench.trigger(board.now + MS)
        board.run(FRAME_S)

    def cut(self, flight):
        """Switches the supply off and on."""
        board = flight.board
        board.processor.reset("power")
        board.forget()
        board.chip.link.sent.clear()
        board.run(BOOT_S)

    def after_reset(self, flight):
        return flight.status()["after_reset"]

    def numbers(self, records):
        names = ("sequence", "boot", "flight")
        return [tuple(int(record[name]) for name in names) for record in records]

    def test_supply_that_fails_in_flight_leaves_the_records_and_their_numbers(self):
        flight = self.armed()
        bank = flight.board.chip.bank
        for _ in range(4):
            self.expose(flight)
        # Each word was written once, in sectors that were erased.
        words = [offset for name, offset in bank.operations if name == "write"]
        self.assertEqual(len(words), len(set(words)))
        self.assertTrue(all(offset >= FIRST for offset in words))
        self.assertEqual(flight.status()["in_flash"], {"AllBut": 0})
        self.cut(flight)
        found = self.after_reset(flight)
        self.assertEqual((found["outcome"], found["boot"], found["flight"]), ("FromFlash", 2, 1))
        self.assertEqual((found["records"], found["damaged"]), (4, 0))
        self.assertEqual(found["without_eyes"], "Unknown")
        records = flight.records()
        self.assertEqual(self.numbers(records), [(number, 1, 1) for number in range(1, 5)])
        self.assertEqual({record["outcome"] for record in records}, {"exposed"})
        # What was fetched does not come again.
        flight.board.run(0.1)
        self.cut(flight)
        flight.prepare()
        self.expose(flight)
        self.assertEqual(self.numbers(flight.records()), [(1, 3, 2)])

    def test_supply_that_fails_while_a_record_is_written_loses_no_other(self):
        for word in (0, 3, 5):
            with self.subTest(word=word):
                flight = self.armed(seed=word)
                board, bank = flight.board, flight.board.chip.bank
                for _ in range(2):
                    self.expose(flight)
                number = len(bank.operations) + word

                def cut(half_way):
                    if half_way == number:
                        board.processor.reset("power")

                bank.half_way = cut
                before = len(board.processor.resets)
                board.bench.trigger(board.now + MS)
                for _ in range(round(FRAME_S * 1000)):
                    if len(board.processor.resets) == before:
                        board.run(1e-3)
                self.assertEqual(len(board.processor.resets), before + 1)
                bank.half_way = None
                # The supply stays off for a while.
                self.cut(flight)
                self.assertEqual(self.after_reset(flight)["outcome"], "FromFlash")
                records = flight.records()
                self.assertEqual(self.numbers(records)[:2], [(1, 1, 1), (2, 1, 1)])
                self.assertEqual({record["outcome"] for record in records[:2]}, {"exposed"})
                self.assertLessEqual(len(records), 3)

    def test_sector_is_erased_beside_the_rounds_and_triggers_are_answered_meanwhile(self):
        flight = self.armed(erasure_cycles=round(LONGEST_ERASURE_S * CYCLES_PER_S))
        board, bank = flight.board, flight.board.chip.bank
        self.assertEqual(bank.operations, [("erase", FIRST)])
        self.assertIsNotNone(bank.doing)
        for _ in range(2):
            self.expose(flight)
        self.assertIsNotNone(bank.doing)
        self.assertEqual(flight.status()["in_flash"], {"AllBut": 2})
        board.run(LONGEST_ERASURE_S)
        self.assertIsNone(bank.doing)
        status = flight.status()
        self.assertEqual((status["late_rounds"], status["in_flash"]), (0, {"AllBut": 0}))
        self.assertEqual(board.processor.resets, [])
        self.cut(flight)
        records = flight.records()
        self.assertEqual({record["outcome"] for record in records}, {"exposed"})
        self.assertEqual(len(records), 2)

    def test_word_that_cannot_be_read_costs_its_record_and_no_start(self):
        flight = self.armed()
        board, bank = flight.board, flight.board.chip.bank
        for _ in range(3):
            self.expose(flight)
        # The last entries are those of the records.
        words = [offset for name, offset in bank.operations if name == "write"]
        bank.unreadable.add(words[-2 * ENTRY_WORDS])
        self.assertEqual(words[-2 * ENTRY_WORDS] % WORD, 0)
        self.cut(flight)
        self.assertEqual(self.after_reset(flight)["damaged"], 1)
        records = flight.records()
        reasons = [record["reason"] for record in records]
        self.assertEqual(reasons, ["", "unusable", ""])
        self.assertEqual([cause for _, cause in board.processor.resets], ["power"])
