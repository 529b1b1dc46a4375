// Products of matrices without any library: panels of 16 outputs, in float32 arithmetic.
#include <algorithm>
#include <vector>

#include "core/half.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/cpu/panels.h"

namespace aligngs::nn {
namespace {

/// T is float, or uint16_t for bfloat16 bits.
template <class T>
class PortableMatrix : public PackedMatrix {
 public:
  static constexpr bool kHalf = sizeof(T) == 2;

  PortableMatrix(const float* weights, int64_t outputs, int64_t inputs)
      : PackedMatrix(outputs, inputs, kHalf ? Precision::kBfloat16 : Precision::kFloat32),
        panels_((outputs + kPanel - 1) / kPanel),
        packed_(static_cast<size_t>(panels_ * inputs * kPanel)) {
    for (int64_t n = 0; n < outputs; ++n) {
      T* panel = packed_.data() + n / kPanel * inputs * kPanel + n % kPanel;
      for (int64_t k = 0; k < inputs; ++k) {
        const float w = weights[n * inputs + k];
        if constexpr (kHalf) {
          panel[k * kPanel] = float_to_bfloat16(w);
        } else {
          panel[k * kPanel] = w;
        }
      }
    }
  }

  size_t bytes() const override { return packed_.size() * sizeof(T); }

  void multiply_operands(const void* x, int64_t rows, float* y, Scratch& scratch) const override {
    const Scratch::Frame frame(scratch);
    const size_t panel_size = static_cast<size_t>(inputs() * kPanel);
    const float* a = static_cast<const float*>(x);
    float* widened_panel = nullptr;
    if constexpr (kHalf) {
      float* widened = scratch.floats(static_cast<size_t>(rows * inputs()));
      const auto* bits = static_cast<const uint16_t*>(x);
      for (int64_t i = 0; i < rows * inputs(); ++i) widened[i] = bfloat16_to_float(bits[i]);
      a = widened;
      widened_panel = scratch.floats(panel_size);
    }
    float* tail = scratch.floats(static_cast<size_t>(rows * kPanel));
    for (int64_t p = 0; p < panels_; ++p) {
      const T* panel = packed_.data() + size_t(p) * panel_size;
      const float* b;
      if constexpr (kHalf) {
        for (size_t i = 0; i < panel_size; ++i) widened_panel[i] = bfloat16_to_float(panel[i]);
        b = widened_panel;
      } else {
        b = panel;
      }
      const int64_t width = std::min(kPanel, outputs() - p * kPanel);
      float* c = y + p * kPanel;
      if (width == kPanel) {
        multiply_panel({a, inputs(), rows, inputs(), b, c, outputs(), false});
        continue;
      }
      multiply_panel({a, inputs(), rows, inputs(), b, tail, kPanel, false});
      for (int64_t r = 0; r < rows; ++r) std::copy_n(tail + r * kPanel, width, c + r * outputs());
    }
  }

 private:
  int64_t panels_;
  std::vector<T> packed_;
};

class PortableBackend : public MatrixBackend {
 public:
  explicit PortableBackend(Precision precision) : precision_(precision) {}
  std::string name() const override { return "portable"; }
  std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const override {
    if (precision_ == Precision::kFloat32) return std::make_unique<PortableMatrix<float>>(weights, outputs, inputs);
    return std::make_unique<PortableMatrix<uint16_t>>(weights, outputs, inputs);
  }

 private:
  Precision precision_;
};

}  // namespace

std::shared_ptr<MatrixBackend> make_portable_backend(Precision precision) {
  return std::make_shared<PortableBackend>(precision);
}

}  // namespace aligngs::nn
