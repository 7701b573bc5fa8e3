//! Memory of the caller: the one place that trusts pointers, after it has checked them.
//!
//! A pointer that is neither NULL nor misaligned, and whose memory the caller owns for the length
//! that the call states, is all that a call relies on. A tag tells an object from storage that was
//! never initialised or holds another type; the compiler knows nothing of what C has written.

use core::mem::MaybeUninit;
use core::ptr;
use core::slice;

use crate::error::{fmc_error, fmc_status};
use crate::refusal::{Failure, Refusal};
use crate::version::{Input, checked};
use crate::{
    FMC_CAMERA_VERSION, FMC_ERROR_BUFFER, FMC_ERROR_MISALIGNED, FMC_ERROR_NULL, FMC_ERROR_OVERLAP,
    FMC_ERROR_TOO_MANY, FMC_ERROR_UNINITIALISED, FMC_OK,
};

/// Storage of the caller for an object.
pub(crate) trait Storage: Sized {
    /// The object.
    type Object;

    /// Four letters of the type.
    const LETTERS: [u8; 4];

    /// First word of storage that holds the object, of its letters and the library's version.
    const TAG: u32 = {
        assert!(size_of::<Kept<Self::Object>>() <= size_of::<Self>());
        assert!(align_of::<Kept<Self::Object>>() <= align_of::<Self>());
        u32::from_le_bytes(Self::LETTERS) ^ FMC_CAMERA_VERSION.rotate_left(16)
    };
}

/// What storage holds.
#[repr(C)]
#[derive(Debug)]
pub(crate) struct Kept<T> {
    tag: u32,
    /// CRC-32 of the calibration that the object is of.
    pub(crate) stamp: u32,
    pub(crate) object: T,
}

/// Addresses of an argument, as the half-open range of its bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    begin: usize,
    end: usize,
    argument: u32,
}

impl Extent {
    /// Returns the extent of so many elements; it is empty for none.
    pub(crate) fn of<T>(pointer: *const T, count: usize, argument: u32) -> Self {
        let begin = pointer.addr();
        Self {
            begin,
            end: begin.wrapping_add(count.wrapping_mul(size_of::<T>())),
            argument,
        }
    }

    /// Returns true if both share no byte.
    #[inline]
    pub(crate) const fn is_apart_from(self, other: Self) -> bool {
        self.begin >= other.end || other.begin >= self.end
    }

    /// Checks that an argument that is written shares no byte with another one.
    #[inline]
    pub(crate) fn apart_from(self, other: Self) -> Result<(), Refusal> {
        if !self.is_apart_from(other) {
            let numbers = [self.argument, other.argument];
            return Err(refused(FMC_ERROR_OVERLAP, self.argument, numbers));
        }
        Ok(())
    }
}

/// Checks that bytes that are written, argument 2, share no memory with what they are made of,
/// argument 1, and with their number and CRC-32, arguments 4 and 5, nor these with each other.
pub(crate) fn bytes_apart(
    input: Extent,
    bytes: Extent,
    count: *const usize,
    crc32: *const u32,
) -> Result<(), Refusal> {
    let count = Extent::of(count, 1, 4);
    let crc32 = Extent::of(crc32, 1, 5);
    for (written, other) in [
        (bytes, input),
        (bytes, count),
        (bytes, crc32),
        (crc32, count),
    ] {
        written.apart_from(other)?;
    }
    Ok(())
}

/// Checks that a pointer is neither NULL nor misaligned.
#[inline]
fn placed<T>(pointer: *const T, argument: u32) -> Result<(), Refusal> {
    placed_at(pointer.addr(), align_of::<T>() - 1, argument)
}

/// Checks that an address is neither 0 nor has bits of a mask.
#[inline(never)]
fn placed_at(address: usize, mask: usize, argument: u32) -> Result<(), Refusal> {
    let status = if address == 0 {
        FMC_ERROR_NULL
    } else if address & mask != 0 {
        FMC_ERROR_MISALIGNED
    } else {
        return Ok(());
    };
    Err(Failure::of_argument(status, argument).into())
}

#[cold]
#[inline(never)]
fn refused(status: fmc_status, argument: u32, numbers: [u32; 2]) -> Refusal {
    let [number, expected] = numbers;
    Failure::of_argument(status, argument)
        .numbers(number, expected)
        .into()
}

/// Number of elements of a call that is refused: a 64th of the addresses.
const MOST_ELEMENTS: usize = 1 << (usize::BITS - 6);

/// Returns true if a pointer may be to so many elements of this extent, at least one.
#[inline]
pub(crate) fn is_placed<T>(pointer: *const T, count: usize, extent: Extent) -> bool {
    const { assert!(size_of::<T>() <= 1 << 5) };
    // With so few, an extent that wraps ends before it begins.
    !pointer.is_null() && pointer.is_aligned() && count < MOST_ELEMENTS && extent.begin < extent.end
}

/// Checks the pointer to so many elements; none may be anywhere.
#[inline]
fn placed_many<T>(pointer: *const T, count: usize, argument: u32) -> Result<(), Refusal> {
    placed(pointer, argument)?;
    if !is_placed(pointer, count, Extent::of(pointer, count, argument)) {
        return Err(refused(FMC_ERROR_TOO_MANY, argument, [0; 2]));
    }
    Ok(())
}

/// Returns the object in storage.
///
/// # Safety
/// As of [`kept`].
#[inline]
pub(crate) unsafe fn object<'a, S: Storage>(
    pointer: *const S,
    argument: u32,
) -> Result<&'a S::Object, Refusal> {
    // SAFETY: the caller's promise is the same.
    unsafe { kept(pointer, argument) }.map(|kept| &kept.object)
}

/// Returns the object in storage, with its stamp; `None` if it is to be refused.
///
/// # Safety
/// As of [`kept`].
#[inline]
pub(crate) unsafe fn holding<'a, S: Storage>(pointer: *const S) -> Option<&'a Kept<S::Object>> {
    if pointer.is_null() || !pointer.is_aligned() {
        return None;
    }
    let storage = pointer.cast::<Kept<S::Object>>();
    // SAFETY: the storage is as large and as aligned as `Kept`, by the assertions of `TAG`, and a
    // word is valid with all bits.
    let tag = unsafe { ptr::addr_of!((*storage).tag).read() };
    // SAFETY: only `put` writes the tag, together with the object.
    (tag == S::TAG).then(|| unsafe { &*storage })
}

/// Returns the objects in two storages, with their stamps; `None` if one is to be refused.
///
/// # Safety
/// As of [`kept`].
#[inline]
#[expect(clippy::type_complexity, reason = "a pair")]
pub(crate) unsafe fn holding_both<'a, S: Storage, T: Storage>(
    first: *const S,
    second: *const T,
) -> Option<(&'a Kept<S::Object>, &'a Kept<T::Object>)> {
    let unaligned = (first.addr() | second.addr()) % align_of::<S>().max(align_of::<T>());
    if unaligned != 0 || first.is_null() || second.is_null() {
        return None;
    }
    // SAFETY: the caller's promise is the same.
    let (first, second) = unsafe { (holding(first)?, holding(second)?) };
    Some((first, second))
}

/// Returns the object in storage, with its stamp.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to storage that nothing writes for `'a`.
#[inline]
pub(crate) unsafe fn kept<'a, S: Storage>(
    pointer: *const S,
    argument: u32,
) -> Result<&'a Kept<S::Object>, Refusal> {
    let storage = pointer.cast::<Kept<S::Object>>();
    // SAFETY: the storage is as large and as aligned as `Kept`, by the assertions of `TAG`.
    unsafe { tagged(storage.cast(), align_of::<S>() - 1, S::TAG, argument) }?;
    // SAFETY: only `put` writes the tag, together with the object.
    Ok(unsafe { &*storage })
}

/// Checks that storage begins with a tag.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to a word.
#[inline(never)]
unsafe fn tagged(word: *const u32, mask: usize, tag: u32, argument: u32) -> Result<(), Refusal> {
    placed_at(word.addr(), mask, argument)?;
    // SAFETY: the pointer has been checked, and a word is valid with all bits.
    if unsafe { word.read() } != tag {
        return Err(refused(FMC_ERROR_UNINITIALISED, argument, [0; 2]));
    }
    Ok(())
}

/// Returns the object in storage that is known to hold one.
///
/// # Safety
/// [`object`] has accepted the pointer.
#[cfg(control)]
pub(crate) unsafe fn known<'a, S: Storage>(pointer: *const S) -> &'a S::Object {
    // SAFETY: the caller's promise.
    unsafe { &(*pointer.cast::<Kept<S::Object>>()).object }
}

/// Returns the object in storage, to be changed.
///
/// # Safety
/// As of [`object`]; nothing else reads it for `'a`.
pub(crate) unsafe fn object_mut<'a, S: Storage>(
    pointer: *mut S,
    argument: u32,
) -> Result<&'a mut S::Object, Refusal> {
    // SAFETY: the caller's promise is the same.
    unsafe { object(pointer.cast_const(), argument) }?;
    let storage = pointer.cast::<Kept<S::Object>>();
    // SAFETY: `object` has found one there.
    Ok(unsafe { &mut (*storage).object })
}

/// Checks storage for [`put`].
pub(crate) fn room<S: Storage>(pointer: *mut S, argument: u32) -> Result<(), Refusal> {
    placed(pointer.cast_const(), argument)
}

/// Puts an object into storage that [`room`] has accepted.
///
/// # Safety
/// The pointer is to storage that is neither read nor written by others during the call.
pub(crate) unsafe fn put<S: Storage>(pointer: *mut S, stamp: u32, object: S::Object) {
    let storage = pointer.cast::<Kept<S::Object>>();
    // SAFETY: the storage is large and aligned enough, by the assertions of `TAG`.
    unsafe { ptr::addr_of_mut!((*storage).object).write(object) };
    // SAFETY: as above.
    unsafe { ptr::addr_of_mut!((*storage).stamp).write(stamp) };
    // SAFETY: as above.
    unsafe { ptr::addr_of_mut!((*storage).tag).write(S::TAG) };
}

/// Makes an object in storage that [`room`] has accepted.
///
/// # Errors
/// That of `make`, which then has not written.
///
/// # Safety
/// As of [`put`]; without an error, `make` has put an object into its place.
pub(crate) unsafe fn put_in_place<S: Storage>(
    pointer: *mut S,
    stamp: u32,
    make: impl FnOnce(&mut MaybeUninit<S::Object>) -> Result<(), Refusal>,
) -> Result<(), Refusal> {
    let storage = pointer.cast::<Kept<MaybeUninit<S::Object>>>();
    // SAFETY: the storage is large and aligned enough, by the assertions of `TAG`, and nothing else
    // uses it; that of an object may hold anything.
    let object = unsafe { &mut *ptr::addr_of_mut!((*storage).object) };
    make(object)?;
    // SAFETY: as above.
    unsafe { ptr::addr_of_mut!((*storage).stamp).write(stamp) };
    // SAFETY: as above.
    unsafe { ptr::addr_of_mut!((*storage).tag).write(S::TAG) };
    Ok(())
}

/// Returns a structure that the caller has filled, if size and version are the library's.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to a structure that begins with its size and
/// version, is as large as it says, and is not written for `'a`.
pub(crate) unsafe fn input<'a, T: Input>(
    pointer: *const T,
    argument: u32,
) -> Result<&'a T, Refusal> {
    const { assert!(align_of::<T>() == align_of::<[u32; 2]>()) };
    // SAFETY: every version of the structure begins with these words.
    unsafe { headed(pointer.cast(), size_of::<T>(), argument) }?;
    // SAFETY: it is of the library's size, and all its fields are valid with all bits.
    Ok(unsafe { &*pointer })
}

/// Checks size and version at the head of a structure.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to both.
#[inline(never)]
unsafe fn headed(head: *const [u32; 2], size: usize, argument: u32) -> Result<(), Refusal> {
    placed(head, argument)?;
    // SAFETY: the pointer has been checked, and words are valid with all bits.
    checked(unsafe { head.read() }, size, argument)
}

/// Returns elements that are read; none may be anywhere.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to so many elements that nothing writes for
/// `'a`.
pub(crate) unsafe fn elements<'a, T>(
    pointer: *const T,
    count: usize,
    argument: u32,
) -> Result<&'a [T], Refusal> {
    if count == 0 {
        return Ok(&[]);
    }
    placed_many(pointer, count, argument)?;
    // SAFETY: the pointer has been checked, and the caller owns the elements.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// Returns elements that are written; none may be anywhere.
///
/// # Safety
/// As of [`elements`]; nothing else reads or writes them for `'a`.
#[inline]
pub(crate) unsafe fn elements_mut<'a, T>(
    pointer: *mut T,
    count: usize,
    argument: u32,
) -> Result<&'a mut [T], Refusal> {
    if count == 0 {
        return Ok(&mut []);
    }
    placed_many(pointer.cast_const(), count, argument)?;
    // SAFETY: the pointer has been checked, and the caller owns the elements.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

/// Returns the first elements of a buffer.
pub(crate) fn part_of<T>(
    buffer: &mut [T],
    count: usize,
    argument: u32,
) -> Result<&mut [T], Refusal> {
    let number = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
    let refused = Failure::of_argument(FMC_ERROR_BUFFER, argument)
        .numbers(number(buffer.len()), number(count));
    buffer.get_mut(..count).ok_or_else(|| refused.into())
}

/// Place of an answer, which has been checked.
#[derive(Debug)]
pub(crate) struct Output<T>(*mut T);

/// Checks the place of an answer.
pub(crate) fn output<T>(pointer: *mut T, argument: u32) -> Result<Output<T>, Refusal> {
    placed(pointer.cast_const(), argument)?;
    Ok(Output(pointer))
}

impl<T> Output<T> {
    /// Writes the answer.
    ///
    /// # Safety
    /// The pointer that was checked is to memory of the caller for one `T`.
    pub(crate) unsafe fn write(self, answer: T) {
        // SAFETY: the pointer has been checked, and the caller owns the memory.
        unsafe { self.0.write(answer) };
    }
}

/// Returns the status of a call, and fills the error of a refusal, which may be NULL.
///
/// # Safety
/// Unless it is NULL, `error` is to memory of the caller for an error, wherever it lies.
#[inline]
pub(crate) unsafe fn status(result: Result<(), Refusal>, error: *mut fmc_error) -> fmc_status {
    match result {
        Ok(()) => FMC_OK,
        // SAFETY: the caller's promise is the same.
        Err(refusal) => unsafe { fill(error, refusal) },
    }
}

#[cold]
#[inline(never)]
unsafe fn fill(error: *mut fmc_error, refusal: Refusal) -> fmc_status {
    let filled = fmc_error::from(refusal);
    if !error.is_null() {
        // SAFETY: the caller owns the memory; it may be misaligned.
        unsafe { error.write_unaligned(filled) };
    }
    filled.status
}

/// Returns a structure without size and version.
///
/// # Safety
/// Unless it is NULL or misaligned, the pointer is to a structure of the caller, whose fields are
/// valid with all bits.
pub(crate) unsafe fn structure<T: Copy>(pointer: *const T, argument: u32) -> Result<T, Refusal> {
    placed(pointer, argument)?;
    // SAFETY: the pointer has been checked, and the caller owns the structure.
    Ok(unsafe { pointer.read() })
}

#[cfg(test)]
mod tests {
    use super::{Kept, Storage};
    use crate::{fmc_camera, fmc_flight, fmc_frame, fmc_mesh};

    /// Returns the part of the storage that its object takes.
    fn used<S: Storage>() -> f64 {
        assert_ne!(S::TAG, 0);
        let sizes = [size_of::<Kept<S::Object>>(), size_of::<S>()];
        let [object, storage] = sizes.map(|size| f64::from(u32::try_from(size).unwrap()));
        object / storage
    }

    #[test]
    fn storage_has_room_for_its_object_and_hardly_more() {
        for used in [
            used::<fmc_camera>(),
            used::<fmc_frame>(),
            used::<fmc_mesh>(),
            used::<fmc_flight>(),
        ] {
            assert!((0.7..=1.0).contains(&used), "{used}");
        }
    }
}
