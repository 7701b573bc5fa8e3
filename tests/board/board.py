"""The board: chip, processor and bench, with the link as a serial port of this PC or in the model's
own time.
"""

import functools
import os
import pathlib
import random
import subprocess
import time
import tty

from elftools.elf.elffile import ELFFile

from bench import Bench
from chip import Chip
from processor import AXI, AXI_BYTES, CYCLES_PER_US, DTCM, DTCM_BYTES, Processor

CYCLES_PER_S = 1_000_000 * CYCLES_PER_US
# Time between two looks at the serial port.
LOOK_CYCLES = 500 * CYCLES_PER_US


@functools.cache
def segments(image):
    """Returns addresses and bytes of what is flashed."""
    with pathlib.Path(image).open("rb") as file:
        return [
            (segment["p_paddr"], segment.data())
            for segment in ELFFile(file).iter_segments("PT_LOAD")
            if segment["p_filesz"]
        ]


class Board:
    """A board that has just been switched on."""

    def __init__(self, image, seed=1, bank=None, **bench):
        """Switches it on, with what another board's flash holds if `bank` is that."""
        self.random = random.Random(seed)
        self.bench = Bench(**bench)
        self.chip = Chip(self.bench, self.random)
        self.processor = Processor(segments(image), self.chip)
        self.bench.connect(self.processor, self.chip)
        self.chip.connect(self.processor)
        if bank is not None:
            self.chip.bank.keep(bank)
        self.forget()
        self.port = None
        self.path = None

    def forget(self):
        """Leaves in memory what nobody has written."""
        for start, length in ((DTCM, DTCM_BYTES), (AXI, AXI_BYTES)):
            self.processor.uc.mem_write(start, self.random.randbytes(length))

    @property
    def now(self):
        return self.processor.now

    def run(self, seconds):
        """Runs for a time of the model, as fast as this PC does."""
        self.processor.run(self.now + round(seconds * CYCLES_PER_S))

    # The link as a serial port.

    def open_port(self):
        """Opens a serial port that is the board's link; returns its path."""
        self.port, other = os.openpty()
        tty.setraw(other)
        os.set_blocking(self.port, False)
        # The other end stays open, so that programs may come and go.
        self.other = other
        self.path = os.ttyname(other)
        return self.path

    def pump(self):
        """Moves bytes between port and chip."""
        try:
            self.chip.link.put(os.read(self.port, 4096))
        except BlockingIOError:
            pass
        sent = self.chip.link.sent
        if sent:
            try:
                del sent[: os.write(self.port, bytes(sent))]
            except BlockingIOError:
                pass

    def serve(self, goes_on):
        """Runs no faster than real time, as long as it is wanted."""
        start, begin = time.monotonic(), self.now
        while goes_on():
            self.pump()
            self.processor.run(self.now + LOOK_CYCLES)
            ahead = (self.now - begin) / CYCLES_PER_S - (time.monotonic() - start)
            if ahead > 0.0:
                time.sleep(ahead)
            elif ahead < -0.1:
                # It is behind: real time waits.
                start, begin = time.monotonic(), self.now

    def serve_until(self, condition, *command):
        """Runs a program of this PC with the port until something has happened, and ends it."""
        with subprocess.Popen([str(part) for part in command], stderr=subprocess.DEVNULL) as program:
            self.serve(lambda: not condition() and program.poll() is None)
            assert program.poll() is None, f"{command} has ended"
            program.terminate()

    def client(self, *command, code=0):
        """Runs a program of this PC with the port until it ends; returns what it has printed, or its
        errors where it is to fail."""
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        with subprocess.Popen([str(part) for part in command], **pipes) as program:
            self.serve(lambda: program.poll() is None)
            output, errors = program.communicate()
        if program.returncode != code:
            raise AssertionError(f"{command}: {program.returncode}\n{output}{errors}")
        return errors if code else output
