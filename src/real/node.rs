//! `Real` for recorded nodes: each operation calls back into the host.
//!
//! The host owns the values. A [`Node`] is a slot number on the host's tape and a pointer to
//! the table of functions that extend it, so a Rust formula builds the host's own graph,
//! for its own compiler and its own automatic differentiation.

use super::{Mask, Real};
use libc::c_void;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A slot on the host's tape. Slot 0 means that the host failed; operations on it give 0.
pub type AmNode = u32;

/// Declares the host table and the method of [`Node`] behind each entry, from one list.
macro_rules! host_table {
    ($( $(#[$doc:meta])* $name:ident ( $($argument:ident),* ) ; )*) => {
        /// What a host offers to record formulas: arithmetic on the slots of its own tape.
        ///
        /// Every function gets `tape` first, returns a new slot, must not unwind, and returns
        /// slot 0 after a failure of its own. Masks live on the same tape as numbers.
        #[repr(C)]
        pub struct AmHostTable {
            /// The host's tape, passed back to every function.
            pub tape: *mut c_void,
            /// Bits of the significand of the host's numbers: 24 (single) or 53 (double).
            pub digits: u32,
            /// The constant `value`.
            pub literal: unsafe extern "C" fn(tape: *mut c_void, value: f64) -> AmNode,
            $( $(#[$doc])*
            pub $name: unsafe extern "C" fn(tape: *mut c_void $(, $argument: AmNode)*) -> AmNode, )*
        }

        impl AmHostTable {
            $( fn $name(&self $(, $argument: AmNode)*) -> AmNode {
                // SAFETY: the host vouches for its own functions and tape.
                unsafe { (self.$name)(self.tape $(, $argument)*) }
            } )*
        }
    };
}

host_table! {
    /// −a.
    neg(a);
    /// |a|.
    abs(a);
    /// √a.
    sqrt(a);
    /// e^a.
    exp(a);
    /// Natural logarithm of a.
    log(a);
    /// The value of a without its derivatives.
    detach(a);
    /// a + b.
    add(a, b);
    /// a − b.
    sub(a, b);
    /// a · b.
    mul(a, b);
    /// a / b.
    div(a, b);
    /// The smaller of a and b.
    min(a, b);
    /// The larger of a and b.
    max(a, b);
    /// a · b + c.
    fma(a, b, c);
    /// Mask: a < b.
    less(a, b);
    /// Mask: a ≤ b.
    less_equal(a, b);
    /// Mask: p and q.
    mask_and(p, q);
    /// Mask: p or q.
    mask_or(p, q);
    /// Mask: not p.
    mask_not(p);
    /// a where the mask p is set, else b.
    select(p, a, b);
}

/// A recorded real number.
#[derive(Clone, Copy)]
pub struct Node<'h> {
    host: &'h AmHostTable,
    slot: AmNode,
}

/// A recorded truth value.
#[derive(Clone, Copy)]
pub struct NodeMask<'h>(Node<'h>);

impl<'h> Node<'h> {
    /// The number in `slot` of the tape of `host`.
    #[must_use]
    pub fn new(host: &'h AmHostTable, slot: AmNode) -> Self {
        Self { host, slot }
    }

    /// Slot of this number.
    #[must_use]
    pub fn slot(self) -> AmNode {
        self.slot
    }

    fn with(self, slot: AmNode) -> Self {
        Self { slot, ..self }
    }
}

impl std::fmt::Debug for Node<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "node {}", self.slot)
    }
}

impl std::fmt::Debug for NodeMask<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "mask {}", self.0.slot)
    }
}

impl Add for Node<'_> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(self.host.add(self.slot, other.slot))
    }
}

impl Sub for Node<'_> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(self.host.sub(self.slot, other.slot))
    }
}

impl Mul for Node<'_> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.with(self.host.mul(self.slot, other.slot))
    }
}

impl Div for Node<'_> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.with(self.host.div(self.slot, other.slot))
    }
}

impl Neg for Node<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.with(self.host.neg(self.slot))
    }
}

impl<'h> Real for Node<'h> {
    type Mask = NodeMask<'h>;
    const DERIVATIVES: bool = true;

    fn lit(self, value: f64) -> Self {
        // SAFETY: the host vouches for its own functions and tape.
        self.with(unsafe { (self.host.literal)(self.host.tape, value) })
    }
    fn digits(self) -> u32 {
        self.host.digits
    }
    fn sqrt(self) -> Self {
        self.with(self.host.sqrt(self.slot))
    }
    fn exp(self) -> Self {
        self.with(self.host.exp(self.slot))
    }
    fn ln(self) -> Self {
        self.with(self.host.log(self.slot))
    }
    fn abs(self) -> Self {
        self.with(self.host.abs(self.slot))
    }
    fn min(self, other: Self) -> Self {
        self.with(self.host.min(self.slot, other.slot))
    }
    fn max(self, other: Self) -> Self {
        self.with(self.host.max(self.slot, other.slot))
    }
    fn mul_add(self, a: Self, b: Self) -> Self {
        self.with(self.host.fma(self.slot, a.slot, b.slot))
    }
    fn detach(self) -> Self {
        self.with(self.host.detach(self.slot))
    }
    fn lt(self, other: Self) -> NodeMask<'h> {
        NodeMask(self.with(self.host.less(self.slot, other.slot)))
    }
    fn le(self, other: Self) -> NodeMask<'h> {
        NodeMask(self.with(self.host.less_equal(self.slot, other.slot)))
    }
    fn select(mask: NodeMask<'h>, a: Self, b: Self) -> Self {
        a.with(a.host.select(mask.0.slot, a.slot, b.slot))
    }
}

impl BitAnd for NodeMask<'_> {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        let Self(node) = self;
        Self(node.with(node.host.mask_and(node.slot, other.0.slot)))
    }
}

impl BitOr for NodeMask<'_> {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        let Self(node) = self;
        Self(node.with(node.host.mask_or(node.slot, other.0.slot)))
    }
}

impl Not for NodeMask<'_> {
    type Output = Self;
    fn not(self) -> Self {
        let Self(node) = self;
        Self(node.with(node.host.mask_not(node.slot)))
    }
}

impl Mask for NodeMask<'_> {
    fn any(self) -> bool {
        true
    }
}
