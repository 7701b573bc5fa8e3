"""Drift of the clock in the status, where it is corrected and where it is too much."""

import unittest

from support import Flight


class Clock(unittest.TestCase):
    image = host_sim = None

    def after_pulses(self, ppm):
        """Returns board and status after five seconds with time pulses."""
        flight = Flight(self.image, self.host_sim, ppm=ppm)
        flight.prepare()
        before = flight.status()
        self.assertIsNone(before["clock_drift_ppm"])
        self.assertIsNone(before["last_finding"])
        flight.board.bench.start_pulses()
        flight.board.run(5.5)
        return flight, flight.status()

    def test_clock_beyond_one_percent_is_not_corrected_and_the_status_says_why_utc_is_missing(self):
        flight, status = self.after_pulses(14_000.0)
        self.assertLess(abs(status["clock_drift_ppm"] - 14_000.0), 2.0)
        self.assertEqual(status["clock_corrected_ppm"], 0.0)
        self.assertEqual(status["last_finding"], "UTC no pulse")
        self.assertLess(status["last_finding_age_s"], 1.0)
        text = flight.camera("status")
        self.assertIn("ppm fast by the time pulses: above 10000 ppm", " ".join(text.split()))

    def test_clock_within_one_percent_is_corrected_and_told(self):
        flight, status = self.after_pulses(-9_000.0)
        self.assertLess(abs(status["clock_drift_ppm"] + 9_000.0), 2.0)
        self.assertLess(abs(status["clock_corrected_ppm"] + 9_000.0), 2.0)
        self.assertIn("ppm slow by the time pulses, 9000", flight.camera("status"))
