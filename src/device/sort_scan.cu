#include "device/sort_scan.h"

#ifdef ALIGNGS_CUDA_EMULATED
#include <algorithm>
#include <numeric>
#include <vector>

#include "device/emulation/emulated_devices.h"
#include "device/emulation/tape.h"
#else
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "device/cuda_check.h"
#endif

namespace aligngs::cuda {
namespace {

#ifdef ALIGNGS_CUDA_EMULATED

template <class Key>
void sort_now(DeviceSpan<const Key> keys, DeviceSpan<const uint32_t> values, DeviceSpan<Key> sorted_keys,
              DeviceSpan<uint32_t> sorted_values, int key_bits) {
  const Key mask = key_bits >= int(sizeof(Key)) * 8 ? Key(~Key(0)) : Key((Key(1) << key_bits) - 1);
  std::vector<size_t> order(keys.size);
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return (keys[a] & mask) < (keys[b] & mask); });
  for (size_t i = 0; i < order.size(); ++i) {
    sorted_keys[i] = keys[order[i]];
    sorted_values[i] = values[order[i]];
  }
}

template <class Key>
void sort_pairs_of(DeviceArena& arena, DeviceSpan<const Key> keys, DeviceSpan<const uint32_t> values,
                   DeviceSpan<Key> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits) {
  require_current_device(arena.context().stream(), "radix sort");
  emulated_stream_operation("radix sort", [=] { sort_now(keys, values, sorted_keys, sorted_values, key_bits); });
}

#else

template <class Key>
void sort_pairs_of(DeviceArena& arena, DeviceSpan<const Key> keys, DeviceSpan<const uint32_t> values,
                   DeviceSpan<Key> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits) {
  if (keys.size == 0) return;
  size_t bytes = 0;
  const auto run = [&](void* scratch) {
    check_cuda(
        cub::DeviceRadixSort::SortPairs(scratch, bytes, keys.data, sorted_keys.data, values.data, sorted_values.data,
                                        static_cast<int64_t>(keys.size), 0, key_bits, arena.context().stream()),
        "radix sort");
  };
  run(nullptr);
  run(arena.take<unsigned char>(bytes, "scratch of a sort").data);
}

#endif

}  // namespace

void sort_pairs(DeviceArena& arena, DeviceSpan<const uint32_t> keys, DeviceSpan<const uint32_t> values,
                DeviceSpan<uint32_t> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits) {
  arena.context().use();
  sort_pairs_of(arena, keys, values, sorted_keys, sorted_values, key_bits);
}

void sort_pairs(DeviceArena& arena, DeviceSpan<const uint64_t> keys, DeviceSpan<const uint32_t> values,
                DeviceSpan<uint64_t> sorted_keys, DeviceSpan<uint32_t> sorted_values, int key_bits) {
  arena.context().use();
  sort_pairs_of(arena, keys, values, sorted_keys, sorted_values, key_bits);
}

void exclusive_scan(DeviceArena& arena, DeviceSpan<const uint32_t> in, DeviceSpan<uint32_t> out) {
  if (in.size == 0) return;
  arena.context().use();
#ifdef ALIGNGS_CUDA_EMULATED
  require_current_device(arena.context().stream(), "scan");
  emulated_stream_operation("scan", [in, out] {
    uint32_t sum = 0;
    for (size_t i = 0; i < in.size; ++i) {
      const uint32_t value = in[i];
      out[i] = sum;
      sum += value;
    }
  });
#else
  size_t bytes = 0;
  const auto run = [&](void* scratch) {
    check_cuda(cub::DeviceScan::ExclusiveSum(scratch, bytes, in.data, out.data, static_cast<int64_t>(in.size),
                                             arena.context().stream()),
               "scan");
  };
  run(nullptr);
  run(arena.take<unsigned char>(bytes, "scratch of a scan").data);
#endif
}

}  // namespace aligngs::cuda
