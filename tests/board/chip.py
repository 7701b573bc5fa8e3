"""Peripherals of the STM32H743 that the image uses, as far as it can tell: clocks and power that
become ready, reset flags, pins, serial ports with FIFO, timers and the independent watchdog.

Addresses and bits are those of ST's manual RM0433. Every register that is not named here keeps what
is written to it.
"""

from collections import deque

from processor import CYCLES_PER_US
from timers import ARR, BDTR, CCER, CCR1, CR1, ENABLED, MAIN_OUTPUT, EncoderTimer, Timer

TIM1, TIM2, TIM4, TIM5 = 0x4001_0000, 0x4000_0000, 0x4000_0800, 0x4000_0C00
USART2, USART3, UART7 = 0x4000_4400, 0x4000_4800, 0x4000_7800
GPIO, PORTS = 0x5802_0000, "ABCDEFGHIJK"
RCC, PWR, IWDG = 0x5802_4400, 0x5802_4800, 0x5800_4800
RCC_CR, RCC_CFGR, RCC_RSR, RCC_CSR, RCC_BDCR = (RCC + at for at in (0, 0x10, 0xD0, 0x74, 0x70))
RCC_PLLCKSELR = RCC + 0x28
PWR_CR1, PWR_CSR1, PWR_D3CR = PWR, PWR + 4, PWR + 0x18

# Flags of RCC_RSR by cause, RM0433 table 56: the processor's flag and the pin's come with each.
RESET_FLAGS = {
    "power": 0x00FA_0000,
    "brown-out": 0x0062_0000,
    "software": 0x0142_0000,
    "watchdog": 0x0442_0000,
    "pin": 0x0042_0000,
}
REMOVE_FLAGS = 1 << 16

# Watchdog after its start: 4096 periods of the 32 kHz oscillator divided by 4.
WATCHDOG_CYCLES = 4096 * 4 * CYCLES_PER_US * 1_000_000 // 32_000

# Alternate functions by which pins reach peripherals, from the data sheet of the STM32H743.
FUNCTIONS = {
    "PA0": 1, "PB3": 1, "PB10": 1, "PB11": 1, "PD12": 2, "PD13": 2, "PD14": 2, "PE9": 1,
    "PD8": 7, "PD9": 7, "PD6": 7, "PE7": 7,
}  # fmt: skip
CAPTURES = {"PA0": 0, "PB3": 1, "PB10": 2, "PB11": 3}


class Pins:
    """Ports of pins: their modes, and the levels that the chip drives."""

    def __init__(self, processor, changed):
        self.processor = processor
        self.changed = changed
        self.inputs = {}
        self.reset()

    def reset(self):
        self.registers = {(port, 0): 0xFFFF_FFFF for port in range(len(PORTS))}
        self.levels = [0] * len(PORTS)

    def mode(self, name):
        port, pin = PORTS.index(name[1]), int(name[2:])
        return self.registers[(port, 0)] >> 2 * pin & 3

    def is_output(self, name):
        return self.mode(name) == 1

    def has_function(self, name):
        """Returns true if the pin is given to the peripheral that it is for."""
        port, pin = PORTS.index(name[1]), int(name[2:])
        function = self.registers.get((port, 0x20 + 4 * (pin // 8)), 0) >> 4 * (pin % 8) & 0xF
        return self.mode(name) == 2 and function == FUNCTIONS[name]

    def is_high(self, name):
        """Returns the level on a wire: what the chip drives, or low by the resistor outside."""
        port, pin = PORTS.index(name[1]), int(name[2:])
        return bool(self.is_output(name) and self.levels[port] >> pin & 1)

    def read(self, address):
        port, offset = divmod(address - GPIO, 0x400)
        if offset == 0x14:
            return self.levels[port]
        if offset == 0x10:
            letter = PORTS[port]
            high = (pin for pin in range(16) if self.inputs.get(f"P{letter}{pin}"))
            return sum(1 << pin for pin in high)
        return self.registers.get((port, offset), 0)

    def write(self, address, value):
        port, offset = divmod(address - GPIO, 0x400)
        if offset == 0x18:
            before = self.levels[port]
            self.levels[port] = (before | value & 0xFFFF) & ~(value >> 16 & ~value)
            if self.levels[port] == before:
                return
        elif offset == 0x14:
            self.levels[port] = value
        else:
            self.registers[(port, offset)] = value
        self.changed()


class SerialPort:
    """A serial port with FIFOs of 16 bytes, at the speed of its divider."""

    FIFO = 16

    def __init__(self, processor, pins, base, receive, transmit=None):
        self.processor, self.pins, self.base = processor, pins, base
        self.receive_pin, self.transmit_pin = receive, transmit
        self.sent = bytearray()
        self.waiting = deque()
        self.reset()

    def reset(self):
        self.registers = {}
        self.received = deque()
        self.sending = 0
        self.overrun = False
        self.is_receiving = bool(self.waiting)
        self.epoch = getattr(self, "epoch", 0) + 1
        if self.is_receiving:
            self._next_byte()

    @property
    def byte_cycles(self):
        # Ten bits of the divider's periods of 10 ns.
        return 10 * self.registers.get(0x0C, 109) * CYCLES_PER_US // 100

    def put(self, data):
        """Puts bytes on the wire, which come one after the other."""
        self.waiting.extend(data)
        if self.waiting and not self.is_receiving:
            self.is_receiving = True
            self._next_byte()

    def _next_byte(self):
        epoch = self.epoch
        self.processor.after(self.byte_cycles, lambda: self._come(epoch))

    def _come(self, epoch):
        if epoch != self.epoch or not self.waiting:
            return
        byte = self.waiting.popleft()
        if self.registers.get(0, 0) & 5 == 5 and self.pins.has_function(self.receive_pin):
            if len(self.received) < self.FIFO:
                self.received.append(byte)
            else:
                self.overrun = True
        self.is_receiving = bool(self.waiting)
        if self.is_receiving:
            self._next_byte()

    def line(self):
        return self.registers.get(0, 0) & 1 << 5 and (self.received or self.overrun)

    def read(self, offset):
        if offset == 0x1C:
            if self.sending == self.FIFO:
                self.processor.poll()
            return (
                (8 if self.overrun else 0)
                | (0x20 if self.received else 0)
                | (0x80 if self.sending < self.FIFO else 0)
                | (0x40 if self.sending == 0 else 0)
                | 0x60_0000
            )
        if offset == 0x24:
            return self.received.popleft() if self.received else 0
        return self.registers.get(offset, 0)

    def write(self, offset, value):
        if offset == 0x20:
            self.overrun = self.overrun and not value & 8
        elif offset == 0x28:
            if self.sending == 0:
                self._send_later()
            self.sending += 1
            if self.pins.has_function(self.transmit_pin):
                self.sent.append(value & 0xFF)
        else:
            self.registers[offset] = value

    def _send_later(self):
        epoch = self.epoch
        self.processor.after(self.byte_cycles, lambda: self._sent(epoch))

    def _sent(self, epoch):
        if epoch == self.epoch:
            self.sending -= 1
            if self.sending:
                self._send_later()


class Chip:
    """All peripherals. `bench` is what is connected: it is told of outputs and asked for counts."""

    def __init__(self, bench):
        self.bench = bench
        self.supply_is_low = False

    def connect(self, processor):
        self.processor = processor
        self.pins = Pins(processor, self.outputs_changed)
        self.motor = Timer(processor, TIM1, bits=16)
        self.clock = Timer(processor, TIM2)
        self.shutter = Timer(processor, TIM5)
        self.encoder = EncoderTimer(processor, TIM4, self.bench.counts)
        self.link = SerialPort(processor, self.pins, USART3, "PD9", "PD8")
        self.receiver = SerialPort(processor, self.pins, USART2, "PD6")
        self.autopilot = SerialPort(processor, self.pins, UART7, "PE7")
        self.timers = (self.motor, self.clock, self.shutter, self.encoder)
        self.ports = (self.link, self.receiver, self.autopilot)
        self.interrupts = (
            (28, self.clock), (50, self.shutter),
            (39, self.link), (38, self.receiver), (82, self.autopilot),
        )  # fmt: skip
        self.blocks = {block.base >> 10: block for block in (*self.timers, *self.ports)}
        self.flags = 0
        self.fed = None
        self.reset("power")

    def reset(self, cause):
        """Resets every peripheral; flags of earlier resets stay until they are removed."""
        self.registers = {RCC_CR: 0x83, PWR_CSR1: 0x4000}
        self.flags |= RESET_FLAGS[cause]
        self.fed = None
        self.pins.reset()
        for block in (*self.timers, *self.ports):
            block.reset()
        self.outputs_changed()

    def lock_up(self):
        """The processor has locked up; nothing on this chip is told of it."""

    def lines(self):
        return {number for number, block in self.interrupts if block.line()}

    # Registers.

    def read(self, address, size):
        block = self.blocks.get(address >> 10)
        if block is not None:
            return block.read(address - block.base)
        if GPIO <= address < GPIO + 0x400 * len(PORTS):
            return self.pins.read(address)
        value = self.registers.get(address & ~3, 0)
        match address:
            case _ if address == RCC_CR:
                # Each oscillator and PLL is ready as soon as it is on.
                on = value & 0x1501_1081
                return value | 0xC000 | (on & 1) << 2 | (on & 0x80) << 1 | (on & 0x1501_1000) << 1
            case _ if address == RCC_CFGR:
                return value & ~0x38 | (value & 7) << 3
            case _ if address == RCC_RSR:
                return self.flags
            case _ if address in (RCC_CSR, RCC_BDCR):
                return value | (value & 1) << 1
            case _ if address == PWR_CSR1:
                is_low = self.supply_is_low and self.registers.get(PWR_CR1, 0) & 0x10
                return 0xE000 | (0x10 if is_low else 0)
            case _ if address == PWR_D3CR:
                return value | 0x2000
        return value

    def write(self, address, size, value):
        block = self.blocks.get(address >> 10)
        if block is not None:
            block.write(address - block.base, value)
            if block is self.motor:
                self.outputs_changed()
        elif GPIO <= address < GPIO + 0x400 * len(PORTS):
            self.pins.write(address, value)
        elif address == IWDG:
            if value == 0xCCCC or (value == 0xAAAA and self.fed is not None):
                self._feed()
        elif address == RCC_PLLCKSELR:
            # Source and dividers stay as they are while their PLL is on.
            kept = 0
            for pll in range(3):
                if self.registers[RCC_CR] >> 24 + 2 * pll & 1:
                    kept |= 3 | 0x3F << 4 + 8 * pll
            before = self.registers.get(address, 0)
            self.registers[address] = before & kept | value & ~kept
        elif address == RCC_RSR:
            if value & REMOVE_FLAGS:
                self.flags = 0
        else:
            self.registers[address] = value

    # Watchdog.

    def _feed(self):
        if self.fed is None:
            self.processor.after(WATCHDOG_CYCLES, self._look_at_watchdog)
        self.fed = self.processor.now

    def _look_at_watchdog(self):
        if self.fed is None:
            return
        left = self.fed + WATCHDOG_CYCLES - self.processor.now
        if left <= 0:
            self.processor.reset("watchdog")
        else:
            self.processor.after(left, self._look_at_watchdog)

    # Wires.

    def outputs_changed(self):
        """Tells the bench what the chip drives."""
        timer = self.motor.registers
        drives = (
            timer.get(CR1, 0) & ENABLED
            and timer.get(CCER, 0) & 1
            and timer.get(BDTR, 0) & MAIN_OUTPUT
            and self.pins.has_function("PE9")
        )
        duty = min(1.0, timer.get(CCR1, 0) / (timer.get(ARR, 0) + 1)) if drives else 0.0
        direction = -1.0 if self.pins.is_high("PE10") else 1.0
        self.bench.drive(
            self.processor.now,
            duty=direction * duty,
            is_enabled=self.pins.is_high("PE12"),
            is_open=self.pins.is_high("PC10"),
        )

    def edge(self, name, time, width_ns=1000.0):
        """A rising edge comes on a capture input, at a time that has just passed."""
        channel = CAPTURES[name]
        samples = self.clock.filter_samples(channel)
        if self.pins.has_function(name) and width_ns >= samples * 5.0:
            self.clock.capture(channel, self.clock.count(time))

    def index(self, counts):
        """The stage has crossed the mark, where the encoder has so many counts."""
        if self.pins.has_function("PD14"):
            self.encoder.capture(2, (counts - self.encoder.zero) & 0xFFFF)
