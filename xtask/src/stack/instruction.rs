//! Thumb instructions, read for two things: how they move the stack pointer, and where they lead.
//!
//! Encodings: ARM DDI 0403 (ARMv7-M Architecture Reference Manual), A5 to A7. An instruction that
//! writes the stack pointer in another way than by a constant is [`Effect::Unreadable`]; the walk
//! of a function ([`super::function`]) finds one that was missed, since depths no longer agree.

/// Number of the stack pointer, the link register and the program counter.
const SP: u16 = 13;
const LR: u16 = 14;
const PC: u16 = 15;

/// Instruction: its length and what it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Instruction {
    pub(crate) bytes: u32,
    pub(crate) effect: Effect,
}

/// Effect of an instruction on the stack pointer and on the program counter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Neither.
    Next,
    /// The depth of the stack grows by these bytes, or shrinks.
    Deepen(i64),
    /// Leads to an address always.
    Branch(u32),
    /// Leads to an address, or on.
    BranchIf(u32),
    /// Calls the function at an address.
    Call(u32),
    /// Calls the function whose address is in a register.
    CallRegister,
    /// Leads to an address in a register or from memory.
    BranchRegister,
    /// Leads to one of the targets of a table that follows, of bytes or halfwords.
    Table { halfwords: bool },
    /// Returns, after these bytes have left the stack.
    Return(i64),
    /// Makes the following instructions conditional: one each, true where its condition is the
    /// stated one, false where it is the opposite.
    IfThen(Conditions),
    /// Replaces the main stack by another one.
    LeaveStack,
    /// Does not go on.
    Stop,
    /// Changes the stack pointer by what is not known.
    Unreadable,
}

/// Conditions of up to four instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Conditions {
    left: u8,
    /// Bit 0 is that of the next instruction.
    stated: u8,
}

impl Conditions {
    /// Returns the condition of the next instruction, if it has one, and those behind it.
    pub(super) fn next(self) -> (Option<bool>, Self) {
        let Some(left) = self.left.checked_sub(1) else {
            return (None, self);
        };
        let stated = self.stated >> 1;
        (Some(self.stated & 1 == 1), Self { left, stated })
    }

    /// Returns the same instructions with the opposite conditions.
    pub(super) fn opposite(self) -> Self {
        let stated = !self.stated & ((1 << self.left) - 1);
        Self { stated, ..self }
    }

    /// Condition and mask of an instruction IT (A7.7.38).
    fn of(condition: u16, mask: u16) -> Self {
        let left = 4 - mask.trailing_zeros().min(3);
        let low = condition & 1;
        let bit = |index: u32| u8::from(index == 0 || (mask >> (4 - index)) & 1 == low);
        let stated = (0..left).fold(0, |stated, index| stated | bit(index) << index);
        Self {
            left: u8::try_from(left).unwrap_or_default(),
            stated,
        }
    }
}

impl Instruction {
    /// Returns the address of the constant that the instruction at an address reads from between
    /// the code, if it does.
    pub(crate) fn constant(address: u32, first: u16, second: u16) -> Option<u32> {
        let twelve_bits = u32::from(second & 0xfff);
        let eight_bits = 4 * u32::from(second & 0xff);
        let (distance, adds) = match first {
            // LDR and ADR of 16 bits.
            0x4800..0x5000 | 0xa000..0xa800 => (4 * u32::from(first & 0xff), true),
            // ADR, of which one subtracts.
            0xf20f => (u32::from(second & 0xff | second >> 4 & 0x700), true),
            0xf2af => (u32::from(second & 0xff | second >> 4 & 0x700), false),
            // LDR and those of bytes and halfwords, LDRD, VLDR.
            _ if first & 0xfe1f == 0xf81f => (twelve_bits, first & 0x80 != 0),
            _ if first & 0xff5f == 0xe95f => (eight_bits, first & 0x80 != 0),
            _ if first & 0xff3f == 0xed1f => (eight_bits, first & 0x80 != 0),
            _ => return None,
        };
        let base = address.wrapping_add(4) & !3;
        Some(if adds {
            base.wrapping_add(distance)
        } else {
            base.wrapping_sub(distance)
        })
    }

    /// Returns the register, the half and whether it is the upper one, if the instruction puts half
    /// of a word into a register (MOVW and MOVT).
    pub(crate) fn half(first: u16, second: u16) -> Option<(u16, u16, bool)> {
        let is_upper = match first & 0xfbf0 {
            0xf240 => false,
            0xf2c0 => true,
            _ => return None,
        };
        let half =
            (first & 15) << 12 | (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xff;
        (second & 0x8000 == 0).then_some((second >> 8 & 15, half, is_upper))
    }

    /// Reads the instruction at an address; `second` is the halfword behind its first.
    pub(crate) fn read(address: u32, first: u16, second: u16) -> Self {
        let wide = first >> 11 >= 0b11101;
        Self {
            bytes: if wide { 4 } else { 2 },
            effect: if wide {
                wide_effect(address, first, second)
            } else {
                narrow_effect(address, first)
            },
        }
    }
}

/// Returns the address of a branch: that of the instruction, 4, and the distance.
fn ahead(address: u32, distance: i32) -> u32 {
    address.wrapping_add(4).wrapping_add_signed(distance)
}

/// Extends the sign of a number of that many bits.
fn signed(number: u32, bits: u32) -> i32 {
    let shift = 32 - bits;
    (number << shift).cast_signed() >> shift
}

fn words(mask: u16) -> i64 {
    4 * i64::from(mask.count_ones())
}

fn narrow_effect(address: u32, code: u16) -> Effect {
    let destination = (code >> 4 & 8) | (code & 7);
    let source = code >> 3 & 15;
    match code {
        // ADD and MOV between any registers.
        0x4400..0x4500 | 0x4600..0x4700 if destination == SP => Effect::Unreadable,
        0x4600..0x4700 if (destination, source) == (PC, LR) => Effect::Return(0),
        0x4400..0x4500 | 0x4600..0x4700 if destination == PC => Effect::BranchRegister,
        0x4700..0x4780 if source == LR => Effect::Return(0),
        0x4700..0x4780 => Effect::BranchRegister,
        0x4780..0x4800 => Effect::CallRegister,
        0xb000..0xb080 => Effect::Deepen(-4 * i64::from(code & 0x7f)),
        0xb080..0xb100 => Effect::Deepen(4 * i64::from(code & 0x7f)),
        0xb400..0xb600 => Effect::Deepen(words(code & 0x1ff)),
        0xbd00..0xbe00 => Effect::Return(words(code & 0x1ff)),
        0xbc00..0xbd00 => Effect::Deepen(-words(code & 0xff)),
        // CBZ and CBNZ.
        _ if code & 0xf500 == 0xb100 => {
            let distance = (code >> 9 & 1) << 6 | (code >> 3 & 31) << 1;
            Effect::BranchIf(ahead(address, i32::from(distance)))
        }
        0xbf00..0xc000 if code & 15 != 0 => {
            Effect::IfThen(Conditions::of(code >> 4 & 15, code & 15))
        }
        0xde00..0xdf00 => Effect::Stop,
        0xd000..0xde00 => Effect::BranchIf(ahead(address, signed(u32::from(code & 0xff) << 1, 9))),
        0xe000..0xe800 => Effect::Branch(ahead(address, signed(u32::from(code & 0x7ff) << 1, 12))),
        _ => Effect::Next,
    }
}

fn wide_effect(address: u32, first: u16, second: u16) -> Effect {
    let base = first & 15;
    let high = second >> 12;
    let destination = second >> 8 & 15;
    // Load, write back, add the offset, and before the access.
    let [loads, writes_back, adds, is_before] = [4, 5, 7, 8].map(|bit| first >> bit & 1 == 1);
    let down_to_stack = |bytes: i64| Effect::Deepen(if adds { -bytes } else { bytes });
    if first & 0xf800 == 0xf000 && second & 0x8000 != 0 {
        return branch_or_system(address, first, second);
    }
    if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 {
        return if base == PC {
            let halfwords = second & 0x10 != 0;
            Effect::Table { halfwords }
        } else {
            Effect::BranchRegister
        };
    }
    // LDM and STM.
    if first & 0xfe40 == 0xe800 {
        let bytes = words(second);
        return match (base == SP && writes_back, loads) {
            (true, false) if is_before && !adds => Effect::Deepen(bytes),
            (true, true) if adds && !is_before && second & 0x8000 != 0 => Effect::Return(bytes),
            (true, true) if adds && !is_before => Effect::Deepen(-bytes),
            (true, _) => Effect::Unreadable,
            (false, true) if second & 0x2000 != 0 => Effect::Unreadable,
            (false, true) if second & 0x8000 != 0 => Effect::BranchRegister,
            _ => Effect::Next,
        };
    }
    // LDRD and STRD.
    if first & 0xfe40 == 0xe840 {
        let bytes = 4 * i64::from(second & 0xff);
        let is_exclusive = !is_before && !writes_back;
        return if base == SP && writes_back && !is_exclusive {
            down_to_stack(bytes)
        } else {
            Effect::Next
        };
    }
    // Loads and stores of coprocessors, of which VPUSH and VPOP are two.
    if first & 0xfe00 == 0xec00 {
        return if base == SP && writes_back {
            down_to_stack(4 * i64::from(second & 0xff))
        } else {
            Effect::Next
        };
    }
    // Arithmetic with a constant.
    if first & 0xf800 == 0xf000 {
        return arithmetic_with_constant(first, second);
    }
    if first & 0xfe00 == 0xf800 {
        return load_or_store(first, second);
    }
    let is_arithmetic = [0xea00, 0xfa00].contains(&(first & 0xfe00));
    let writes_stack_pointer = match first & 0xff80 {
        // Long products have two results.
        0xfb80 => high == SP || destination == SP,
        _ => is_arithmetic && destination == SP,
    };
    if writes_stack_pointer {
        Effect::Unreadable
    } else {
        Effect::Next
    }
}

/// Branches and control of the processor (A5.3.4).
fn branch_or_system(address: u32, first: u16, second: u16) -> Effect {
    let [first_bits, second_bits] = [first, second].map(u32::from);
    let sign = first_bits >> 10 & 1;
    let [j1, j2] = [13, 11].map(|bit| second_bits >> bit & 1);
    if second & 0x5000 != 0 {
        let [i1, i2] = [j1, j2].map(|j| !(j ^ sign) & 1);
        let distance = sign << 24
            | i1 << 23
            | i2 << 22
            | (first_bits & 0x3ff) << 12
            | (second_bits & 0x7ff) << 1;
        let target = ahead(address, signed(distance, 25));
        return match second & 0xd000 {
            0xd000 => Effect::Call(target),
            0x9000 => Effect::Branch(target),
            // To the instruction set that these processors lack.
            _ => Effect::Unreadable,
        };
    }
    if first_bits >> 6 & 0b1110 != 0b1110 {
        let distance = sign << 20
            | j2 << 19
            | j1 << 18
            | (first_bits & 0x3f) << 12
            | (second_bits & 0x7ff) << 1;
        return Effect::BranchIf(ahead(address, signed(distance, 21)));
    }
    let is_undefined = first & 0xfff0 == 0xf7f0 && second & 0xf000 == 0xa000;
    match (first & 0xffe0, second & 0xff) {
        // MSR to the main stack pointer, to the other one, and to the register that chooses.
        (0xf380, 8) => Effect::LeaveStack,
        (0xf380, 9 | 20) => Effect::Unreadable,
        _ if is_undefined => Effect::Stop,
        _ => Effect::Next,
    }
}

fn arithmetic_with_constant(first: u16, second: u16) -> Effect {
    if second >> 8 & 15 != SP {
        return Effect::Next;
    }
    let low = second & 0xff;
    let middle = second >> 12 & 7;
    let constant = (first >> 10 & 1) << 11 | middle << 8 | low;
    let is_plain = first & 0x0200 != 0;
    let amount = if is_plain {
        u32::from(constant)
    } else {
        expanded(constant)
    };
    let amount = i64::from(amount);
    match (is_plain, first >> 5 & 15, first & 15) {
        (false, 8, SP) | (true, 0, SP) => Effect::Deepen(-amount),
        (false, 13, SP) | (true, 5, SP) => Effect::Deepen(amount),
        _ => Effect::Unreadable,
    }
}

/// Constant of twelve bits as arithmetic expands it (A5.3.2).
fn expanded(constant: u16) -> u32 {
    let byte = u32::from(constant & 0xff);
    match constant >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | byte & 0x7f).rotate_right(u32::from(constant >> 7)),
    }
}

/// Loads and stores of one register.
fn load_or_store(first: u16, second: u16) -> Effect {
    let is_word_load = first & 0xff70 == 0xf850;
    let register = second >> 12;
    let writes_back = first & 0x80 == 0 && second & 0x0900 == 0x0900;
    let bytes = i64::from(second & 0xff);
    let deeper = if second & 0x0200 == 0 { bytes } else { -bytes };
    match (first & 15 == SP && writes_back, is_word_load, register) {
        (_, true, SP) => Effect::Unreadable,
        (true, true, PC) => Effect::Return(-deeper),
        (false, true, PC) => Effect::BranchRegister,
        (true, ..) => Effect::Deepen(deeper),
        _ => Effect::Next,
    }
}

#[cfg(test)]
mod tests {
    use super::{Effect, Instruction};

    fn effect(first: u16, second: u16) -> Effect {
        Instruction::read(0x1000, first, second).effect
    }

    /// Encodings as llvm-objdump shows them.
    #[test]
    fn instructions_that_move_the_stack_pointer_are_read() {
        for (first, second, moved) in [
            (0xb5f0, 0, 20),        // push {r4-r7, lr}
            (0xbc30, 0, -8),        // pop {r4, r5}
            (0xb082, 0, 8),         // sub sp, #8
            (0xb004, 0, -16),       // add sp, #16
            (0xe92d, 0x0ff0, 32),   // push.w {r4-r11}
            (0xe8bd, 0x0f00, -16),  // pop.w {r8-r11}
            (0xf84d, 0xbd04, 4),    // str r11, [sp, #-4]!
            (0xf85d, 0xbb04, -4),   // ldr r11, [sp], #4
            (0xed2d, 0x8b10, 64),   // vpush {d8-d15}
            (0xecbd, 0x8b02, -8),   // vpop {d8}
            (0xf5ad, 0x5d80, 4096), // sub.w sp, sp, #4096
            (0xf6ad, 0x7d84, 3972), // subw sp, sp, #3972
            (0xf60d, 0x7d84, -3972),
            (0xe96d, 0x0102, 8), // strd r0, r1, [sp, #-8]!
        ] {
            assert_eq!(
                effect(first, second),
                Effect::Deepen(moved),
                "{first:04x} {second:04x}"
            );
        }
    }

    #[test]
    fn stack_of_a_size_that_is_not_constant_is_unreadable() {
        for (first, second) in [
            (0x4685, 0),      // mov sp, r0
            (0x4485, 0),      // add sp, r0
            (0xebad, 0x0d00), // sub.w sp, sp, r0
            (0xf1a7, 0x0d08), // sub.w sp, r7, #8
            (0xf36f, 0x0d02), // bfc sp, #0, #3
            (0xf380, 0x8809), // msr psp, r0
            (0xf380, 0x8814), // msr control, r0
            (0xf8d0, 0xd000), // ldr.w sp, [r0]
            (0xe890, 0x2001), // ldm.w r0, {r0, sp}
        ] {
            assert_eq!(
                effect(first, second),
                Effect::Unreadable,
                "{first:04x} {second:04x}"
            );
        }
    }

    #[test]
    fn instructions_that_lead_elsewhere_are_read() {
        for (first, second, to) in [
            (0xe7fe, 0, Effect::Branch(0x1000)),
            (0xd0fe, 0, Effect::BranchIf(0x1000)),
            (0xb108, 0, Effect::BranchIf(0x1006)),
            (0xf7ff, 0xbffe, Effect::Branch(0x1000)),
            (0xf7ff, 0xfffe, Effect::Call(0x1000)),
            (0xf43f, 0xaffe, Effect::BranchIf(0x1000)),
            (0x4770, 0, Effect::Return(0)),
            (0x4718, 0, Effect::BranchRegister),
            (0x4780, 0, Effect::CallRegister),
            (0xbdf0, 0, Effect::Return(20)),
            (0xe8bd, 0x8ff0, Effect::Return(36)),
            (0xf85d, 0xfb04, Effect::Return(4)),
            (0xe8df, 0xf000, Effect::Table { halfwords: false }),
            (0xe8df, 0xf011, Effect::Table { halfwords: true }),
            (0xde00, 0, Effect::Stop),
        ] {
            assert_eq!(effect(first, second), to, "{first:04x} {second:04x}");
        }
    }

    #[test]
    fn constants_between_the_code_are_found() {
        for (first, second, at) in [
            (0x4801, 0, 0x1008),            // ldr r0, [pc, #4]
            (0xf8df, 0x0010, 0x1014),       // ldr.w r0, [pc, #16]
            (0xf85f, 0x0004, 0x1000),       // ldr.w r0, [pc, #-4]
            (0xed9f, 0x4ad5, 0x1004 + 852), // vldr s8, [pc, #852]
        ] {
            assert_eq!(
                Instruction::constant(0x1000, first, second),
                Some(at),
                "{first:04x} {second:04x}"
            );
        }
        // vldr s24, [r1, #8]
        assert_eq!(Instruction::constant(0x1000, 0xed91, 0xca02), None);
    }

    #[test]
    fn halves_of_addresses_are_read() {
        // movw r3, #8917 and movt r3, #2
        assert_eq!(Instruction::half(0xf242, 0x23d5), Some((3, 8917, false)));
        assert_eq!(Instruction::half(0xf2c0, 0x0302), Some((3, 2, true)));
        assert_eq!(Instruction::half(0xf5ad, 0x5d80), None);
    }

    #[test]
    fn conditions_are_those_of_each_instruction() {
        // ITE NE, ITT EQ, ITTE EQ, IT NE.
        for (code, expected) in [
            (0xbf14, &[true, false][..]),
            (0xbf04, &[true, true]),
            (0xbf06, &[true, true, false]),
            (0xbf18, &[true]),
        ] {
            let Effect::IfThen(mut conditions) = effect(code, 0) else {
                panic!("{code:04x}");
            };
            let mut stated = Vec::new();
            while let (Some(condition), rest) = conditions.next() {
                stated.push(condition);
                conditions = rest;
            }
            assert_eq!(stated, expected, "{code:04x}");
        }
    }
}
