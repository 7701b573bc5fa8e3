"""Instructions that the processor leaves out, one at a time, each in a copy of the model."""

import bisect
import collections
import os
import pickle
import random
import traceback

import unicorn
from elftools.elf.elffile import ELFFile
from unicorn import arm_const as arm

# Part of the instructions that are left out, drawn by this seed; FMC_SKIPS=all takes every one.
SHARE, SEED = 8, 1


def chosen(places):
    """Returns the places to try."""
    if os.environ.get("FMC_SKIPS") == "all":
        return places
    return random.Random(SEED).sample(places, len(places) // SHARE)


def wrong_ones(image, places, goes_wrong):
    """Leaves out the instruction of each place in a copy; prints and returns those with which it goes
    wrong."""
    names, tried = Names(image), chosen(places)
    wrong = [place for place in tried if apart(lambda: goes_wrong(place))]
    print(f"{len(tried)} of {len(places)} instructions left out: {len(wrong)} go wrong")
    for name, number in collections.Counter(names.of(place[0]) for place in wrong).most_common():
        print(f"  {number} in {name}")
    return wrong


def watch(board, seconds):
    """Returns address and length of every instruction that is carried out in a time, in order of
    addresses."""
    seen = set()
    board.processor.uc.hook_add(
        unicorn.UC_HOOK_CODE, lambda uc, address, size, data: seen.add((address, size))
    )
    board.run(seconds)
    return sorted(seen)


def skip(board, address, size):
    """Leaves an instruction out the first time that it is reached."""
    board.chip.bank.lets_wait = True
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
        except Exception:
            traceback.print_exc()
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
