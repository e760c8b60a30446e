//! Strided arrays of numbers or points, borrowed from C.

use super::{AmStatus, Failure};

macro_rules! array {
    ($Array:ident, $float:ident) => {
        /// Numbers or points in the memory of the caller: item `i` starts at
        /// `data[i * stride]`, and the three components of a point follow each other.
        #[derive(Clone, Copy, Debug)]
        #[repr(C)]
        pub struct $Array {
            /// The first item. May be null if there are no items.
            pub data: *const $float,
            /// Distance between items, in numbers: 0 if one item serves all, else at least
            /// the size of an item (1 for numbers, 3 for points).
            pub stride: usize,
        }

        impl Array for $Array {
            type Number = $float;

            fn check(&self, n: usize, size: usize, name: &str) -> Result<(), Failure> {
                if n > 0 && self.data.is_null() {
                    let message = format!("{name}.data must not be null");
                    return Err(Failure::new(AmStatus::NullPointer, message));
                }
                if self.stride > 0 && self.stride < size {
                    let got = self.stride;
                    let message = format!("{name}.stride must be 0 or >= {size}, got {got}");
                    return Err(Failure::new(AmStatus::InvalidArgument, message));
                }
                Ok(())
            }

            #[inline(always)]
            unsafe fn get(&self, item: usize, component: usize) -> $float {
                // SAFETY: promised by the caller.
                unsafe { *self.data.add(item * self.stride + component) }
            }
        }
    };
}

/// What both kinds of array have in common.
pub trait Array: Copy {
    /// Type of the numbers.
    type Number;

    /// Checks pointer and stride for `n` items of `size` numbers.
    fn check(&self, n: usize, size: usize, name: &str) -> Result<(), Failure>;

    /// A number of an item.
    ///
    /// # Safety
    /// The array has been checked, and has the item.
    unsafe fn get(&self, item: usize, component: usize) -> Self::Number;
}

array!(AmArrayF64, f64);
array!(AmArrayF32, f32);
