#include "edit/fill/stains.h"

#include <algorithm>
#include <utility>

#include "gaussians/gaussian_geometry.h"

namespace aligngs {
namespace {

constexpr size_t kAround = 32;  ///< Gaussians of a surface; enough for all colours of a pattern
constexpr size_t kStained = 8;  ///< one in so many of them may be a stain of something else

float brightness(const Vec3f& color) { return (color.x + color.y + color.z) / 3; }

}  // namespace

Stains::Stains(const LabelledGaussians& room, std::vector<Vec3f> removed, std::vector<Vec3f> furniture,
               const FillSettings& settings)
    : room_(room),
      settings_(settings),
      beside_(removed, settings.beside * room.extent),
      shaded_(furniture, settings.shade * room.extent),
      removed_(std::move(removed)),
      furniture_(std::move(furniture)) {}

Stains::Surface Stains::surface_of(std::vector<uint32_t> rows) const {
  std::vector<Vec3f> points;
  for (const uint32_t i : rows) points.push_back(position_of(room_.model, i).cast<float>());
  return {std::move(rows), PointTree(std::move(points))};
}

bool Stains::is_near(const PointTree& tree, const Vec3f& place, double share) const {
  return tree.any_within(place, share * room_.extent);
}

bool Stains::is_stain(size_t row, const Surface& surface) const {
  const Vec3f place = position_of(room_.model, row).cast<float>(), color = base_color_of(room_.model, row);
  const bool beside = beside_.may_be_near(place) && is_near(removed_, place, settings_.beside);
  const bool shaded = shaded_.may_be_near(place) && is_near(furniture_, place, settings_.shade);
  if (!beside && !shaded) return false;
  std::vector<PointTree::Neighbour> near;
  surface.tree.nearest(place, kAround, near);
  if (near.empty()) return false;
  const auto is_alike = [&](const PointTree::Neighbour& n) {
    return norm(color - base_color_of(room_.model, surface.rows[n.index])) <= settings_.unlike;
  };
  return (beside && std::none_of(near.begin(), near.end(), is_alike)) ||
         (shaded && brightness(color) < settings_.shaded * dark_of(near, surface));
}

bool Stains::is_shade(size_t row, const Surface& surface) const {
  std::vector<PointTree::Neighbour> near;
  surface.tree.nearest(position_of(room_.model, row).cast<float>(), kAround, near);
  return !near.empty() && brightness(base_color_of(room_.model, row)) < settings_.shaded * dark_of(near, surface);
}

float Stains::dark_of(const std::vector<PointTree::Neighbour>& near, const Surface& surface) const {
  std::vector<float> brightnesses;
  for (const PointTree::Neighbour& n : near)
    brightnesses.push_back(brightness(base_color_of(room_.model, surface.rows[n.index])));
  const auto dark = brightnesses.begin() + static_cast<std::ptrdiff_t>(brightnesses.size() / kStained);
  std::nth_element(brightnesses.begin(), dark, brightnesses.end());
  return *dark;
}

bool Stains::is_foreign(size_t row, const Surface& surface) const {
  const Vec3f color = base_color_of(room_.model, row);
  std::vector<PointTree::Neighbour> near;
  surface.tree.nearest(position_of(room_.model, row).cast<float>(), kAround, near);
  return std::none_of(near.begin(), near.end(), [&](const PointTree::Neighbour& n) {
    return norm(color - base_color_of(room_.model, surface.rows[n.index])) <= settings_.unlike;
  });
}

}  // namespace aligngs
