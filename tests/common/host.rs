//! A host in f64 or f32: it computes at once, and counts the operations.

use analytic_media::real::node::{AmHostTable, AmNode, Node};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ptr::null_mut;

/// Values of the slots so far, masks as 0 and 1; and how often each operation was used.
#[derive(Default)]
pub struct Tape {
    single: bool,
    values: Vec<f64>,
    pub counts: BTreeMap<&'static str, usize>,
}

impl Tape {
    fn push(&mut self, operation: &'static str, value: f64) -> AmNode {
        *self.counts.entry(operation).or_default() += 1;
        self.values.push(if self.single {
            f64::from(value as f32)
        } else {
            value
        });
        self.values.len() as AmNode - 1
    }
}

/// A host and its table.
pub struct Host {
    tape: Box<RefCell<Tape>>,
    table: AmHostTable,
}

impl Host {
    /// A host that computes in f32 if `single`, else in f64.
    pub fn new(single: bool) -> Self {
        let tape = Tape {
            single,
            values: vec![f64::NAN], // slot 0 means failure
            ..Tape::default()
        };
        let tape = Box::new(RefCell::new(tape));
        let mut table = table(if single { 24 } else { 53 });
        table.tape = (&raw const *tape).cast_mut().cast();
        Self { tape, table }
    }

    pub fn table(&self) -> &AmHostTable {
        &self.table
    }

    /// A new slot with this value.
    pub fn input(&self, value: f64) -> Node<'_> {
        let slot = self.tape.borrow_mut().push("input", value);
        Node::new(&self.table, slot)
    }

    pub fn value(&self, slot: AmNode) -> f64 {
        self.tape.borrow().values[slot as usize]
    }

    /// How often each operation was recorded.
    pub fn counts(&self) -> BTreeMap<&'static str, usize> {
        self.tape.borrow().counts.clone()
    }
}

fn truth(mask: bool) -> f64 {
    f64::from(u8::from(mask))
}

macro_rules! table {
    ($($name:ident ($($arg:ident),*) = $value:expr;)*) => {
        fn table(digits: u32) -> AmHostTable {
            unsafe extern "C" fn literal(tape: *mut c_void, value: f64) -> AmNode {
                unsafe { &*tape.cast::<RefCell<Tape>>() }.borrow_mut().push("literal", value)
            }
            $(
                unsafe extern "C" fn $name(tape: *mut c_void $(, $arg: AmNode)*) -> AmNode {
                    let mut tape = unsafe { &*tape.cast::<RefCell<Tape>>() }.borrow_mut();
                    $( let $arg = tape.values[$arg as usize]; )*
                    tape.push(stringify!($name), $value)
                }
            )*
            AmHostTable { tape: null_mut(), digits, literal, $($name),* }
        }
    };
}

table! {
    neg(a) = -a;
    abs(a) = a.abs();
    sqrt(a) = a.sqrt();
    exp(a) = a.exp();
    log(a) = a.ln();
    detach(a) = a;
    add(a, b) = a + b;
    sub(a, b) = a - b;
    mul(a, b) = a * b;
    div(a, b) = a / b;
    min(a, b) = a.min(b);
    max(a, b) = a.max(b);
    fma(a, b, c) = a.mul_add(b, c);
    less(a, b) = truth(a < b);
    less_equal(a, b) = truth(a <= b);
    mask_and(p, q) = p * q;
    mask_or(p, q) = p.max(q);
    mask_not(p) = 1.0 - p;
    select(p, a, b) = if p == 1.0 { a } else { b };
}
