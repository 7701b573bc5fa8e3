"""The schema of the link, and its vectors: what the clients in Python make of them."""

import json
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "examples"))

import link  # noqa: E402
import link_client  # noqa: E402
import link_messages  # noqa: E402

SCHEMA, VECTORS = (
    json.loads((ROOT / f"docs/link-{name}.json").read_text("utf-8"))
    for name in ("schema", "vectors")
)


def number(kind, name):
    """Returns the number of a variant."""
    variants = SCHEMA["types"][kind]["ENUM"]
    return next(int(number) for number, variant in variants.items() if name in variant)


class Vectors(unittest.TestCase):
    image = host_sim = None

    def test_reader_of_the_schema_reads_and_writes_every_message(self):
        self.assertGreater(link_messages.check(SCHEMA, VECTORS), 300)
        kinds = {(one["type"], str(one["value"]).split("'")[1 if isinstance(one["value"], dict)
                 else 0]) for one in VECTORS["vectors"]}  # fmt: skip
        variants = [
            (kind, name)
            for kind in ("Request", "Answer")
            for variant in SCHEMA["types"][kind]["ENUM"].values()
            for name in variant
        ]
        self.assertEqual(kinds, set(variants))

    def test_wrong_bytes_are_read_as_no_message(self):
        vectors = json.loads(json.dumps(VECTORS))
        payload = vectors["vectors"][5]["payload"]
        vectors["vectors"][5]["payload"] = payload[:-1] + ("0" if payload[-1] != "0" else "1")
        self.assertRaises(Exception, link_messages.check, SCHEMA, vectors)

    def test_packets_of_the_client_are_those_of_the_vectors(self):
        longest = 0
        for vector in VECTORS["vectors"]:
            payload, packet = (bytes.fromhex(vector[name]) for name in ("payload", "packet"))
            self.assertEqual(link_client.payload(packet[1:-1]), payload)
            if all(len(block) < 254 for block in payload.split(b"\0")):
                self.assertEqual(link_client.packet(payload), packet)
                self.assertEqual(link.packet(payload), packet)
                longest = max(longest, len(packet))
            damaged = bytes([packet[1] ^ 1]) + packet[2:-1]
            self.assertEqual(link_client.payload(damaged), b"")
            header = link_client.varint(vector["session"]) + link_client.varint(vector["sequence"])
            self.assertEqual(payload[: 1 + len(header)], bytes([link_client.VERSION]) + header)
        self.assertGreater(longest, 300)

    def test_numbers_of_the_clients_are_those_of_the_schema(self):
        self.assertEqual(link_client.VERSION, SCHEMA["protocol_version"])
        self.assertEqual(int(link.VERSION), SCHEMA["protocol_version"])
        for name, found in (
            ("ConnectReading", link_client.CONNECT_READING),
            ("Status", link_client.STATUS),
            ("FrameRecord", link_client.RECORD),
        ):
            self.assertEqual(found, [number("Request", name)])
        states = SCHEMA["types"]["State"]["ENUM"].values()
        names = [re.sub("(?<!^)(?=[A-Z])", "-", next(iter(state))).lower() for state in states]
        self.assertEqual(link_client.STATES, names)
        source = pathlib.Path(link_client.__file__).read_text("utf-8")
        kinds = [int(kind) for kind in re.findall(r"kind [!=]= (\d+)", source)]
        self.assertEqual(kinds, [number("Answer", "Status"), number("Answer", "FrameRecord")])
        pairs = [(number("Request", name), number("Answer", answer))
                 for name, answer in (("Connect", "Connected"), ("Counters", "Counters"))]  # fmt: skip
        self.assertEqual([link.CONNECT, link.COUNTERS], pairs)
        counters = [name for field in SCHEMA["types"]["Counters"]["STRUCT"] for name in field]
        self.assertEqual(list(link.COUNTER_NAMES), counters)


if __name__ == "__main__":
    unittest.main()
