"""Edges on the capture inputs, and a link that is flooded."""

import unittest

from link import Link
from support import MS, Flight


class Edges(unittest.TestCase):
    image = host_sim = None

    def setUp(self):
        self.flight = Flight(self.image, self.host_sim)
        self.board = self.flight.board
        self.flight.prepare()

    def test_three_hundred_edges_in_two_ms_delay_no_round_and_hide_no_other_edge(self):
        board, start = self.board, self.board.now + 10 * MS
        for edge in range(300):
            board.bench.trigger(start + edge * 2 * MS // 300)
        closed = start + MS
        board.processor.at(closed, lambda: board.chip.edge("PB11", closed))
        board.run(0.05)
        status = self.flight.status()
        self.assertEqual(status["late_rounds"], 0)
        self.assertEqual(status["unexpected_edges"], 1, "the shutter's edge among them")
        # Each line keeps 8 of a round; what it loses is counted, overwritten ones as one.
        self.assertTrue(8 <= status["triggers"] <= 32, status)
        self.assertGreater(status["lost_events"], 0)
        # The line works again.
        before = status["triggers"]
        board.bench.trigger(board.now + MS)
        board.run(0.01)
        self.assertEqual(self.flight.status()["triggers"], before + 1)

    def test_pulse_is_stamped_from_forty_ns_on(self):
        board, stamps = self.board, []
        for index, width_ns in enumerate((10.0, 34.0, 40.0, 100.0)):
            time = board.now + (10 + 10 * index) * MS + 137 * index
            if width_ns >= 40.0:
                stamps.append((time, width_ns))
            board.bench.trigger(time, width_ns)
        board.run(0.06)
        records = self.flight.records()
        self.assertEqual([record["reason"] for record in records], ["not armed"] * 2)
        expected = [board.chip.clock.count(time) for time, _ in stamps]
        self.assertEqual([int(record["trigger_us"]) for record in records], expected)

    def test_two_edges_between_two_rounds_are_two_stamps(self):
        board = self.board
        first = board.now + 10 * MS
        times = [first, first + MS // 4]
        for time in times:
            board.bench.trigger(time)
        board.run(0.03)
        stamps = [int(record["trigger_us"]) for record in self.flight.records()]
        self.assertEqual(stamps, [board.chip.clock.count(time) for time in times])

    def test_flood_on_the_link_delays_no_round_and_the_link_answers_after_it(self):
        board = self.board
        flood = board.random.randbytes(20_000)
        board.chip.link.put(flood)
        before = board.now
        while board.chip.link.waiting:
            board.run(0.01)
        self.assertGreater(board.now - before, 200 * MS, "20,000 bytes take 218 ms")
        board.run(0.01)
        link = Link(board)
        counters = link.counters()
        self.assertEqual(counters["overrun_bytes"], 0)
        damaged = sum(counters[name] for name in ("truncated", "oversized", "wrong_crc"))
        self.assertGreater(damaged, 10)
        self.assertEqual(self.flight.status()["late_rounds"], 0)
