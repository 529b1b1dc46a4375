#include "serve/compact_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "gaussians/gaussian_geometry.h"
#include "gaussians/morton_order.h"
#include "io/gzip.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using Rows = std::span<const uint32_t>;

constexpr size_t kCoarseShare = 4;              // one splat of four is in the first part
constexpr size_t kSmallestCoarse = 20'000;      // splats; below that a second step saves no time
constexpr float kCompactColorStep = 1.0f / 64;  // of f_dc: one level of 255 is 1/72
constexpr float kCompactHarmonicStep = 1.0f / 64;
constexpr float kCompactOpacityStep = 1.0f / 16;  // of a logit: at most 0.016 in opacity
constexpr float kCompactScaleStep = 1.0f / 16;    // of a natural logarithm: 3 % in size
constexpr float kCompactRotationStep = 1.0f / 127;
constexpr int kCompactGzipLevel = 6;

float opacity_of_logit(float logit) { return 1 / (1 + std::exp(-logit)); }

/// How much of a picture a splat covers: opacity times the area of its two longest axes.
float visibility(const SplatTable& t, uint32_t i) {
  float axes[3] = {t.log_scale[0][i], t.log_scale[1][i], t.log_scale[2][i]};
  std::sort(axes, axes + 3);
  return std::log(opacity_of_logit(t.opacity[i])) + axes[1] + axes[2];
}

/// Neighbours in space follow each other: their numbers are alike and compress well.
void sort_in_space(const SplatTable& t, std::span<uint32_t> rows) {
  if (rows.empty()) return;
  float low[3], side = 0;
  for (size_t k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax_element(t.position[k].begin(), t.position[k].end());
    low[k] = *least;
    side = std::max(side, *most - *least);
  }
  const float cells = side > 0 ? static_cast<float>((1u << kMortonBits) - 1) / side : 0;
  std::vector<uint64_t> code(t.size());
  for (const uint32_t i : rows) {
    uint32_t cell[3];
    for (size_t k = 0; k < 3; ++k) cell[k] = static_cast<uint32_t>((t.position[k][i] - low[k]) * cells);
    code[i] = morton_code(cell[0], cell[1], cell[2]);
  }
  std::sort(rows.begin(), rows.end(),
            [&](uint32_t a, uint32_t b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
}

/// One of the two parts while it is written.
class Part {
 public:
  template <class Number, class Value>
  void add(const std::string& name, float step, Rows rows, size_t first, const Value& value) {
    describe<Number>(name, step, rows, first, false, false);
    constexpr float kLow = static_cast<float>(std::numeric_limits<Number>::min()),
                    kHigh = static_cast<float>(std::numeric_limits<Number>::max());
    for (const uint32_t row : rows) {
      append(static_cast<Number>(std::lround(std::clamp(static_cast<float>(value(row)) / step, kLow, kHigh))));
    }
  }
  /// A coordinate: finer near the origin than far from it, as differences between neighbours.
  void add_coordinate(const std::string& name, const std::vector<float>& values, Rows rows, size_t first) {
    const auto bent = [](float x) { return std::copysign(std::log1p(std::fabs(x)), x); };
    float largest = 0;
    for (const float x : values) largest = std::max(largest, std::fabs(bent(x)));
    const float step = largest > 0 ? largest / std::numeric_limits<int16_t>::max() : 1;
    describe<int16_t>(name, step, rows, first, true, true);
    uint16_t before = 0;
    for (const uint32_t row : rows) {
      const auto now = static_cast<uint16_t>(static_cast<int16_t>(std::lround(bent(values[row]) / step)));
      append(static_cast<uint16_t>(now - before));
      before = now;
    }
  }
  std::string compressed(size_t total, size_t shown) const {
    const nlohmann::json head = {{"total", total}, {"shown", shown}, {"columns", columns_}};
    return gzip_compressed(json_line(head) + "\n" + data_, kCompactGzipLevel);
  }

 private:
  template <class Number>
  void describe(const std::string& name, float step, Rows rows, size_t first, bool log, bool delta) {
    const std::string type = std::string(std::is_signed_v<Number> ? "i" : "u") + std::to_string(8 * sizeof(Number));
    columns_.push_back({{"name", name},
                        {"type", type},
                        {"step", step},
                        {"first", first},
                        {"count", rows.size()},
                        {"log", log},
                        {"delta", delta}});
  }
  template <class Number>
  void append(Number number) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, &number, sizeof bytes);
    data_.append(bytes, sizeof bytes);
  }

  nlohmann::json columns_ = nlohmann::json::array();
  std::string data_;
};

void add_splats(Part& part, const SplatTable& t, Rows rows, size_t first) {
  const char* axes[3] = {"x", "y", "z"};
  const auto number = [](const char* name, size_t k) { return name + std::to_string(k); };
  for (size_t k = 0; k < 3; ++k) part.add_coordinate(axes[k], t.position[k], rows, first);
  for (size_t k = 0; k < 3; ++k)
    part.add<int8_t>(number("f_dc_", k), kCompactColorStep, rows, first, [&](uint32_t i) { return t.color[k][i]; });
  part.add<int8_t>("opacity", kCompactOpacityStep, rows, first, [&](uint32_t i) { return t.opacity[i]; });
  for (size_t k = 0; k < 3; ++k)
    part.add<int8_t>(number("scale_", k), kCompactScaleStep, rows, first,
                     [&](uint32_t i) { return t.log_scale[k][i]; });
  for (size_t k = 0; k < 4; ++k) {
    part.add<int8_t>(number("rot_", k), kCompactRotationStep, rows, first, [&](uint32_t i) {
      const float length =
          std::hypot(std::hypot(t.rotation[0][i], t.rotation[1][i]), std::hypot(t.rotation[2][i], t.rotation[3][i]));
      return length > 0 ? t.rotation[k][i] / length : static_cast<float>(k == 0);
    });
  }
  if (t.label.empty()) return;
  part.add<uint16_t>("label", 1, rows, first, [&](uint32_t i) { return t.label[i]; });
  part.add<uint16_t>("instance", 1, rows, first,
                     [&](uint32_t i) { return t.instance.empty() ? uint16_t(0) : t.instance[i]; });
  part.add<uint8_t>("confidence", 1, rows, first,
                    [&](uint32_t i) { return t.confidence.empty() ? uint8_t(0) : t.confidence[i]; });
}

}  // namespace

CompactScene compact_scene(const SplatTable& table) {
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < table.size(); ++i) {
    if (opacity_of_logit(table.opacity[i]) >= kInvisibleOpacity) rows.push_back(i);
  }
  const size_t shown = std::min(rows.size(), std::max(kSmallestCoarse, rows.size() / kCoarseShare));
  std::vector<float> seen(table.size());
  for (const uint32_t i : rows) seen[i] = visibility(table, i);
  const auto middle = rows.begin() + static_cast<std::ptrdiff_t>(shown);
  std::nth_element(rows.begin(), middle, rows.end(),
                   [&](uint32_t a, uint32_t b) { return seen[a] != seen[b] ? seen[a] > seen[b] : a < b; });
  sort_in_space(table, std::span(rows).first(shown));
  sort_in_space(table, std::span(rows).subspan(shown));
  Part coarse, rest;
  add_splats(coarse, table, Rows(rows).first(shown), 0);
  add_splats(rest, table, Rows(rows).subspan(shown), shown);
  for (size_t k = 0; k < table.harmonics.size(); ++k) {
    rest.add<int8_t>("f_rest_" + std::to_string(k), kCompactHarmonicStep, rows, 0,
                     [&](uint32_t i) { return table.harmonics[k][i]; });
  }
  return {coarse.compressed(rows.size(), shown), rest.compressed(rows.size(), rows.size()), std::move(rows)};
}

}  // namespace aligngs
