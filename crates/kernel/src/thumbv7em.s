@ Point kernel for Cortex-M4F and M7: three points a, b, c in lock-step, so that no instruction waits
@ for the result of an earlier one (M4F: 2 cycles, M7: 3).
@
@ The operations and their order are those of portable.rs; factors and summands are exchanged freely.
@ Multiply and add are separate instructions, or VMLA, which rounds the product and then the sum. VFMA
@ rounds only once, which would change the bits, and is not used.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16

@ Performs an operation for each point: every register name ends in the letter of the point.
    .macro each operation, to, first, second
    \operation\().f32 \to\()a, \first\()a, \second\()a
    \operation\().f32 \to\()b, \first\()b, \second\()b
    \operation\().f32 \to\()c, \first\()c, \second\()c
    .endm

@ Performs an operation for each point, with one second operand for all points.
    .macro with operation, to, first, second
    \operation\().f32 \to\()a, \first\()a, \second
    \operation\().f32 \to\()b, \first\()b, \second
    \operation\().f32 \to\()c, \first\()c, \second
    .endm

    .macro function name
    .section .text.\name, "ax", %progbits
    .global \name
    .hidden \name
    .type \name, %function
    .thumb_func
    .p2align 3
\name:
    .endm

    .macro return name
    bx lr
    .size \name, . - \name
    .endm

@ Runs \block \blocks times, at least once: two per round, the first round entered in the middle if
@ the number is odd.
    .macro rounds blocks, block, load, store
    subs \blocks, #1
    lsrs \blocks, #1
    bcc.w 2f
1:  \load
    \block
    \store
2:  \load
    \block
    \store
    subs \blocks, #1
    bpl.w 1b
    .endm

@ ---- Registers. Of each point, counted from the centre: X, Y; R = X² + Y²; G.

X_a .req s6
X_b .req s7
X_c .req s8
Y_a .req s9
Y_b .req s10
Y_c .req s11
R_a .req s12
R_b .req s13
R_c .req s14
G_a .req s15
G_b .req s16
G_c .req s17

@ The coefficients in their order in memory; the short form has the first ten.

cx_ .req s18
cy_ .req s19
k0_ .req s20
k1_ .req s21
k2_ .req s22
k3_ .req s23
hx_ .req s24
hy_ .req s25
gx_ .req s26
gy_ .req s27
b1_ .req s28
b2_ .req s29
tx_ .req s30
ty_ .req s31

@ A term of each point, which in the short form takes the registers of b1, b2, tx.

T_a .req s28
T_b .req s29
T_c .req s30

@ A term of each point, which in the full form overwrites k1, k2, k3; they are loaded for every block.

A_a .req s21
A_b .req s22
A_c .req s23

@ ---- The forms

@ Computes G without its term hy·Y.
    .macro short_head
    with vsub, X_, xm_, cx_
    with vsub, Y_, ym_, cy_
    each vmul, R_, X_, X_
    each vmul, T_, Y_, Y_
    each vadd, R_, R_, T_
    with vmul, G_, R_, k3_
    with vadd, G_, G_, k2_
    each vmul, G_, G_, R_
    with vadd, G_, G_, k1_
    each vmul, G_, G_, R_
    with vadd, G_, G_, k0_
    with vmul, T_, X_, hx_
    each vadd, G_, G_, T_
    .endm

    .macro short_tail
    each vmul, X_, X_, G_
    each vmul, Y_, Y_, G_
    with vmul, T_, R_, gx_
    with vmul, R_, R_, gy_
    each vadd, X_, X_, T_
    each vadd, Y_, Y_, R_
    each vsub, xm_, xm_, X_
    each vsub, ym_, ym_, Y_
    .endm

    .macro short_block
    short_head
    with vmul, T_, Y_, hy_
    each vadd, G_, G_, T_
    short_tail
    .endm

@ The short block for separate coordinates, which need two instructions more to load and store. VMLA
@ is one instruction in place of two, and on the M4F one cycle more.
    .macro short_block_xy
    short_head
    with vmla, G_, Y_, hy_
    short_tail
    .endm

@ Computes G without its terms hx·X and hy·Y.
    .macro full_head
    with vsub, X_, xm_, cx_
    with vsub, Y_, ym_, cy_
    each vmul, R_, X_, X_
    each vmul, G_, Y_, Y_
    each vadd, R_, R_, G_
    with vmul, G_, R_, k3_
    with vadd, G_, G_, k2_
    each vmul, G_, G_, R_
    with vadd, G_, G_, k1_
    each vmul, G_, G_, R_
    .endm

@ Adds hy·Y and computes the rest. VMLA also needs no register for the product.
    .macro full_tail
    with vmla, G_, Y_, hy_
    each vmul, A_, X_, G_
    with vmla, A_, R_, gx_
    with vmul, X_, X_, b1_
    each vmul, G_, G_, Y_
    each vadd, A_, A_, X_
    with vmul, X_, Y_, b2_
    with vmul, R_, R_, gy_
    each vadd, A_, A_, X_
    each vadd, G_, G_, R_
    with vadd, A_, A_, tx_
    with vadd, G_, G_, ty_
    each vsub, xm_, xm_, A_
    each vsub, ym_, ym_, G_
    .endm

    .macro full_block
    full_head
    with vmul, A_, X_, hx_
    with vadd, G_, G_, k0_
    each vadd, G_, G_, A_
    full_tail
    .endm

@ The full block for separate coordinates.
    .macro full_block_xy
    full_head
    with vadd, G_, G_, k0_
    with vmla, G_, X_, hx_
    full_tail
    .endm

@ ---- Pairs: r0 points, r1 blocks of three, r2 coefficients. d8-d15 belong to the caller.

xm_a .req s0
ym_a .req s1
xm_b .req s2
ym_b .req s3
xm_c .req s4
ym_c .req s5

    .macro load_pairs
    vldmia r0, {s0-s5}
    .endm
    .macro load_pairs_and_k
    vldmia r2, {s21-s23}
    vldmia r0, {s0-s5}
    .endm
    .macro store_pairs
    vstmia r0!, {s0-s5}
    .endm

    function fmc_camera_kernel_short_pairs
    vpush {d8-d15}
    vldmia r2, {s18-s27}
    rounds r1, short_block, load_pairs, store_pairs
    vpop {d8-d15}
    return fmc_camera_kernel_short_pairs

    function fmc_camera_kernel_full_pairs
    vpush {d8-d15}
    vldmia r2, {s18-s31}
    adds r2, #12
    rounds r1, full_block, load_pairs_and_k, store_pairs
    vpop {d8-d15}
    return fmc_camera_kernel_full_pairs

@ ---- Square root of the number in s0.

    function fmc_camera_kernel_sqrt
    vsqrt.f32 s0, s0
    return fmc_camera_kernel_sqrt

    .unreq xm_a
    .unreq ym_a
    .unreq xm_b
    .unreq ym_b
    .unreq xm_c
    .unreq ym_c

@ ---- Separate coordinates: r0 x, r1 y, r2 blocks of three, r3 coefficients.

xm_a .req s0
xm_b .req s1
xm_c .req s2
ym_a .req s3
ym_b .req s4
ym_c .req s5

    .macro load_xy
    vldmia r0, {s0-s2}
    vldmia r1, {s3-s5}
    .endm
    .macro load_xy_and_k
    vldmia r3, {s21-s23}
    load_xy
    .endm
    .macro store_xy
    vstmia r0!, {s0-s2}
    vstmia r1!, {s3-s5}
    .endm

    function fmc_camera_kernel_short_xy
    vpush {d8-d15}
    vldmia r3, {s18-s27}
    rounds r2, short_block_xy, load_xy, store_xy
    vpop {d8-d15}
    return fmc_camera_kernel_short_xy

    function fmc_camera_kernel_full_xy
    vpush {d8-d15}
    vldmia r3, {s18-s31}
    adds r3, #12
    rounds r2, full_block_xy, load_xy_and_k, store_xy
    vpop {d8-d15}
    return fmc_camera_kernel_full_xy

@ ---- The names end here, because a program's assembly is read in one piece.

    .unreq xm_a
    .unreq xm_b
    .unreq xm_c
    .unreq ym_a
    .unreq ym_b
    .unreq ym_c
    .unreq X_a
    .unreq X_b
    .unreq X_c
    .unreq Y_a
    .unreq Y_b
    .unreq Y_c
    .unreq R_a
    .unreq R_b
    .unreq R_c
    .unreq G_a
    .unreq G_b
    .unreq G_c
    .unreq cx_
    .unreq cy_
    .unreq k0_
    .unreq k1_
    .unreq k2_
    .unreq k3_
    .unreq hx_
    .unreq hy_
    .unreq gx_
    .unreq gy_
    .unreq b1_
    .unreq b2_
    .unreq tx_
    .unreq ty_
    .unreq T_a
    .unreq T_b
    .unreq T_c
    .unreq A_a
    .unreq A_b
    .unreq A_c
    .purgem each
    .purgem with
    .purgem function
    .purgem return
    .purgem rounds
    .purgem short_head
    .purgem short_tail
    .purgem short_block
    .purgem short_block_xy
    .purgem full_head
    .purgem full_tail
    .purgem full_block
    .purgem full_block_xy
    .purgem load_pairs
    .purgem load_pairs_and_k
    .purgem store_pairs
    .purgem load_xy
    .purgem load_xy_and_k
    .purgem store_xy
    .text
