"""Edges on the capture inputs, and a link that is flooded."""

import tempfile
import unittest

from bench import sentence
from link import Link
from support import MS, Flight, settings


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

    def test_filter_and_edge_of_the_trigger_are_those_of_the_settings(self):
        board, expected = self.board, []
        lines = '[inputs]\nshortest_pulse_ns = 1000\ntrigger = "Falling"\n'
        with tempfile.TemporaryDirectory() as folder:
            self.flight.prepare(settings(folder, lines))
        self.assertEqual(board.chip.pins.pull("PA0"), 1, "a line that idles high is pulled up")
        # The longest filter that lets 1000 ns pass has 960 ns.
        for index, width_ns in enumerate((40.0, 900.0, 1000.0, 5000.0)):
            time = board.now + (10 + 10 * index) * MS + 137 * index
            if width_ns >= 1000.0:
                expected.append(board.chip.clock.count(time + round(0.4 * width_ns)))
            board.bench.trigger(time, width_ns)
        board.run(0.06)
        stamps = [int(record["trigger_us"]) for record in self.flight.records()]
        self.assertEqual(stamps, expected)

    def test_settings_of_every_line_reach_its_timer_and_the_next_flight_sets_them_back(self):
        chip = self.board.chip
        lines = ("trigger", "time_pulse", "shutter_opened", "shutter_closed")

        def falling():
            stamps = [chip.clock.is_falling(channel) for channel in range(4)]
            return [*stamps, chip.encoder.is_falling(2)]

        for number, name in enumerate((*lines, "index")):
            with tempfile.TemporaryDirectory() as folder:
                text = f'[inputs]\n{name} = "Falling"\nshortest_track_ns = 20\n'
                self.flight.prepare(settings(folder, text))
            self.assertEqual(falling(), [place == number for place in range(5)], name)
            self.assertEqual([chip.encoder.filter_ns(track) for track in (0, 1)], [20.0, 20.0])
            self.assertEqual(chip.encoder.filter_ns(2), 40.0)
        self.flight.prepare()
        self.assertEqual(falling(), [False] * 5)
        self.assertEqual(chip.encoder.filter_ns(0), 40.0)
        self.assertEqual(self.flight.status()["unexpected_edges"], 0)

    def test_wires_of_receiver_and_autopilot_run_at_the_speeds_of_the_settings(self):
        chip = self.board.chip

        def dividers():
            return [port.registers[0x0C] for port in (chip.receiver, chip.autopilot)]

        self.assertEqual(dividers(), [2604, 1736])
        with tempfile.TemporaryDirectory() as folder:
            lines = "[inputs]\nreceiver_baud = 9600\nautopilot_baud = 115200\n"
            self.flight.prepare(settings(folder, lines))
        self.assertEqual(dividers(), [10417, 868])
        chip.receiver.put(sentence(5))
        self.board.run(0.2)
        receiver = self.flight.status()["instruments"]["receiver"]
        self.assertEqual((receiver["read"], receiver["lost_bytes"]), (1, 0))

    def test_settings_that_are_refused_are_named_with_their_range(self):
        for text, parts in (
            ("shortest_pulse_ns = -1", ("shortest_pulse_ns", "0 to 100000")),
            ("shortest_track_ns = 1e9", ("shortest_track_ns", "0 to 100000")),
            ('brake = "Sometimes"', ("Sometimes", "Unused")),
            ('trigger = "Both"', ("Both", "Falling")),
            ("filter = 3", ("inputs.filter",)),
            ("receiver_baud = 300", ("receiver_baud", "2400 to 1000000")),
            ("autopilot_baud = 2e6", ("autopilot_baud", "2400 to 1000000")),
        ):
            with tempfile.TemporaryDirectory() as folder, self.assertRaises(AssertionError) as said:
                self.flight.prepare(settings(folder, f"[inputs]\n{text}\n"))
            for part in parts:
                self.assertIn(part, str(said.exception))

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
