// Each operation of src/engine/cuda beside the CPU's. The inputs of an operation are the CPU's, so that a difference
// belongs to the operation that shows it. Only the last group runs both engines from end to end.
#pragma once

#include <string>

#include "cpu_step.h"
#include "op_table.h"

namespace aligngs::op_compare {

void compare_forward(cuda::DeviceContext& context, const CpuStep& step, OpTable& table);  ///< project, lists, blend
void compare_backward(cuda::DeviceContext& context, const CpuStep& step,
                      OpTable& table);  ///< losses, blend, parameter gradients
void compare_semantics(cuda::DeviceContext& context, const CpuStep& step, OpTable& table);  ///< rows, visit, gradients
void compare_updates(cuda::DeviceContext& context, const CpuStep& step, OpTable& table);    ///< shape, density, Adam
/// The multi-view terms, on two photos of a folded wall: in the room nothing is seen alike from two places.
void compare_multi_view(cuda::DeviceContext& context, const BenchmarkRoom& room, OpTable& table);
/// Render, labels, lift, restructuring and a whole step, by the engines.
void compare_engines(int device, const CompareScene& scene, OpTable& table);

/// Operations without the scene: fusion of views of a ball, and the operators in which networks spend their time.
void compare_fusion(int device, OpTable& table);
void compare_networks(int device, OpTable& table);

template <class T>
std::vector<std::remove_const_t<T>> to_host(const cuda::DeviceContext& context, cuda::DeviceSpan<T> span) {
  std::vector<std::remove_const_t<T>> out(span.size);
  cuda::download(context, out.data(), span);
  return out;
}

/// Field `first` to `first + count` (in floats) of the records whose index `keep(i)` wants, as one array.
template <class Records, class Keep>
std::vector<float> fields_of(const Records& records, size_t count_of_records, size_t first, size_t count,
                             const Keep& keep) {
  std::vector<float> out;
  for (size_t i = 0; i < count_of_records; ++i) {
    if (!keep(i)) continue;
    const float* field = reinterpret_cast<const float*>(&records[i]) + first;
    out.insert(out.end(), field, field + count);
  }
  return out;
}

}  // namespace aligngs::op_compare
