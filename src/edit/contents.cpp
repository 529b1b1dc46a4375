#include "edit/contents.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "edit/fill/carrying_classes.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/row_flags.h"
#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

using Column = std::pair<int, int>;

/// Upright columns of the room.
class Columns {
 public:
  Columns(const GaussianModel& model, const Vec3d& up, double edge) : model_(model), up_(up), edge_(edge) {
    u_ = normalized(cross(std::fabs(up.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, up));
    v_ = cross(up, u_);
  }
  Column column_of(size_t i) const {
    const Vec3d p = place(i);
    return {static_cast<int>(std::floor(dot(u_, p) / edge_)), static_cast<int>(std::floor(dot(v_, p) / edge_))};
  }
  double height_of(size_t i) const { return dot(up_, place(i)); }

 private:
  Vec3d place(size_t i) const { return position_of(model_, i); }
  const GaussianModel& model_;
  Vec3d up_, u_, v_;
  double edge_;
};

/// Heights of the selected Gaussians in each column, ascending.
std::map<Column, std::vector<double>> heights_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                                 const Columns& columns) {
  std::map<Column, std::vector<double>> out;
  for (size_t i = 0; i < selected.size(); ++i) {
    if (selected[i] && opacity_of(room.model, i) >= kSolidOpacity)
      out[columns.column_of(i)].push_back(columns.height_of(i));
  }
  for (auto& [column, heights] : out) std::sort(heights.begin(), heights.end());
  return out;
}

/// The top of a thing that goes, as a rectangle at a height. Photos taken from eye level do not show the top of a
/// wardrobe, so that it has no Gaussians there.
struct Top {
  PlaneRectangle rectangle;  ///< in columns
  double height = 0;         ///< scene units along up
};

/// Tops of the objects of which most is selected.
std::vector<Top> tops_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected, const Columns& columns,
                         const std::vector<Instance>& objects) {
  constexpr double kHighStrays = 0.02;  // share of an object's Gaussians that may be higher
  constexpr size_t kFewest = 20;        // Gaussians that show how large a thing is
  std::vector<Top> tops;
  for (const Instance& o : objects) {
    std::vector<Vec2d> places;
    std::vector<double> heights;
    size_t rows = 0, taken = 0;
    for (size_t i = 0; i < selected.size(); ++i) {
      if (room.labels.label[i] != o.label || room.labels.instance[i] != o.number) continue;
      ++rows;
      taken += selected[i];
      if (!selected[i] || opacity_of(room.model, i) < kSolidOpacity) continue;
      const Column column = columns.column_of(i);
      places.push_back({column.first + 0.5, column.second + 0.5});
      heights.push_back(columns.height_of(i));
    }
    if (places.size() < kFewest || 2 * taken < rows) continue;
    const auto high =
        heights.end() - 1 - static_cast<std::ptrdiff_t>(kHighStrays * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), high, heights.end());
    tops.push_back({rectangle_of(places), *high});
  }
  return tops;
}

/// Whether a thing rests on a top: a share of its columns is over it, and its lowest place near to it.
bool rests_on(const Top& top, const std::map<Column, double>& lowest, double bottom, double contact, double share) {
  if (std::fabs(bottom - top.height) > contact) return false;
  size_t inside = 0;
  for (const auto& [column, height] : lowest)
    inside += top.rectangle.holds({column.first + 0.5, column.second + 0.5}, 0.5);
  return static_cast<double>(inside) >= share * static_cast<double>(lowest.size());
}

}  // namespace

void select_objects(const LabelledGaussians& room, const std::vector<Instance>& objects,
                    std::vector<uint8_t>& selected) {
  for (size_t i = 0; i < selected.size(); ++i) {
    for (const Instance& o : objects) {
      if (room.labels.label[i] == o.label && room.labels.instance[i] == o.number) selected[i] = 1;
    }
  }
}

std::vector<Instance> contents_of(const LabelledGaussians& room, const std::vector<uint8_t>& selected,
                                  const LabelSet& labels, const Vec3d& up, const ContentsSettings& settings) {
  std::vector<Instance> found;
  if (!room.has_labels()) return found;
  const std::vector<CarryingClass> classes = carrying_classes(labels);
  const Columns columns(room.model, up, settings.column * room.extent);
  const double contact = settings.contact * room.extent;
  std::vector<uint8_t> carried = selected;
  const std::vector<Instance> objects = list_instances(room.model, room.labels);
  const std::vector<Top> tops = tops_of(room, selected, columns, objects);
  for (bool more = true; more;) {  // a book on a tray on a table
    more = false;
    const auto below = heights_of(room, carried, columns);
    for (const Instance& o : objects) {
      const CarryingClass& kind = classes[static_cast<size_t>(o.label)];
      if (kind.shell != PlaneKind::kNone || kind.on_floor) continue;
      std::map<Column, double> lowest;
      size_t rows = 0, taken = 0;
      for (size_t i = 0; i < room.model.size(); ++i) {
        if (room.labels.label[i] != o.label || room.labels.instance[i] != o.number) continue;
        ++rows;
        taken += carried[i];
        if (opacity_of(room.model, i) < kSolidOpacity) continue;
        const double height = columns.height_of(i);
        const auto [at, fresh] = lowest.emplace(columns.column_of(i), height);
        if (!fresh) at->second = std::min(at->second, height);
      }
      if (rows == 0 || 2 * taken > rows || lowest.empty()) continue;
      // A thing that also reaches down to the floor is beside, not on: only its lowest columns count.
      double bottom = 1e300;
      for (const auto& [column, height] : lowest) bottom = std::min(bottom, height);
      size_t touching = 0, low = 0;
      for (const auto& [column, height] : lowest) {
        if (height > bottom + 2 * contact) continue;
        ++low;
        const auto it = below.find(column);
        if (it == below.end()) continue;
        const auto above = std::upper_bound(it->second.begin(), it->second.end(), height + 0.3 * contact);
        touching += above != it->second.begin() && height - *std::prev(above) < contact;
      }
      const bool on_top = std::any_of(
          tops.begin(), tops.end(), [&](const Top& t) { return rests_on(t, lowest, bottom, contact, settings.share); });
      if (!on_top && static_cast<double>(touching) < settings.share * static_cast<double>(low)) continue;
      found.push_back(o);
      select_objects(room, {o}, carried);
      more = true;
    }
  }
  return found;
}

}  // namespace aligngs
