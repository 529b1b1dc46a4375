#include "serve/edited_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "gaussians/soft_labels.h"
#include "io/gzip.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

constexpr float kChangeInvisible = 1.0f / 255;  // alpha_min of the rasteriser
// Steps as in html_export.cpp: what changes must not look coarser than what stays.
constexpr float kChangeColorStep = 1.0f / 256, kChangeHarmonicStep = 1.0f / 128, kChangeOpacityStep = 1.0f / 16, kChangeScaleStep = 1.0f / 256, kChangeRotationStep = 1.0f / 127;
constexpr int kChangeGzipLevel = 1;  // made while somebody waits
constexpr size_t kChangeHarmonics = size_t(3) * kShCoefficients;
constexpr uint32_t kGone = 0xffffffffu;

/// Columns of some rows of a room behind each other, with their description.
class Columns {
 public:
  Columns(const EditableRoom& room, const std::vector<uint32_t>& rows) : room_(room), rows_(rows) {}

  void add_colors(size_t harmonics) {
    const std::vector<float>& sh = room_.gaussians.model.sh;
    for (size_t k = 0; k < 3; ++k) add<int16_t>("f_dc_" + std::to_string(k), "i16", kChangeColorStep, [&](uint32_t i) { return sh[kChangeHarmonics * i + k]; });
    const size_t per_channel = harmonics / 3;
    for (size_t k = 0; k < harmonics; ++k) {
      const size_t at = 3 * (1 + k % per_channel) + k / per_channel;
      add<int8_t>("f_rest_" + std::to_string(k), "i8", kChangeHarmonicStep, [&](uint32_t i) { return sh[kChangeHarmonics * i + at]; });
    }
  }
  void add_labels() {
    const GaussianLabels& l = room_.gaussians.labels;
    add<uint16_t>("label", "u16", 1, [&](uint32_t i) { return static_cast<float>(l.label[i]); });
    add<uint16_t>("instance", "u16", 1, [&](uint32_t i) { return static_cast<float>(l.instance[i]); });
    add<uint8_t>("confidence", "u8", 1, [&](uint32_t i) { return static_cast<float>(l.confidence[i]); });
  }
  void add_shapes() {
    const GaussianModel& m = room_.gaussians.model;
    const char* axes[3] = {"x", "y", "z"};
    for (size_t k = 0; k < 3; ++k) add<float>(axes[k], "f32", 1, [&](uint32_t i) { return m.positions[3 * size_t(i) + k]; });
    add<int8_t>("opacity", "i8", kChangeOpacityStep, [&](uint32_t i) { return m.opacity_logits[i]; });
    for (size_t k = 0; k < 3; ++k) add<int16_t>("scale_" + std::to_string(k), "i16", kChangeScaleStep, [&](uint32_t i) { return m.log_scales[3 * size_t(i) + k]; });
    for (size_t k = 0; k < 4; ++k) {
      add<int8_t>("rot_" + std::to_string(k), "i8", kChangeRotationStep, [&](uint32_t i) {
        const float* r = &m.rotations[4 * size_t(i)];
        const float length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
        return length > 0 ? r[k] / length : static_cast<float>(k == 0);
      });
    }
  }
  const nlohmann::json& description() const { return description_; }
  const std::string& data() const { return data_; }

 private:
  template <class Number, class Value>
  void add(const std::string& name, const char* type, float step, const Value& value) {
    description_.push_back({{"name", name}, {"type", type}, {"step", step}});
    for (const uint32_t row : rows_) {
      Number number;
      if constexpr (std::is_floating_point_v<Number>) {
        number = value(row);
      } else {
        constexpr float kLow = static_cast<float>(std::numeric_limits<Number>::min()), kHigh = static_cast<float>(std::numeric_limits<Number>::max());
        number = static_cast<Number>(std::lround(std::clamp(value(row) / step, kLow, kHigh)));
      }
      data_.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
  }

  const EditableRoom& room_;
  const std::vector<uint32_t>& rows_;
  nlohmann::json description_ = nlohmann::json::array();
  std::string data_;
};

bool looks_the_same(const EditableRoom& trained, size_t before, const EditableRoom& room, size_t now) {
  const GaussianLabels &a = trained.gaussians.labels, &b = room.gaussians.labels;
  return a.label[before] == b.label[now] && a.instance[before] == b.instance[now] &&
         std::memcmp(&trained.gaussians.model.sh[kChangeHarmonics * before], &room.gaussians.model.sh[kChangeHarmonics * now], kChangeHarmonics * sizeof(float)) == 0;
}

}  // namespace

std::string edited_scene(const EditableRoom& trained, const EditableRoom& room, const ShownSplats& shown) {
  std::vector<uint32_t> now(trained.origins.size(), kGone), added;
  for (uint32_t i = 0; i < room.origins.size(); ++i) {
    if (!room.origins[i].filled) now[room.origins[i].row] = i;
    else if (opacity_of(room.gaussians.model, i) >= kChangeInvisible) added.push_back(i);
  }
  std::string stays((shown.order.size() + 7) / 8, '\0');
  std::vector<uint32_t> places, changed;
  for (uint32_t k = 0; k < shown.order.size(); ++k) {
    const uint32_t row = shown.order[k];
    if (now[row] == kGone) continue;
    stays[k / 8] = static_cast<char>(stays[k / 8] | 1 << k % 8);
    if (looks_the_same(trained, row, room, now[row])) continue;
    places.push_back(k);
    changed.push_back(now[row]);
  }
  Columns changes(room, changed), more(room, added);
  changes.add_colors(shown.harmonics);
  more.add_shapes();
  more.add_colors(shown.harmonics);
  if (room.gaussians.has_labels()) {
    changes.add_labels();
    more.add_labels();
  }
  const nlohmann::json head = {{"total", shown.order.size()}, {"changed", changed.size()}, {"added", added.size()},
                               {"changed_columns", changes.description()}, {"added_columns", more.description()}};
  std::string out = json_line(head) + "\n" + stays;
  out.append(reinterpret_cast<const char*>(places.data()), places.size() * sizeof(uint32_t));
  return gzip_compressed(out + changes.data() + more.data(), kChangeGzipLevel);
}

}  // namespace aligngs
