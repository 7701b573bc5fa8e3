"""Peripherals of the STM32H743 that the image uses, as far as it can tell: clocks and power that
become ready, reset flags, pins, serial ports with FIFO, timers, the independent watchdog, and the
second bank of the flash.

Addresses and bits are those of ST's manual RM0433. Every register that is not named here keeps what
is written to it.
"""

from collections import deque

import dma
import flash
from processor import CYCLES_PER_US
from timers import (
    ARR, CCER, CCR1, CNT, CR1, DIER, ENABLED, CompareTimer, EncoderTimer, MotorTimer, Timer,
    UpdateTimer,
)  # fmt: skip

TIM1, TIM2, TIM4, TIM5 = 0x4001_0000, 0x4000_0000, 0x4000_0800, 0x4000_0C00
TIM6 = 0x4000_1000
USART2, USART3, UART7 = 0x4000_4400, 0x4000_4800, 0x4000_7800
GPIO, PORTS = 0x5802_0000, "ABCDEFGHIJK"
RCC, PWR, IWDG = 0x5802_4400, 0x5802_4800, 0x5800_4800
RCC_CR, RCC_CFGR, RCC_RSR, RCC_CSR, RCC_BDCR = (RCC + at for at in (0, 0x10, 0xD0, 0x74, 0x70))
RCC_PLLCKSELR, RCC_CIFR, RCC_CICR = RCC + 0x28, RCC + 0x64, RCC + 0x68
# Clock security of the external clock: switch, flag, and flags of oscillator and PLL.
CLOCK_WATCHED, CLOCK_FAILED, EXTERNAL_READY, PLL_READY = 1 << 19, 1 << 10, 1 << 17, 1 << 25
# SYSCFG_CFGR leads the supply's monitor and a lock-up to the timers' breaks, until a reset.
SYSCFG_CFGR, SUPPLY_BREAKS, LOCK_UP_BREAKS = 0x5800_0418, 1 << 2, 1 << 6
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
    "PE12": 1, "PE15": 1, "PA3": 2,
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

    def pull(self, name):
        """Returns the resistor inside: 0 none, 1 up, 2 down."""
        port, pin = PORTS.index(name[1]), int(name[2:])
        return self.registers.get((port, 0x0C), 0) >> 2 * pin & 3

    def level(self, name):
        """Returns the level of an input: what is connected, or what the resistor inside makes."""
        connected = self.inputs.get(name)
        return self.pull(name) == 1 if connected is None else connected

    def read(self, address):
        port, offset = divmod(address - GPIO, 0x400)
        if offset == 0x14:
            return self.levels[port]
        if offset == 0x10:
            letter = PORTS[port]
            high = (name for name, level in self.inputs.items() if level and name[1] == letter)
            return sum(1 << int(name[2:]) for name in high)
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

    BANK_2, BANK_2_BYTES = flash.BANK_2, flash.BANK_2_BYTES

    def __init__(self, bench, random):
        self.bench, self.random = bench, random
        self._supply_is_low = False
        self.clock_has_failed = False
        self.is_locked_up = False

    def connect(self, processor):
        self.processor = processor
        self.pins = Pins(processor, self.outputs_changed)
        self.motor = MotorTimer(processor, TIM1, self)
        self.clock = Timer(processor, TIM2)
        self.shutter = CompareTimer(processor, TIM5, self.outputs_changed)
        self.encoder = EncoderTimer(processor, TIM4, self.bench.counts)
        self.interval = UpdateTimer(processor, TIM6, self._interval)
        self.link = SerialPort(processor, self.pins, USART3, "PD9", "PD8")
        self.receiver = SerialPort(processor, self.pins, USART2, "PD6")
        self.autopilot = SerialPort(processor, self.pins, UART7, "PE7")
        self.bank = flash.Bank(processor, self.random)
        self.streams = dma.Streams(processor.uc.mem_write)
        self.requests = dma.Requests(self.streams)
        self.timers = (self.motor, self.clock, self.shutter, self.encoder, self.interval)
        self.ports = (self.link, self.receiver, self.autopilot)
        self.interrupts = (
            (28, self.clock.line), (38, self.receiver.line), (39, self.link.line),
            (50, self.shutter.line), (82, self.autopilot.line),
        )  # fmt: skip
        blocks = (*self.timers, *self.ports, self.bank, self.streams, self.requests)
        self.blocks = {block.base >> 10: block for block in blocks}
        self.flags = 0
        self.fed = None
        self.reset("power")

    def reset(self, cause):
        """Resets every peripheral; flags of earlier resets stay until they are removed."""
        self.registers = {RCC_CR: 0x83, PWR_CSR1: 0x4000}
        self.flags |= RESET_FLAGS[cause]
        self.is_locked_up = False
        self.fed = None
        self.pins.reset()
        for block in self.blocks.values():
            block.reset()
        self.outputs_changed()

    # Protections.

    def lock_up(self):
        """The processor has locked up."""
        self.is_locked_up = True
        self.look_at_breaks()

    @property
    def supply_is_low(self):
        return self._supply_is_low

    @supply_is_low.setter
    def supply_is_low(self, is_low):
        self._supply_is_low = is_low
        self.look_at_breaks()

    def sees_low_supply(self):
        return self._supply_is_low and self.registers.get(PWR_CR1, 0) & 0x10

    def fail_clock(self):
        """The ST-LINK gives no clock any more. Where that is watched the processor goes on by its
        own oscillator, which the model lets be as fast."""
        self.clock_has_failed = True
        if self.registers[RCC_CR] & CLOCK_WATCHED:
            self.registers[RCC_CIFR] = self.registers.get(RCC_CIFR, 0) | CLOCK_FAILED
            self.processor.nmi_pending = True
            self.look_at_breaks()
        else:
            self.processor.stop()

    def breaks(self):
        """Returns true while a system break is requested."""
        led = self.registers.get(SYSCFG_CFGR, 0)
        return bool(
            led & SUPPLY_BREAKS and self.sees_low_supply()
            or led & LOCK_UP_BREAKS and self.is_locked_up
            or self.registers.get(RCC_CIFR, 0) & CLOCK_FAILED
        )

    def brake_level(self):
        """Level of the brake: what is connected, or else what the resistor inside makes of it."""
        return self.pins.level("PE15")

    def look_at_breaks(self):
        self.motor.look()
        self.outputs_changed()

    def set_brake(self, level, width_ns=1e9):
        """Connects the brake to a level, or to nothing."""
        if width_ns >= self.motor.brake_filter_ns():
            self.pins.inputs["PE15"] = level
            self.look_at_breaks()

    def lines(self):
        """Returns the numbers of the interrupts that are asked for, lowest first."""
        return [number for number, line in self.interrupts if line()]

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
                if self.clock_has_failed:
                    # The PLL is fed by the clock that has failed, and start-up waits for it.
                    on &= ~(EXTERNAL_READY | PLL_READY) >> 1
                    self.processor.poll()
                return value | 0xC000 | (on & 1) << 2 | (on & 0x80) << 1 | (on & 0x1501_1000) << 1
            case _ if address == RCC_CFGR:
                return value & ~0x38 | (value & 7) << 3
            case _ if address == RCC_RSR:
                return self.flags
            case _ if address in (RCC_CSR, RCC_BDCR):
                return value | (value & 1) << 1
            case _ if address == PWR_CSR1:
                return 0xE000 | (0x10 if self.sees_low_supply() else 0)
            case _ if address == PWR_D3CR:
                return value | 0x2000
        return value

    def write(self, address, size, value):
        block = self.blocks.get(address >> 10)
        if block is not None:
            block.write(address - block.base, value)
            if block in (self.motor, self.shutter):
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
        elif address == RCC_CICR:
            cleared = self.registers.get(RCC_CIFR, 0) & ~value
            self.registers[RCC_CIFR] = cleared
        elif address == SYSCFG_CFGR:
            # Its bits can only be set.
            self.registers[address] = self.registers.get(address, 0) | value
            self.look_at_breaks()
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

    def outputs_changed(self, time=None):
        """Tells the bench what the chip drives, since a time that has just passed, or since now."""
        timer = self.motor.registers
        drives = (
            timer.get(CR1, 0) & ENABLED
            and timer.get(CCER, 0) & 1
            and self.motor.drives()
            and self.pins.has_function("PE9")
        )
        duty = min(1.0, timer.get(CCR1, 0) / (timer.get(ARR, 0) + 1)) if drives else 0.0
        direction = -1.0 if self.pins.is_high("PE10") else 1.0
        self.bench.drive(
            self.processor.now if time is None else time,
            duty=direction * duty,
            is_enabled=self.motor.enable_is_high() and self.pins.has_function("PE12"),
            is_open=self.shutter.is_high() and self.pins.has_function("PA3"),
        )

    def edge(self, name, time, width_ns=1000.0, is_falling=False):
        """An edge comes on a capture input, at a time that has just passed."""
        channel = CAPTURES[name]
        passes = width_ns >= self.clock.filter_ns(channel)
        if passes and self.clock.is_falling(channel) == is_falling and self.pins.has_function(name):
            self.clock.capture(channel, self.clock.count(time))
            if self.clock.registers.get(DIER, 0) >> 9 + channel & 1:
                request = dma.REQUESTS_OF_CAPTURES + channel
                self.requests.come(request, lambda address: self._latch(address, time))

    def _interval(self, time):
        self.requests.come(dma.REQUEST_OF_INTERVAL, lambda address: self._latch(address, time))

    def _latch(self, address, time):
        """Returns what the DMA reads from a register at a time that has just passed."""
        if address == TIM4 + CNT:
            return self.encoder.count(time)
        return self.read(address, 2)

    def index(self, counts):
        """The stage has crossed the mark, where the encoder has so many counts."""
        if self.pins.has_function("PD14") and not self.encoder.is_falling(2):
            self.encoder.capture(2, (counts - self.encoder.zero) & 0xFFFF)
