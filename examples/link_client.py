"""The camera's link in Python, with nothing but its standard library (serial ports: Unix).

Usage: link_client.py /dev/ttyACM0 | HOST:PORT

Opens a session for reading, which ends no other; prints identity, state, and the records that are
kept, each checked by its CRC. `src/io/link/mod.rs` describes packets, `message.rs` the messages.
"""

import os, random, select, socket, sys, tty, zlib  # noqa: E401

VERSION, CONNECT_READING, STATUS, RECORD = 11, [27], [18], [16]
STATES = "standby armed degraded run-up tracking exposing fly-back fault".split()


def sevens(number, count):
    return bytes(number >> 7 * place & 0x7F | 0x80 for place in range(count))


def varint(number):
    more = number > 0x7F
    return bytes([number & 0x7F | more << 7]) + (varint(number >> 7) if more else b"")


def number(data):
    """Takes a number off the beginning of a message."""
    value = place = 0
    while True:
        byte = data.pop(0)
        value, place = value | (byte & 0x7F) << place, place + 7
        if byte < 0x80:
            return value


def text(data):
    taken = bytes(data.pop(0) for _ in range(number(data)))
    return taken.decode()


def packet(payload):
    blocks = b"".join(bytes([len(block) + 1]) + block for block in payload.split(b"\0"))
    checked = sevens(len(blocks), 2) + blocks
    return b"\0" + checked + sevens(zlib.crc32(checked), 5) + b"\0"


def payload(packet):
    checked, found = packet[:-5], bytearray()
    if len(packet) < 8 or sevens(zlib.crc32(checked), 5) != packet[-5:]:
        return found  # Damaged: the request is made again.
    blocks = checked[2:]
    while blocks:
        code, data, blocks = blocks[0], blocks[1 : blocks[0]], blocks[blocks[0] :]
        found += data + (b"\0" if blocks and code < 0xFF else b"")
    return found


class Camera:
    def __init__(self, name):
        if ":" in name:
            host, port = name.rsplit(":", 1)
            self.wire = socket.create_connection((host, int(port)), 5).detach()
            os.set_blocking(self.wire, True)
        else:
            self.wire = os.open(name, os.O_RDWR | os.O_NOCTTY)
            tty.setraw(self.wire)
        self.session, self.sequence = random.randrange(1, 1 << 32), 0

    def ask(self, request):
        """Returns kind and contents of the answer; requests of this session may be repeated."""
        header = varint(self.session) + varint(self.sequence)
        self.sequence = (self.sequence + 1) & 0xFFFF
        received = b""
        for _ in range(5):
            os.write(self.wire, packet(bytes([VERSION]) + header + bytes(request)))
            while select.select([self.wire], [], [], 1.0)[0]:
                *whole, received = (received + os.read(self.wire, 4096)).split(b"\0")
                for answer in map(payload, whole):
                    if answer.startswith(bytes([VERSION]) + header):
                        del answer[: 1 + len(header)]
                        return number(answer), answer
        sys.exit("the camera does not answer")


def main():
    camera = Camera(sys.argv[1])
    kind, data = camera.ask(CONNECT_READING)
    print("firmware {}, build {}, board {}".format(text(data), text(data), text(data)))
    kind, data = camera.ask(STATUS)
    print("state:", STATES[number(data)] if kind == 15 else "not prepared")
    sequence = 0
    while True:
        kind, data = camera.ask(RECORD + list(varint(sequence)))
        if kind != 13 or not data.pop(0):
            break
        # Its CRC-32 follows the record, as a number of up to five bytes.
        ends = (len(data) - length for length in range(1, 6))
        assert any(number(data[end:]) == zlib.crc32(data[:end]) for end in ends), "damaged"
        sequence = number(data) + 1
        print("record", sequence - 1)


if __name__ == "__main__":
    main()
