"""Messages of the camera's link by their schema, with nothing but Python's standard library.

Usage: link_messages.py docs/link-schema.json docs/link-vectors.json

Reads every message of the vectors and writes it again; both must be the vector's own. `Messages`
is what a client needs of it: names of types and fields are those of the schema.
"""

import json
import struct
import sys

WHOLE = {"U8": 1, "U16": 3, "U32": 5, "U64": 10}
SIGNED = ("I16", "I32", "I64")
REAL = {"F32": "<f", "F64": "<d"}


class Messages:
    def __init__(self, schema):
        self.types = schema["types"]

    def write(self, kind, value):
        """Returns the bytes of a value of a type, as postcard writes them."""
        if isinstance(kind, str):
            return self.write_plain(kind, value)
        ((form, content),) = kind.items()
        if form == "TYPENAME":
            return self.write_type(self.types[content], value)
        if form == "OPTION":
            return b"\0" if value is None else b"\1" + self.write(content, value)
        if form == "SEQ":
            return varint(len(value)) + b"".join(self.write(content, one) for one in value)
        return b"".join(map(self.write, elements(form, content), value))

    def write_plain(self, kind, value):
        if kind in ("BOOL", "U8"):
            return bytes([value])
        if kind in WHOLE:
            return varint(value)
        if kind in SIGNED:
            return varint(2 * value if value >= 0 else -2 * value - 1)
        if kind in REAL:
            return struct.pack(REAL[kind], value)
        return varint(len(value.encode())) + value.encode()

    def write_type(self, container, value):
        form, content = form_of(container)
        if form == "ENUM":
            ((name, value),) = value.items() if isinstance(value, dict) else [(value, None)]
            for number, variant in content.items():
                if name in variant:
                    return varint(int(number)) + self.write_type(variant[name], value)
            raise ValueError(f"{name} is none of {content}")
        if form == "STRUCT":
            fields = ((name, kind) for field in content for name, kind in field.items())
            return b"".join(self.write(kind, value[name]) for name, kind in fields)
        if form == "UNIT":
            return b""
        if form == "NEWTYPE":
            return self.write(content, value)
        return b"".join(map(self.write, content, value))

    def read(self, kind, data):
        """Takes a value of a type off the beginning of some bytes."""
        if isinstance(kind, str):
            return self.read_plain(kind, data)
        ((form, content),) = kind.items()
        if form == "TYPENAME":
            return self.read_type(self.types[content], data)
        if form == "OPTION":
            return self.read(content, data) if data.pop(0) else None
        if form == "SEQ":
            return [self.read(content, data) for _ in range(number(data))]
        return [self.read(one, data) for one in elements(form, content)]

    def read_plain(self, kind, data):
        if kind in ("BOOL", "U8"):
            return bool(data.pop(0)) if kind == "BOOL" else data.pop(0)
        if kind in WHOLE:
            return number(data)
        if kind in SIGNED:
            doubled = number(data)
            return -(doubled + 1) // 2 if doubled % 2 else doubled // 2
        if kind in REAL:
            return struct.unpack(REAL[kind], take(data, struct.calcsize(REAL[kind])))[0]
        return take(data, number(data)).decode()

    def read_type(self, container, data):
        form, content = form_of(container)
        if form == "ENUM":
            ((name, variant),) = content[str(number(data))].items()
            value = self.read_type(variant, data)
            return name if variant == "UNIT" else {name: value}
        if form == "STRUCT":
            fields = ((name, kind) for field in content for name, kind in field.items())
            return {name: self.read(kind, data) for name, kind in fields}
        if form == "UNIT":
            return None
        if form == "NEWTYPE":
            return self.read(content, data)
        return [self.read(one, data) for one in content]


def form_of(container):
    """Returns form and content of a type or variant; structs and variants have short names."""
    if isinstance(container, str):
        return "UNIT", None
    ((form, content),) = container.items()
    return {"NEWTYPESTRUCT": "NEWTYPE", "TUPLESTRUCT": "TUPLE"}.get(form, form), content


def elements(form, content):
    return content if form == "TUPLE" else [content["CONTENT"]] * content["SIZE"]


def varint(value):
    more = value > 0x7F
    return bytes([value & 0x7F | more << 7]) + (varint(value >> 7) if more else b"")


def number(data):
    value = place = 0
    while True:
        byte = data.pop(0)
        value, place = value | (byte & 0x7F) << place, place + 7
        if byte < 0x80:
            return value


def take(data, count):
    taken = bytes(data[:count])
    del data[:count]
    return taken


def check(schema, vectors):
    """Reads and writes every message; returns their number."""
    messages = Messages(schema)
    for vector in vectors["vectors"]:
        data = bytearray.fromhex(vector["payload"])
        version, header = data.pop(0), messages.read({"TYPENAME": schema["header"]}, data)
        found = messages.read({"TYPENAME": vector["type"]}, data)
        assert version == schema["protocol_version"] and not data, vector
        assert header == {name: vector[name] for name in header}, vector
        assert found == vector["value"], (found, vector)
        written = messages.write({"TYPENAME": schema["header"]}, header)
        written += messages.write({"TYPENAME": vector["type"]}, found)
        assert bytes([version]) + written == bytes.fromhex(vector["payload"]), vector
    return len(vectors["vectors"])


def main():
    files = [json.load(open(path, encoding="utf-8")) for path in sys.argv[1:3]]
    print(check(*files), "messages")


if __name__ == "__main__":
    main()
