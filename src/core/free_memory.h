// Memory that was freed, given back to the system.
#pragma once

namespace aligngs {

/// An allocator keeps what was freed for later. After work that needed much more than what stays, a process that runs
/// for hours gives it back with this. Takes milliseconds; does nothing with other C libraries than glibc.
void give_back_free_memory();

/// Arrays of a megabyte and more go back to the system as soon as they are freed, from now on. Else glibc keeps up to
/// 32 MB of an array for later, in pieces that nothing large fits into. For a process that runs for hours.
void return_large_arrays_at_once();

/// Freed memory stays with the process, in one arena, for what it allocates next: the system then clears fewer pages.
/// For a process that ends soon, before threads start. An edit takes about a twentieth less time with it.
void keep_freed_memory();

}  // namespace aligngs
