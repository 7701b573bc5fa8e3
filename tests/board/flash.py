"""The second bank of the flash and its registers (RM0433, section 4): words of 32 bytes with an ECC,
written once between two erasures, in sectors of 128 KB.

The bank is memory behind callbacks, so that every access is judged. It keeps its content through
resets; a write or an erasure that a reset cuts leaves words as `torn` says.
"""

from processor import CYCLES_PER_US

BANK_2, BANK_2_BYTES = 0x0810_0000, 0x10_0000
SECTOR, WORD = 0x2_0000, 32
KEYR, CR, SR, CCR, FAILED_AT = 0x104, 0x10C, 0x110, 0x114, 0x160
KEYS = (0x4567_0123, 0xCDEF_89AB)
LOCK, PG, SER, START = 1, 1 << 1, 1 << 2, 1 << 7
BUSY, WAITS, QUEUED = 1, 1 << 1, 1 << 2
ENDED, PROTECTED, SEQUENCE, STROBE, INCOMPLETE, OPERATION = (
    1 << bit for bit in (16, 17, 18, 19, 21, 22)
)  # fmt: skip
CORRECTED, UNREADABLE = 1 << 25, 1 << 26
FLAGS = 0x1FEF_0000
# The bits of the control register that a write keeps: the others start something, or are one shot.
CR_AT_RESET = 0x31
BLANK = b"\xff" * WORD
# Typical times at the parallelism of the reset, 64 bits, from the data sheet: a word, and a sector.
WRITE_CYCLES = 100 * CYCLES_PER_US
ERASURE_CYCLES = 1_000_000 * CYCLES_PER_US


class Bank:
    """The bank. `data` is its content, `unreadable` and `corrected` are the offsets of words with
    two wrong bits and with one."""

    base = 0x5200_2000

    def __init__(self, processor, random):
        self.processor, self.random = processor, random
        self.data = bytearray(b"\xff" * BANK_2_BYTES)
        self.unreadable, self.corrected = set(), set()
        # Sectors that the option bytes protect, and words and sectors that do not take anything.
        self.protected, self.worn = set(), set()
        self.erasure_cycles = ERASURE_CYCLES
        # What has been begun: "erase" or "write", and an offset.
        self.operations = []
        # Words in the processor's cache.
        self.lines = {}
        # A write of the registers waits for a bank that is busy, as the bus does; otherwise the test
        # fails, since no image should make one.
        self.lets_wait = False
        # Called at the half of an operation with its number, from 0.
        self.half_way = None
        self.busy_until = 0
        self.doing = None
        self.reset()

    def keep(self, other):
        """Takes the content of another bank over."""
        self.data[:] = other.data
        self.unreadable, self.corrected = set(other.unreadable), set(other.corrected)

    def reset(self):
        if self.doing is not None:
            self._tear(*self.doing)
        self.doing = None
        self.registers = {CR: CR_AT_RESET}
        self.status = 0
        self.keys = []
        self.locked_out = False
        self.failed_at = 0
        self.buffer = {}
        self.lines = {}
        self.epoch = getattr(self, "epoch", 0) + 1

    # Registers.

    def read(self, offset):
        if offset == SR:
            if self.doing is not None:
                self.processor.poll()
            busy = BUSY | QUEUED if self.doing is not None else 0
            return self.status | busy | (WAITS if self.buffer else 0)
        return {FAILED_AT: self.failed_at}.get(offset, self.registers.get(offset, 0))

    def write(self, offset, value):
        if offset == KEYR:
            self._key(value)
        elif offset == CCR:
            self.status &= ~(value & FLAGS)
        elif offset == CR:
            self._control(value)
        elif offset != SR:
            self.registers[offset] = value

    @property
    def control(self):
        return self.registers[CR]

    def _key(self, value):
        """Both keys in order unlock; anything else, and keys for what is unlocked, lock the bank until
        the next reset, with a fault of the bus."""
        self.keys.append(value)
        if self.locked_out or not self.control & LOCK or self.keys != list(KEYS[: len(self.keys)]):
            self.locked_out = True
            self.registers[CR] |= LOCK
            self.processor.fail_bus(0)
        elif len(self.keys) == len(KEYS):
            self.registers[CR] &= ~LOCK
            self.keys = []

    def _control(self, value):
        if self.control & LOCK:
            return
        if self.doing is not None:
            assert self.lets_wait, "the register is written while the bank is busy"
            self.processor.now = max(self.processor.now, self.busy_until)
            self._end(self.epoch)
        self.registers[CR] = value & ~START
        if value & LOCK:
            self.keys = []
        if not value & PG:
            self.buffer = {}
        if value & START and value & SER:
            sector = value >> 8 & 7
            if value & PG or self.status & (STROBE | INCOMPLETE):
                self.status |= SEQUENCE
            elif sector in self.protected:
                self.status |= PROTECTED
            else:
                self._begin("erase", sector * SECTOR, self.erasure_cycles)

    # Memory.

    def load(self, offset, size):
        """Reads bytes; a bank that is busy lets the processor wait."""
        if self.doing is not None:
            self.processor.now = max(self.processor.now, self.busy_until)
            self._end(self.epoch)
        word = offset - offset % WORD
        if word in self.unreadable:
            if not self.status & (CORRECTED | UNREADABLE):
                self.failed_at = word // WORD
            self.status |= UNREADABLE
            self.processor.fail_bus(BANK_2 + offset)
            return 0xDEAD_BEEF & (1 << 8 * size) - 1
        if word in self.corrected:
            self.status |= CORRECTED
            self.failed_at = word // WORD
        content = self.data[word : word + WORD]
        if self.processor.caches(BANK_2 + offset):
            # A line of the cache is a word, and what is written goes past it.
            content = self.lines.setdefault(word, bytes(content))
        return int.from_bytes(content[offset - word : offset - word + size], "little")

    def store(self, offset, size, value):
        """Takes bytes of a word into the buffer; whole it is written."""
        word = offset - offset % WORD
        if self.doing is not None or not self.control & PG or self.status & (STROBE | INCOMPLETE):
            self.status |= SEQUENCE
        elif word // SECTOR in self.protected:
            self.status |= PROTECTED
        elif any(place - place % WORD != word for place in self.buffer):
            self.status |= INCOMPLETE
        else:
            places = range(offset, offset + size)
            if any(place in self.buffer for place in places):
                self.status |= STROBE
            self.buffer.update(zip(places, value.to_bytes(size, "little")))
            if len(self.buffer) == WORD:
                self._begin("write", word, WRITE_CYCLES)

    # Operations.

    def _begin(self, name, offset, cycles):
        self.doing = name, offset
        number = len(self.operations)
        self.operations.append(self.doing)
        self.busy_until = self.processor.now + cycles
        epoch = self.epoch
        if self.half_way is not None:
            self.processor.after(cycles // 2, lambda: self._half(epoch, number))
        self.processor.at(self.busy_until, lambda: self._end(epoch))

    def _half(self, epoch, number):
        if epoch == self.epoch and self.doing is not None:
            self.half_way(number)

    def _end(self, epoch):
        if epoch != self.epoch or self.doing is None:
            return
        name, offset = self.doing
        self.doing = None
        if offset in self.worn:
            self.status |= OPERATION
            self.buffer = {}
        elif name == "erase":
            self.erase(offset)
            self.status |= ENDED
        else:
            self.write_word(offset, bytes(self.buffer[offset + at] for at in range(WORD)))
            self.buffer = {}
            self.status |= ENDED

    def erase(self, sector):
        """Makes a sector blank."""
        self.data[sector : sector + SECTOR] = b"\xff" * SECTOR
        for words in (self.unreadable, self.corrected):
            words.difference_update(range(sector, sector + SECTOR, WORD))

    def write_word(self, offset, word):
        """Writes a word. What was written before has an ECC that does not fit the bits of both."""
        before = bytes(self.data[offset : offset + WORD])
        self.data[offset : offset + WORD] = bytes(a & b for a, b in zip(before, word))
        if before not in (BLANK, word):
            self.unreadable.add(offset)

    def _tear(self, name, offset):
        """Leaves what a cut in the middle does: words as before, done, or unreadable."""
        if name == "write":
            match self.random.randrange(3):
                case 1:
                    self.unreadable.add(offset)
                case 2:
                    self.write_word(offset, bytes(self.buffer[offset + at] for at in range(WORD)))
            return
        for word in range(offset, offset + SECTOR, WORD):
            match self.random.randrange(3):
                case 1:
                    self.unreadable.add(word)
                case 2:
                    self.data[word : word + WORD] = BLANK
                    self.unreadable.discard(word)
