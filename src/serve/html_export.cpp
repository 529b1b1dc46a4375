#include "serve/html_export.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "gaussians/soft_labels.h"
#include "io/atomic_file.h"
#include "io/base64.h"
#include "io/gzip.h"
#include "io/json_text.h"
#include "serve/web_page.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kInvisible = 1.0f / 255;              // alpha_min of the rasteriser
constexpr uint64_t kPageLimit = uint64_t(64) << 20;   // bytes of one file of the page
constexpr uint64_t kMaxCameras = uint64_t(16) << 20;  // bytes of cameras.json
// Steps: 8-bit colours have 1/255, which is f_dc / 0.282: 1/256 of f_dc is a quarter of that. Most
// harmonics of a room are below 0.05: in steps of 1/128 their bytes reach to 1.
constexpr float kColorStep = 1.0f / 256, kHarmonicStep = 1.0f / 128;
constexpr float kOpacityStep = 1.0f / 16;  // of a logit: at most 0.016 in opacity
constexpr float kScaleStep = 1.0f / 256;   // of a natural logarithm: 0.4 % in size
constexpr float kRotationStep = 1.0f / 127;

/// Columns of numbers behind each other, with their description.
class Columns {
 public:
  explicit Columns(const std::vector<uint32_t>& rows) : rows_(rows) {}

  template <class Number>
  void add(const std::string& name, const char* type, float step, const std::function<float(uint32_t)>& value) {
    description_.push_back({{"name", name}, {"type", type}, {"step", step}});
    for (const uint32_t row : rows_) {
      Number number;
      if constexpr (std::is_floating_point_v<Number>) {
        number = value(row);
      } else {
        constexpr float kLow = static_cast<float>(std::numeric_limits<Number>::min()), kHigh = static_cast<float>(std::numeric_limits<Number>::max());
        number = static_cast<Number>(std::lround(std::clamp(value(row) / step, kLow, kHigh)));
      }
      char bytes[sizeof(Number)];
      std::memcpy(bytes, &number, sizeof bytes);
      data_.append(bytes, sizeof bytes);
    }
  }
  const Json& description() const { return description_; }
  const std::string& data() const { return data_; }

 private:
  const std::vector<uint32_t>& rows_;
  Json description_ = Json::array();
  std::string data_;
};

Json classes_of(const LabelSet& labels) {
  Json classes = Json::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}});
  }
  return classes;
}

Json cameras_of(const std::filesystem::path& path) {
  try {
    Json cameras = parse_ordered_json(read_file(path, kMaxCameras));
    return cameras.is_array() ? cameras : Json();
  } catch (const Error&) {
    return nullptr;
  }
}

void add_model(Columns& columns, const GaussianModel& model) {
  const char* axes[3] = {"x", "y", "z"};
  for (size_t k = 0; k < 3; ++k) {
    columns.add<float>(axes[k], "f32", 1, [&, k](uint32_t i) { return model.positions[3 * size_t(i) + k]; });
  }
  const size_t row = size_t(3) * kShCoefficients;
  for (size_t k = 0; k < 3; ++k) {
    columns.add<int16_t>("f_dc_" + std::to_string(k), "i16", kColorStep, [&, k](uint32_t i) { return model.sh[row * i + k]; });
  }
  const size_t rest = static_cast<size_t>(sh_coefficient_count(model.sh_degree)) - 1;
  for (size_t k = 0; k < 3; ++k) {
    for (size_t j = 0; j < rest; ++j) {
      columns.add<int8_t>("f_rest_" + std::to_string(rest * k + j), "i8", kHarmonicStep,
                          [&, j, k](uint32_t i) { return model.sh[row * i + 3 * (1 + j) + k]; });
    }
  }
  columns.add<int8_t>("opacity", "i8", kOpacityStep, [&](uint32_t i) { return model.opacity_logits[i]; });
  for (size_t k = 0; k < 3; ++k) {
    columns.add<int16_t>("scale_" + std::to_string(k), "i16", kScaleStep, [&, k](uint32_t i) { return model.log_scales[3 * size_t(i) + k]; });
  }
  for (size_t k = 0; k < 4; ++k) {
    columns.add<int8_t>("rot_" + std::to_string(k), "i8", kRotationStep, [&, k](uint32_t i) {
      const float* r = &model.rotations[4 * size_t(i)];
      const float length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
      return length > 0 ? r[k] / length : static_cast<float>(k == 0);
    });
  }
}

std::string page_file(const char* path) {
  const auto content = embedded_page_file(path);
  return gzip_expanded({reinterpret_cast<const char*>(content.data()), content.size()}, path, kPageLimit);
}

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw Error({ErrorKind::kFailed, "the page has no " + from, {}, {}, "build web/dist anew"});
  text.replace(at, from.size(), to);
}

/// Neither may be in a script element of HTML.
std::string escaped_script(std::string script) {
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"</script", "<\\/script"}, {"<!--", "<\\!--"}}) {
    for (size_t at = script.find(from); at != std::string::npos; at = script.find(from, at + to.size())) script.replace(at, from.size(), to);
  }
  return script;
}

}  // namespace

std::string packed_scene(const EditableRoom& room, const HtmlSceneInfo& info) {
  const GaussianModel& model = room.gaussians.model;
  const GaussianLabels& labels = room.gaussians.labels;
  std::vector<uint32_t> rows;
  for (uint32_t i = 0; i < model.size(); ++i) {
    if (opacity_of(model, i) >= kInvisible) rows.push_back(i);
  }
  Columns columns(rows);
  add_model(columns, model);
  columns.add<uint16_t>("label", "u16", 1, [&](uint32_t i) { return static_cast<float>(labels.label[i]); });
  columns.add<uint16_t>("instance", "u16", 1, [&](uint32_t i) { return static_cast<float>(labels.instance[i]); });
  columns.add<uint8_t>("confidence", "u8", 1, [&](uint32_t i) { return static_cast<float>(labels.confidence[i]); });
  Json state = {{"name", info.name}, {"status", "exported"}, {"version", "1"}, {"splats", "scene.ply"},
                {"units", info.metric ? "metres" : "arbitrary"}, {"classes", room.gaussians.has_labels() ? classes_of(room.labels) : Json()}};
  state["up"] = room.up ? Json{room.up->x, room.up->y, room.up->z} : Json();
  state["cameras"] = cameras_of(info.cameras);
  const Json head = {{"state", state}, {"count", rows.size()}, {"columns", columns.description()}};
  return head.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n" + columns.data();
}

void write_html(const std::filesystem::path& path, const EditableRoom& room, const HtmlSceneInfo& info) {
  std::string html = page_file("/index.html");
  const std::string data = base64_text(gzip_compressed(packed_scene(room, info)));
  replace_once(html, "<link rel=\"icon\" href=\"/favicon.svg\">",
               "<link rel=\"icon\" href=\"data:image/svg+xml;base64," + base64_text(page_file("/favicon.svg")) + "\">");
  replace_once(html, "<link rel=\"stylesheet\" href=\"/app.css\">", "<style>\n" + page_file("/app.css") + "</style>");
  replace_once(html, "<script type=\"module\" src=\"/app.js\"></script>\n", "");
  replace_once(html, "</body>",
               "<script type=\"text/plain\" id=\"aligngs-scene\">" + data + "</script>\n<script type=\"module\">\n" +
                   escaped_script(page_file("/app.js")) + "</script>\n</body>");
  // Third-party licences travel with the code.
  std::string licences = page_file("/third_party_licenses.txt");
  for (size_t at = licences.find("--"); at != std::string::npos; at = licences.find("--", at)) licences.replace(at, 2, "- -");
  write_file_atomically(path, html + "\n<!--\n" + licences + "\n-->\n");
}

}  // namespace aligngs
