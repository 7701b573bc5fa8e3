//! Machine code of small functions, and what the check says of it.

use std::{fs, path::Path};

use super::{StackBound, image::Code, pointers::PointerCalls};

/// Start of the first function; the others follow every 32 bytes.
const START: u32 = 0x100;

/// Returns the bound of code whose first function is that of the reset, or why there is none.
fn bound(functions: &[&[u16]]) -> Result<u32, String> {
    let code = Code::of_functions(START, 32, functions);
    bound_of(&code, &PointerCalls::NONE)
}

fn bound_of(code: &Code, pointers: &PointerCalls) -> Result<u32, String> {
    let bound = StackBound::of_code(code, pointers);
    bound
        .map(|bound| bound.bytes())
        .map_err(|error| format!("{error:#}"))
}

#[test]
fn depth_is_that_of_the_deepest_call() {
    // push {r4, lr}; sub sp, #8; bl +32; add sp, #8; bl +64; pop {r4, pc}
    let first = [
        0xb510, 0xb082, 0xf000, 0xf80c, 0xb002, 0xf000, 0xf819, 0xbd10,
    ];
    let [eight, thirty_two] = [[0xb082, 0xb002, 0x4770], [0xb088, 0xb008, 0x4770]];
    assert_eq!(bound(&[&first, &eight, &thirty_two]), Ok(8 + 32));
    assert_eq!(bound(&[&first, &thirty_two, &eight]), Ok(8 + 8 + 32));
}

#[test]
fn recursion_has_no_bound() {
    // push {r7, lr}; bl -6; pop {r7, pc}
    let error = bound(&[&[0xb580, 0xf7ff, 0xfffd, 0xbd80]]).unwrap_err();
    assert!(error.contains("circle"), "{error}");
    assert!(error.contains("f0\n    f0"), "{error}");
}

#[test]
fn pointer_without_a_listed_target_has_no_bound() {
    // push {r7, lr}; blx r0; pop {r7, pc}
    let error = bound(&[&[0xb580, 0x4780, 0xbd80]]).unwrap_err();
    assert!(error.contains("f0 calls by a pointer"), "{error}");
    // The address of the second function, taken by movw r0, #0x121.
    let error = bound(&[&[0xf240, 0x1021, 0x4770], &[0x4770]]).unwrap_err();
    assert!(
        error.contains("does not list as targets:\n    f1"),
        "{error}"
    );
    // And with a second upper half: movt r0, #1 and movt r0, #0.
    let twice = [0xf240, 0x1021, 0xf2c0, 0x0001, 0xf2c0, 0x0000, 0x4770];
    let error = bound(&[&twice, &[0x4770]]).unwrap_err();
    assert!(error.contains("as targets:\n    f1"), "{error}");
}

#[test]
fn listed_target_of_a_pointer_is_on_the_path() {
    // push {r7, lr}; movw r0, #0x121; blx r0; pop {r7, pc}; and sub sp, #32; add sp, #32; bx lr
    let caller = [0xb580, 0xf240, 0x1021, 0x4780, 0xbd80];
    let code = Code::of_functions(START, 32, &[&caller, &[0xb088, 0xb008, 0x4770]]);
    let listed = PointerCalls::of(&[["f0", "f1"]]);
    assert_eq!(bound_of(&code, &listed), Ok(8 + 32));
}

#[test]
fn target_of_a_caller_that_the_image_lacks_is_not_listed() {
    // movw r0, #0x121; bx lr
    let code = Code::of_functions(START, 32, &[&[0xf240, 0x1021, 0x4770], &[0x4770]]);
    let error = bound_of(&code, &PointerCalls::of(&[["f2", "f1"]])).unwrap_err();
    assert!(error.contains("as targets:\n    f1"), "{error}");
    assert_eq!(bound_of(&code, &PointerCalls::of(&[["f0", "f1"]])), Ok(0));
}

#[test]
fn handler_is_on_top_of_the_main_loop() {
    let [eight, thirty_two] = [[0xb082, 0xb002, 0x4770], [0xb088, 0xb008, 0x4770]];
    let code = Code::of_functions(START, 32, &[&eight, &thirty_two]).with_handler(START + 32);
    assert_eq!(bound_of(&code, &PointerCalls::NONE), Ok(8 + 32 + 108));
}

#[test]
fn handler_with_a_stack_of_its_own_leaves_its_frame_on_the_other_one() {
    // sub sp, #8; add sp, #8; bx lr, then msr msp, r1; sub sp, #16; b .
    let (first, second) = ([0xb082, 0xb002, 0x4770], [0xf381, 0x8808, 0xb084, 0xe7fe]);
    let code =
        |second: &[u16]| Code::of_functions(START, 32, &[&first, second]).with_handler(START + 32);
    let stack = StackBound::of_code(&code(&second), &PointerCalls::NONE).unwrap();
    assert_eq!(stack.bytes(), 8 + 108);
    // The only handler is also that of the non-maskable interrupt; the guard has 32 bytes.
    let error = stack.check_guard().unwrap_err().to_string();
    assert!(error.contains("needs 140 bytes"), "{error}");
    // Without one, no handler can run on a full stack.
    let stack = StackBound::of_code(&code(&first), &PointerCalls::NONE).unwrap();
    let error = stack.check_guard().unwrap_err().to_string();
    assert!(error.contains("no handler has a stack"), "{error}");
    // sub sp, #8; msr msp, r1; b .: what was used on the first stack would not be counted.
    let error = bound_of(
        &code(&[0xb082, 0xf381, 0x8808, 0xe7fe]),
        &PointerCalls::NONE,
    );
    assert!(error.unwrap_err().contains("has used"));
    // push {r7, lr}; bl +28: a function that is no handler.
    let caller = [0xb580, 0xf000, 0xf80d, 0xbd80];
    let error = bound(&[&caller, &second]).unwrap_err();
    assert_eq!(error, "f0 calls f1, which replaces the stack");
}

#[test]
fn every_target_of_a_table_is_followed() {
    // tbb [pc, r0] with two targets, each of which makes room on the stack.
    for (first, second) in [(2, 4), (4, 2)] {
        let [down, up] = [0xb080, 0xb000];
        let code = [
            0xe8df,
            0xf000,
            0x0401,
            down + first,
            up + first,
            0x4770,
            down + second,
            up + second,
            0x4770,
        ];
        let code = Code::of_functions(START, 32, &[&code]).with_data(0x104..0x106);
        assert_eq!(bound_of(&code, &PointerCalls::NONE), Ok(16));
    }
    // ldr r0, [pc, #8]; tbh [pc, r0, lsl #1] with two entries, a NOP, the constant, and the target.
    let code = [
        0x4802, 0xe8df, 0xf010, 5, 5, 0xbf00, 0, 0, 0xb082, 0xb002, 0x4770,
    ];
    let code = Code::of_functions(START, 32, &[&code]).with_data(0x106..0x110);
    assert_eq!(bound_of(&code, &PointerCalls::NONE), Ok(8));
    // ldr r0, [pc, #4]; nop; tbb [pc, r0], and where the table would be, the constant
    let code = [0x4801, 0xbf00, 0xe8df, 0xf000, 0, 0];
    let code = Code::of_functions(START, 32, &[&code]).with_data(0x108..0x10c);
    let error = bound_of(&code, &PointerCalls::NONE).unwrap_err();
    assert!(error.contains("no table follows"), "{error}");
}

#[test]
fn stack_of_a_size_known_at_run_time_has_no_bound() {
    // sub.w sp, sp, r0; bx lr
    let error = bound(&[&[0xebad, 0x0d00, 0x4770]]).unwrap_err();
    assert_eq!(error, "f0: at 0x100: the size of the stack is not constant");
}

#[test]
fn stack_that_grows_in_a_loop_or_is_left_behind_has_no_bound() {
    // push {r4}; cbz r0, -: back by b
    let error = bound(&[&[0xb410, 0xe7fd]]).unwrap_err();
    assert!(
        error.contains("0 bytes deep by one path and 4 by another"),
        "{error}"
    );
    // it ne; subne sp, #8; b .
    let error = bound(&[&[0xbf18, 0xb082, 0xe7fe]]).unwrap_err();
    assert!(error.contains("by another"), "{error}");
    // push {r4}; bx lr
    let error = bound(&[&[0xb410, 0x4770]]).unwrap_err();
    assert!(error.contains("it returns with 4 bytes"), "{error}");
}

#[test]
fn both_paths_of_a_condition_are_followed() {
    // cmp r0, #0; it eq; bxeq lr; sub sp, #16; add sp, #16; bx lr
    let code = [0x2800, 0xbf08, 0x4770, 0xb084, 0xb004, 0x4770];
    assert_eq!(bound(&[&code]), Ok(16));
}

#[test]
fn more_stack_than_the_bound_or_much_less_is_an_error() {
    let code = Code::of_functions(START, 32, &[&[0xb0a8, 0xb028, 0x4770]]);
    let bound = StackBound::of_code(&code, &PointerCalls::NONE).unwrap();
    assert_eq!(bound.bytes(), 160);
    assert!(bound.check_used(160).is_ok());
    assert!(bound.check_used(144).is_ok());
    assert!(bound.check_used(164).is_err());
    assert!(bound.check_used(140).is_err());
    // The memory is 212 bytes, of which a quarter has to be free.
    assert!(bound.check_room().is_err());
}

/// Otherwise a handler could come on top of itself, by another vector.
#[test]
fn no_source_of_the_firmware_sets_a_priority() {
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../src/bin/firmware")];
    let mut sources = 0;
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(
                fs::read_dir(path)
                    .unwrap()
                    .map(|entry| entry.unwrap().path()),
            );
        } else {
            let text = fs::read_to_string(&path).unwrap().to_lowercase();
            assert!(!text.contains("priority"), "{}", path.display());
            sources += 1;
        }
    }
    assert!(sources > 20);
}
