"""Instructions that the processor leaves out, one at a time, from the look at the stage's speed to
the shutter's command."""

import bisect
import collections
import os
import pickle
import unittest

import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

from support import MS, Flight

VH_PER_S = 0.1
PRINCIPAL_DISTANCE_MM = 100.0
# The stage is slowed to this part of its speed, so long before the command would leave: it is not
# back at speed by the time at which the frame is given up.
SLOWED, BEFORE_S = 0.6, 0.002
# Time from there for which instructions are watched, and for which the shutter must stay closed.
WATCHED_S, CLOSED_S = 0.004, 0.012
# Travel by which an exposure of a stage at speed may differ from the image's, mm: half a pixel.
ALLOWED_MM = 0.5 * 8.75e-3
# Least number of instructions that the watched time must have.
LEAST = 2500


class Skips(unittest.TestCase):
    image = host_sim = None

    def test_no_skipped_instruction_opens_the_shutter_over_a_stage_that_is_not_at_speed(self):
        board = self.about_to_open()
        self.assertTrue(apart(lambda: opens(board)), "the stage is at speed, and nothing opens")
        slow(board)
        self.assertFalse(apart(lambda: opens(board)), "without a skip")
        watched = apart(lambda: watch(board))
        self.assertGreater(len(watched), LEAST)
        wrong = [place for place in watched if apart(lambda: self.opens_wrongly(board, place))]
        names = Names(self.image)
        told = collections.Counter(names.of(address) for address, _ in wrong)
        print(f"{len(watched)} instructions skipped: {len(wrong)} wrong openings")
        for name, number in told.most_common():
            print(f"  {number} in {name}")
        self.assertEqual(wrong, [])

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
        board.bench.trigger(board.now + MS)
        (command, _), *_ = apart(lambda: commands(board))
        board.run(board.bench.seconds(command - board.now) - BEFORE_S)
        return board

    def opens_wrongly(self, board, place):
        skip(board, *place)
        if not opens(board):
            return False
        board.run(0.02)
        for frame in board.bench.frames:
            exposure_s = frame["closed_s"] - frame["opened_s"]
            image_mm = PRINCIPAL_DISTANCE_MM * VH_PER_S * exposure_s
            if abs(frame["travel_mm"] - image_mm) > ALLOWED_MM:
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


def watch(board):
    """Returns address and length of every instruction that is carried out."""
    seen = set()
    board.processor.uc.hook_add(
        unicorn.UC_HOOK_CODE, lambda uc, address, size, data: seen.add((address, size))
    )
    board.run(WATCHED_S)
    return sorted(seen)


def skip(board, address, size):
    """Leaves an instruction out the first time that it is reached."""
    uc, left = board.processor.uc, [1]

    def step_over(uc, at, length, data):
        if left:
            left.clear()
            uc.reg_write(arm.UC_ARM_REG_PC, address + size | 1)

    uc.hook_add(unicorn.UC_HOOK_CODE, step_over, begin=address, end=address)
    uc.ctl_remove_cache(address, address + 4)


def apart(act):
    """Returns what a copy of this process finds, which is given up afterwards."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        code = 1
        try:
            with os.fdopen(writing, "wb") as pipe:
                pickle.dump(act(), pipe)
            code = 0
        finally:
            os._exit(code)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        found = pipe.read()
    _, status = os.waitpid(child, 0)
    assert status == 0, f"a copy ended with status {status}"
    return pickle.loads(found)


class Names:
    """Names of the image's functions."""

    def __init__(self, image):
        with open(image, "rb") as file:
            symbols = ELFFile(file).get_section_by_name(".symtab").iter_symbols()
            functions = [it for it in symbols if it["st_info"]["type"] == "STT_FUNC"]
        self.functions = sorted((it["st_value"] & ~1, it["st_size"], it.name) for it in functions)

    def of(self, address):
        index = bisect.bisect(self.functions, (address, 1 << 32, "")) - 1
        start, size, name = self.functions[index]
        return name if address < start + size else "?"
