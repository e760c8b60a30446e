//! What the integration tests share: reference rows, and hosts that fill the recording table.

// Each test program uses its own part.
#![allow(dead_code)]

pub mod host;
pub mod rows;
