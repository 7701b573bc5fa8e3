"""The PC's end of the link in the model's own time, for what `host-sim` does not print: the reason
of the start, and the counters. `src/io/link/mod.rs` describes packets and messages."""

import pathlib
import re
import zlib

SOURCE = pathlib.Path(__file__).parents[2] / "src/io/link/mod.rs"
(VERSION,) = re.findall(r"PROTOCOL_VERSION: u8 = (\d+);", SOURCE.read_text())

# Numbers of the requests used, and of their answers.
CONNECT, COUNTERS = (0, 0), (8, 6)
CAUSES = ("power on", "requested", "watchdog", "fault", "stack overflow")
COUNTER_NAMES = (
    "done", "refused", "repeated", "truncated", "oversized", "wrong_crc", "other_protocol",
    "unknown", "other_session", "out_of_order", "overrun_bytes", "stack_used_bytes",
)  # fmt: skip
SERIAL_BYTES = 16
ANSWER_WITHIN_S = 0.2
STEP_S = 0.001


def sevens(number, count):
    """Returns the bytes of a number on the wire, none of them zero."""
    return bytes(number >> 7 * place & 0x7F | 0x80 for place in range(count))


def varint(number):
    """Returns a number as postcard writes it."""
    encoded = bytearray()
    while number > 0x7F:
        encoded.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes(encoded) + bytes([number])


def packet(payload):
    """Returns the packet of a payload."""
    blocks = b"".join(
        bytes([len(block) + 1]) + block for block in bytes(payload).split(b"\0")
    )
    assert all(len(block) < 254 for block in payload.split(b"\0"))
    checked = sevens(len(blocks), 2) + blocks
    return b"\0" + checked + sevens(zlib.crc32(checked), 5) + b"\0"


def payloads(received):
    """Returns the payloads of whole packets, and the rest."""
    *whole, rest = bytes(received).split(b"\0")
    found = []
    for one in filter(None, whole):
        checked, crc = one[:-5], one[-5:]
        assert sevens(zlib.crc32(checked), 5) == crc, one
        blocks, payload = checked[2:], bytearray()
        while blocks:
            code, data, blocks = blocks[0], blocks[1 : blocks[0]], blocks[blocks[0] :]
            payload += data + (b"\0" if blocks and code < 0xFF else b"")
        found.append(bytes(payload))
    return found, rest


class Reader:
    """Reads what postcard has written."""

    def __init__(self, data):
        self.data = data

    def byte(self):
        first, self.data = self.data[0], self.data[1:]
        return first

    def number(self):
        number = place = 0
        while True:
            byte = self.byte()
            number |= (byte & 0x7F) << place
            place += 7
            if byte < 0x80:
                return number

    def text(self):
        length = self.number()
        text, self.data = self.data[:length], self.data[length:]
        return text.decode()


class Link:
    """A session with a board."""

    def __init__(self, board):
        self.board = board
        self.session, self.sequence = board.random.randrange(1, 1 << 32), 0
        board.chip.link.sent.clear()
        reader = self.ask(CONNECT)
        self.version, self.build, self.name = (reader.text() for _ in range(3))
        reader.byte()
        self.cause = CAUSES[reader.number()]
        reader.number()
        # Serial number, version, CRC-32 and storage of the calibration in use, or None.
        self.calibration = None
        if reader.byte():
            serial = bytes(reader.byte() for _ in range(SERIAL_BYTES)).rstrip(b"\0").decode()
            self.calibration = serial, *(reader.number() for _ in range(3))

    def ask(self, kind):
        request, expected = kind
        self.send(varint(request))
        sent = self.board.chip.link.sent
        for _ in range(round(ANSWER_WITHIN_S / STEP_S)):
            self.board.run(STEP_S)
            answers, rest = payloads(sent)
            sent[:] = rest
            for answer in answers:
                reader = Reader(answer)
                assert reader.byte() == int(VERSION)
                if reader.number() == self.session:
                    assert reader.number() == self.sequence - 1
                    assert reader.number() == expected, answer
                    return reader
        raise AssertionError(f"no answer within {ANSWER_WITHIN_S} s")

    def send(self, request):
        """Sends a request, as its bytes."""
        header = varint(self.session) + varint(self.sequence)
        self.board.chip.link.put(packet(bytes([int(VERSION)]) + header + request))
        self.sequence += 1

    def counters(self):
        reader = self.ask(COUNTERS)
        return {name: reader.number() for name in COUNTER_NAMES}
