"""Short exposures of a stage that shakes faster than the control loop can follow."""

import math
import tempfile
import unittest

from bench import Shake
from support import MS, Flight, settings

# A shake whose periods are two readings and a third long, and an exposure of about one reading.
AMPLITUDE_MM, FREQUENCY_HZ, EXPOSURE_S = 0.5e-3, 430.0, 0.001
FRAMES, INTERVAL, VH_PER_S = 24, 200 * MS, 0.05


class Shaking(unittest.TestCase):
    image = host_sim = None

    def test_error_of_a_stage_that_shakes_is_covered_by_sigma_and_no_trigger_is_refused(self):
        flight = Flight(self.image, self.host_sim, phase=0.31)
        bench = flight.board.bench
        with tempfile.TemporaryDirectory() as folder:
            flight.arm(settings(folder, "", trigger_interval_s=0.17, exposure_s=EXPOSURE_S))
        bench.shake = Shake(AMPLITUDE_MM, FREQUENCY_HZ, bench.seconds(flight.board.now))
        triggers = [700 * MS + frame * INTERVAL + frame**2 * 12_345 for frame in range(FRAMES)]
        records = flight.fly(triggers, VH_PER_S)
        self.assertEqual((len(records), len(bench.frames)), (FRAMES, FRAMES))
        errors, ratios = [], []
        for record, truth in zip(records, bench.frames):
            self.assertEqual(record["outcome"], "exposed", record["reason"])
            self.assertLess(truth["closed_s"] - truth["opened_s"], 1.01 * EXPOSURE_S)
            errors.append(float(record["principal_point_y_mm"]) - truth["mean_mm"])
            ratios.append(errors[-1] / float(record["principal_point_sigma_mm"]))
        error_um, ratio = (
            math.sqrt(sum(value**2 for value in values) / FRAMES) for values in (errors, ratios)
        )
        print(f"shake: error {1e3 * error_um:.3f} um RMS, {ratio:.2f} of sigma")
        self.assertLess(ratio, 1.3)
        # The shake is there: without it the readings alone err by less.
        self.assertGreater(1e3 * error_um, 0.1)
