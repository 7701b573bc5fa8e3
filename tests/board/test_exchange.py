"""A flight whose calibration is exchanged between two frames, and stored: UTC, V/H, counts and
records go on."""

import pathlib
import tempfile
import unittest

from board import CYCLES_PER_S
from support import CAMERA, MS, SETTINGS, Flight, signed

VH_PER_S = 0.1
# Time from the first time pulse until UTC is there.
UTC_WITHIN_S = 12.0
# Erasure of a sector: longer than the time from one event to the next after which a clock has
# jumped.
ERASURE_S = 1.5
# Another principal distance, mm, of the camera whose own is 100.
OTHER_MM = 101.5


class Exchange(unittest.TestCase):
    image = host_sim = None

    def test_flight_goes_on_with_another_calibration_and_with_the_store_of_it(self):
        flight = Flight(self.image, self.host_sim)
        board = flight.board
        board.chip.bank.erasure_cycles = round(ERASURE_S * CYCLES_PER_S)
        with tempfile.TemporaryDirectory() as folder:
            text = CAMERA.read_text().replace("= 100.0", f"= {OTHER_MM}")
            camera, signature = signed(flight, pathlib.Path(folder), 2, text)
            flight.prepare()
            board.bench.start_pulses()
            board.run(UTC_WITHIN_S)
            flight.camera("referenced")
            flight.camera("arm")
            flight.expose([700 * MS, 1700 * MS], VH_PER_S)
            # While the stage is under force the calibration stays.
            recalibrate = ("recalibrate", "--camera", camera, "--settings", SETTINGS)
            errors = flight.camera(*recalibrate, code=3)
            self.assertIn("disarm", " ".join(errors.split()))
            flight.camera("disarm")
            before = flight.status()
            flight.camera(*recalibrate)
            after = flight.status()
            self.assertEqual(before["state"], after["state"])
            self.assertEqual((after["triggers"], after["records_kept"]), (2, 2))
            self.assertEqual(after["clock_drift_ppm"], before["clock_drift_ppm"])
            flight.camera("arm")
            flight.expose([700 * MS], VH_PER_S)
            flight.camera("disarm")
            flight.camera("store", "--signature", signature)
            flight.camera("arm")
            flight.expose([700 * MS], VH_PER_S)
        records = flight.records()
        self.assertEqual(board.processor.resets, [])
        frames = board.bench.frames
        self.assertEqual([record["sequence"] for record in records], ["1", "2", "3", "4"])
        self.assertEqual([record["faults"] for record in records], [""] * 4)
        made_with = [record["calibration_version"] for record in records]
        self.assertEqual(made_with, ["", "", "2", "2"])
        kept_in = [record["calibration_storage"] for record in records]
        self.assertEqual(kept_in, ["volatile"] * 3 + ["stored"])
        for record, truth, focal_mm in zip(records, frames, (100.0, 100.0, OTHER_MM, OTHER_MM)):
            with self.subTest(frame=record["sequence"]):
                self.assertEqual(float(record["principal_distance_mm"]), focal_mm)
                travel_mm = focal_mm * VH_PER_S * (truth["closed_s"] - truth["opened_s"])
                self.assertLess(abs(truth["travel_mm"] - travel_mm), 2e-4)
                error_mm = float(record["principal_point_y_mm"]) - truth["mean_mm"]
                self.assertLess(abs(error_mm), 4 * float(record["principal_point_sigma_mm"]))
                utc_error_us = int(record["centroid_unix_us"]) - truth["unix_us"]
                self.assertLess(abs(utc_error_us), 1 + 3e6 * float(record["utc_sigma_s"]))
                self.assertLess(float(record["utc_sigma_s"]), 1e-4)
