//! Modelled cycles of the point kernels' loops; they are not measured on silicon.
//!
//! For the Cortex-M4F they come from the table of its manual, for the others from LLVM's model of
//! the processor. Neither knows the wait states of a memory; LLVM's takes a load of many registers
//! for one cycle, and assumes for the M55 how its vectors overlap. The cycles are those of the
//! loops alone; the rest of a call is in the instructions.

use anyhow::{Context as _, Result, bail};
use object::{File, Object as _, ObjectSymbol as _};

use super::{
    kernel_loop::{Instruction, KernelLoop},
    llvm::Llvm,
};
use crate::{
    cores::{Core, Program},
    route::Architecture,
};

/// A row of the table, and the loop that it is the cost of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    pub(super) row: &'static str,
    /// Its function on a Cortex-M4F and M7, and on a Cortex-M55.
    armv7em: &'static str,
    helium: &'static str,
    /// Operations per point, which tell its loop from others.
    pub(super) operations: u32,
}

/// Rows of the table. Of a row of sources it is the loop that adds up the differences, without the
/// nodes of a block.
pub(super) const KERNELS: [Kernel; 7] = [
    Kernel {
        row: "correct_slice",
        armv7em: "fmc_camera_kernel_short_pairs",
        helium: "fmc_camera_kernel::portable::short_pairs",
        operations: 23,
    },
    Kernel {
        row: "correct_slice_xy",
        armv7em: "fmc_camera_kernel_short_xy",
        helium: "fmc_camera_kernel::portable::short_xy",
        operations: 23,
    },
    Kernel {
        row: "correct_slice_full",
        armv7em: "fmc_camera_kernel_full_pairs",
        helium: "fmc_camera_kernel::portable::full_pairs",
        operations: 29,
    },
    Kernel {
        row: "correct_slice_xy_full",
        armv7em: "fmc_camera_kernel_full_xy",
        helium: "fmc_camera_kernel::portable::full_xy",
        operations: 29,
    },
    Kernel {
        row: "distort_slice",
        armv7em: "fmc_camera_kernel::inverse::pairs",
        helium: DISTORT_SLICE,
        operations: 94,
    },
    Kernel {
        row: "distort_slice_full",
        armv7em: "fmc_camera_kernel::inverse::pairs",
        helium: DISTORT_SLICE,
        operations: 108,
    },
    Kernel {
        row: "mesh_source_row",
        armv7em: "mesh::block_row::BlockRow::fill",
        helium: "mesh::block_row::BlockRow::fill",
        operations: 10,
    },
];

const DISTORT_SLICE: &str = "frame_correction::FrameCorrection::distort_slice";

/// Largest allowed cycles per point: core, row, limit.
const LIMITS: [(&str, &str, f64); 4] = [
    ("cortex-m4f", "correct_slice", 31.0),
    ("cortex-m4f", "correct_slice_xy", 31.0),
    ("cortex-m7", "correct_slice", 27.0),
    ("cortex-m7", "correct_slice_xy", 27.0),
];

/// Cycles of a taken branch on the M4F: one, and one to three to fill the pipeline.
const TAKEN_BRANCH: u32 = 3;

/// Cycles of a kernel on a core.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cycles {
    pub(super) core: &'static str,
    pub(super) kernel: &'static str,
    pub(super) per_point: f64,
    /// Table or model that they come from.
    pub(super) by: String,
}

impl Cycles {
    /// Returns a message if the cycles exceed their limit.
    pub(super) fn over_limit(&self) -> Option<String> {
        let is_it =
            |(core, kernel, _): &&(&str, &str, f64)| (*core, *kernel) == (self.core, self.kernel);
        let (core, kernel, limit) = LIMITS.iter().find(is_it)?;
        (self.per_point > *limit).then(|| {
            format!(
                "{kernel} on {core}: {:.1} cycles, the limit is {limit}",
                self.per_point
            )
        })
    }
}

/// Models the cycles of all kernels on all cores, from the images that were counted.
///
/// # Errors
/// An error if a loop is not found, or holds an instruction that the table does not have.
pub(super) fn cycles(llvm: &Llvm<'_>, programs: &[Program<'_>]) -> Result<Vec<Cycles>> {
    let mut all = Vec::new();
    for Program { core, image, .. } in programs {
        let bytes = std::fs::read(image).with_context(|| format!("{}", image.display()))?;
        let file = File::parse(&*bytes).with_context(|| format!("{}", image.display()))?;
        for kernel in KERNELS {
            let wanted = match core.architecture {
                Architecture::Armv7em | Architecture::Armv7emSoft | Architecture::Armv8m => {
                    kernel.armv7em
                }
                Architecture::Helium => kernel.helium,
            };
            let is_it = |symbol: &object::Symbol<'_, '_>| {
                let name = symbol.name().map(rustc_demangle::demangle);
                name.is_ok_and(|name| is_named(&format!("{name:#}"), wanted))
            };
            // A generic function has several forms under one name.
            let mut loops = Vec::new();
            for symbol in file.symbols().filter(is_it) {
                // The lowest bit of the address marks Thumb instructions.
                let start = symbol.address() & !1;
                let disassembly = llvm.disassembly(image, start..start + symbol.size())?;
                loops.extend(KernelLoop::find(&disassembly, kernel.operations));
            }
            let found = loops.into_iter().max_by_key(|found| found.points);
            let found = found.with_context(|| {
                let operations = kernel.operations;
                format!(
                    "no loop of {operations} operations per point in {wanted} on {}",
                    core.name
                )
            })?;
            all.push(of_loop(llvm, *core, kernel.row, &found)?);
        }
    }
    Ok(all)
}

/// Returns `true` if a symbol is this function, given by the end of its path: compilers write
/// generic arguments and implementations into names, or leave them out.
fn is_named(symbol: &str, function: &str) -> bool {
    // An implementation stands before the function's name, its arguments behind it.
    let arguments = symbol.find("::<").filter(|_| symbol.ends_with('>'));
    let name = arguments.map_or(symbol, |at| symbol.split_at(at).0);
    name.replace(['<', '>'], "").ends_with(function)
}

/// Returns LLVM's name of the instruction set.
fn triple(architecture: Architecture) -> &'static str {
    match architecture {
        Architecture::Armv7em | Architecture::Armv7emSoft | Architecture::Armv8m => {
            architecture.target()
        }
        Architecture::Helium => "thumbv8.1m.main-none-eabihf",
    }
}

/// Models a loop by the manual's table for the M4F and by LLVM's model for others.
fn of_loop(
    llvm: &Llvm<'_>,
    core: Core,
    kernel: &'static str,
    found: &KernelLoop,
) -> Result<Cycles> {
    let (cycles, by) = match core.name {
        "cortex-m4f" => (
            f64::from(by_manual(&found.instructions)?),
            "manual".to_owned(),
        ),
        processor => (
            llvm.cycles(triple(core.architecture), processor, &found.text())?,
            llvm.version()?,
        ),
    };
    Ok(Cycles {
        core: core.name,
        kernel,
        per_point: cycles / f64::from(found.points),
        by,
    })
}

/// Returns the cycles of a round on a Cortex-M4F.
///
/// # Source
/// Arm, Cortex-M4 Technical Reference Manual (DDI 0439), tables of processor and floating-point
/// instructions: arithmetic 1, VMLA 3, VDIV 14, VLDM and VSTM 1 and one per register, a taken
/// branch 1 and 1 to 3; arithmetic takes one more where the next instruction uses its result. Of
/// the branches the last is taken, which closes the loop; those before lead out of it.
fn by_manual(round: &[Instruction]) -> Result<u32> {
    let mut cycles = 0;
    for (index, one) in round.iter().enumerate() {
        let names = u32::try_from(one.registers().count())?;
        cycles += match one.mnemonic.as_str() {
            "vadd.f32" | "vsub.f32" | "vmul.f32" | "vmov.f32" | "vmov" | "vabs.f32"
            | "vcmp.f32" | "vmrs" | "adds" | "subs" | "add" | "add.w" | "sub" | "cmp" | "cmp.w"
            | "mov" | "lsls" => 1,
            "vmla.f32" | "vmls.f32" | "vnmls.f32" => 3,
            "vdiv.f32" => 14,
            // The first register holds the address.
            "vldmia" | "vstmia" => names,
            "vldr" | "vstr" => 2,
            _ if one.is_branch() && index + 1 < round.len() => 1,
            _ if one.is_branch() => TAKEN_BRANCH,
            unknown => bail!("the table of cycles has no {unknown}"),
        };
        let is_arithmetic = |one: &Instruction| one.operations() > 0;
        if let Some(next) = round.get(index + 1).filter(|_| is_arithmetic(one)) {
            let reads = |next: &Instruction, name| {
                // Arithmetic writes its first register; VMLA also reads it.
                let reads_its_own = ["vmla.f32", "vmls.f32", "vnmls.f32"];
                let written =
                    usize::from(is_arithmetic(next) && !reads_its_own.contains(&&*next.mnemonic));
                next.registers()
                    .skip(written)
                    .any(|register| register == name)
            };
            cycles += u32::from(one.registers().next().is_some_and(|name| reads(next, name)));
        }
    }
    Ok(cycles)
}

#[cfg(test)]
mod tests {
    use super::{Cycles, by_manual, is_named};
    use crate::bench::{comparison::Row, documented, kernel_loop::Instruction};

    fn cycles(text: &str) -> anyhow::Result<u32> {
        let lines = text.lines().enumerate();
        let round: Vec<_> = lines
            .map(|(index, line)| Instruction::parse(&format!("{index:x}:\t{line}")).unwrap())
            .collect();
        by_manual(&round)
    }

    #[test]
    fn instructions_cost_what_the_manual_says() {
        for (text, expected) in [
            ("vmul.f32\ts0, s1, s2", 1),
            ("vmla.f32\ts0, s1, s2", 3),
            ("vldmia\tr0!, {s0, s1, s2, s3, s4, s5}", 7),
            ("vldr\ts0, [r1]", 2),
            ("subs\tr1, #0x1\nbpl.w\t0x0 <kernel>", 4),
            // The first leads out of the loop.
            ("bhi\t0x40 <kernel+0x40>\nbne\t0x0 <kernel>", 4),
            ("vdiv.f32\ts0, s1, s2\nvmls.f32\ts3, s4, s5", 17),
        ] {
            assert_eq!(cycles(text).unwrap(), expected, "{text}");
        }
        let unknown = cycles("vsqrt.f32\ts0, s1").unwrap_err();
        assert_eq!(unknown.to_string(), "the table of cycles has no vsqrt.f32");
    }

    #[test]
    fn functions_have_the_names_that_compilers_give_them() {
        for symbol in [
            "a_kernel::inverse::pairs",
            "a_kernel::inverse::pairs::<true>",
            "<a_kernel::inverse>::pairs::<a::B<c::D>>",
            "a::<impl a_kernel::inverse>::pairs",
        ] {
            assert!(is_named(symbol, "kernel::inverse::pairs"), "{symbol}");
        }
        assert!(!is_named(
            "kernel::inverse::pairs::other",
            "kernel::inverse::pairs"
        ));
    }

    #[test]
    fn next_instruction_waits_for_what_it_reads() {
        for (text, expected) in [
            ("vmul.f32\ts0, s1, s2\nvadd.f32\ts3, s0, s4", 3),
            ("vmul.f32\ts0, s1, s2\nvadd.f32\ts0, s3, s4", 2),
            ("vmul.f32\ts0, s1, s2\nvmla.f32\ts0, s3, s4", 5),
            ("vmul.f32\ts0, s1, s2\nvstmia\tr0!, {s0, s1}", 5),
            (
                "vmul.f32\ts0, s1, s2\nvadd.f32\ts3, s4, s5\nvadd.f32\ts6, s0, s1",
                3,
            ),
        ] {
            assert_eq!(cycles(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn limit_is_of_its_core_and_kernel() {
        let of = |core, kernel, per_point| Cycles {
            core,
            kernel,
            per_point,
            by: String::new(),
        };
        assert_eq!(of("cortex-m7", "correct_slice", 27.0).over_limit(), None);
        assert_eq!(
            of("cortex-m7", "correct_slice_full", 27.1).over_limit(),
            None
        );
        let text = of("cortex-m7", "correct_slice", 27.14).over_limit();
        let expected = "correct_slice on cortex-m7: 27.1 cycles, the limit is 27";
        assert_eq!(text.as_deref(), Some(expected));
    }

    #[test]
    fn documented_cycles_are_those_of_the_committed_table() {
        let table: Vec<Row> = documented::table("docs/performance.csv");
        let documented = documented::rows(
            include_str!("../../../docs/performance.md"),
            "| loop of | M4F, by its manual's table | M7, by llvm-mca 19 | M55, by llvm-mca 19 |",
        );
        assert_eq!(documented.len(), super::KERNELS.len());
        for row in documented {
            let kernel = row[0].trim_matches('`');
            for (core, cycles) in ["cortex-m4f", "cortex-m7", "cortex-m55"]
                .iter()
                .zip(&row[1..])
            {
                let is_it = |row: &&Row| row.core == *core && row.kernel == kernel;
                let cycles_of = table.iter().find(is_it).and_then(|row| row.cycles);
                assert_eq!(
                    format!("{:.1}", cycles_of.unwrap()),
                    *cycles,
                    "{kernel} on {core}"
                );
            }
        }
    }
}
