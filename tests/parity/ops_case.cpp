#include <functional>
#include <map>

#include "core/error.h"
#include "nn/multihead_attention.h"
#include "nn/ops/bilinear_sample.h"
#include "nn/ops/convolution.h"
#include "nn/ops/position_encoding.h"
#include "nn/ops/resize.h"
#include "nn/ops/rope.h"
#include "nn/vggt_heads.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// The tensors of one op, and its attributes.
struct Op {
  std::shared_ptr<const WeightFile> file;
  std::string name;
  Json attributes;
  nn::Compute& compute;

  bool has(const std::string& tensor) const { return file->tensors().count(name + "." + tensor) > 0; }
  Shape shape(const std::string& tensor) const {
    const auto found = file->tensors().find(name + "." + tensor);
    if (found == file->tensors().end()) throw_bad_input(file->name(), name + "." + tensor, "missing");
    return found->second.shape;
  }
  std::vector<float> values(const std::string& tensor) const {
    shape(tensor);
    return file->read(name + "." + tensor);
  }
  std::vector<nn::FeatureMap> maps(const std::string& tensor) const { return maps_of({shape(tensor), values(tensor)}); }
  nn::Matrix matrix(const std::string& tensor) const {  // the last axis as columns
    nn::Matrix m;
    m.columns = shape(tensor).back();
    m.data = values(tensor);
    m.rows = int64_t(m.data.size()) / m.columns;
    return m;
  }
  using PerMap = std::function<nn::FeatureMap(const nn::FeatureMap&)>;
  std::vector<float> each(const PerMap& function) const {
    std::vector<nn::FeatureMap> out;
    for (const nn::FeatureMap& map : maps("x")) out.push_back(function(map));
    return nchw(out);
  }
};

using Result = std::vector<float>;

/// The number after `key` in a name: number_after("conv3x3_s2p1", "s") == 2.
double number_after(const std::string& name, const std::string& key, double otherwise) {
  const size_t start = name.find('_');
  const size_t at = start == std::string::npos ? start : name.find(key, start);
  const size_t digits = at + key.size();
  if (at == std::string::npos || digits >= name.size() || name[digits] < '0' || name[digits] > '9') return otherwise;
  return std::stod(name.substr(digits));
}

Result resize(const Op& op) {
  const Shape in = op.shape("x"), out = op.shape("out");
  const std::string& n = op.name;
  const auto axis = [&](size_t a) -> nn::ResampleAxis {
    const int64_t from = in.at(a), to = out.at(a);
    if (n.rfind("bicubic_aa", 0) == 0) return nn::antialiased_bicubic_axis(from, to);
    if (n.rfind("bicubic_scale", 0) == 0) {
      const double factor = op.attributes.at("scale_factor").at(a - 2).get<double>();
      return nn::bicubic_axis(from, to, 1 / factor);
    }
    if (n.rfind("bicubic", 0) == 0) return nn::bicubic_axis(from, to, double(from) / double(to));
    if (n.rfind("area", 0) == 0) return nn::area_axis(from, to);
    return nn::bilinear_axis(from, to, n.find("ac1") != std::string::npos);
  };
  return op.each([&](const nn::FeatureMap& map) { return nn::resample(op.compute, map, axis(2), axis(3)); });
}

Result grid_sample(const Op& op) {
  const Shape out = op.shape("out");
  const nn::Matrix grid = op.matrix("grid");  // x, y in [-1, 1], the borders of the map
  const bool corners = op.name.find("ac1") != std::string::npos;
  std::vector<nn::FeatureMap> results;
  const std::vector<nn::FeatureMap> maps = op.maps("x");
  for (size_t m = 0; m < maps.size(); ++m) {
    const nn::FeatureMap& map = maps[m];
    nn::FeatureMap result(out.at(2), out.at(3), map.channels);
    for (int64_t p = 0; p < result.places(); ++p) {
      const float* g = grid.row(int64_t(m) * result.places() + p);
      const float x = corners ? (g[0] + 1) * float(map.width - 1) / 2 : ((g[0] + 1) * float(map.width) - 1) / 2;
      const float y = corners ? (g[1] + 1) * float(map.height - 1) / 2 : ((g[1] + 1) * float(map.height) - 1) / 2;
      nn::add_bilinear_sample({map.data.data(), map.channels, map.channels, map.height, map.width}, x, y, 1,
                              result.data.data() + p * map.channels);
    }
    results.push_back(std::move(result));
  }
  return nchw(results);
}

Result convolution(const Op& op) {
  const Shape w = op.shape("w");
  const std::vector<float> bias = op.has("b") ? op.values("b") : std::vector<float>();
  if (op.name.rfind("convtranspose", 0) == 0) {
    const nn::TransposedConvolution c(op.compute, w.at(1), w.at(0), w.at(2), op.values("w"), bias);
    return op.each([&](const nn::FeatureMap& map) { return c(op.compute, map); });
  }
  if (op.name.rfind("dwconv", 0) == 0) {
    const nn::DepthwiseConvolution c(op.values("w"), bias.empty() ? std::vector<float>(size_t(w.at(0)), 0.0f) : bias);
    return op.each([&](const nn::FeatureMap& map) {
      nn::FeatureMap y(map.height, map.width, map.channels);
      c.apply(op.compute, map.data.data(), map.height, map.width, y.data.data());
      return y;
    });
  }
  nn::ConvolutionShape shape{w.at(0), w.at(1), w.at(2), 1, 0};
  if (op.name.rfind("patch_embed", 0) == 0) {
    shape.stride = shape.kernel;
  } else {  // conv3x3_s2p1
    shape.stride = int64_t(number_after(op.name, "s", 1));
    shape.padding = int64_t(number_after(op.name, "p", 0));
  }
  const nn::Convolution c(op.compute, shape, op.values("w"), bias);
  return op.each([&](const nn::FeatureMap& map) { return c(op.compute, map); });
}

Result activation(const Op& op) {
  nn::Matrix m = op.matrix("x");
  const nn::Activation kind = op.name == "silu" ? nn::Activation::kSilu : nn::Activation::kGelu;
  nn::add_bias_and_activate(m.data.data(), m.rows, m.columns, nullptr, kind);
  return m.data;
}

Result softmax(const Op& op) {
  nn::Matrix m = op.matrix("x");
  nn::softmax_rows(m.data.data(), m.rows, m.columns);
  return m.data;
}

Result layer_norm(const Op& op) {
  nn::Matrix m = op.matrix("x");
  const float eps = std::stof(op.name.substr(op.name.find('_') + 1));
  nn::layer_norm(m.data.data(), m.rows, m.columns, op.values("w").data(), op.values("b").data(), eps, m.data.data());
  return m.data;
}

Result group_norm(const Op& op) {
  const nn::GroupNorm norm(op.values("w"), op.values("b"), op.attributes.at("groups").get<int64_t>());
  return op.each([&](nn::FeatureMap map) {
    norm.apply(op.compute, map);
    return map;
  });
}

Result batch_norm(const Op& op) {
  const nn::BatchNorm norm(op.values("w"), op.values("b"), op.values("mean"), op.values("var"));
  return op.each([&](nn::FeatureMap map) {
    norm.apply(op.compute, map);
    return map;
  });
}

Result rope(const Op& op) {
  const Shape shape = op.shape("x");  // [batch, heads, tokens, dim]
  const nn::Matrix positions = op.matrix("pos");
  nn::Matrix x = op.matrix("x");
  float largest = 0;
  for (const float p : positions.data) largest = std::max(largest, p);
  const nn::Rope2d rotation(x.columns, int64_t(largest), number_after(op.name, "freq", 100));
  for (int64_t i = 0; i < x.rows; ++i) {
    const int64_t batch = i / (shape.at(1) * shape.at(2)), token = i % shape.at(2);
    const float* p = positions.row(batch * shape.at(2) + token);
    rotation.rotate(x.row(i), int64_t(p[0]), int64_t(p[1]));
  }
  return x.data;
}

Result position_encoding(const Op& op) {
  const Json& a = op.attributes;
  if (op.name == "uv_embed") {
    return nn::uv_embedding(a.at("height"), a.at("width"), a.at("dim"), a.at("aspect_ratio")).data;
  }
  if (op.name == "uv_grid") return nn::uv_grid(a.at("height"), a.at("width"), a.at("aspect_ratio")).data;
  return nchw({nn::sine_encoding(a.at("h"), a.at("w"), a.at("num_feats"))});
}

Result dense_activation(const Op& op) {
  Result out;
  for (const nn::FeatureMap& map : op.maps("x")) {
    for (int64_t p = 0; p < map.places(); ++p) {
      const float* v = map.data.data() + p * map.channels;
      if (op.name == "act_expp1") {
        out.push_back(nn::dense_confidence(v[map.channels - 1]));
      } else {
        for (int64_t c = 0; c + 1 < map.channels; ++c)
          out.push_back(nn::dense_value(nn::DenseActivation::kPoints, v[c]));
      }
    }
  }
  return out;
}

Result rotations(const Op& op) {
  const std::vector<float> x = op.values("x");
  Result out;
  if (op.name == "mat_to_quat_xyzw") {
    for (size_t i = 0; i + 9 <= x.size(); i += 9) {
      std::array<double, 9> m{};
      std::copy_n(x.begin() + std::ptrdiff_t(i), 9, m.begin());
      for (const double v : nn::xyzw_from_rotation(m)) out.push_back(float(v));
    }
    return out;
  }
  for (size_t i = 0; i + 4 <= x.size(); i += 4) {
    for (const double v : nn::rotation_from_xyzw({double(x[i]), double(x[i + 1]), double(x[i + 2]), double(x[i + 3])}))
      out.push_back(float(v));
  }
  return out;
}

Result pose_decoding(const Op& op) {
  const nn::Matrix x = op.matrix("x");
  Result out;
  for (int64_t i = 0; i < x.rows; ++i) {
    nn::PoseEncoding e;
    std::copy_n(x.row(i), e.size(), e.begin());
    const Json& hw = op.attributes.at("hw");
    const nn::VggtCamera c = nn::decode_pose(e, hw.at(1), hw.at(0));
    if (op.name == "pose_dec_intrinsic") {
      for (const double v : {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}) out.push_back(float(v));
      continue;
    }
    for (size_t r = 0; r < 3; ++r) {
      for (size_t k = 0; k < 3; ++k) out.push_back(float(c.rotation[3 * r + k]));
      out.push_back(float(c.translation[r]));
    }
  }
  return out;
}

Result masked_attention(const Op& op) {
  nn::Weights weights;
  weights.add("in_proj_weight", op.file, {op.name + ".in_proj_weight"});
  weights.add("in_proj_bias", op.file, {op.name + ".in_proj_bias"});
  weights.add("out_proj.weight", op.file, {op.name + ".out_proj_weight"});
  weights.add("out_proj.bias", op.file, {op.name + ".out_proj_bias"});
  const nn::Matrix q = op.matrix("q"), kv = op.matrix("kv");
  const nn::MultiheadAttention attention(op.compute, weights, q.columns, op.attributes.at("heads").get<int64_t>());
  std::vector<uint8_t> mask;
  int64_t masks = 1;
  if (op.has("mask")) {
    for (const float v : op.values("mask")) mask.push_back(uint8_t(v));
    masks = op.shape("mask").at(0);
  }
  return attention(op.compute, q, kv, kv, masks, mask.empty() ? nullptr : mask.data()).data;
}

Result max_pool(const Op& op) {
  return op.each([&](const nn::FeatureMap& map) { return nn::max_pool_3x3_stride_2(op.compute, map); });
}

/// By the beginning of the name; the longest that fits counts.
const std::map<std::string, Result (*)(const Op&)> kOps = {{"bicubic", resize},
                                                           {"bilinear", resize},
                                                           {"area", resize},
                                                           {"grid_sample", grid_sample},
                                                           {"convtranspose", convolution},
                                                           {"conv", convolution},
                                                           {"dwconv", convolution},
                                                           {"patch_embed", convolution},
                                                           {"maxpool_k3s2p1", max_pool},
                                                           {"gelu_erf", activation},
                                                           {"silu", activation},
                                                           {"softmax", softmax},
                                                           {"layernorm", layer_norm},
                                                           {"groupnorm", group_norm},
                                                           {"batchnorm_eval", batch_norm},
                                                           {"rope2d", rope},
                                                           {"uv_", position_encoding},
                                                           {"sine_pos", position_encoding},
                                                           {"act_", dense_activation},
                                                           {"quat_to_mat_xyzw", rotations},
                                                           {"mat_to_quat_xyzw", rotations},
                                                           {"pose_dec", pose_decoding},
                                                           {"mha", masked_attention}};

}  // namespace

void run_ops(Case& test, nn::Compute& compute) {
  const auto file = WeightFile::open(test.folder() / "ops.safetensors");
  for (const auto& [name, attributes] : test.config().at("attributes").items()) {
    Result (*run)(const Op&) = nullptr;
    for (const auto& [start, function] : kOps) {
      if (name.rfind(start, 0) == 0) run = function;
    }
    if (!run) {
      test.fail(name, "unknown op");
      continue;
    }
    const Op op{file, name, attributes, compute};
    test.judge(name, run(op), op.values("out"));
  }
}

}  // namespace aligngs::parity
