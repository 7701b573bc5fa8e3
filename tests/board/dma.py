"""The part of the DMA that the image uses: circular transfers of 16 bits from a register to memory,
each requested by a capture of the clock or by the wrap of a timer.

Registers are those of ST's manual RM0433: streams of DMA1, and DMAMUX1, which leads requests to
them.
"""

DMA1, DMAMUX1 = 0x4002_0000, 0x4002_0800
# Requests of TIM2's channels, RM0433 table 121, from channel 1 on.
REQUESTS_OF_CAPTURES = 18
# Request of TIM6's wraps.
REQUEST_OF_INTERVAL = 69
STREAMS, FIRST_STREAM, STREAM_BYTES = 8, 0x10, 0x18
CR, NDTR, PAR, M0AR = 0x00, 0x04, 0x08, 0x0C
# Enabled, circular, memory pointer moves, both sides 16 bits, from a register to memory.
MODE = 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1
MODE_MASK = 0x3 << 13 | 0x3 << 11 | 1 << 10 | 1 << 9 | 1 << 8 | 3 << 6 | 1


class Streams:
    base = DMA1

    def __init__(self, write_memory):
        self.write_memory = write_memory
        # Transfers for each request.
        self.transfers = 1
        self.reset()

    def reset(self):
        self.registers = {}
        self.lengths = {}

    def read(self, offset):
        return self.registers.get(offset, 0)

    def write(self, offset, value):
        self.registers[offset] = value
        stream, register = divmod(offset - FIRST_STREAM, STREAM_BYTES)
        if register == NDTR:
            self.lengths[stream] = value & 0xFFFF

    def serve(self, stream, read_register):
        """Makes the transfers of a request."""
        for _ in range(self.transfers):
            self._transfer(stream, read_register)

    def _transfer(self, stream, read_register):
        of = {name: FIRST_STREAM + STREAM_BYTES * stream + name for name in (CR, NDTR, PAR, M0AR)}
        if self.registers.get(of[CR], 0) & MODE_MASK != MODE:
            return
        length, left = self.lengths[stream], self.registers[of[NDTR]]
        place = self.registers[of[M0AR]] + 2 * (length - left)
        value = read_register(self.registers[of[PAR]])
        self.write_memory(place, (value & 0xFFFF).to_bytes(2, "little"))
        self.registers[of[NDTR]] = left - 1 or length


class Requests:
    base = DMAMUX1

    def __init__(self, streams):
        self.streams = streams
        self.reset()

    def reset(self):
        self.registers = {}

    def read(self, offset):
        return self.registers.get(offset, 0)

    def write(self, offset, value):
        self.registers[offset] = value

    def come(self, request, read_register):
        """A peripheral requests a transfer."""
        for stream in range(STREAMS):
            if self.registers.get(4 * stream, 0) & 0x7F == request:
                self.streams.serve(stream, read_register)
