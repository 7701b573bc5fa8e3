"""Timers of the model: a counter with captures, a compare output, an encoder or a pulse width."""

from processor import CYCLES_PER_US

CR1, SMCR, DIER, SR, EGR, CCMR1, CCER, CNT, PSC, ARR, CCR1, BDTR, AF1 = (
    0x00, 0x08, 0x0C, 0x10, 0x14, 0x18, 0x20, 0x24, 0x28, 0x2C, 0x34, 0x44, 0x60,
)  # fmt: skip
ENABLED = 1
ENCODER_MODE_3 = 3
MAIN_OUTPUT = 1 << 15
# Cycles of the processor per cycle of the timers' clock, 200 MHz.
TIMER_CYCLES = CYCLES_PER_US // 200
# Filters of the inputs, by number: periods of the timer's clock through which a level must hold,
# the sampling clock undivided (RM0433, TIMx_CCMR1, field IC1F).
FILTER_PERIODS = (0, 2, 4, 8, 12, 16, 24, 32, 48, 64, 80, 96, 128, 160, 192, 256)
PERIOD_NS = 5.0


class Timer:
    """A timer that counts up. The time of its events is that of the model, not that of a slice."""

    def __init__(self, processor, base, bits=32):
        self.processor = processor
        self.base = base
        self.top = (1 << bits) - 1
        self.reset()

    def reset(self):
        self.registers = {ARR: self.top}
        self.prescaler = 1
        self.start_count = 0
        self.start_time = 0
        self.status = 0
        self.epoch = getattr(self, "epoch", 0) + 1

    @property
    def runs(self):
        return self.registers.get(CR1, 0) & ENABLED

    def count(self, time):
        """Returns the counter at a time."""
        if not self.runs:
            return self.start_count
        ticks = (time - self.start_time) // (TIMER_CYCLES * self.prescaler)
        return (self.start_count + ticks) % (self.registers[ARR] + 1)

    def set_count(self, count):
        self.start_count = count & self.top
        # The prescaler's phase is kept, as the hardware keeps it.
        period = TIMER_CYCLES * self.prescaler
        now = self.processor.now
        self.start_time = now - (now - self.start_time) % period if self.runs else now

    def read(self, offset):
        if offset == CNT:
            return self.count(self.processor.now)
        if offset == SR:
            return self.status
        if CCR1 <= offset < CCR1 + 16:
            channel = (offset - CCR1) // 4
            if self.is_input(channel):
                self.status &= ~(2 << channel)
        return self.registers.get(offset, 0)

    def write(self, offset, value):
        now = self.processor.now
        if offset == CNT:
            self.set_count(value)
        elif offset == SR:
            self.status &= value
        elif offset == EGR:
            if value & 1:
                self.prescaler = self.registers.get(PSC, 0) + 1
                self.start_count, self.start_time = 0, now
            self.status |= value & 0x1E
        elif offset == CR1:
            count = self.count(now)
            self.registers[CR1] = value
            self.start_count, self.start_time = count, now
        else:
            self.registers[offset] = value
        is_mode = offset in (CCMR1, CCMR1 + 4)
        if is_mode or offset in (CNT, EGR, CR1, DIER) or CCR1 <= offset < CCR1 + 16:
            self.epoch += 1
            for channel in range(4):
                self._plan(channel)

    def line(self):
        """Returns true while the timer asks for its interrupt."""
        return self.status & self.registers.get(DIER, 0) & 0x1F

    def is_input(self, channel):
        mode = self.registers.get(CCMR1 + 4 * (channel // 2), 0) >> 8 * (channel % 2)
        return mode & 3 == 1

    def filter_ns(self, channel):
        mode = self.registers.get(CCMR1 + 4 * (channel // 2), 0) >> 8 * (channel % 2)
        return PERIOD_NS * FILTER_PERIODS[mode >> 4 & 0xF]

    def is_falling(self, channel):
        """Returns true if a channel captures at falling edges."""
        return self.registers.get(CCER, 0) >> 4 * channel & 0xA == 2

    def capture(self, channel, count):
        """Latches a count. A latch that nobody has read is overwritten, which the status says."""
        if not self.is_input(channel) or not self.registers.get(CCER, 0) >> 4 * channel & 1:
            return
        if self.status >> channel & 2:
            self.status |= 0x200 << channel
        self.status |= 2 << channel
        self.registers[CCR1 + 4 * channel] = count

    def is_compared(self, channel):
        """Returns true if anybody asks to be told of a channel's match."""
        return bool(self.registers.get(DIER, 0) >> channel & 2)

    def _plan(self, channel):
        """Plans the next match of a channel that compares."""
        if self.is_input(channel) or not self.runs or not self.is_compared(channel):
            return
        now, period = self.processor.now, TIMER_CYCLES * self.prescaler
        ahead = (self.registers.get(CCR1 + 4 * channel, 0) - self.count(now)) % (
            self.registers[ARR] + 1
        ) or self.registers[ARR] + 1
        phase = (now - self.start_time) % period
        epoch, time = self.epoch, now + ahead * period - phase
        self.processor.at(time, lambda: self._match(channel, epoch, time))

    def _match(self, channel, epoch, time):
        if epoch == self.epoch:
            self.status |= 2 << channel
            self._matched(channel, time)
            self._plan(channel)

    def _matched(self, channel, time):
        """A channel has matched at a time that has just passed."""


class CompareTimer(Timer):
    """TIM5: channel 4 drives a line, which a match changes at its own time, or a forced level."""

    CHANNEL = 3
    ACTIVE_ON_MATCH, INACTIVE_ON_MATCH, FORCED_INACTIVE, FORCED_ACTIVE = 1, 2, 4, 5

    def __init__(self, processor, base, changed):
        self.changed = changed
        super().__init__(processor, base)

    def reset(self):
        super().reset()
        self.is_active = False

    @property
    def mode(self):
        mode = self.registers.get(CCMR1 + 4, 0)
        return mode >> 12 & 7 | mode >> 21 & 8

    def is_compared(self, channel):
        return super().is_compared(channel) or channel == self.CHANNEL and self.mode in (
            self.ACTIVE_ON_MATCH, self.INACTIVE_ON_MATCH,
        )  # fmt: skip

    def write(self, offset, value):
        super().write(offset, value)
        if offset == CCMR1 + 4:
            if self.mode in (self.FORCED_ACTIVE, self.FORCED_INACTIVE):
                self._set(self.mode == self.FORCED_ACTIVE, self.processor.now)

    def _matched(self, channel, time):
        super()._matched(channel, time)
        if channel == self.CHANNEL and self.mode in (self.ACTIVE_ON_MATCH, self.INACTIVE_ON_MATCH):
            self._set(self.mode == self.ACTIVE_ON_MATCH, time)

    def _set(self, is_active, time):
        if is_active != self.is_active:
            self.is_active = is_active
            self.changed(time)

    def is_high(self):
        """Level of the output; low where the channel does not drive it."""
        return self.is_active and self.registers.get(CCER, 0) >> 4 * self.CHANNEL & 3 == 1


class UpdateTimer(Timer):
    """TIM6: a counter whose wraps request transfers."""

    REQUESTS = 1 << 8

    def __init__(self, processor, base, updated):
        self.updated = updated
        super().__init__(processor, base, bits=16)

    def _plan(self, channel):
        """Plans the next wrap; it has no channels."""
        if channel or not self.runs or not self.registers.get(DIER, 0) & self.REQUESTS:
            return
        now, period = self.processor.now, TIMER_CYCLES * self.prescaler
        ahead = self.registers[ARR] + 1 - self.count(now)
        phase = (now - self.start_time) % period
        self._wrap_at(now + ahead * period - phase, self.epoch)

    def _wrap_at(self, time, epoch):
        self.processor.at(time, lambda: self._wrap(time, epoch))

    def _wrap(self, time, epoch):
        if epoch == self.epoch:
            self.updated(time)
            turn = (self.registers[ARR] + 1) * TIMER_CYCLES * self.prescaler
            self._wrap_at(time + turn, epoch)


class MotorTimer(Timer):
    """TIM1: pulses on channel 1, a forced level on the complementary output of channel 3, and the
    break, which takes both outputs low and stays until software enables them again.

    `chip` says whether the brake is pulled and whether a system break is requested."""

    BRAKE, SYSTEM = 1 << 7, 1 << 13
    FORCED_ACTIVE = 5
    BREAK_ENABLED, BREAK_ACTIVE_HIGH, IDLE_LEVEL = 1 << 12, 1 << 13, 1 << 10
    INPUT_ENABLED, INPUT_INVERTED = 1, 1 << 9

    def __init__(self, processor, base, chip):
        self.chip = chip
        super().__init__(processor, base, bits=16)

    def reset(self):
        super().reset()
        self.registers[AF1] = self.INPUT_ENABLED

    def requests(self):
        """Returns the flags of the breaks that are requested now."""
        if not self.registers.get(BDTR, 0) & self.BREAK_ENABLED:
            return 0
        source = self.registers[AF1]
        inverted = bool(source & self.INPUT_INVERTED)
        level = bool(source & self.INPUT_ENABLED) and self.chip.brake_level() != inverted
        is_braked = level == bool(self.registers[BDTR] & self.BREAK_ACTIVE_HIGH)
        return (self.BRAKE if is_braked else 0) | (self.SYSTEM if self.chip.breaks() else 0)

    def look(self):
        """Lets what is requested now act."""
        requests = self.requests()
        self.status |= requests
        if requests:
            self.registers[BDTR] &= ~MAIN_OUTPUT

    def brake_filter_ns(self):
        return PERIOD_NS * FILTER_PERIODS[self.registers.get(BDTR, 0) >> 16 & 0xF]

    def write(self, offset, value):
        super().write(offset, value)
        # The main output can be enabled and flags can be cleared where nothing is requested.
        if offset == BDTR and self.status & self.SYSTEM:
            self.registers[BDTR] &= ~MAIN_OUTPUT
        self.look()

    def drives(self):
        """Returns true while the outputs do what their channels say."""
        return self.registers.get(BDTR, 0) & MAIN_OUTPUT

    def enable_is_high(self):
        """Level of the complementary output of channel 3; low where the timer does not drive it."""
        mode = self.registers.get(CCMR1 + 4, 0) >> 4 & 7
        only_complementary = self.registers.get(CCER, 0) >> 8 & 0xF == 4
        return bool(self.drives() and only_complementary and mode == self.FORCED_ACTIVE)


class EncoderTimer(Timer):
    """A timer that counts the edges of two tracks."""

    def __init__(self, processor, base, tracks):
        self.tracks = tracks
        super().__init__(processor, base, bits=16)

    def reset(self):
        super().reset()
        self.zero = 0

    def count(self, time):
        if not self.runs or self.registers.get(SMCR, 0) & 7 != ENCODER_MODE_3:
            return self.start_count
        return (self.tracks(time) - self.zero) & 0xFFFF

    def read(self, offset):
        # What the tracks have done by now may have latched; to count looks at them, too.
        if offset != CNT:
            self.tracks(self.processor.now)
        return super().read(offset)

    def _plan(self, channel):
        """Plans nothing: it counts tracks, not time."""

    def write(self, offset, value):
        super().write(offset, value)
        if offset in (CNT, CR1, EGR):
            # It counts from what it held when it began.
            self.zero = self.tracks(self.processor.now) - self.start_count
