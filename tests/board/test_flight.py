"""Ten seconds of flight under `host-sim camera`, and its records against the truth."""

import math
import unittest

from support import MS, Flight

FRAMES = 10
VH_PER_S = 0.1
EXPOSURE_S = 0.004
# The command lasts whole counts of the clock. Where it leaves at once, because its time has come
# while it was set, its first count has begun before: it is short by that, and by the instructions
# from reading the counter until the line is set.
ROUNDED_S, BEGUN_S = 0.51e-6, 1.2e-6
PRINCIPAL_DISTANCE_MM = 100.0
# The ST-LINK's oscillator has been found 0.39 % to 0.46 % off.
CLOCK_PPM = 4600.0
# Time from the first time pulse until UTC is there.
UTC_WITHIN_S = 12.0
# The microsecond counter wraps between two of the frames.
BEFORE_WRAP_S = UTC_WITHIN_S + 6.0


class TenSeconds(unittest.TestCase):
    image = host_sim = None

    def test_records_hold_the_truth_by_a_clock_that_is_off_across_the_wrap_of_its_counter(self):
        flight = Flight(self.image, self.host_sim, ppm=CLOCK_PPM, phase=0.31)
        board = flight.board
        self.count_on(board)
        flight.prepare()
        board.bench.start_pulses()
        board.run(UTC_WITHIN_S)
        flight.camera("referenced")
        flight.camera("arm")
        records = flight.fly(
            [700 * MS + frame * 1000 * MS + frame * frame * 12_345 for frame in range(FRAMES)],
            VH_PER_S,
        )
        status = flight.status()
        self.assertEqual(status["late_rounds"], 0)
        self.assertLess(abs(status["clock_drift_ppm"] - CLOCK_PPM), 1.0)
        self.assertLess(abs(status["clock_corrected_ppm"] - CLOCK_PPM), 2.0)
        self.assertEqual(len(records), FRAMES)
        self.assertEqual(len(board.bench.frames), FRAMES)
        wraps = {int(record["trigger_us"]) >> 32 for record in records}
        self.assertEqual(wraps, {0, 1}, "the counter has not wrapped between two frames")
        self.hold(board, records)

    def count_on(self, board):
        """Lets the counter's time pass, as if the board had been on for an hour and more."""
        start_us = (1 << 32) - round(BEFORE_WRAP_S * 1e6)
        while (count := board.chip.clock.count(board.now)) < start_us - 1_000_000:
            ahead = min(1 << 30, start_us - count)
            for timer in (board.chip.clock, board.chip.shutter):
                timer.write(0x24, (count + ahead) & 0xFFFF_FFFF)
            board.run(0.01)

    def hold(self, board, records):
        ratios, speeds = [], []
        triggers_s = [board.bench.seconds(time) for time in board.bench.triggers]
        first_us = int(records[0]["trigger_us"])
        for record, truth, trigger_s in zip(records, board.bench.frames, triggers_s):
            with self.subTest(frame=record["sequence"]):
                self.assertEqual(record["outcome"], "exposed", record["reason"])
                self.assertEqual(record["faults"], "")
                trigger_us, opened_us, closed_us = (
                    int(record[name]) for name in ("trigger_us", "opened_us", "closed_us")
                )
                # Times within a frame are of true seconds, to the microsecond of each stamp; over
                # the flight the rate is left 1 ppm.
                exposure_s = truth["closed_s"] - truth["opened_s"]
                self.assertLess(abs(closed_us - opened_us - 1e6 * exposure_s), 2)
                delay_s = truth["opened_s"] - trigger_s
                self.assertLess(abs(opened_us - trigger_us - 1e6 * delay_s), 2)
                elapsed_s = trigger_s - triggers_s[0]
                self.assertLess(abs(trigger_us - first_us - 1e6 * elapsed_s), 2 + elapsed_s)
                self.assertLess(exposure_s - EXPOSURE_S, ROUNDED_S)
                self.assertLess(EXPOSURE_S - exposure_s, ROUNDED_S + BEGUN_S)
                sigma_mm = float(record["principal_point_sigma_mm"])
                error_mm = float(record["principal_point_y_mm"]) - truth["mean_mm"]
                self.assertLess(sigma_mm, 5e-4)
                self.assertLess(abs(error_mm), 4 * sigma_mm)
                ratios.append(error_mm / sigma_mm)
                # The stage has moved as the image did.
                speeds.append(truth["travel_mm"] / (PRINCIPAL_DISTANCE_MM * VH_PER_S * exposure_s))
                self.assertLess(abs(float(record["travel_mm"]) - truth["travel_mm"]), 3e-4)
                utc_error_us = int(record["centroid_unix_us"]) - truth["unix_us"]
                self.assertLess(abs(utc_error_us), 1 + 3e6 * float(record["utc_sigma_s"]))
                self.assertLess(float(record["utc_sigma_s"]), 1e-4)
        rms = math.sqrt(sum(ratio**2 for ratio in ratios) / len(ratios))
        speed = sum(speeds) / len(speeds)
        print(
            f"principal point: error over sigma {rms:.2f} RMS of {len(ratios)} frames; "
            f"speed of the stage {speed:.5f} of the image's"
        )
        self.assertLess(rms, 1.5)
        self.assertLess(abs(speed - 1.0), 0.002)
