//! Results that a plug-in may do without.

/// Writes a result, if it is wanted.
///
/// # Safety
/// `to` is null or valid for a write.
pub unsafe fn write_if_wanted<T>(to: *mut T, value: T) {
    if !to.is_null() {
        // SAFETY: guaranteed by the caller.
        unsafe { to.write(value) };
    }
}
