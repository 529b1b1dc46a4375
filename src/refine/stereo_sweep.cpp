#include "refine/stereo_sweep.h"

#include <algorithm>
#include <cmath>

#include "refine/sweep_rows.h"

namespace aligngs {
namespace {

constexpr float kMiddleGrey = 0.5f;  // luma is compared around it: smaller sums round less
constexpr int kTerms = 6;            // of WindowTerms

/// The six arrays of WindowTerms, some rows of them.
class TermRows {
 public:
  TermRows(int width, int rows)
      : width_(static_cast<size_t>(width)), rows_(static_cast<size_t>(rows)), data_(kTerms * width_ * rows_) {}
  float* term(int k, int row) { return &data_[(static_cast<size_t>(k) * rows_ + static_cast<size_t>(row)) * width_]; }
  WindowTerms terms(int row) {
    return {term(0, row), term(1, row), term(2, row), term(3, row), term(4, row), term(5, row)};
  }

 private:
  size_t width_, rows_;
  std::vector<float> data_;
};

class Sweep {
 public:
  Sweep(const MatchView& view, const std::vector<const MatchView*>& others, const SweepSettings& settings)
      : view_(view),
        others_(others),
        settings_(settings),
        width_(view.luma.width),
        height_(view.luma.height),
        half_(settings.half_window),
        pixels_(view.luma.pixels()),
        own_(pixels_),
        terms_(width_, height_),
        sums_(width_, height_),
        window_(width_, 1),
        padded_(static_cast<size_t>(width_ + 2 * half_), 0.0f),
        score_(static_cast<size_t>(width_)),
        scores_(static_cast<size_t>(std::max(1, settings.best)), std::vector<float>(pixels_)) {
    for (size_t i = 0; i < pixels_; ++i) own_[i] = view.luma.data[i] - kMiddleGrey;
  }

  CostVolume run() {
    CostVolume volume;
    volume.width = width_;
    volume.height = height_;
    volume.hypotheses = settings_.hypotheses;
    volume.cost.assign(pixels_ * static_cast<size_t>(settings_.hypotheses), CostVolume::kUnknown);
    volume.known.assign(pixels_, 0);
    std::vector<Carried> carried;
    for (const MatchView* other : others_) carried.push_back(carry(*other));
    for (int h = 0; h < settings_.hypotheses; ++h) {
      for (auto& s : scores_) std::fill(s.begin(), s.end(), kNone);
      for (size_t k = 0; k < others_.size(); ++k) {
        if (others_[k]->luma.width < 2 || others_[k]->luma.height < 2) continue;  // nothing to interpolate between
        compare(*others_[k], carried[k], std::exp(settings_.log_factor(h)));
      }
      for (size_t i = 0; i < pixels_; ++i) {
        double sum = 0;
        int count = 0;
        for (const auto& s : scores_) {
          if (s[i] == kNone) continue;
          sum += s[i];
          ++count;
        }
        if (count == 0) continue;
        volume.known[i] = 1;
        volume.cost[i * static_cast<size_t>(settings_.hypotheses) + static_cast<size_t>(h)] =
            static_cast<float>(1 - sum / count);
      }
    }
    return volume;
  }

 private:
  static constexpr float kNone = -2;        // below every correlation
  static constexpr float kBehind = -1e30f;  // of every camera: where pixels without depth are put

  /// This photo's pixels as points in the other camera's frame: factor * direction + origin.
  struct Carried {
    std::vector<float> x, y, z;
    Vec3f origin;
  };

  Carried carry(const MatchView& other) const {
    const Rigidd to_other = other.camera.world_to_camera * view_.camera.world_to_camera.inverse();
    Carried out{std::vector<float>(pixels_), std::vector<float>(pixels_), std::vector<float>(pixels_),
                to_other.translation.cast<float>()};
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float z = view_.depth.at(x, y);
        const bool valid = z > 0 && std::isfinite(z);
        const Vec3d p =
            to_other.rotation * (view_.camera.ray(x + 0.5, y + 0.5) * (valid ? static_cast<double>(z) : 0.0));
        const size_t i = size_t(y) * width_ + x;
        out.x[i] = static_cast<float>(p.x);
        out.y[i] = static_cast<float>(p.y);
        out.z[i] = valid ? static_cast<float>(p.z) : kBehind;
      }
    }
    return out;
  }

  /// Terms of a row of pixels, and their sums over the window's columns.
  void warp(const MatchView& other, const Carried& carried, double factor, int y) {
    const size_t first = size_t(y) * width_;
    WarpedRow row;
    row.x = &carried.x[first];
    row.y = &carried.y[first];
    row.z = &carried.z[first];
    row.origin = carried.origin;
    row.factor = static_cast<float>(factor);
    row.depth = &view_.depth.data[first];
    row.own = &own_[first];
    row.luma = other.luma.data.data();
    row.width = other.luma.width;
    row.height = other.luma.height;
    row.fx = static_cast<float>(other.camera.fx);
    row.fy = static_cast<float>(other.camera.fy);
    row.cx = static_cast<float>(other.camera.cx - 0.5);
    row.cy = static_cast<float>(other.camera.cy - 0.5);
    row.middle = kMiddleGrey;
    warp_row(row, width_, terms_.terms(y));
    for (int k = 0; k < kTerms; ++k) {
      std::copy_n(terms_.term(k, y), width_, &padded_[static_cast<size_t>(half_)]);
      sum_strided(padded_.data(), 1, 2 * half_ + 1, width_, sums_.term(k, y));
    }
  }

  void compare(const MatchView& other, const Carried& carried, double factor) {
    const int side = 2 * half_ + 1;
    const ScoreRule rule{static_cast<float>(settings_.least_share * side * side),
                         static_cast<float>(settings_.least_contrast * settings_.least_contrast), kNone};
    for (int y = 0; y < height_; ++y) warp(other, carried, factor, y);
    for (int y = 0; y < height_; ++y) {
      const int first = std::max(0, y - half_), last = std::min(height_ - 1, y + half_);
      for (int k = 0; k < kTerms; ++k) {
        sum_strided(sums_.term(k, first), static_cast<size_t>(width_), last - first + 1, width_, window_.term(k, 0));
      }
      score_row(window_.terms(0), terms_.term(0, y), rule, width_, score_.data());
      for (auto& best : scores_) keep_best_row(width_, score_.data(), &best[size_t(y) * width_]);
    }
  }

  const MatchView& view_;
  const std::vector<const MatchView*>& others_;
  const SweepSettings& settings_;
  int width_, height_, half_;
  size_t pixels_;
  std::vector<float> own_;  ///< luma around middle grey
  TermRows terms_, sums_;   ///< per pixel; over the columns of its window
  TermRows window_;         ///< one row: over the window
  std::vector<float> padded_, score_;
  std::vector<std::vector<float>> scores_;  ///< the best of all photos, best first
};

}  // namespace

CostVolume sweep_prior_depth(const MatchView& view, const std::vector<const MatchView*>& others,
                             const SweepSettings& settings) {
  return Sweep(view, others, settings).run();
}

}  // namespace aligngs
