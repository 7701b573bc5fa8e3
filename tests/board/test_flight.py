"""Ten seconds of flight under `host-sim camera`, and its records against the truth."""

import math
import subprocess
import unittest

from support import MS, Flight

FRAMES = 10
VH_PER_S = 0.1
# The microsecond counter wraps between two of the frames.
BEFORE_WRAP_S = 8.0


class TenSeconds(unittest.TestCase):
    image = host_sim = None

    def test_records_hold_the_truth_across_the_wrap_of_the_counter(self):
        flight = Flight(self.image, self.host_sim, ppm=23.0, phase=0.31)
        board = flight.board
        self.count_on(board)
        board.bench.start_pulses()
        flight.arm()
        records = self.fly(flight)
        self.assertEqual(flight.status()["late_rounds"], 0)
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

    def fly(self, flight):
        """Gives V/H by a client that stays, and triggers, one a second."""
        board = flight.board
        device = f"serial:{board.path}"
        vh = ["vh", str(VH_PER_S), "--for", "3600"]
        # The model may be slower than this PC's clock: the client is ended when the flight is.
        with subprocess.Popen(
            [flight.host_sim, "camera", "--device", device, *vh], stderr=subprocess.PIPE, text=True
        ) as client:
            first = board.now + 700 * MS
            for frame in range(FRAMES):
                board.bench.trigger(first + frame * 1000 * MS + frame * frame * 12_345)
            end = first + FRAMES * 1000 * MS
            board.serve(lambda: board.now < end and client.poll() is None)
            client.terminate()
            self.assertEqual(client.stderr.read(), "")
        # What was on the way when the client ended is no answer for the next.
        board.run(0.05)
        board.pump()
        return flight.records()

    def hold(self, board, records):
        ratios = []
        triggers = [board.chip.clock.count(time) for time in board.bench.triggers]
        for record, truth, trigger_us in zip(records, board.bench.frames, triggers):
            number = record["sequence"]
            with self.subTest(frame=number):
                self.assertEqual(record["outcome"], "exposed", record["reason"])
                self.assertEqual(record["faults"], "")
                stamps = [int(record[name]) for name in ("trigger_us", "opened_us", "closed_us")]
                expected = [trigger_us, truth["opened_us"], truth["closed_us"]]
                self.assertEqual([stamp & 0xFFFF_FFFF for stamp in stamps], expected)
                sigma_mm = float(record["principal_point_sigma_mm"])
                error_mm = float(record["principal_point_y_mm"]) - truth["mean_mm"]
                self.assertLess(sigma_mm, 5e-4)
                self.assertLess(abs(error_mm), 4 * sigma_mm)
                ratios.append(error_mm / sigma_mm)
                # The stage has moved as the image did.
                travel_mm = 100.0 * VH_PER_S * truth["exposure_s"]
                self.assertLess(abs(float(record["travel_mm"]) - travel_mm), 1e-3)
                if record["centroid_unix_us"]:
                    error_us = int(record["centroid_unix_us"]) - truth["unix_us"]
                    self.assertLess(abs(error_us), 1 + 3e6 * float(record["utc_sigma_s"]))
        with_utc = sum(bool(record["centroid_unix_us"]) for record in records)
        self.assertGreaterEqual(with_utc, FRAMES - 2, "UTC did not come")
        rms = math.sqrt(sum(ratio**2 for ratio in ratios) / len(ratios))
        print(f"principal point: error over sigma {rms:.2f} RMS of {len(ratios)} frames")
        self.assertLess(rms, 1.5)
