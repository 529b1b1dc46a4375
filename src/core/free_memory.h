// Memory that was freed, given back to the system.
#pragma once

namespace aligngs {

/// An allocator keeps what was freed for later. After work that needed much more than what stays, a process that runs
/// for hours gives it back with this. Takes milliseconds; does nothing with other C libraries than glibc.
void give_back_free_memory();

}  // namespace aligngs
