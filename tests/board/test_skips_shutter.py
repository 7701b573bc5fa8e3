"""Instructions that the processor leaves out, one at a time, from the look at the stage's speed to
the shutter's command."""

import unittest

from skips import apart, skip, watch, wrong_ones
from support import MS, Flight

VH_PER_S = 0.1
PRINCIPAL_DISTANCE_MM = 100.0
# The stage is slowed to this part of its speed, so long before the command would leave: it is not
# back at speed by the time at which the frame is given up.
SLOWED, BEFORE_S = 0.6, 0.002
# Time from there for which instructions are watched, and for which the shutter must stay closed.
WATCHED_S, CLOSED_S = 0.004, 0.012
# Cycles from a whole millisecond of the model to the trigger.
PHASE = MS // 3
# Smear of the exposure by the speed at first light that is allowed, mm: half a pixel. What the stage
# does later is measured, and in the record.
EXPOSURE_S = 0.004
ALLOWED_MM = 0.5 * 8.75e-3
# Least number of instructions that the watched time must have.
LEAST = 2500


class ShutterSkips(unittest.TestCase):
    image = host_sim = None

    def test_no_skipped_instruction_opens_the_shutter_over_a_stage_that_is_not_at_speed(self):
        board = self.about_to_open()
        self.assertTrue(apart(lambda: opens(board)), "the stage is at speed, and nothing opens")
        slow(board)
        self.assertFalse(apart(lambda: opens(board)), "without a skip")
        watched = apart(lambda: watch(board, WATCHED_S))
        self.assertGreater(len(watched), LEAST)
        self.assertEqual(
            wrong_ones(self.image, watched, lambda place: self.opens_wrongly(board, place)), []
        )

    def about_to_open(self):
        """Returns a board whose shutter is told to open soon."""
        flight = Flight(self.image, self.host_sim)
        board = flight.board
        flight.arm()
        end = board.now + 1500 * MS
        vh = ("vh", str(VH_PER_S), "--for", "3600")
        device = f"serial:{board.path}"
        board.serve_until(
            lambda: board.now > end, self.host_sim, "camera", "--device", device, *vh
        )
        # The link takes as long as it does: the trigger comes in the same part of a round all the same.
        board.bench.trigger((board.now // MS + 2) * MS + PHASE)
        (command, _), *_ = apart(lambda: commands(board))
        board.run(board.bench.seconds(command - board.now) - BEFORE_S)
        return board

    def opens_wrongly(self, board, place):
        skip(board, *place)
        if not opens(board):
            return False
        board.run(0.02)
        for frame in board.bench.frames:
            off_mm_s = frame["speed_mm_s"] - PRINCIPAL_DISTANCE_MM * VH_PER_S
            if abs(off_mm_s) * EXPOSURE_S > ALLOWED_MM:
                return True
        return not board.bench.frames


def commands(board):
    """Returns the shutter's commands to come."""
    begun = len(board.bench.commands)
    board.run(0.3)
    return board.bench.commands[begun:]


def opens(board):
    """Returns true if the shutter is told to open in the next milliseconds."""
    begun = len(board.bench.commands)
    board.run(CLOSED_S)
    return any(is_open for _, is_open in board.bench.commands[begun:])


def slow(board):
    board.bench.drive(board.now, board.bench.duty, board.bench.is_enabled, board.bench.is_open)
    board.bench.stage.speed_mm_s *= SLOWED
