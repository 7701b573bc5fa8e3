//! Innermost loop of a kernel, from the image that is counted.

/// An instruction: a line of a disassembly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Instruction {
    address: u64,
    pub(super) mnemonic: String,
    pub(super) operands: String,
}

/// Branches at the end of a loop that count down by themselves and take no time once the loop is
/// known.
const LOW_OVERHEAD_END: [&str; 2] = ["le", "letp"];

impl Instruction {
    /// Parses a line `address: mnemonic operands <symbol>`; `None` for other lines.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let (address, text) = line.split_once(':')?;
        let address = u64::from_str_radix(address.trim(), 16).ok()?;
        let text = text.trim();
        let (mnemonic, operands) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        // The meaning of a number follows it.
        let operands = operands.split(['<', '@']).next().unwrap_or_default();
        Some(Self {
            address,
            mnemonic: mnemonic.to_owned(),
            operands: operands.trim().to_owned(),
        })
    }

    /// Returns the target of a branch.
    fn target(&self) -> Option<u64> {
        let is_branch = self.is_low_overhead_end() || self.mnemonic.starts_with('b');
        let last = self
            .operands
            .rsplit(|c: char| c == ',' || c.is_whitespace())
            .next()?;
        let address = last.strip_prefix("0x").filter(|_| is_branch)?;
        u64::from_str_radix(address, 16).ok()
    }

    pub(super) fn is_branch(&self) -> bool {
        self.target().is_some()
    }

    pub(super) fn is_low_overhead_end(&self) -> bool {
        LOW_OVERHEAD_END.contains(&self.mnemonic.as_str())
    }

    /// Counts multiplications, additions and subtractions in single precision, over all lanes of
    /// the instruction.
    pub(super) fn operations(&self) -> u32 {
        let each = match self.mnemonic.as_str() {
            "vadd.f32" | "vsub.f32" | "vmul.f32" => 1,
            "vmla.f32" | "vmls.f32" | "vnmls.f32" => 2,
            _ => 0,
        };
        let lanes = if self.operands.starts_with('q') { 4 } else { 1 };
        each * lanes
    }

    /// Returns the registers that it names, in order; an instruction writes its first one.
    pub(super) fn registers(&self) -> impl Iterator<Item = &str> {
        let names = self.operands.split(|c: char| !c.is_ascii_alphanumeric());
        names.filter(|name| !name.is_empty())
    }
}

/// One round of a loop; the last instruction is its branch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct KernelLoop {
    pub(super) instructions: Vec<Instruction>,
    /// Points per round.
    pub(super) points: u32,
}

impl KernelLoop {
    /// Finds the innermost loop with the most operations, of those whose operations are those of
    /// whole points, `operations` each, that store results and call nothing; `None` if there is
    /// none, so that it is not the kernel.
    pub(super) fn find(disassembly: &str, operations: u32) -> Option<Self> {
        let all: Vec<_> = disassembly.lines().filter_map(Instruction::parse).collect();
        let mut loops = Vec::new();
        for (end, branch) in all.iter().enumerate() {
            let start = branch
                .target()
                .and_then(|target| all.iter().take(end).position(|one| one.address == target));
            if let Some(round) = start.and_then(|start| all.get(start..=end)) {
                loops.push(round);
            }
        }
        let points = |round: &[Instruction]| {
            let count: u32 = round.iter().map(Instruction::operations).sum();
            let is_call = |one: &Instruction| one.mnemonic == "bl";
            let is_store = |one: &Instruction| one.mnemonic.starts_with("vst");
            let is_kernel = count > 0 && count.is_multiple_of(operations);
            let is_kernel = is_kernel && round.iter().any(is_store) && !round.iter().any(is_call);
            is_kernel.then_some(count / operations)
        };
        let is_inside = |inner: &&[Instruction], outer: &&[Instruction]| {
            inner.len() < outer.len() && outer.iter().any(|one| inner.first() == Some(one))
        };
        let innermost = loops
            .iter()
            .filter(|outer| !loops.iter().any(|inner| is_inside(inner, outer)));
        let rounds = innermost.filter_map(|round| Some((points(round)?, *round)));
        let (points, round) = rounds.max_by_key(|(points, _)| *points)?;
        Some(Self {
            instructions: round.to_vec(),
            points,
        })
    }

    /// Returns the round as text for an assembler, with a branch to its own beginning.
    pub(super) fn text(&self) -> String {
        let lines = self
            .instructions
            .iter()
            .filter(|one| !one.is_low_overhead_end());
        let lines = lines.map(|one| {
            let operands = if one.is_branch() { "0b" } else { &one.operands };
            format!("{} {operands}\n", one.mnemonic)
        });
        std::iter::once("0:\n".to_owned()).chain(lines).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::KernelLoop;

    /// Two operations per point: a vector of four points, then the remaining ones one by one.
    const DISASSEMBLY: &str = "
00000100 <kernel>:
     100:      \tcbz\tr2, 0x132 <kernel+0x32> @ imm = #0x2e
     104:      \tvldrw.u32\tq0, [r1]
     108:      \tvsub.f32\tq1, q0, r2
     10c:      \tvmul.f32\tq1, q1, q1
     110:      \tvstrw.32\tq1, [r1], #16
     114:      \tle\tlr, 0x104 <kernel+0x4>
     118:      \tvldr\ts0, [r1]
     11c:      \tvsub.f32\ts1, s0, s2
     120:      \tvmul.f32\ts1, s1, s1
     124:      \tvstr\ts1, [r1]
     128:      \tsubs\tr3, #0x1
     12a:      \tbne\t0x118 <kernel+0x18> @ imm = #-0x16
     12c:      \tsubs\tr4, #0x1
     12e:      \tbpl.w\t0x104 <kernel+0x4> @ imm = #-0x2e
     132:      \tbx\tlr
";

    #[test]
    fn innermost_loop_with_most_operations_is_found() {
        let found = KernelLoop::find(DISASSEMBLY, 2).unwrap();
        assert_eq!(found.points, 4);
        let text = "0:\nvldrw.u32 q0, [r1]\nvsub.f32 q1, q0, r2\nvmul.f32 q1, q1, q1\nvstrw.32 q1, [r1], #16\n";
        assert_eq!(found.text(), text);
    }

    #[test]
    fn branch_of_a_round_leads_to_its_beginning() {
        let rest = DISASSEMBLY.split_once("     118:").unwrap().1;
        let found = KernelLoop::find(&format!("     118:{rest}"), 2).unwrap();
        assert_eq!(found.points, 1);
        assert!(found.text().ends_with("\nsubs r3, #0x1\nbne 0b\n"));
    }

    #[test]
    fn what_does_not_make_whole_points_is_another_loop() {
        assert_eq!(KernelLoop::find(DISASSEMBLY, 3), None);
        assert_eq!(KernelLoop::find("     132:      \tbx\tlr", 3), None);
    }

    #[test]
    fn loop_that_calls_a_function_or_stores_nothing_is_another() {
        for other in ["vldrw.u32\tq2, [r1], #16", "bl\t0x400 <other>"] {
            let text = DISASSEMBLY.replace("vstrw.32\tq1, [r1], #16", other);
            assert_eq!(KernelLoop::find(&text, 2).unwrap().points, 1);
        }
    }
}
