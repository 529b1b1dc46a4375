// A parquet for tests: squares of boards that lie across each other, each board with a shade of its own.
#pragma once

#include "core/random.h"
#include "edit/fill/texture_map.h"

namespace aligngs::parquet {

constexpr int kSquare = 20;  ///< cells: edge of a square
constexpr int kBoards = 5;   ///< of a square
constexpr int kPeriod = 2 * kSquare;

/// Whether the boards of a cell's square lie along the rows.
inline bool is_along_rows(int i, int j) { return (i / kSquare + j / kSquare) % 2 == 0; }

/// Cells of `is_hole(i, j)` are unknown.
template <class IsHole>
TextureMap map(int side, const IsHole& is_hole) {
  Random random(3);
  const int squares = side / kSquare + 1;
  std::vector<float> shades(static_cast<size_t>(squares * squares * kBoards));
  for (float& shade : shades) shade = static_cast<float>(random.uniform(-0.3, 0.3));
  TextureMap out{side, side, {}, {}};
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const int board = (is_along_rows(i, j) ? j : i) % kSquare / (kSquare / kBoards);
      const int square = j / kSquare * squares + i / kSquare;
      const float shade = shades[static_cast<size_t>(square * kBoards + board)];
      const bool known = !is_hole(i, j);
      out.value.push_back(known ? Vec3f{shade, shade, shade} : Vec3f{});
      out.mask.push_back(known ? 1.f : 0.f);
    }
  }
  return out;
}

}  // namespace aligngs::parquet
