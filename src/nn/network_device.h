// The interface of a device on which networks run: memory, and the operators that do their work there. Every pointer to
// floats is device memory unless named host. A null pointer means a part that a network does not have. Rows lie one
// after the other. Operators run in the order of the calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/host_device.h"
#include "nn/attention.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/cpu/row_kernels.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {

/// The ends of a product: y = activation(product(x) + bias).
struct ProductEnds {
  const float* bias = nullptr;  ///< one per output
  Activation activation = Activation::kNone;
  bool relu_input = false;
};

/// Square patches of a map [height, width, channels].
struct PatchShape {
  int64_t height = 0, width = 0, channels = 0;
  int64_t kernel = 1, stride = 1, padding = 0;
  ALIGNGS_HD int64_t out_height() const { return (height + 2 * padding - kernel) / stride + 1; }
  ALIGNGS_HD int64_t out_width() const { return (width + 2 * padding - kernel) / stride + 1; }
};

/// Normalisation of queries and keys per head, then rotation of both by place, in rows of queries, keys and values.
struct HeadPreparation {
  int64_t rows = 0, heads = 0, head_dim = 0;
  const float *q_weight = nullptr, *q_bias = nullptr, *k_weight = nullptr, *k_bias = nullptr;
  float eps = 0;
  const float *cosines = nullptr, *sines = nullptr;  ///< [place][head_dim / 4] of Rope2d
  const std::vector<int>* places = nullptr;          ///< host: y, x of each token; repeated for later rows
};

/// Rows of `stride` floats that begin with the values of all heads.
struct AttentionRows {
  const float* values = nullptr;
  int64_t stride = 0;
};

struct DeformableSamples {
  int64_t queries = 0, heads = 0, head_dim = 0, points = 0;
  const float* reference = nullptr;  ///< [queries, 2 * reference_levels]
  int64_t reference_levels = 1;
  const float *offsets = nullptr, *attention = nullptr;  ///< [queries, heads, levels, points (, 2)]
  const float* values = nullptr;                         ///< [places of all levels, heads * head_dim]
  std::vector<int64_t> sizes;                            ///< height, width per level
};

class NetworkDevice {
 public:
  virtual ~NetworkDevice() = default;
  virtual std::string name() const = 0;

  /// The memory keeps the device alive. Error{kResources} when there is no room.
  virtual std::shared_ptr<float> allocate(size_t count) = 0;
  virtual void upload(float* to, const float* host, size_t count) = 0;
  virtual void download(float* host, const float* from, size_t count) = 0;
  virtual void copy(float* to, const float* from, size_t count) = 0;
  virtual void clear(float* to, size_t count) = 0;
  /// `rows` rows of `columns` floats, which begin `to_stride` and `from_stride` floats apart; add: to += from.
  virtual void copy_columns(float* to, int64_t to_stride, const float* from, int64_t from_stride, int64_t rows,
                            int64_t columns, bool add) = 0;

  /// Weights [outputs, inputs] (host) for product() and convolution() of this device, rounded to the precision. They
  /// multiply rows of the host as well, which travel there and back.
  virtual std::unique_ptr<PackedMatrix> pack(const float* host_weights, int64_t outputs, int64_t inputs,
                                             Precision precision) = 0;
  virtual void product(const PackedMatrix& matrix, const float* x, int64_t rows, const ProductEnds& ends, float* y) = 0;
  /// The matrix holds [outputs][kernel y][kernel x][inputs]; zeros lie around the map.
  virtual void convolution(const PackedMatrix& matrix, const float* x, const PatchShape& shape, const ProductEnds& ends,
                           float* y) = 0;
  /// Products [height * width][kernel][kernel][channels] to a map of kernel times the size; adds the bias.
  virtual void spread_patches(const float* products, int64_t height, int64_t width, int64_t channels, int64_t kernel,
                              const float* bias, float* y) = 0;
  /// 3x3 with zeros around; weight [3][3][channels].
  virtual void depthwise(const float* x, int64_t height, int64_t width, int64_t channels, const float* weight,
                         const float* bias, float* y) = 0;
  virtual void max_pool(const float* x, const PatchShape& shape, float* y) = 0;
  virtual void resample(const float* x, int64_t height, int64_t width, int64_t channels, const ResampleAxis& vertical,
                        const ResampleAxis& horizontal, float* y) = 0;

  virtual void prepare_heads(const HeadPreparation& heads, float* qkv) = 0;
  /// masked: host, as attention() has it, or null. bfloat16: operands are rounded, except under a mask.
  virtual void attention(const AttentionShape& shape, const AttentionRows& queries, const AttentionRows& keys,
                         const AttentionRows& values, const uint8_t* masked, Precision precision, float* out) = 0;
  virtual void deformable(const DeformableSamples& samples, float* out) = 0;

  // As in cpu/row_kernels.h and ops/norm.h.
  virtual void layer_norm(const float* x, int64_t rows, int64_t columns, const float* weight, const float* bias,
                          float eps, float* y) = 0;
  virtual void group_norm(float* x, int64_t rows, int64_t columns, int64_t groups, const float* weight,
                          const float* bias, double eps, bool relu) = 0;
  virtual void softmax_rows(float* x, int64_t rows, int64_t columns) = 0;
  virtual void add_bias_and_activate(float* y, int64_t rows, int64_t columns, const float* bias,
                                     Activation activation) = 0;
  virtual void swiglu(const float* x, int64_t rows, int64_t columns, float* out) = 0;
  virtual void add_scaled(float* x, const float* y, int64_t rows, int64_t columns, const float* bias,
                          const float* scale) = 0;
  /// x[r, c] = x[r, c] * scale[c] + shift[c]; scale may be null (1).
  virtual void scale_columns(float* x, int64_t rows, int64_t columns, const float* scale, const float* shift) = 0;
  /// x += y, or x += max(y, 0).
  virtual void add(float* x, const float* y, size_t count, bool rectified) = 0;
};

}  // namespace aligngs::nn
