#include "compare_ops.h"
#include "device/tolerances.h"
#include "nn/attention.h"
#include "nn/cuda/network_device.h"
#include "nn/ops/convolution.h"
#include "nn/ops/linear.h"
#include "nn/testing/weights.h"

namespace aligngs::op_compare {
namespace {

using nn::Compute;
using nn::Precision;
using nn::Values;

const cuda::CudaNetworkTolerance kTolerance;

Limit limit_of(Precision precision) {
  return precision == Precision::kFloat32 ? tight(kTolerance.single) : loose(kTolerance.bfloat16);
}
std::vector<float> numbers_of(const Values& values) { return {values.data(), values.data() + values.size()}; }

/// The operators that networks spend their time in, on the CPU in float32 and on the device in either precision.
class NetworkOps {
 public:
  explicit NetworkOps(int device) : device_(make_cuda_network_device(device)) {}

  void compare_product(OpTable& table) {
    nn::Matrix x(130, 200);
    x.data = nn::random_values(x.data.size(), 1);
    const std::vector<float> w = nn::random_values(200 * 70, 2), b = nn::random_values(70, 3);
    compare("product", table,
            [&](Compute& c) { return numbers_of(nn::Linear(c, w, 70, 200, b)(c, x, nn::Activation::kGelu).data); });
  }
  void compare_convolution(OpTable& table) {
    nn::FeatureMap x(17, 19, 12);
    x.data = nn::random_values(x.data.size(), 1);
    const nn::ConvolutionShape shape{16, 12, 3, 2, 1};
    const std::vector<float> w = nn::random_values(16 * 12 * 9, 2), b = nn::random_values(16, 3);
    compare("convolution", table, [&](Compute& c) {
      return numbers_of(nn::Convolution(c, shape, w, b)(c, x, {true, nn::Activation::kSilu}).data);
    });
  }
  void compare_attention(OpTable& table) {
    const nn::AttentionShape shape{2, 2, 64, 70, 131, 0};
    const int64_t width = shape.heads * shape.head_dim;
    Values q = nn::random_values(size_t(shape.sequences * shape.queries * width), 1),
           k = nn::random_values(size_t(shape.sequences * shape.keys * width), 2),
           v = nn::random_values(size_t(shape.sequences * shape.keys * width), 3);
    Compute cpu(pool_, {Precision::kFloat32, false, false});
    nn::AttentionOperands operands(cpu, shape);
    for (int64_t s = 0; s < shape.sequences; ++s) {
      for (int64_t i = 0; i < shape.queries; ++i)
        operands.set_query_row(s, i, q.data() + (s * shape.queries + i) * width);
      for (int64_t i = 0; i < shape.keys; ++i) {
        operands.set_key_row(s, i, k.data() + (s * shape.keys + i) * width);
        operands.set_value_row(s, i, v.data() + (s * shape.keys + i) * width);
      }
    }
    Values want(q.size());
    nn::attention(cpu, operands, want.data(), nullptr);
    for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
      Values got(q.size());
      device_->attention(shape, {q.on(*device_), width}, {k.on(*device_), width}, {v.on(*device_), width}, nullptr,
                         precision, got.write_on(*device_));
      table.compare("attention", name_of(precision), numbers_of(got), numbers_of(want), limit_of(precision));
    }
  }

 private:
  static const char* name_of(Precision precision) { return precision == Precision::kFloat32 ? "float32" : "bfloat16"; }

  template <class Run>
  void compare(const char* op, OpTable& table, const Run& run) {
    Compute cpu(pool_, {Precision::kFloat32, false, false});
    const std::vector<float> want = run(cpu);
    for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
      Compute there(pool_, {precision, false, false, device_});
      table.compare(op, name_of(precision), run(there), want, limit_of(precision));
    }
  }

  ThreadPool pool_{1};
  std::shared_ptr<nn::NetworkDevice> device_;
};

}  // namespace

void compare_networks(int device, OpTable& table) {
  NetworkOps ops(device);
  ops.compare_product(table);
  ops.compare_convolution(table);
  ops.compare_attention(table);
}

}  // namespace aligngs::op_compare
