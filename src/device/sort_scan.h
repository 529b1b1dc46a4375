// Sorts and scans of whole arrays on the device: CUB under nvcc, the standard library under emulation.
#pragma once

#include <cstdint>

#include "device/device_memory.h"

namespace aligngs::cuda {

/// Ascending by the lowest `key_bits` bits of the key, stable. All spans have one size; outputs must not overlap
/// inputs. Scratch comes from the arena.
void sort_pairs(DeviceArena& arena, DeviceSpan<const uint32_t> keys, DeviceSpan<const uint32_t> values,
                DeviceSpan<uint32_t> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits);
void sort_pairs(DeviceArena& arena, DeviceSpan<const uint64_t> keys, DeviceSpan<const uint32_t> values,
                DeviceSpan<uint64_t> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits);

/// out[i] = in[0] + ... + in[i - 1], modulo 2^32. `out` may be `in`.
void exclusive_scan(DeviceArena& arena, DeviceSpan<const uint32_t> in, DeviceSpan<uint32_t> out);

}  // namespace aligngs::cuda
