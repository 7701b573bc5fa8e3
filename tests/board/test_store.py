"""The calibration in the second bank of the flash: stored over the link, found by a start, through
cuts of the supply and words that cannot be read."""

import json
import pathlib
import struct
import tempfile
import unittest

from board import CYCLES_PER_S
from flash import BANK_2, LOCK, SECTOR, WORD
from link import Link
from processor import ACCESS_FAULT, BUS_FAULT, CFSR
from support import BOOT_S, CAMERA, MS, Flight, astray, signed, start_reason
from unicorn import UC_PROT_READ, UC_PROT_WRITE

# Longest erasure of a sector in the data sheet, s, and the time after which the driver gives up, ten
# times the watchdog's.
LONGEST_ERASURE_S, GIVEN_UP_S = 4.0, 5.0
# Erasure where its time is not the point, cycles: serving the port keeps to real time.
SHORT_ERASURE = 20 * MS
# Word 0 of a slot is the commit word, the next are seals, and from here on comes the body.
BODY = 8
# Thumb instructions: the address of the bank in r0, a load from it, a store to it.
BANK_START = (0x2081, 0x0500)
LOAD, STORE_IT, HANG = 0x6800, 0x6000, 0xE7FE
# Number of the storage on the wire.
STORED = 1


class Store(unittest.TestCase):
    image = host_sim = kept = None

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def flight(self, **board):
        """Returns a board that has started."""
        flight = Flight(self.image, self.host_sim, **board)
        flight.board.chip.bank.erasure_cycles = SHORT_ERASURE
        return flight

    def restart(self, flight):
        """Switches the supply off and on."""
        board = flight.board
        board.processor.reset("power")
        self.start(board)

    def start(self, board):
        """Lets a board start whose supply has been off."""
        board.forget()
        board.chip.link.sent.clear()
        board.run(BOOT_S)

    def signed(self, flight, version):
        """Returns a camera file of this version, and its signature."""
        folder = pathlib.Path(self.folder.name)
        camera, signature = signed(flight, folder, version, CAMERA.read_text())
        return "--camera", camera, "--signature", signature

    def store(self, flight, version, code=0):
        return flight.camera("store", "--json", *self.signed(flight, version), code=code)

    def stored(self, flight):
        return json.loads(flight.camera("stored", "--json"))

    def version(self, flight):
        return self.stored(flight)["calibration"]["version"]

    def two_stored(self, unreadable=(), corrected=()):
        """Returns a bank with version 1 in the first slot and version 2 in the second, and with words
        that have wrong bits."""
        if self.kept is None:
            flight = self.flight()
            for version in (1, 2):
                self.store(flight, version)
            Store.kept = flight.board.chip.bank
        self.kept.unreadable, self.kept.corrected = set(unreadable), set(corrected)
        return self.kept

    def test_calibration_is_stored_and_in_use_after_a_start_without_any_load(self):
        flight = self.flight()
        bank = flight.board.chip.bank
        self.assertEqual(self.stored(flight)["slot_faults"], ["blank", "blank"])
        self.assertEqual(json.loads(self.store(flight, 1))["calibration"]["version"], 1)
        self.assertEqual(flight.board.processor.resets, [])
        # One sector was erased, and each word written once.
        self.assertEqual(bank.operations[0], ("erase", 0))
        words = [offset for name, offset in bank.operations if name == "write"]
        self.assertEqual(len(words), len(bank.operations) - 1)
        self.assertEqual(len(words), len(set(words)))
        self.assertEqual(words, [*range(BODY * WORD, words[-3] + WORD, WORD), 0, WORD])
        self.restart(flight)
        stored = self.stored(flight)
        self.assertEqual((stored["slot"], stored["is_sealed"]), (0, True))
        calibration = stored["calibration"]
        self.assertEqual((calibration["serial"], calibration["version"]), ("5282", 1))
        # What is in use, without any load.
        serial, version, crc, storage = Link(flight.board).calibration
        self.assertEqual((serial, version, storage), ("5282", 1, STORED))
        self.assertEqual(int(calibration["crc32"], 16), crc)

    def test_erasure_that_does_not_end_is_given_up_and_the_watchdog_does_not_bite(self):
        flight = self.flight()
        board, bank = flight.board, flight.board.chip.bank
        bank.erasure_cycles = round((GIVEN_UP_S + 1.0) * CYCLES_PER_S)
        before = board.now
        errors = self.store(flight, 1, code=3)
        self.assertIn("slot 0 is not erased", " ".join(errors.split()))
        waited_s = (board.now - before) / CYCLES_PER_S
        self.assertGreater(waited_s, GIVEN_UP_S)
        self.assertGreater(GIVEN_UP_S, LONGEST_ERASURE_S)
        # The link answers while the bank is still busy, and rounds go on.
        self.assertIsNotNone(bank.doing)
        Link(board)
        self.assertEqual(board.processor.resets, [])
        board.run(1.0)
        self.assertIsNone(bank.doing)
        bank.erasure_cycles = SHORT_ERASURE
        self.store(flight, 1)
        self.assertEqual(self.version(flight), 1)
        flight.arm()
        board.bench.trigger(board.now + MS)
        board.run(0.5)
        (record,) = flight.records()
        self.assertEqual(record["outcome"], "exposed", record["reason"])

    def test_bank_can_be_written_only_while_the_store_does_so(self):
        opened = []
        flight = self.flight()
        board, bank = flight.board, flight.board.chip.bank
        begin = bank._begin

        def note(*operation):
            opened.append(board.processor.permissions(BANK_2))
            begin(*operation)

        bank._begin = note
        self.store(flight, 1)
        self.assertEqual(set(opened), {UC_PROT_READ | UC_PROT_WRITE})
        self.assertEqual(board.processor.permissions(BANK_2), UC_PROT_READ)
        self.assertTrue(bank.control & LOCK)
        before = bytes(bank.data)
        self.assertEqual(self.fault_of(board, *BANK_START, STORE_IT), ACCESS_FAULT)
        self.assertEqual(before, bytes(bank.data))
        self.assertEqual(start_reason(board), ("fault", True))
        self.assertEqual(self.version(flight), 1)

    def fault_of(self, board, *instructions):
        """Returns the fault that instructions lead to."""
        astray(board, struct.pack(f"<{len(instructions) + 1}H", *instructions, HANG))
        board.run(0.001)
        status = board.processor.private.get(CFSR, 0)
        board.run(0.05)
        return status

    def test_word_that_cannot_be_read_is_a_fault_of_its_slot_and_the_other_is_used(self):
        for word in (0, BODY + 3):
            with self.subTest(word=word):
                flight = self.flight(bank=self.two_stored(unreadable={SECTOR + word * WORD}))
                stored = self.stored(flight)
                self.assertEqual((stored["slot"], stored["calibration"]["version"]), (0, 1))
                self.assertIn(f"word {word}", stored["slot_faults"][1])
                self.assertEqual(Link(flight.board).calibration[1], 1)
                self.assertEqual(flight.board.processor.resets, [])
                self.assertEqual(flight.board.chip.bank.status, 0)

    def test_damage_of_both_slots_is_named_and_the_link_answers_and_takes_a_store(self):
        damaged = {BODY * WORD, SECTOR + (BODY + 1) * WORD}
        flight = self.flight(bank=self.two_stored(unreadable=damaged))
        stored = self.stored(flight)
        self.assertIsNone(stored["calibration"])
        for word, fault in zip((BODY, BODY + 1), stored["slot_faults"]):
            self.assertIn(f"word {word}", fault)
        link = Link(flight.board)
        self.assertIsNone(link.calibration)
        self.assertEqual(link.cause, "power on")
        self.store(flight, 3)
        self.restart(flight)
        self.assertEqual(self.version(flight), 3)

    def test_bit_that_the_ecc_corrects_changes_nothing(self):
        weak = {SECTOR, SECTOR + BODY * WORD}
        flight = self.flight(bank=self.two_stored(corrected=weak))
        self.assertEqual(self.version(flight), 2)
        self.assertEqual(flight.board.chip.bank.status, 0)

    def test_model_restarts_firmware_that_reads_such_a_word_as_memory(self):
        flight = self.flight()
        board = flight.board
        board.chip.bank.unreadable.add(0)
        self.assertEqual(self.fault_of(board, *BANK_START, LOAD), BUS_FAULT)
        self.assertEqual(start_reason(board), ("fault", True))

    def test_model_answers_from_the_cache_where_the_protection_does_not_hold(self):
        flight = self.flight()
        flight.board.processor.caches = lambda address: True
        refused = flight.camera("store", *self.signed(flight, 1), code=3)
        self.assertIn("otherwise than it was written", refused)

    def test_store_that_the_supply_cuts_leaves_the_calibration_before_or_the_new_one(self):
        kept = self.two_stored()
        # Operations of the second store: a further seal, the erasure, the body, commit word and seal.
        start = kept.operations.index(("erase", SECTOR)) - 1
        commit = kept.operations.index(("write", SECTOR)) - start
        found = []
        for number in (0, 1, commit // 2, commit, commit + 1):
            with self.subTest(number=number):
                found.append(self.version_after_cut(kept, number))
        # Before the commit word nothing has changed; after it all has.
        self.assertEqual(set(found[:-2]), {2})
        self.assertEqual(found[-1], 3)

    def version_after_cut(self, kept, number):
        flight = self.flight(bank=kept, seed=number)
        board, bank = flight.board, flight.board.chip.bank

        def cut(half_way):
            if half_way == number:
                board.processor.reset("power")

        bank.half_way = cut
        store = ("store", *self.signed(flight, 3))
        device = ("--device", f"serial:{board.path}")
        before = len(board.processor.resets)
        board.serve_until(
            lambda: len(board.processor.resets) > before,
            self.host_sim, "camera", *device, *store,
        )  # fmt: skip
        bank.half_way = None
        self.assertEqual(len(bank.operations), number + 1)
        self.start(board)
        version = self.version(flight)
        self.assertIn(version, (2, 3))
        self.assertEqual(Link(board).calibration[1], version)
        if number == 1:
            # The next store, with a good supply, is whole.
            self.store(flight, 4)
            self.assertEqual(self.version(flight), 4)
        return version

    def test_flash_that_does_not_take_it_is_named_and_the_calibration_before_stays(self):
        kept = self.two_stored()
        for change, reason in (
            ({"protected": {0}}, "slot 0 is not erased"),
            ({"worn": {(BODY + 1) * WORD}}, f"does not take word {BODY + 1}"),
        ):
            with self.subTest(change=change):
                flight = self.flight(bank=kept)
                bank = flight.board.chip.bank
                for name, value in change.items():
                    setattr(bank, name, value)
                self.assertIn(reason, " ".join(self.store(flight, 3, code=3).split()))
                self.assertEqual(self.version(flight), 2)
                self.assertTrue(bank.control & LOCK)
                self.assertEqual(bank.status, 0)
                self.assertEqual(flight.board.processor.permissions(BANK_2), UC_PROT_READ)

    def test_store_is_refused_while_the_camera_is_armed_and_while_the_supply_is_low(self):
        flight = self.flight()
        bank = flight.board.chip.bank
        arguments = self.signed(flight, 1)
        flight.arm()
        self.store_refused(flight, arguments)
        flight.camera("disarm")
        flight.board.chip.supply_is_low = True
        flight.board.run(0.01)
        self.store_refused(flight, arguments)
        # Records have sectors of their own.
        self.assertTrue(all(offset >= 2 * SECTOR for _, offset in bank.operations))

    def store_refused(self, flight, arguments):
        flight.camera("store", *arguments, code=3)
