// Names and shapes of the pieces that published networks consist of.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "nn/random_weights.h"

namespace aligngs::nn {

/// A list of tensors below a prefix.
class TensorNames {
 public:
  explicit TensorNames(std::string prefix) : prefix_(std::move(prefix)) {}
  void add(const std::string& name, std::vector<int64_t> shape) { list.push_back({prefix_ + name, std::move(shape)}); }
  void linear(const std::string& name, int64_t outputs, int64_t inputs) {
    add(name + ".weight", {outputs, inputs});
    add(name + ".bias", {outputs});
  }
  void convolution(const std::string& name, int64_t outputs, int64_t inputs, int64_t kernel, bool bias = true) {
    add(name + ".weight", {outputs, inputs, kernel, kernel});
    if (bias) add(name + ".bias", {outputs});
  }
  void norm(const std::string& name, int64_t channels) {
    add(name + ".weight", {channels});
    add(name + ".bias", {channels});
  }
  void batch_norm(const std::string& name, int64_t channels) {
    norm(name, channels);
    add(name + ".running_mean", {channels});
    add(name + ".running_var", {channels});
  }
  void append(const TensorList& more) { list.insert(list.end(), more.begin(), more.end()); }

  TensorList list;

 private:
  std::string prefix_;
};

/// The tensors of a transformer block.
struct BlockNames {
  int64_t channels, hidden;
  bool gated = false, split_gate = false, head_norms = false;
  int64_t heads = 1;
};

/// Below `p`.
inline void add_block(TensorNames& names, const std::string& p, const BlockNames& b) {
  const int64_t c = b.channels;
  names.norm(p + "norm1", c);
  names.linear(p + "attn.qkv", 3 * c, c);
  if (b.head_norms) {
    names.norm(p + "attn.q_norm", c / b.heads);
    names.norm(p + "attn.k_norm", c / b.heads);
  }
  names.linear(p + "attn.proj", c, c);
  names.add(p + (b.split_gate ? "gamma1" : "ls1.gamma"), {c});
  names.norm(p + "norm2", c);
  if (b.split_gate) {
    names.linear(p + "mlp.w1", b.hidden, c);
    names.linear(p + "mlp.w2", b.hidden, c);
  } else {
    names.linear(p + (b.gated ? "mlp.w12" : "mlp.fc1"), b.gated ? 2 * b.hidden : b.hidden, c);
  }
  names.linear(p + (b.gated ? "mlp.w3" : "mlp.fc2"), c, b.hidden);
  names.add(p + (b.split_gate ? "gamma2" : "ls2.gamma"), {c});
}

/// The four layers of VGGT's and DA3's dense heads, with what fuses them (without the outputs).
struct PyramidNames {
  int64_t inputs, features;
  std::vector<int64_t> levels;
  std::string suffix;  ///< of a second fusion; then the levels are not listed again
};

inline void add_pyramid(TensorNames& names, const std::string& p, const PyramidNames& pyramid) {
  const int64_t f = pyramid.features;
  for (size_t j = 0; j < 4; ++j) {
    const std::string n = std::to_string(j), m = std::to_string(j + 1);
    const int64_t c = pyramid.levels[j];
    if (pyramid.suffix.empty()) {
      names.convolution(p + "projects." + n, c, pyramid.inputs, 1);
      constexpr int64_t kKernels[] = {4, 2, 0, 3};
      if (kKernels[j] > 0) names.convolution(p + "resize_layers." + n, c, c, kKernels[j]);
      names.convolution(p + "scratch.layer" + m + "_rn", f, c, 3, false);
    }
    const std::string r = p + "scratch.refinenet" + m + pyramid.suffix + ".";
    names.convolution(r + "out_conv", f, f, 1);
    for (const char* const unit : {"resConfUnit1", "resConfUnit2"}) {
      if (j == 3 && unit[11] == '1') continue;  // the coarsest has nothing to add
      for (const char* const conv : {".conv1", ".conv2"}) names.convolution(r + unit + conv, f, f, 3);
    }
  }
}

}  // namespace aligngs::nn
