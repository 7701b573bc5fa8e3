"""Processor of the model: Unicorn runs the instructions of a Cortex-M7; exceptions, sleep, faults,
lock-up, resets and the passing of time are here.

Time counts in cycles of the processor. An instruction takes one, a read or write of a peripheral
`BUS_CYCLES` more. Interrupts are looked at between slices of up to `SLICE` instructions, more often
while one waits for the end of a critical section; whatever happens outside is stamped with its own
time.
"""

import heapq
import re
import struct

import unicorn
from registers import Registers
from unicorn import arm_const as arm

# Cycles per microsecond: 400 MHz.
CYCLES_PER_US = 400
# Cycles of an access to a peripheral over the slower buses.
BUS_CYCLES = 24
# Most instructions between two looks at interrupts, while one is masked, and while a register is
# polled.
SLICE = 1000
SLICE_WHILE_MASKED = 24
SLICE_WHILE_POLLED = 100

# The first bank of the flash; the second is the chip's, as every access to it is judged.
FLASH, FLASH_BYTES = 0x0800_0000, 0x10_0000
ITCM, ITCM_BYTES = 0x0000_0000, 0x1_0000
DTCM, DTCM_BYTES = 0x2000_0000, 0x2_0000
AXI, AXI_BYTES = 0x2400_0000, 0x8_0000
# Memories whose accesses the protection judges in the model; flash comes first.
MEMORIES = ((FLASH, FLASH_BYTES), (ITCM, ITCM_BYTES), (DTCM, DTCM_BYTES), (AXI, AXI_BYTES))
PERIPHERALS, PERIPHERALS_BYTES = 0x4000_0000, 0x2000_0000
PRIVATE, PRIVATE_BYTES = 0xE000_0000, 0x10_0000
# Returns from exceptions go to such an address; a page is there so that Unicorn can stop before it.
RETURN_PAGE, RETURN, RETURN_BYTES = 0xFFFF_F000, 0xFFFF_FFE8, 0x1000
WFI = b"\x30\xbf"
# Loops that only wait: a branch to itself, and a register that is counted down by one (`subs`,
# `bne`), whose number is in the first halfword.
HANGS, COUNT_DOWN, AND_BACK = 0xE7FE, 0x3801, 0xD1FD
# Frame that an exception pushes, with floating point: r0-r3, r12, lr, pc, xPSR, s0-s15, FPSCR, and
# a word that keeps it aligned.
FRAME_BYTES = 104

NMI, HARD_FAULT, SYSTICK, FIRST_INTERRUPT = 2, 3, 15, 16

FORCED = 1 << 30
BUS_FAULT, UNDEFINED = 0x8200, 0x1_0000
# Register CCR, its bit by which faults of the bus are ignored where none can be taken, and CFSR.
CCR, BFHFNMIGN, CFSR, BFAR = 0xE000_ED14, 1 << 8, 0xE000_ED28, 0xE000_ED38
# Fault of the bus while an exception's frame is written.
STACKING_FAULT = 0x1000
# Faults of the memory protection: of an instruction fetch, of an access, of an exception's frame.
FETCH_FAULT, ACCESS_FAULT, FRAME_FAULT = 0x1, 0x2, 0x10
# Registers of the memory protection (ARMv7-M, section B3.5), and permissions by field AP.
MPU_CTRL, MPU_RNR, MPU_RBAR, MPU_RASR = 0xE000_ED94, 0xE000_ED98, 0xE000_ED9C, 0xE000_EDA0
MPU_TYPE, MPU_REGIONS = 0xE000_ED90, 16
SMALLEST_REGION = 32
_READ, _WRITE, _FETCH = unicorn.UC_PROT_READ, unicorn.UC_PROT_WRITE, unicorn.UC_PROT_EXEC
PERMISSIONS = {0: 0, 1: _READ | _WRITE, 3: _READ | _WRITE, 5: _READ, 6: _READ, 7: _READ}
PROTECTED = {
    unicorn.UC_ERR_FETCH_PROT: FETCH_FAULT,
    unicorn.UC_ERR_READ_PROT: ACCESS_FAULT,
    unicorn.UC_ERR_WRITE_PROT: ACCESS_FAULT,
}

# Registers of an exception's frame besides PC, and the stack pointer.
_PUSHED = (
    arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3,
    arm.UC_ARM_REG_R12, arm.UC_ARM_REG_LR, arm.UC_ARM_REG_XPSR,
    *(arm.UC_ARM_REG_D0 + number for number in range(8)),
    arm.UC_ARM_REG_FPSCR, arm.UC_ARM_REG_SP,
)  # fmt: skip


class Processor:
    """The core with its memories. `chip` has the peripherals: `read`, `write`, `lines`, `reset`, and
    the second bank of the flash: `load`, `store`."""

    def __init__(self, segments, chip):
        self.chip = chip
        self.now = 0
        self.events = []
        self.order = 0
        self.is_polling = False
        self.is_idle = False
        self.failed = 0
        self.begun_at = None
        mode = unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS
        self.uc = uc = unicorn.Uc(unicorn.UC_ARCH_ARM, mode)
        uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M7)
        self.pushed = Registers(uc, *_PUSHED)
        self.entered = Registers(
            uc, arm.UC_ARM_REG_SP, arm.UC_ARM_REG_LR, arm.UC_ARM_REG_XPSR
        )
        self.program_counter = Registers(uc, arm.UC_ARM_REG_PC)
        self.masks = Registers(uc, arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_FAULTMASK)
        uc.mem_map(FLASH, FLASH_BYTES, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        for start, length in MEMORIES[1:]:
            uc.mem_map(start, length)
        uc.mem_map(RETURN_PAGE, RETURN_BYTES, unicorn.UC_PROT_READ | unicorn.UC_PROT_EXEC)
        uc.mmio_map(chip.BANK_2, chip.BANK_2_BYTES, self._load, None, self._store, None)
        uc.mmio_map(PERIPHERALS, PERIPHERALS_BYTES, self._read, None, self._write, None)
        uc.mmio_map(PRIVATE, PRIVATE_BYTES, self._read_private, None, self._write_private, None)
        for address, data in segments:
            uc.mem_write(address, data)
            for found in re.finditer(re.escape(WFI), data):
                at = address + found.start()
                if at % 2 == 0:
                    uc.hook_add(unicorn.UC_HOOK_CODE, self._sleeps, begin=at, end=at)
        self.resets = []
        # Permissions that the memories have.
        self.protected = {}
        self.reset_core()

    # Time.

    def at(self, time, act):
        """Does something at a time, which must not have passed by more than a slice."""
        self.order += 1
        heapq.heappush(self.events, (time, self.order, act))

    def after(self, cycles, act):
        self.at(self.now + cycles, act)

    def poll(self):
        """A register is read that only the next event can change. Where it was read before, and nothing
        has happened since that the program could be at, time passes up to that event."""
        if self.events and self.is_idle:
            self.now = max(self.now, min(self.events[0][0], self.horizon))
        self.is_idle = True
        self.is_polling = True

    # Reset.

    def reset_core(self):
        self.private = {}
        self.enabled = set()
        self.active = []
        self.systick_pending = False
        self.nmi_pending = False
        self.systick_epoch = getattr(self, "systick_epoch", 0) + 1
        self.asleep = False
        self.locked = False
        self.wants_reset = False
        self.failed = 0
        self.regions = {}
        self._protect()
        stack, entry = struct.unpack("<II", self.uc.mem_read(FLASH, 8))
        self.uc.reg_write(arm.UC_ARM_REG_PRIMASK, 0)
        self.uc.reg_write(arm.UC_ARM_REG_FAULTMASK, 0)
        self.uc.reg_write(arm.UC_ARM_REG_SP, stack)
        self.uc.reg_write(arm.UC_ARM_REG_LR, 0xFFFF_FFFF)
        self.uc.reg_write(arm.UC_ARM_REG_FPSCR, 0)
        self.pc = entry & ~1

    def reset(self, cause):
        """Resets core and chip; memory keeps its content."""
        self.resets.append((self.now, cause))
        self.chip.reset(cause)
        self.reset_core()

    # Registers of the core.

    def _read_private(self, _uc, offset, _size, _data):
        address = PRIVATE + offset
        match address:
            case 0xE000_E018:
                reload = self.private.get(0xE000_E014, 0) + 1
                return reload - 1 - self.now % reload
            case 0xE000_ED00:
                return 0x411F_C271
            case 0xE000_ED04:
                return self.active[-1] if self.active else 0
            case 0xE000_ED78:
                return 0x0900_0003
            case _ if address == MPU_TYPE:
                return MPU_REGIONS << 8
            case 0xE000_ED80:
                # Few sets and ways: a cache has no effect here.
                return 0xF003_E019 & ~0x0FFF_E000
            case _:
                return self.private.get(address, 0)

    def _write_private(self, _uc, offset, _size, value, _data):
        address = PRIVATE + offset
        if 0xE000_E100 <= address < 0xE000_E120:
            first = 8 * (address - 0xE000_E100)
            self.enabled |= {first + bit for bit in range(32) if value >> bit & 1}
            return
        if 0xE000_E180 <= address < 0xE000_E1A0:
            first = 8 * (address - 0xE000_E180)
            self.enabled -= {first + bit for bit in range(32) if value >> bit & 1}
            return
        before = self.private.get(address, 0)
        if address == CFSR:
            # Ones clear its bits.
            value = before & ~value
        self.private[address] = value
        if address == 0xE000_E010 and value & 1 and not before & 1:
            self.systick_epoch += 1
            self._start_systick(self.systick_epoch)
        elif address in (MPU_RBAR, MPU_RASR):
            # Each region has registers of its own.
            number = self.private.get(MPU_RNR, 0)
            base, attributes = self.regions.get(number, (0, 0))
            is_base = address == MPU_RBAR
            self.regions[number] = (value & ~0x1F, attributes) if is_base else (base, value)
            self.allowed = {}
            if not is_base:
                self._protect()
        elif address == MPU_CTRL:
            self._protect()
        elif address == 0xE000_ED0C and value >> 16 == 0x05FA and value & 4:
            self.wants_reset = True
            self.uc.emu_stop()

    def permissions(self, address):
        """Returns what the memory protection allows at an address; handlers of faults may all."""
        # No region is smaller.
        place = address // SMALLEST_REGION
        allowed = self.allowed.get(place)
        if allowed is None:
            allowed = self.allowed[place] = self._permissions(address)
        return allowed

    def _permissions(self, address):
        control = self.private.get(MPU_CTRL, 0)
        is_background = not control & 1 or control & 4
        allowed = _READ | _WRITE | _FETCH if is_background else 0
        if not control & 1 or HARD_FAULT in self.active or NMI in self.active:
            return allowed
        for _, (base, attributes) in sorted(self.regions.items()):
            if attributes & 1:
                length = 2 << (attributes >> 1 & 0x1F)
                eighth = 8 * (address - base) // length
                if 0 <= address - base < length and not attributes >> 8 + eighth & 1:
                    allowed = PERMISSIONS[attributes >> 24 & 7]
                    if allowed & _READ and not attributes >> 28 & 1:
                        allowed |= _FETCH
        return allowed

    def _protect(self):
        """Gives the memories the permissions that the protection leaves, kilobyte by kilobyte."""
        self.allowed = {}
        for start, length in MEMORIES:
            chip = _READ | _FETCH if start == FLASH else _READ | _WRITE | _FETCH
            edges = {start, start + length}
            for base, attributes in self.regions.values():
                size = 2 << (attributes >> 1 & 0x1F)
                edges |= {edge for edge in (base, base + size) if start < edge < start + length}
            edges = sorted(edges)
            parts = [
                (begin, end - begin, chip & self.permissions(begin))
                for begin, end in zip(edges, edges[1:])
            ]
            # To protect memory anew drops the instructions that Unicorn has translated.
            if parts != self.protected.get(start):
                self.protected[start] = parts
                for part in parts:
                    self.uc.mem_protect(*part)

    def _start_systick(self, epoch):
        self.after(self.private.get(0xE000_E014, 0) + 1, lambda: self._tick(epoch))

    def _tick(self, epoch):
        if epoch == self.systick_epoch:
            self.systick_pending |= self.private[0xE000_E010] & 2 != 0
            self._start_systick(epoch)

    def stop(self):
        """The clock stops: nothing but the watchdog, which has its own, goes on."""
        self.locked = True

    def stop_systick(self):
        """Lets the source of rounds fail."""
        self.systick_epoch += 1

    # Peripherals.

    def _read(self, _uc, offset, size, _data):
        self.now += BUS_CYCLES
        return self.chip.read(PERIPHERALS + offset, size)

    def _write(self, _uc, offset, size, value, _data):
        self.now += BUS_CYCLES
        self.chip.write(PERIPHERALS + offset, size, value)

    # Second bank of the flash.

    def _load(self, _uc, offset, size, _data):
        self.now += BUS_CYCLES
        if not self.permissions(self.chip.BANK_2 + offset) & _READ:
            return self._refuse()
        return self.chip.bank.load(offset, size)

    def _store(self, _uc, offset, size, value, _data):
        self.now += BUS_CYCLES
        if self.permissions(self.chip.BANK_2 + offset) & _WRITE:
            self.chip.bank.store(offset, size, value)
        else:
            self._refuse()

    def _refuse(self):
        """The protection does not allow the access that is being made."""
        self.failed = ACCESS_FAULT
        self.uc.emu_stop()
        return 0

    def fail_bus(self, address):
        """The bus fails in the access that is being made. Where no fault can be taken it is ignored, if
        the register says so: the status tells of it (ARMv7-M, B3.2.8)."""
        no_fault = self.is_fault_masked() or self.active[-1:] in ([NMI], [HARD_FAULT])
        if no_fault and self.private.get(CCR, 0) & BFHFNMIGN:
            self.private[CFSR] = self.private.get(CFSR, 0) | BUS_FAULT
            self.private[BFAR] = address
        else:
            self.failed = BUS_FAULT
            self.uc.emu_stop()

    def caches(self, address):
        """Returns true if a load comes from the cache: by its region, or by the default map, which
        holds without a region, and where faults are masked unless HFNMIENA is set (ARMv7-M, B3.5)."""
        control = self.private.get(MPU_CTRL, 0)
        if not control & 1 or (self.is_fault_masked() and not control & 2):
            return True
        attributes = 1 << 17
        for _, (base, found) in sorted(self.regions.items()):
            length = 2 << (found >> 1 & 0x1F)
            eighth = 8 * (address - base) // length
            if found & 1 and 0 <= address - base < length and not found >> 8 + eighth & 1:
                attributes = found
        return bool(attributes >> 17 & 1)

    def is_fault_masked(self):
        return self.uc.reg_read(arm.UC_ARM_REG_FAULTMASK) & 1

    # Exceptions.

    def _sleeps(self, *_):
        self.asleep = True

    def _pending(self):
        """Returns the number of the exception that is to be taken next, or `None`."""
        if self.nmi_pending:
            return NMI
        for line in self.chip.lines():
            if line in self.enabled:
                return FIRST_INTERRUPT + line
        return SYSTICK if self.systick_pending else None

    def _enter(self, number):
        """Pushes the frame and goes to the handler.

        A frame that finds no memory, or memory that is protected, is not written; the handler is
        entered all the same: that of the hard fault, unless the exception comes before it
        (DDI 0337E, 5.12.1: "the fault handler still executes even though the stack pushes for the
        handler failed").
        """
        uc = self.uc
        self.is_idle = False
        self.program_counter.write(self.pc | 1)
        *core, xpsr, d0, d1, d2, d3, d4, d5, d6, d7, fpscr, stack = self.pushed.read()
        frame = (stack - FRAME_BYTES) & ~7
        if not any(
            start <= frame and stack <= start + length
            for start, length in ((DTCM, DTCM_BYTES), (AXI, AXI_BYTES), (ITCM, ITCM_BYTES))
        ):
            status = STACKING_FAULT
        elif not self.permissions(frame) & _WRITE:
            status = FRAME_FAULT
        else:
            status = 0
        aligned = (stack & 4) << 7
        pushed = struct.pack(
            "<8I8QII",
            *core, self.pc, xpsr & ~0x200 | aligned,
            d0, d1, d2, d3, d4, d5, d6, d7, fpscr, 0,
        )  # fmt: skip
        if status:
            self._note_fault(status)
            number = min(number, HARD_FAULT)
        else:
            uc.mem_write(frame, pushed)
        # No flag and no rest of a conditional block goes on into the handler.
        self.entered.write(frame, RETURN | 1, 0x0100_0000)
        table = self.private.get(0xE000_ED08, FLASH)
        (handler,) = struct.unpack("<I", uc.mem_read(table + 4 * number, 4))
        self.pc = handler & ~1
        self.active.append(number)
        if number in (NMI, HARD_FAULT):
            self._protect()
        if number == SYSTICK:
            self.systick_pending = False
        elif number == NMI:
            self.nmi_pending = False

    def _leave(self):
        uc = self.uc
        frame = uc.reg_read(arm.UC_ARM_REG_SP)
        words = struct.unpack("<8I8QII", uc.mem_read(frame, FRAME_BYTES))
        core, (pc, xpsr), floats, fpscr = words[:6], words[6:8], words[8:16], words[16]
        stack = frame + FRAME_BYTES + (4 if xpsr & 0x200 else 0)
        self.pushed.write(*core, xpsr & ~0x200, *floats, fpscr, stack)
        self.pc = pc & ~1
        if self.active.pop() in (NMI, HARD_FAULT):
            self._protect()

    def _note_fault(self, status):
        self.private[CFSR] = self.private.get(CFSR, 0) | status
        self.private[0xE000_ED2C] = self.private.get(0xE000_ED2C, 0) | FORCED

    def fault(self, status):
        """A fault of an instruction: a lock-up where no handler may come, in that of a fault or with
        faults masked."""
        self._note_fault(status)
        if self.is_fault_masked() or (self.active and self.active[-1] in (NMI, HARD_FAULT)):
            self.locked = True
            self.chip.lock_up()
        else:
            self._enter(HARD_FAULT)

    # The run.

    def run(self, until):
        """Runs to a time, or somewhat beyond."""
        while self.now < until:
            while self.events and self.events[0][0] <= self.now:
                self.is_idle = False
                heapq.heappop(self.events)[2]()
            horizon = min(self.events[0][0], until) if self.events else until
            self.horizon = horizon
            if self.locked:
                self.now = max(self.now, horizon)
                continue
            pending = self._pending()
            if self.asleep:
                if pending is None:
                    self.now = max(self.now, horizon)
                    continue
                self.asleep = False
            masked = False
            if pending is not None and not self.active:
                masked = pending > HARD_FAULT and any(mask & 1 for mask in self.masks.read())
                if not masked:
                    self._enter(pending)
            elif pending == NMI and self.active[-1] > HARD_FAULT:
                self._enter(NMI)
            if not self.locked:
                longest = SLICE_WHILE_POLLED if self.is_polling else SLICE
                self.is_polling = False
                if masked:
                    longest = SLICE_WHILE_MASKED
                self._slice(max(1, min(longest, horizon - self.now)))

    def _wait(self):
        """Passes over a loop that only waits, up to the next event; returns whether it was one."""
        first, second = struct.unpack("<HH", self.uc.mem_read(self.pc, 4))
        if first == HANGS:
            self.now = max(self.now, self.horizon)
            return True
        if first & 0xF8FF != COUNT_DOWN or second != AND_BACK:
            return False
        register = arm.UC_ARM_REG_R0 + (first >> 8 & 7)
        left = self.uc.reg_read(register)
        turns = min(left - 1, (self.horizon - self.now) // 2)
        if turns <= 0:
            return False
        self.uc.reg_write(register, left - turns)
        self.now += 2 * turns
        return True

    def _slice(self, instructions):
        uc = self.uc
        # Where the last slice began near here it may be such a loop.
        is_near = self.begun_at is not None and abs(self.pc - self.begun_at) <= 2
        self.begun_at = self.pc
        if is_near and self._wait():
            return
        try:
            uc.emu_start(self.pc | 1, RETURN, count=instructions)
        except unicorn.UcError as error:
            self.pc = self.program_counter.read()[0] & ~1
            self.now += instructions // 2
            if self.pc == RETURN:
                # Unicorn leaves returns from exceptions to its user.
                self._leave()
                return
            if error.errno in PROTECTED:
                self.fault(PROTECTED[error.errno])
                return
            is_code = error.errno in (unicorn.UC_ERR_INSN_INVALID, unicorn.UC_ERR_EXCEPTION)
            self.fault(UNDEFINED if is_code else BUS_FAULT)
            return
        self.now += instructions // 2 if self.asleep else instructions
        self.pc = self.program_counter.read()[0] & ~1
        if self.failed:
            status, self.failed = self.failed, 0
            self.fault(status)
        if self.wants_reset:
            self.reset("software")
