//! Rows of a mesh: the distortion at equidistant points of a row.

use fmc::geometry::evaluation_form::Displacement;
use fmc::geometry::mesh::displacement_rows::DisplacementRows;
use fmc::geometry::range::Quantity;
use fmc::geometry::sensor::SensorPoint;

use crate::camera::fmc_camera;
use crate::error::{fmc_error, fmc_status};
use crate::frame::{fmc_frame, unchanged};
use crate::memory::{self, Extent, Storage};
use crate::points::fmc_point;

/// Words of a mesh.
pub const FMC_MESH_WORDS: usize = 24;

/// Rows of a frame's mesh, in storage of the caller; it may be copied.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_mesh {
    /// Words of the library alone.
    pub opaque: [u64; FMC_MESH_WORDS],
}

impl Storage for fmc_mesh {
    type Object = DisplacementRows;
    const LETTERS: [u8; 4] = *b"mesh";
}

/// Distortion at a point, measured - ideal, mm.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct fmc_displacement {
    /// Along x, mm.
    pub dx_mm: f32,
    /// Along y, mm.
    pub dy_mm: f32,
}

const _: () = assert!(size_of::<fmc_displacement>() == size_of::<Displacement>());
const _: () = assert!(align_of::<fmc_displacement>() == align_of::<Displacement>());

/// Prepares the rows of a frame with `step_mm` from point to point along x, and puts them into
/// storage. `bound_nm` gets the bound of the rounding error of a displacement, nm per axis.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_mesh_init(
    mesh: *mut fmc_mesh,
    camera: *const fmc_camera,
    frame: *const fmc_frame,
    step_mm: f32,
    bound_nm: *mut f32,
    error: *mut fmc_error,
) -> fmc_status {
    let initialised = || {
        memory::room(mesh, 1)?;
        Extent::of(mesh, 1, 1).apart_from(Extent::of(camera, 1, 2))?;
        Extent::of(mesh, 1, 1).apart_from(Extent::of(frame, 1, 3))?;
        let bound = memory::output(bound_nm, 5)?;
        // SAFETY: the caller's promise.
        let (camera, frame) = unsafe { (memory::kept(camera, 2)?, memory::kept(frame, 3)?) };
        Quantity::XMm.check(step_mm)?;
        unchanged(frame, camera, 3)?;
        let rows = DisplacementRows::new(&frame.object.correction, step_mm);
        // SAFETY: the caller's promise.
        unsafe { bound.write(rows.rounding_bound_nm()) };
        // SAFETY: the caller's promise.
        unsafe { memory::put(mesh, camera.stamp, rows) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(initialised(), error) }
}

/// Writes the displacements of the points of a row, of which the first is at `first`. `count` may
/// be 0; then `row` may be anything.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `row` to `count`
/// of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_mesh_row(
    camera: *const fmc_camera,
    mesh: *const fmc_mesh,
    first: fmc_point,
    row: *mut fmc_displacement,
    count: usize,
    error: *mut fmc_error,
) -> fmc_status {
    let written = || {
        // SAFETY: the caller's promise.
        let (kept, mesh_of) = unsafe { (memory::kept(mesh, 2)?, memory::kept(camera, 1)?) };
        unchanged(kept, mesh_of, 2)?;
        let row = row.cast::<Displacement>();
        let extent = Extent::of(row, count, 4);
        extent.apart_from(Extent::of(camera, 1, 1))?;
        extent.apart_from(Extent::of(mesh, 1, 2))?;
        // SAFETY: the caller's promise; both types are two numbers.
        let row = unsafe { memory::elements_mut(row, count, 4) }?;
        let first = SensorPoint::new(first.x_mm, first.y_mm);
        kept.object.row(first).write(row);
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(written(), error) }
}
