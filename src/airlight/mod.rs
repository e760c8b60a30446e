//! Air-light: what a medium scatters once from a source towards the eye, in closed form.

pub mod sunlit;
