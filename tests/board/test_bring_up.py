"""Bring-up of the board before a camera is loaded: its lines, and trials of motor and shutter."""

import json
import unittest

from link import Link
from support import MS, Flight


class BringUp(unittest.TestCase):
    image = host_sim = None

    def setUp(self):
        self.flight = Flight(self.image, self.host_sim, ppm=4_600.0)
        self.board, self.bench = self.flight.board, self.flight.board.bench

    def inputs(self):
        return json.loads(self.flight.camera("inputs", "--json"))

    def way_um(self):
        self.bench.counts(self.board.now)
        return 1e3 * self.bench.stage.position_mm

    def test_lines_edges_and_drift_of_the_clock_are_told_without_a_camera(self):
        before = self.inputs()
        self.assertEqual(before["edges"]["trigger"], 0)
        self.assertFalse(before["limit_low"] or before["limit_high"] or before["supply_low"])
        self.bench.start_pulses()
        for trigger in range(5):
            self.bench.trigger(self.board.now + (1 + 3 * trigger) * MS)
        self.board.run(4.5)
        inputs = self.inputs()
        self.assertEqual(inputs["edges"]["trigger"], 5)
        self.assertIn(inputs["edges"]["time_pulse"], (4, 5))
        self.assertLess(abs(inputs["clock_drift"]["drift_ppm"] - 4_600.0), 2.0)
        self.assertFalse(any(inputs["lines"].values()))
        pins = self.board.chip.pins.inputs
        for line, pin in (
            ("trigger", "PA0"), ("time_pulse", "PB3"), ("shutter_opened", "PB10"),
            ("shutter_closed", "PB11"), ("index", "PD14"), ("encoder_a", "PD12"),
            ("encoder_b", "PD13"), ("limit_low", "PC8"), ("limit_high", "PC9"),
        ):  # fmt: skip
            pins[pin] = True
            lines = self.inputs()["lines"]
            self.assertEqual([name for name, is_high in lines.items() if is_high], [line])
            pins[pin] = False

    def test_jog_and_duty_move_the_stage_and_leave_it_without_force(self):
        for way_um in (80, -150):
            start_um = self.way_um()
            printed = self.flight.camera("jog", str(way_um))
            self.assertIn("complete", printed)
            self.assertLess(abs(self.way_um() - start_um - way_um), 5.0)
            self.assertFalse(self.bench.is_enabled)
        start_um = self.way_um()
        self.assertIn("complete", self.flight.camera("duty", "0.1", "--for", "0.01"))
        self.assertGreater(self.way_um() - start_um, 5.0)
        self.assertFalse(self.bench.is_enabled)

    def test_stuck_stage_ends_a_jog(self):
        self.bench.stage.is_held = True
        self.flight.camera("jog", "150", code=1)
        self.assertFalse(self.bench.is_enabled)
        self.assertEqual(self.inputs()["trial"]["end"], "NotFollowing")

    def test_force_of_a_trial_ends_by_itself_where_the_cable_is_cut(self):
        link = Link(self.board)
        # The longest jog, as postcard writes it: number of the request, of the trial, the way.
        link.send(bytes([31, 0]) + bytes.fromhex("00004843"))
        self.board.run(0.05)
        self.assertTrue(self.bench.is_enabled)
        self.board.run(0.3)
        self.assertFalse(self.bench.is_enabled)

    def test_shutter_opens_once_and_a_prepared_camera_takes_no_trial(self):
        printed = self.flight.camera("shutter", "1/200")
        self.assertIn("1 shutter opened, 1 shutter closed", printed)
        (frame,) = self.bench.frames
        self.assertLess(abs(frame["closed_s"] - frame["opened_s"] - 0.005), 50e-6)
        self.flight.prepare()
        for action in (("jog", "10"), ("duty", "0.1"), ("shutter", "1/200")):
            self.flight.camera(*action, code=3)
        self.assertEqual(len(self.bench.frames), 1)
        self.assertFalse(self.bench.is_enabled)
