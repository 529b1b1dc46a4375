#include "serve/edited_scene.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "gaussians/gaussian_geometry.h"
#include "gaussians/soft_labels.h"
#include "io/gzip.h"
#include "io/json_text.h"
#include "serve/splat_columns.h"

namespace aligngs {
namespace {

constexpr int kChangeGzipLevel = 1;  // made while somebody waits
constexpr size_t kChangeHarmonics = size_t(3) * kShCoefficients;
constexpr uint32_t kGone = 0xffffffffu;

bool looks_the_same(const EditableRoom& trained, size_t before, const EditableRoom& room, size_t now) {
  const GaussianLabels &a = trained.gaussians.labels, &b = room.gaussians.labels;
  // NOLINTBEGIN(bugprone-suspicious-memory-comparison): equal bits are meant, as they are what the page holds.
  return a.label[before] == b.label[now] && a.instance[before] == b.instance[now] &&
         std::memcmp(&trained.gaussians.model.sh[kChangeHarmonics * before],
                     &room.gaussians.model.sh[kChangeHarmonics * now], kChangeHarmonics * sizeof(float)) == 0;
  // NOLINTEND(bugprone-suspicious-memory-comparison)
}

}  // namespace

std::string edited_scene(const EditableRoom& trained, const EditableRoom& room, const ShownSplats& shown) {
  std::vector<uint32_t> now(trained.origins.size(), kGone), added;
  for (uint32_t i = 0; i < room.origins.size(); ++i) {
    if (!room.origins[i].filled)
      now[room.origins[i].row] = i;
    else if (opacity_of(room.gaussians.model, i) >= kInvisibleOpacity)
      added.push_back(i);
  }
  std::vector<uint32_t> place_of(trained.origins.size(), kGone), sources;
  for (uint32_t k = 0; k < shown.order.size(); ++k) place_of[shown.order[k]] = k;
  for (const uint32_t i : added) {
    const uint32_t row = room.origins[i].row;
    sources.push_back(now[row] == kGone ? place_of[row] : kGone);
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
  SplatColumns changes(room.gaussians.model, changed), more(room.gaussians.model, added);
  changes.add_colors(shown.harmonics);
  more.add_positions();
  more.add_shapes();
  more.add_colors(shown.harmonics);
  if (room.gaussians.has_labels()) {
    changes.add_labels(room.gaussians.labels);
    more.add_labels(room.gaussians.labels);
  }
  const nlohmann::json head = {{"total", shown.order.size()},
                               {"changed", changed.size()},
                               {"added", added.size()},
                               {"changed_columns", changes.description()},
                               {"added_columns", more.description()}};
  std::string out = json_line(head) + "\n" + stays;
  out.append(reinterpret_cast<const char*>(places.data()), places.size() * sizeof(uint32_t));
  out += changes.data() + more.data();
  out.append(reinterpret_cast<const char*>(sources.data()), sources.size() * sizeof(uint32_t));
  return gzip_compressed(out, kChangeGzipLevel);
}

}  // namespace aligngs
