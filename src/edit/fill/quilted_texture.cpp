#include "edit/fill/quilted_texture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aligngs {
namespace {

constexpr int kNeighbourhood = 1;     ///< cells: an unknown cell takes the mean of known ones so near
constexpr int kStride = 2;            ///< cells between the pieces that are tried, and between the cells compared
constexpr size_t kFewestPieces = 16;  ///< choices without which every hole looks the same

struct Place {
  int i = 0, j = 0;  ///< lowest cell of a piece
};

/// The known texture without its small gaps: every second cell or so has no Gaussian of its own.
TextureMap without_gaps(const TextureMap& map, const std::vector<uint8_t>& hole) {
  TextureMap out = map;
  for (int j = 0; j < map.rows; ++j) {
    for (int i = 0; i < map.columns; ++i) {
      const size_t at = map.index(i, j);
      if (hole[at]) out.mask[at] = 0;
      if (map.mask[at] > 0 || hole[at]) continue;
      Vec3f sum;
      float count = 0;
      for (int y = j - kNeighbourhood; y <= j + kNeighbourhood; ++y) {
        for (int x = i - kNeighbourhood; x <= i + kNeighbourhood; ++x) {
          if (!map.knows(x, y) || hole[map.index(x, y)]) continue;
          sum += map.value[map.index(x, y)];
          ++count;
        }
      }
      if (count == 0) continue;
      out.value[at] = sum * (1 / count);
      out.mask[at] = 1;
    }
  }
  return out;
}

class Quilt {
 public:
  Quilt(const TextureMap& map, const std::vector<uint8_t>& hole, const QuiltGuide* guide, const QuiltSettings& settings)
      : source_(without_gaps(map, hole)), result_(source_), hole_(hole), guide_(guide), settings_(settings) {
    find_pieces();
  }

  bool has_pieces() const { return pieces_.size() >= kFewestPieces; }

  std::vector<Vec3f> run() {
    std::vector<Place> open = places();
    while (!open.empty()) {
      // The place of which most is there already, so that the hole closes from its rim.
      size_t best = 0;
      int most = -1;
      for (size_t k = 0; k < open.size(); ++k) {
        const int count = known_cells(open[k]);
        if (count > most) {
          most = count;
          best = k;
        }
      }
      lay(open[best]);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(best));
    }
    std::vector<Vec3f> texture(hole_.size());
    for (size_t at = 0; at < hole_.size(); ++at) {
      if (hole_[at]) texture[at] = result_.value[at];
    }
    return texture;
  }

 private:
  /// Whole pieces of the known texture.
  void find_pieces() {
    const size_t columns = static_cast<size_t>(source_.columns) + 1;
    std::vector<int> sums(columns * (static_cast<size_t>(source_.rows) + 1), 0);  // of known cells below and left
    const auto sum_at = [&](int i, int j) -> int& {
      return sums[static_cast<size_t>(j) * columns + static_cast<size_t>(i)];
    };
    for (int j = 0; j < source_.rows; ++j) {
      for (int i = 0; i < source_.columns; ++i)
        sum_at(i + 1, j + 1) = source_.knows(i, j) + sum_at(i, j + 1) + sum_at(i + 1, j) - sum_at(i, j);
    }
    const int n = settings_.piece;
    whole_.assign(source_.mask.size(), 0);
    for (int j = 0; j + n <= source_.rows; ++j) {
      for (int i = 0; i + n <= source_.columns; ++i) {
        const int known = sum_at(i + n, j + n) - sum_at(i, j + n) - sum_at(i + n, j) + sum_at(i, j);
        whole_[source_.index(i, j)] = known == n * n;
        if (known == n * n && i % kStride == 0 && j % kStride == 0) pieces_.push_back({i, j});
      }
    }
  }

  /// Places of a lattice that have cells of the hole; the first ones overlap with the surface before it.
  std::vector<Place> places() const {
    std::vector<Place> out;
    int low_i = source_.columns, low_j = source_.rows;
    for (int j = 0; j < source_.rows; ++j) {
      for (int i = 0; i < source_.columns; ++i) {
        if (!hole_[source_.index(i, j)]) continue;
        low_i = std::min(low_i, i);
        low_j = std::min(low_j, j);
      }
    }
    const int step = settings_.piece - settings_.overlap;
    for (int j = low_j - settings_.overlap; j < source_.rows; j += step) {
      for (int i = low_i - settings_.overlap; i < source_.columns; i += step) {
        if (any_hole({i, j})) out.push_back({i, j});
      }
    }
    return out;
  }
  bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < source_.columns && j < source_.rows; }
  bool any_hole(const Place& p) const {
    for (int y = 0; y < settings_.piece; ++y) {
      for (int x = 0; x < settings_.piece; ++x) {
        if (inside(p.i + x, p.j + y) && hole_[source_.index(p.i + x, p.j + y)]) return true;
      }
    }
    return false;
  }
  int known_cells(const Place& p) const {
    int count = 0;
    for (int y = 0; y < settings_.piece; ++y) {
      for (int x = 0; x < settings_.piece; ++x) count += result_.knows(p.i + x, p.j + y);
    }
    return count;
  }

  /// Squared distance of a piece to what is at a place, and to the guide; stops above `most`.
  double distance(const Place& piece, const Place& place, double most) const {
    double sum = 0;
    for (int y = 0; y < settings_.piece; y += kStride) {
      for (int x = 0; x < settings_.piece; x += kStride) {
        const int i = place.i + x, j = place.j + y;
        if (!inside(i, j)) continue;
        const size_t at = source_.index(i, j);
        const size_t from = source_.index(piece.i + x, piece.j + y);
        if (result_.mask[at] > 0) {
          const Vec3f d = source_.value[from] - result_.value[at];
          sum += static_cast<double>(dot(d, d));
        } else if (hole_[at] && guide_) {
          const Vec3f d = (guide_->looks.empty() ? source_.value[from] : guide_->looks[from]) - guide_->wanted[at];
          sum += static_cast<double>(settings_.guide_share * dot(d, d));
        }
      }
      if (sum >= most) return sum;
    }
    return sum;
  }

  /// Pieces from a place that was used before cost more, so that no piece is seen again and again.
  double again_factor(const Place& piece) const {
    constexpr double kAgain = 1.3;
    double factor = 1;
    if (guide_ && guide_->is_exact) return factor;
    for (const Place& u : used_) {
      if (2 * std::abs(u.i - piece.i) < settings_.piece && 2 * std::abs(u.j - piece.j) < settings_.piece)
        factor *= kAgain;
    }
    return factor;
  }

  /// Takes a piece that fits better than the best so far.
  void try_piece(const Place& piece, const Place& place, double& least, Place& best) const {
    const double again = again_factor(piece), d = again * distance(piece, place, least / again);
    if (d >= least) return;
    least = d;
    best = piece;
  }

  void lay(const Place& place) {
    Place best = pieces_.front();
    double least = std::numeric_limits<double>::infinity();
    for (const Place& piece : pieces_) try_piece(piece, place, least, best);
    const Place coarse = best;
    for (int j = coarse.j - kStride + 1; j < coarse.j + kStride; ++j) {
      for (int i = coarse.i - kStride + 1; i < coarse.i + kStride; ++i) {
        if (inside(i, j) && whole_[source_.index(i, j)]) try_piece({i, j}, place, least, best);
      }
    }
    used_.push_back(best);
    // A seam of two cells in the middle of the overlap with earlier pieces: a wider one would mix their textures.
    for (int y = 0; y < settings_.piece; ++y) {
      for (int x = 0; x < settings_.piece; ++x) {
        const int i = place.i + x, j = place.j + y;
        if (!inside(i, j) || !hole_[source_.index(i, j)]) continue;
        const size_t at = source_.index(i, j);
        const Vec3f& value = source_.value[source_.index(best.i + x, best.j + y)];
        const int edge = std::min(std::min(x, y), std::min(settings_.piece - 1 - x, settings_.piece - 1 - y));
        const float share = std::clamp(0.5f * static_cast<float>(1 + 2 * edge - settings_.overlap) / 2, 0.f, 1.f);
        result_.value[at] = result_.mask[at] > 0 ? result_.value[at] * (1 - share) + value * share : value;
        result_.mask[at] = 1;
      }
    }
  }

  const TextureMap source_;
  TextureMap result_;
  const std::vector<uint8_t>& hole_;
  const QuiltGuide* guide_;
  const QuiltSettings settings_;
  std::vector<Place> pieces_, used_;
  std::vector<uint8_t> whole_;  ///< per cell: a piece with this lowest cell has known cells only
};

}  // namespace

std::vector<Vec3f> quilted_texture(const TextureMap& map, const std::vector<uint8_t>& hole, const QuiltGuide* guide,
                                   const QuiltSettings& settings) {
  Quilt quilt(map, hole, guide, settings);
  if (!quilt.has_pieces()) return {};
  return quilt.run();
}

}  // namespace aligngs
