#include "refine/stereo_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "refine/sweep_rows.h"

namespace aligngs {
namespace {

constexpr float kMiddleGrey = 0.5f;  // luma is compared around it: smaller sums round less
constexpr int kTerms = 6;            // of WindowTerms
constexpr int kLane = 8;             // spans begin and end at multiples of it, so that vectors are full

/// The six arrays of WindowTerms, some rows of them.
class TermRows {
 public:
  TermRows(int width, int rows)
      : width_(static_cast<size_t>(width)), rows_(static_cast<size_t>(rows)), data_(kTerms * width_ * rows_) {}
  float* term(int k, int row) { return &data_[(static_cast<size_t>(k) * rows_ + static_cast<size_t>(row)) * width_]; }
  WindowTerms terms(int row, int column) {
    return {term(0, row) + column, term(1, row) + column, term(2, row) + column,
            term(3, row) + column, term(4, row) + column, term(5, row) + column};
  }

 private:
  size_t width_, rows_;
  std::vector<float> data_;
};

/// Columns [begin, end) of a row.
struct Span {
  int begin = 0, end = 0;
  bool empty() const { return begin >= end; }
  int length() const { return end - begin; }
  /// The shortest that holds both.
  Span with(const Span& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {std::min(begin, other.begin), std::max(end, other.end)};
  }
};

/// Rows of a photo go by once per hypothesis and other photo. The rows of a window stay in the nearest caches.
class Sweep {
 public:
  Sweep(const MatchView& view, const std::vector<const MatchView*>& others, const SweepSettings& settings)
      : view_(view),
        others_(others),
        settings_(settings),
        width_(view.luma.width),
        height_(view.luma.height),
        half_(settings.half_window),
        side_(2 * settings.half_window + 1),
        pixels_(view.luma.pixels()),
        own_(pixels_),
        terms_(width_ + 2 * half_, 1),
        sums_(width_, side_),
        counts_(width_, side_),
        window_(width_, 1),
        score_(static_cast<size_t>(width_)),
        scores_(static_cast<size_t>(std::max(1, settings.best)), std::vector<float>(pixels_)) {
    for (size_t i = 0; i < pixels_; ++i) own_[i] = view.luma.data[i] - kMiddleGrey;
    find_spans();
  }

  CostVolume run() {
    CostVolume volume;
    volume.width = width_;
    volume.height = height_;
    volume.hypotheses = settings_.hypotheses;
    volume.known.assign(pixels_, 0);
    std::vector<Carried> carried;
    for (const MatchView* other : others_) carried.push_back(carry(*other));
    const size_t hypotheses = static_cast<size_t>(settings_.hypotheses);
    std::vector<float> costs(pixels_ * hypotheses, CostVolume::kUnknown);  // [hypothesis][y][x]
    std::vector<double> sum(static_cast<size_t>(width_)), number(sum.size());
    for (int h = 0; h < settings_.hypotheses; ++h) {
      for (auto& s : scores_) std::fill(s.begin(), s.end(), kNone);
      for (size_t k = 0; k < others_.size(); ++k) {
        if (others_[k]->luma.width < 2 || others_[k]->luma.height < 2) continue;  // nothing to interpolate between
        compare(*others_[k], carried[k], std::exp(settings_.log_factor(h)));
      }
      for (int y = 0; y < height_; ++y) {
        const Span span = spans_[static_cast<size_t>(y)];
        if (span.empty()) continue;
        const size_t first = place(span.begin, y);
        std::fill(sum.begin(), sum.end(), 0.0);
        std::fill(number.begin(), number.end(), 0.0);
        for (const auto& s : scores_) add_scores(span.length(), &s[first], kNone, sum.data(), number.data());
        cost_row(span.length(), sum.data(), number.data(), CostVolume::kUnknown,
                 &costs[static_cast<size_t>(h) * pixels_ + first], &volume.known[first]);
      }
    }
    volume.cost.resize(costs.size());
    transpose_costs(costs.data(), hypotheses, pixels_, volume.cost.data());
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

  size_t place(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  /// Columns that have depth, in whole vectors: nothing else is scored.
  void find_spans() {
    spans_.resize(static_cast<size_t>(height_));
    for (int y = 0; y < height_; ++y) {
      int begin = width_, end = 0;
      for (int x = 0; x < width_; ++x) {
        if (!(view_.depth.at(x, y) > 0)) continue;
        begin = std::min(begin, x);
        end = x + 1;
      }
      if (begin >= end) continue;
      spans_[static_cast<size_t>(y)] = {begin / kLane * kLane, std::min(width_, (end + kLane - 1) / kLane * kLane)};
    }
  }

  /// The rows of the window around a row: [first, second].
  std::pair<int, int> window_rows(int y) const { return {std::max(0, y - half_), std::min(height_ - 1, y + half_)}; }

  /// Terms of a row of pixels, and their sums over the window's columns, as far as any window needs them.
  void warp(const MatchView& other, const Carried& carried, double factor, int y) {
    const auto [first, last] = window_rows(y);
    Span needed;
    for (int r = first; r <= last; ++r) needed = needed.with(spans_[static_cast<size_t>(r)]);
    if (needed.empty()) return;
    for (int k = 0; k < kTerms; ++k) std::fill_n(terms_.term(k, 0), width_ + 2 * half_, 0.0f);
    const Span own = spans_[static_cast<size_t>(y)];
    if (!own.empty()) warp_span(other, carried, factor, y, own);
    std::vector<const float*>& columns = rows_;
    for (int k = 0; k < kTerms; ++k) {
      const float* const row = terms_.term(k, 0) + needed.begin;
      for (int i = 0; i < side_; ++i) columns[static_cast<size_t>(i)] = row + i;
      sum_rows(columns.data(), side_, needed.length(), sums_.term(k, y % side_) + needed.begin);
    }
    std::copy_n(terms_.term(0, 0) + half_, width_, counts_.term(0, y % side_));
  }

  void warp_span(const MatchView& other, const Carried& carried, double factor, int y, const Span& span) {
    const size_t first = place(span.begin, y);
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
    warp_row(row, span.length(), terms_.terms(0, half_ + span.begin));
  }

  void compare(const MatchView& other, const Carried& carried, double factor) {
    for (int y = 0; y < std::min(half_, height_); ++y) warp(other, carried, factor, y);
    for (int y = 0; y < height_; ++y) {
      if (y + half_ < height_) warp(other, carried, factor, y + half_);
      score(y);
    }
  }

  void score(int y) {
    const Span span = spans_[static_cast<size_t>(y)];
    if (span.empty()) return;
    const ScoreRule rule{static_cast<float>(settings_.least_share * side_ * side_),
                         static_cast<float>(settings_.least_contrast * settings_.least_contrast), kNone};
    const auto [first, last] = window_rows(y);
    for (int k = 0; k < kTerms; ++k) {
      for (int r = first; r <= last; ++r) rows_[static_cast<size_t>(r - first)] = sums_.term(k, r % side_) + span.begin;
      sum_rows(rows_.data(), last - first + 1, span.length(), window_.term(k, 0));
    }
    score_row(window_.terms(0, 0), counts_.term(0, y % side_) + span.begin, rule, span.length(), score_.data());
    for (auto& best : scores_) keep_best_row(span.length(), score_.data(), &best[place(span.begin, y)]);
  }

  const MatchView& view_;
  const std::vector<const MatchView*>& others_;
  const SweepSettings& settings_;
  int width_, height_, half_, side_;
  size_t pixels_;
  std::vector<Span> spans_;  ///< per row: the columns with depth
  std::vector<float> own_;   ///< luma around middle grey
  TermRows terms_;           ///< one row, with zeros for half a window on both sides
  TermRows sums_;            ///< the last rows: over the columns of windows
  TermRows counts_;          ///< the last rows: the first of the terms alone
  TermRows window_;          ///< one row: over the window
  std::vector<const float*> rows_ = std::vector<const float*>(static_cast<size_t>(side_));
  std::vector<float> score_;
  std::vector<std::vector<float>> scores_;  ///< the best of all photos, best first
};

}  // namespace

CostVolume sweep_prior_depth(const MatchView& view, const std::vector<const MatchView*>& others,
                             const SweepSettings& settings) {
  return Sweep(view, others, settings).run();
}

}  // namespace aligngs
