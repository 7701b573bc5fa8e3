"""What the tests share: the image, `host-sim`, boards, and ways to make the image go wrong."""

import csv
import json
import pathlib
import struct
import subprocess
import tempfile

from unicorn import arm_const as arm

from board import CYCLES_PER_S, Board
from link import Link
from processor import FLASH, FLASH_BYTES, SYSTICK

HERE = pathlib.Path(__file__).parent
CAMERA = HERE.parents[1] / "host-sim/scenarios/cameras/mission.toml"
SETTINGS = HERE / "flight.toml"
KEY = CAMERA.parents[2] / "keys/test-private-key.pem"
MS = CYCLES_PER_S // 1000
# From a trigger until its record is there.
FRAME = 250 * MS

# Instructions that the processor goes astray to: a loop, a stack that grows for ever, by 32 bytes or
# by more than the guard has, one that does not exist, and the same with faults masked.
HANGS = struct.pack("<H", 0xE7FE)
OVERFLOWS = struct.pack("<HH", 0xB4FF, 0xE7FD)
LEAPS = struct.pack("<HHHH", 0xF5AD, 0x5D80, 0x9000, 0xE7FB)
UNDEFINED = struct.pack("<H", 0xDE00)
LOCKS_UP = struct.pack("<HH", 0xB671, 0xDE00)
BOOT_S = 0.02
# Flash of the first bank that the image leaves free.
ASTRAY = FLASH + FLASH_BYTES - 0x1000


def settings(folder, text, **others):
    """Writes the settings of the tests with more of them, and with other values of some; returns the
    file's path."""
    lines = SETTINGS.read_text().splitlines()
    for name, value in others.items():
        (number,) = (at for at, line in enumerate(lines) if line.startswith(f"{name} = "))
        lines[number] = f"{name} = {value}"
    path = pathlib.Path(folder) / "settings.toml"
    path.write_text("\n".join(lines) + "\n" + text)
    return path


class Flight:
    """A board under `host-sim`."""

    def __init__(self, image, host_sim, **bench):
        self.host_sim = host_sim
        self.board = Board(image, **bench)
        self.board.open_port()
        self.board.run(BOOT_S)

    def camera(self, *action, code=0):
        device = f"serial:{self.board.path}"
        return self.board.client(self.host_sim, "camera", "--device", device, *action, code=code)

    def prepare(self, settings=SETTINGS):
        self.camera("prepare", "--camera", CAMERA, "--settings", settings)

    def arm(self, settings=SETTINGS):
        """Prepares and arms; without V/H the stage stands under force."""
        self.prepare(settings)
        self.camera("referenced")
        self.camera("arm")

    def fly(self, triggers, vh_per_s):
        """Exposes frames, and returns the records."""
        self.expose(triggers, vh_per_s)
        return self.records()

    def expose(self, triggers, vh_per_s):
        """Gives V/H by a client that stays, and triggers after so many cycles each."""
        board = self.board
        start = board.now
        for after in triggers:
            board.bench.trigger(start + after)
        end = start + triggers[-1] + FRAME
        device = f"serial:{board.path}"
        vh = ["vh", str(vh_per_s), "--for", "3600"]
        # The model may be slower than this PC's clock: the client is ended when the flight is.
        with subprocess.Popen(
            [self.host_sim, "camera", "--device", device, *vh], stderr=subprocess.PIPE, text=True
        ) as client:
            board.serve(lambda: board.now < end and client.poll() is None)
            client.terminate()
            errors = client.stderr.read()
        assert errors == "", errors
        # What was on the way when the client ended is no answer for the next.
        board.run(0.05)
        board.pump()

    def status(self):
        return json.loads(self.camera("status", "--json"))

    def records(self):
        """Fetches the records, as `host-sim records` writes them."""
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out"
            device = f"serial:{self.board.path}"
            self.board.client(self.host_sim, "records", "--device", device, "--out", out)
            with (out / "records.csv").open(newline="") as file:
                return list(csv.DictReader(file))


def signed(flight, folder, version, text):
    """Writes a camera file of this version in a folder, and its signature; returns both."""
    camera, signature = (folder / f"{version}.{kind}" for kind in ("toml", "json"))
    if not signature.exists():
        camera.write_text(f'serial = "5282"\nversion = {version}\n' + text)
        sign = ("sign", "--camera", camera, "--key", KEY, "--out", signature)
        flight.board.client(flight.host_sim, *sign)
    return camera, signature


def astray(board, code, in_interrupt=False):
    """Lets the main loop go on with this code, interrupts allowed, once no interrupt is served or
    waits, or lets the next tick's interrupt do so."""
    while board.processor.active or board.chip.lines():
        board.processor.run(board.now + 1)
    processor = board.processor
    processor.uc.mem_write(ASTRAY, code)
    processor.uc.ctl_remove_cache(ASTRAY, ASTRAY + 0x100)
    processor.uc.reg_write(arm.UC_ARM_REG_PRIMASK, 0)
    processor.uc.reg_write(arm.UC_ARM_REG_XPSR, 0x0100_0000)
    processor.asleep = False
    if in_interrupt:
        processor.systick_pending = True
        processor.run(board.now + 1)
        assert processor.active == [SYSTICK]
    processor.pc = ASTRAY


def start_reason(board):
    """Returns the reason of the last start, as the link tells it, and the red light."""
    board.run(BOOT_S)
    return Link(board).cause, board.chip.pins.is_high("PB14")
