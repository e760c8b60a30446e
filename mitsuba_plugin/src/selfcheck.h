// Is the Mitsuba that loaded us the one we were compiled for?

#pragma once

namespace mitsuba {

/// Throws std::runtime_error, naming what was found and what was expected, unless the running
/// Mitsuba has the version and the memory layout that this plugin was compiled for and the Rust
/// core has the C ABI of its header. The work is done once per process.
///
/// Not for use inside init_plugin: the plugin manager is locked there, and the check makes
/// stock plugins.
void require_matching_mitsuba();

} // namespace mitsuba
