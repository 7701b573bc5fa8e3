"""The client in Python, and a program that reads beside one that flies."""

import pathlib
import sys
import unittest

from link import Link
from support import MS, Flight

CLIENT = pathlib.Path(__file__).parents[2] / "examples/link_client.py"


class Client(unittest.TestCase):
    image = host_sim = None

    def test_client_of_the_example_reads_identity_state_and_records_beside_another_session(self):
        flight = Flight(self.image, self.host_sim)
        board = flight.board
        self.assertIn("not prepared", board.client(sys.executable, CLIENT, board.path))
        flight.arm()
        for trigger in range(3):
            board.bench.trigger(board.now + (1 + trigger) * MS)
        board.run(0.5)
        # A session that flies: its next request is taken after the other program has come.
        flying = Link(board)
        printed = board.client(sys.executable, CLIENT, board.path)
        self.assertIn("board nucleo-h743zi", printed)
        self.assertIn("state: degraded", printed)
        self.assertEqual(printed.splitlines()[2:], ["record 1", "record 2", "record 3"])
        self.assertEqual(flying.counters()["other_session"], 0)
        self.assertTrue(board.bench.is_enabled)
        self.assertEqual(len(flight.records()), 3)
        flying.counters()
