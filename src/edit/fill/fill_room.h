// The room of a fill and what goes from it, as all steps of a fill ask for them.
#pragma once

#include <cstdint>
#include <vector>

#include "edit/fill/carrying_classes.h"
#include "edit/fill/fill_removed.h"
#include "edit/fill/hidden_places.h"
#include "edit/fill/plane_rectangle.h"
#include "edit/fill/room_planes.h"
#include "edit/fill/stains.h"
#include "edit/taken_objects.h"

namespace aligngs {

/// The input and the settings outlive this.
struct FillRoom {
  static constexpr size_t kFewestCarriers = 12;  ///< Gaussians that make a surface believable

  FillRoom(const FillInput& given, const FillSettings& lengths);

  const FillInput& input;
  const FillSettings& settings;
  const LabelledGaussians& room;
  double extent;
  std::vector<CarryingClass> classes;
  std::vector<std::vector<uint8_t>> parts;  ///< of the selection: connected ones, a mask each
  HiddenPlaces hidden;
  std::vector<RoomPlane> planes;
  Stains stains;
  TakenObjects taken;
  std::vector<uint8_t> gone;  ///< selected, and debris as soon as it is known

  /// Rows of debris go, too, and carry nothing.
  void take_away(const std::vector<uint8_t>& debris);

  /// In parallel where there is a pool. The body of an index writes for that index alone.
  template <class Body>
  void for_each(size_t count, const Body& body, size_t grain = 256) const {
    const auto chunk = [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) body(i);
    };
    if (input.pool)
      input.pool->parallel_for(count, grain, chunk);
    else
      chunk(0, count, 0);
  }

  /// A part reaches a plane to within a share of the extent.
  bool reaches(const std::vector<uint8_t>& part, const RoomPlane& plane, double distance) const;
  /// Furniture, also where nobody saw its legs.
  bool rests_on(const std::vector<uint8_t>& part, const RoomPlane& plane) const;
  bool lies_on(const Vec3d& place, const RoomPlane& plane) const;
  /// Carriers of a surface farther from the removed object than a share of the extent. Near it they count only where a
  /// photo shows them. All count where too few are left.
  std::vector<uint32_t> clean(const std::vector<uint32_t>& carriers, double halo) const;
  /// Edge of a cell for a surface, scene units: the spacing of its Gaussians.
  double cell_of(const std::vector<uint32_t>& carriers) const;
  /// Opacity of what stays on a plane, or with `is_gone` of what goes from it.
  std::vector<float> coverage(const PlaneGrid& grid, bool is_gone) const;
  /// Rows of an object that lie on a plane; `tolerance` is a share of the extent.
  std::vector<uint32_t> rows_on(const PlaneGrid& grid, int label, int instance, double tolerance) const;
  /// Around rows on a plane, in cells.
  PlaneRectangle rectangle_on(const PlaneGrid& grid, const std::vector<uint32_t>& rows) const;
  /// Adds what the Gaussians of a removed part cover of a plane.
  void splat_part(const std::vector<uint8_t>& part, const PlaneGrid& grid, std::vector<float>& cover) const;

 private:
  std::vector<Vec3f> points_of(const std::vector<uint8_t>& rows) const;
  std::vector<Vec3f> furniture_points() const;
};

}  // namespace aligngs
