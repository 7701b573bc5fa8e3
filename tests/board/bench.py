"""What is connected to the board: motor and stage with encoder and index mark, shutter with sensor,
receiver of satellites, and the truth about all of them.

Positions are in mm along the FMC axis from the calibrated position, times in cycles of the
processor's clock, which runs `ppm` fast against true seconds.
"""

import datetime
import math
from collections import deque

from processor import CYCLES_PER_US

# Longest step of the integration, s.
STEP_S = 50e-6
# Steps that are remembered: more than an exposure.
REMEMBERED = 4096
# 2026-01-01T00:00:00 UTC, when the model's true time is 0.
EPOCH_S = 1_767_225_600


class Stage:
    """A mass under the force of a motor, with viscous and Coulomb friction and end stops.

    m dv/dt = F d - b v - F_c sgn(v), with the values to which the gains of the firmware's defaults
    belong (`Plant::REFERENCE`). In each step the acceleration is constant.
    """

    MASS_KG, FORCE_N, DAMPING_N_S_M, FRICTION_N = 0.3, 6.0, 22.0, 0.25
    ENDS_MM = (-2.4, 2.4)

    def __init__(self, position_mm=0.0):
        self.time_s = 0.0
        self.position_mm = position_mm
        self.speed_mm_s = 0.0
        self.duty = 0.0
        self.is_held = False
        self.steps = deque(maxlen=REMEMBERED)

    def acceleration(self):
        force = self.FORCE_N * self.duty - 1e-3 * self.DAMPING_N_S_M * self.speed_mm_s
        if self.is_held:
            return 0.0
        if self.speed_mm_s == 0.0:
            if abs(force) <= self.FRICTION_N:
                return 0.0
            return 1e3 * (force - math.copysign(self.FRICTION_N, force)) / self.MASS_KG
        return 1e3 * (force - math.copysign(self.FRICTION_N, self.speed_mm_s)) / self.MASS_KG

    def advance(self, time_s, crossed=None):
        """Moves on; calls `crossed` with the positions before and after each step."""
        while time_s > self.time_s:
            speed, rate = self.speed_mm_s, self.acceleration()
            rests = speed == 0.0 and rate == 0.0
            step_s = time_s - self.time_s if rests else min(STEP_S, time_s - self.time_s)
            if speed != 0.0 and speed * (speed + rate * step_s) < 0.0:
                # It comes to a standstill in this step.
                step_s = max(-speed / rate, 1e-9)
                end_speed = 0.0
            else:
                end_speed = speed + rate * step_s
            before = self.position_mm
            self.steps.append((self.time_s, before, speed, rate))
            after = before + (speed + 0.5 * rate * step_s) * step_s
            low, high = self.ENDS_MM
            if not low <= after <= high:
                after, end_speed = min(max(after, low), high), 0.0
            self.position_mm, self.speed_mm_s = after, end_speed
            self.time_s += step_s
            if crossed is not None and after != before:
                crossed(before, after)

    def at_mm(self, time_s):
        """Returns the position at a time that is remembered."""
        assert self.steps[0][0] <= time_s <= self.time_s
        begin, position, speed, rate = next(
            step for step in reversed(self.steps) if step[0] <= time_s
        )
        after_s = time_s - begin
        return position + (speed + 0.5 * rate * after_s) * after_s

    def mean_mm(self, start_s, end_s):
        """Returns the mean position over a time that is remembered."""
        assert self.steps and self.steps[0][0] <= start_s < end_s <= self.time_s
        ends = [step[0] for step in self.steps][1:] + [self.time_s]
        integral = 0.0
        for (begin, position, speed, rate), end in zip(self.steps, ends):
            a, b = max(begin, start_s) - begin, min(end, end_s) - begin
            if b > a:
                integral += position * (b - a) + speed * (b**2 - a**2) / 2
                integral += rate * (b**3 - a**3) / 6
        return integral / (end_s - start_s)


class Shake:
    """A shake of the stage that the motor does not cause: a sine from a time on."""

    def __init__(self, amplitude_mm=0.0, frequency_hz=1.0, start_s=0.0):
        self.amplitude_mm = amplitude_mm
        self.rad_s = 2 * math.pi * frequency_hz
        self.start_s = start_s

    def at_mm(self, time_s):
        return self.amplitude_mm * math.sin(self.rad_s * max(0.0, time_s - self.start_s))

    def mean_mm(self, start_s, end_s):
        """Returns the mean over a time at which it shakes."""
        assert self.amplitude_mm == 0.0 or start_s >= self.start_s
        begin, end = (math.cos(self.rad_s * (time - self.start_s)) for time in (start_s, end_s))
        return self.amplitude_mm * (begin - end) / (self.rad_s * (end_s - start_s))


class Bench:
    """Everything outside the chip."""

    ENCODER_STEP_MM = 1e-4
    INDEX_MM, INDEX_WIDTH_MM = 0.7, 0.02
    OPENING_S, CLOSING_S = 0.002, 0.002

    def __init__(self, ppm=0.0, phase=0.0, position_mm=0.0):
        self.cycles_per_s = 400e6 * (1 + 1e-6 * ppm)
        # Part of a step between the encoder's zero and the calibrated position.
        self.phase = phase
        self.stage = Stage(position_mm)
        self.shake = Shake()
        self.is_enabled = self.is_open = False
        # Signed duty of the pulses, whatever the enable is.
        self.duty = 0.0
        self.light_since = None
        # What happened, for the tests.
        self.frames = []
        self.commands = []
        self.enables = [(0, False)]
        self.triggers = []
        self.has_pulses = False

    def connect(self, processor, chip):
        self.processor, self.chip = processor, chip

    def seconds(self, time):
        return time / self.cycles_per_s

    def cycles(self, seconds):
        return round(seconds * self.cycles_per_s)

    # Motor and encoder.

    def counts(self, time):
        self._advance(time)
        place_mm = self.stage.position_mm + self.shake.at_mm(self.seconds(time))
        return math.floor(place_mm / self.ENCODER_STEP_MM + 0.5 + self.phase)

    def _place_mm(self, time_s):
        return self.stage.at_mm(time_s) + self.shake.at_mm(time_s)

    def _advance(self, time):
        self.stage.advance(self.seconds(time), self._crossed)

    def _crossed(self, before, after):
        """Latches the index where its pulse begins, on either way."""
        for mark, is_up in ((self.INDEX_MM, True), (self.INDEX_MM + self.INDEX_WIDTH_MM, False)):
            if (before < mark <= after) if is_up else (after <= mark < before):
                self.chip.index(math.floor(mark / self.ENCODER_STEP_MM + 0.5 + self.phase))

    # Outputs of the chip.

    def drive(self, time, duty, is_enabled, is_open):
        self._advance(time)
        self.duty = duty
        self.stage.duty = duty if is_enabled else 0.0
        if is_enabled != self.is_enabled:
            self.is_enabled = is_enabled
            self.enables.append((time, is_enabled))
        if is_open != self.is_open:
            self.is_open = is_open
            self.commands.append((time, is_open))
            after_s = self.OPENING_S if is_open else self.CLOSING_S
            at = time + self.cycles(after_s)
            self.processor.at(at, lambda: self._light(at, is_open))

    def _light(self, time, is_light):
        if is_light:
            self.light_since = time
            self._advance(time)
            self.light_speed_mm_s = self.stage.speed_mm_s
            self.chip.edge("PB10", time)
        elif self.light_since is not None:
            since, self.light_since = self.light_since, None
            self.chip.edge("PB11", time)
            self._advance(time)
            start_s, end_s = self.seconds(since), self.seconds(time)
            self.frames.append({
                "opened_s": start_s,
                "speed_mm_s": self.light_speed_mm_s,
                "closed_s": end_s,
                "mean_mm": self.stage.mean_mm(start_s, end_s) + self.shake.mean_mm(start_s, end_s),
                "travel_mm": self._place_mm(end_s) - self._place_mm(start_s),
                "unix_us": 1e6 * (EPOCH_S + (start_s + end_s) / 2),
            })  # fmt: skip

    # Inputs of the chip.

    def trigger(self, time, width_ns=1000.0):
        """Gives a pulse: its rising edge at a time, its falling edge after its width."""
        self.triggers.append(time)
        self.processor.at(time, lambda: self.chip.edge("PA0", time, width_ns))
        end = time + round(1e-3 * width_ns * CYCLES_PER_US)
        self.processor.at(end, lambda: self.chip.edge("PA0", end, width_ns, is_falling=True))

    def start_pulses(self):
        """Lets the receiver give time pulses, and the sentence that names each, 0.15 s later."""
        self.has_pulses = True
        self._plan_pulse(math.floor(self.seconds(self.processor.now)) + 1)

    def _plan_pulse(self, second):
        time = self.cycles(second)
        self.processor.at(time, lambda: self._pulse(time, second))

    def _pulse(self, time, second):
        if self.has_pulses:
            self.chip.edge("PB3", time)
            self.processor.at(
                time + self.cycles(0.15), lambda: self.chip.receiver.put(sentence(second))
            )
            self._plan_pulse(second + 1)


def sentence(second):
    """Returns the RMC sentence of a second."""
    then = datetime.datetime.fromtimestamp(EPOCH_S + second, datetime.timezone.utc)
    body = f"GPRMC,{then:%H%M%S}.00,A,4723.100,N,00832.400,E,136.1,090.0,{then:%d%m%y},,,A"
    checksum = 0
    for letter in body.encode():
        checksum ^= letter
    return f"${body}*{checksum:02X}\r\n".encode()
