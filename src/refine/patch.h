// A patch of one photo, carried into another by prior depth and compared there.
#pragma once

#include <optional>
#include <vector>

#include "core/vector_lanes.h"
#include "refine/guided_match.h"

namespace aligngs {

struct Patch {
  std::vector<float> value;  ///< minus the mean, over the standard deviation times sqrt(n)
  std::vector<Vec2d> place;  ///< where its pixels are expected in the other photo
  Vec2d centre;              ///< expected place of the corner itself
};

/// The patch around (x, y). Nothing if it leaves the photo, lacks depth somewhere, has a jump of depth or no contrast,
/// or lies behind the other camera.
std::optional<Patch> carry_over(const MatchView& from, int x, int y, const MatchView& to,
                                const MatchSettings& settings);

/// Normalised cross-correlation with the photo when all places are shifted by whole pixels. kOutside where the patch
/// leaves the photo or the photo is flat there.
class ShiftedScores {
 public:
  static constexpr double kOutside = -1;

  /// A pixel of the patch between four of the photo.
  struct Tap {
    int column, row;    ///< of the upper left one, without a shift
    float right, down;  ///< shares of the right and the lower ones
    float value;        ///< Patch::value
  };
  /// Over the taps, of shifts side by side.
  struct Sums {
    double dot[kLanes], sum[kLanes], squares[kLanes];
  };

  /// Both outlive it.
  ShiftedScores(const Patch& patch, const ImageF& luma);

  double at(int dx, int dy) const;
  /// out[k] = at(first + k, dy) for 0 <= k < count, faster than one by one and the same bits.
  void row(int first, int count, int dy, double* out) const;
  /// The same for every second shift of a square: at(-reach + 2 k, -reach + 2 j) of row j and column k. Both have
  /// reach + 1 places, row by row.
  std::vector<double> every_second(int reach) const;

 private:
  double score(double dot, double sum, double squares) const;

  const ImageF& luma_;
  std::vector<Tap> taps_;
  int first_column_, last_column_, first_row_, last_row_;  ///< of all taps
};

}  // namespace aligngs
