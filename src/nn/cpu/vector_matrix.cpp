// Products of matrices in float32 arithmetic: panels of 16 outputs. Weights of 16 bits are widened in the cache.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/half.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/cpu/panels.h"

namespace aligngs::nn {
namespace {

constexpr int64_t kMostDepth = 256;    // of a block: a panel of it, 16 KB, stays in the first cache
constexpr int64_t kGroupPanels = 18;   // of which sums stay in the second cache: 288 KB for 256 rows
constexpr int64_t kRowPadding = 16;    // floats: rows of a block lie in different sets of the first cache
constexpr float kLargestHalf = 65504;  // of float16

/// Inputs are cut into blocks of nearly equal depth.
int64_t block_depth(int64_t inputs) {
  const int64_t blocks = std::max<int64_t>(1, (inputs + kMostDepth - 1) / kMostDepth);
  return std::max<int64_t>(1, (inputs + blocks - 1) / blocks);
}

/// Weights are float32, or 16 bits that are widened block by block. Sums are float32. The parts of a sum are added in
/// the same order whatever the number of rows.
class VectorMatrix : public PackedMatrix {
 public:
  VectorMatrix(const float* weights, int64_t outputs, int64_t inputs, Precision precision)
      : PackedMatrix(outputs, inputs, precision),
        panels_((outputs + kPanel - 1) / kPanel),
        packed_(size_t(panels_ * inputs * kPanel) * item()) {
    std::memset(packed_.get(), 0, packed_.size());
    for (int64_t n = 0; n < outputs; ++n) {
      const int64_t panel = n / kPanel * inputs * kPanel + n % kPanel;
      const float* row = weights + n * inputs;
      if (precision == Precision::kFloat32) {
        float* out = reinterpret_cast<float*>(packed_.get()) + panel;
        for (int64_t k = 0; k < inputs; ++k) out[k * kPanel] = row[k];
      } else {
        const bool brain = precision == Precision::kBfloat16;
        uint16_t* out = reinterpret_cast<uint16_t*>(packed_.get()) + panel;
        for (int64_t k = 0; k < inputs; ++k)
          out[k * kPanel] = brain ? float_to_bfloat16(row[k]) : float_to_half(row[k]);
      }
    }
  }

  size_t bytes() const override { return packed_.size(); }

  void multiply_packed(const void* x, int64_t rows, float* y, Scratch& scratch) const override {
    const Scratch::Frame frame(scratch);
    const int64_t depth = block_depth(inputs());
    const Operands operands = operands_of(x, rows, depth, scratch);
    float* const wide = item() == 4 ? nullptr : scratch.floats(size_t(kJoinedPanels * depth * kPanel));
    const int64_t whole = outputs() / kPanel;  // panels; one more has a tail
    PanelProduct product{nullptr, operands.row_stride, rows, 0, nullptr, 0, 1, nullptr, outputs(), kPanel, false};
    const auto add_up = [&](int64_t first, int64_t last, float* c) {
      for (int64_t begin = 0; begin < inputs(); begin += depth) {
        product.a = operands.first + begin / depth * operands.block_stride;
        product.depth = std::min(depth, inputs() - begin);
        product.accumulate = begin > 0;
        for (int64_t p = first; p < last; p += kJoinedPanels) {
          product.panels = std::min(kJoinedPanels, last - p);
          product.c = c + (p - first) * kPanel;
          set_weights(p, begin, wide, product);
          multiply_panels(product);
        }
      }
    };
    for (int64_t p = 0; p < whole; p += kGroupPanels) add_up(p, std::min(whole, p + kGroupPanels), y + p * kPanel);
    if (whole == panels_) return;
    float* const tail = scratch.floats(size_t(rows * kPanel));
    product.c_stride = kPanel;
    add_up(whole, panels_, tail);
    const int64_t width = outputs() - whole * kPanel;
    for (int64_t r = 0; r < rows; ++r) std::copy_n(tail + r * kPanel, width, y + r * outputs() + whole * kPanel);
  }

 private:
  /// Rows as floats, in blocks of some columns: those of block i begin at first + i * block_stride.
  struct Operands {
    const float* first;
    int64_t block_stride, row_stride;
  };

  /// The rows where they lie, if they are floats and few of them share a set of the first cache; else a copy.
  Operands operands_of(const void* x, int64_t rows, int64_t depth, Scratch& scratch) const {
    constexpr int64_t kSetsRepeat = 512;  // floats: 2 KB, half of the first cache's way
    const bool floats = precision() != Precision::kBfloat16;
    if (floats && inputs() % kSetsRepeat != 0) return {static_cast<const float*>(x), depth, inputs()};
    const int64_t row_stride = depth + kRowPadding, block_stride = rows * row_stride;
    const int64_t blocks = (inputs() + depth - 1) / depth;
    float* const copies = scratch.floats(size_t(blocks * block_stride));
    for (int64_t begin = 0; begin < inputs(); begin += depth) {
      const int64_t n = std::min(depth, inputs() - begin);
      float* const block = copies + begin / depth * block_stride;
      for (int64_t r = 0; r < rows; ++r) copy_row(x, r * inputs() + begin, n, block + r * row_stride);
    }
    return {copies, block_stride, row_stride};
  }

  size_t item() const { return precision() == Precision::kFloat32 ? sizeof(float) : sizeof(uint16_t); }

  void copy_row(const void* x, int64_t first, int64_t count, float* out) const {
    if (precision() == Precision::kBfloat16) {
      widen(static_cast<const uint16_t*>(x) + first, count, HalfFormat::kBfloat16, out);
    } else {
      std::copy_n(static_cast<const float*>(x) + first, count, out);
    }
  }

  /// Points at rows begin, begin + 1, ... of the panels, widened where they are of 16 bits.
  void set_weights(int64_t panel, int64_t begin, float* wide, PanelProduct& product) const {
    const int64_t size = inputs() * kPanel, from = panel * size + begin * kPanel;
    if (!wide) {
      product.b = reinterpret_cast<const float*>(packed_.get()) + from;
      product.b_stride = size;
      return;
    }
    const auto format = precision() == Precision::kBfloat16 ? HalfFormat::kBfloat16 : HalfFormat::kFloat16;
    const int64_t count = product.depth * kPanel;
    for (int64_t p = 0; p < product.panels; ++p)
      widen(reinterpret_cast<const uint16_t*>(packed_.get()) + from + p * size, count, format, wide + p * count);
    product.b = wide;
    product.b_stride = count;
  }

  int64_t panels_;
  AlignedBytes packed_;
};

class VectorBackend : public MatrixBackend {
 public:
  explicit VectorBackend(Precision precision) : precision_(precision) {}
  std::string name() const override { return "vector kernels"; }
  bool rows_are_independent() const override { return true; }
  std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const override {
    const auto too_large = [](float w) { return !(std::abs(w) <= kLargestHalf); };
    const bool wide = precision_ == Precision::kFloat16 && std::any_of(weights, weights + outputs * inputs, too_large);
    return std::make_unique<VectorMatrix>(weights, outputs, inputs, wide ? Precision::kFloat32 : precision_);
  }

 private:
  Precision precision_;
};

}  // namespace

std::shared_ptr<MatrixBackend> make_vector_backend(Precision precision) {
  return std::make_shared<VectorBackend>(precision);
}

}  // namespace aligngs::nn
