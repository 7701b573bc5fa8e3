"""Instructions that the processor leaves out, one at a time, while a signature is checked that is not
that of the camera's key."""

import pathlib
import tempfile
import unittest

from skips import Names, apart, skip, watch, wrong_ones
from support import CAMERA, MS, Flight

# Time in which the order to store is answered, and the time from one message to the next.
ANSWERED_S, MESSAGE_S = 0.1, 0.03
# Code that decides; left out are the arithmetic of curve and hash, whose errors make a point that is
# not that of the signature, and what reads and writes messages.
DECIDES = ("2io5store", "4link7storing", "4link5shelf")
# Least number of its instructions.
LEAST = 1000


class SignatureSkips(unittest.TestCase):
    image = host_sim = None

    def test_no_skipped_instruction_stores_a_calibration_that_is_not_signed_by_the_cameras_key(self):
        *before, order = self.messages()
        board = self.board().board
        for message in before:
            board.chip.link.put(message)
            board.run(MESSAGE_S)
        board.chip.link.sent.clear()
        board.chip.link.put(order)
        self.assertFalse(apart(lambda: stores(board)), "without a skip")
        names = Names(self.image)
        watched = [
            place for place in apart(lambda: watch(board, ANSWERED_S))
            if any(name in names.of(place[0]) for name in DECIDES)
        ]  # fmt: skip
        self.assertGreater(len(watched), LEAST)

        def goes_wrong(place):
            skip(board, *place)
            return stores(board)

        self.assertEqual(wrong_ones(self.image, watched, goes_wrong), [])

    def board(self):
        flight = Flight(self.image, self.host_sim)
        flight.board.chip.bank.erasure_cycles = MS
        return flight

    def messages(self):
        """Returns the messages by which `host-sim` orders a store that is signed by another key; the
        control is signed by the camera's."""
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            flight = self.board()
            board = flight.board
            keys, camera, signature = (folder / it for it in ("keys", "camera.toml", "other.json"))
            camera.write_text('serial = "5282"\nversion = 1\n' + CAMERA.read_text())
            board.client(self.host_sim, "sign", "key", "--out", keys)
            sign = ("sign", "--camera", camera, "--out", signature, "--key")
            board.client(self.host_sim, *sign, keys / "private-key.pem")
            sent, put = bytearray(), board.chip.link.put
            board.chip.link.put = lambda data: (sent.extend(data), put(data))
            store = ("store", "--camera", camera, "--signature", signature)
            self.assertIn("signature", flight.camera(*store, code=3))
            self.assertEqual(board.chip.bank.operations, [])
            board.chip.link.put = put
            key = CAMERA.parents[2] / "keys/test-private-key.pem"
            board.client(self.host_sim, "sign", "--camera", camera, "--out", folder / "own.json",
                         "--key", key)  # fmt: skip
            flight.camera("store", "--camera", camera, "--signature", folder / "own.json")
            self.assertNotEqual(board.chip.bank.operations, [], "the control is not stored")
        return [bytes(message) + b"\0" for message in sent.split(b"\0") if message]


def stores(board):
    """Returns true if anything is stored before the order is answered."""
    end = board.now + round(ANSWERED_S * 1000 * MS)
    while not board.chip.bank.operations and not board.chip.link.sent and board.now < end:
        board.run(0.001)
    return bool(board.chip.bank.operations)
