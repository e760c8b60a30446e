//! What the integration tests share: reference rows, random scenes, numbers that count, and
//! hosts that fill the recording table.

// Each test program uses its own part.
#![allow(dead_code, unused_imports, unused_macros)]

pub mod arithmetic;
pub mod article;
pub mod counted;
pub mod host;
pub mod lamps;
pub mod random;
pub mod rows;
