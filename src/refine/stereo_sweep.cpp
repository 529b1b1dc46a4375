#include "refine/stereo_sweep.h"

#include <algorithm>
#include <cmath>

namespace aligngs {
namespace {

/// Sums over square windows, cut off at the border.
class BoxFilter {
 public:
  BoxFilter(int width, int height, int half)
      : width_(width), height_(height), half_(half), padded_(static_cast<size_t>(width + 2 * half), 0.0f), rows_(size_t(width) * height) {}

  void sum(const std::vector<float>& values, std::vector<float>& out) {
    const size_t width = static_cast<size_t>(width_);
    for (int y = 0; y < height_; ++y) {
      std::copy_n(&values[y * width], width, &padded_[static_cast<size_t>(half_)]);
      add_up(2 * half_ + 1, [&](int k) { return &padded_[static_cast<size_t>(k)]; }, &rows_[y * width]);
    }
    for (int y = 0; y < height_; ++y) {
      const int first = std::max(0, y - half_), last = std::min(height_ - 1, y + half_);
      add_up(last - first + 1, [&](int k) { return &rows_[static_cast<size_t>(first + k) * width]; }, &out[y * width]);
    }
  }

 private:
  /// One row: the sum of `count` others, summand by summand, which the compiler turns into vectors.
  template <class Row>
  void add_up(int count, const Row& row, float* out) const {
    std::copy_n(row(0), width_, out);
    for (int k = 1; k < count; ++k) {
      const float* summand = row(k);
      for (int x = 0; x < width_; ++x) out[x] += summand[x];
    }
  }

  int width_, height_, half_;
  std::vector<float> padded_, rows_;
};

constexpr float kMiddleGrey = 0.5f;  // luma is compared around it: smaller sums round less

/// The window sums of one comparison.
struct Sums {
  std::vector<float> count, own, own2, other, other2, product;
  explicit Sums(size_t n) : count(n), own(n), own2(n), other(n), other2(n), product(n) {}
};

class Sweep {
 public:
  Sweep(const MatchView& view, const std::vector<const MatchView*>& others, const SweepSettings& settings)
      : view_(view), others_(others), settings_(settings), width_(view.luma.width), height_(view.luma.height),
        box_(width_, height_, settings.half_window), pixels_(view.luma.pixels()), sums_(pixels_), raw_(pixels_),
        scores_(static_cast<size_t>(std::max(1, settings.best)), std::vector<float>(pixels_)) {}

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
        volume.cost[i * static_cast<size_t>(settings_.hypotheses) + static_cast<size_t>(h)] = static_cast<float>(1 - sum / count);
      }
    }
    return volume;
  }

 private:
  static constexpr float kNone = -2;  // below every correlation

  /// This photo's pixels as points in the other camera's frame: factor * direction + origin.
  struct Carried {
    std::vector<Vec3f> direction;
    Vec3f origin;
  };

  Carried carry(const MatchView& other) const {
    const Rigidd to_other = other.camera.world_to_camera * view_.camera.world_to_camera.inverse();
    Carried out{std::vector<Vec3f>(pixels_), to_other.translation.cast<float>()};
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const float z = view_.depth.at(x, y);
        const bool valid = z > 0 && std::isfinite(z);
        const Vec3d p = to_other.rotation * (view_.camera.ray(x + 0.5, y + 0.5) * (valid ? static_cast<double>(z) : 0.0));
        out.direction[size_t(y) * width_ + x] = p.cast<float>();
      }
    }
    return out;
  }

  /// Luma of the other photo where this one's pixels fall, and which of them do.
  void warp(const MatchView& other, const Carried& carried, float factor) {
    const float fx = static_cast<float>(other.camera.fx), fy = static_cast<float>(other.camera.fy);
    const float cx = static_cast<float>(other.camera.cx - 0.5), cy = static_cast<float>(other.camera.cy - 0.5);
    const int other_width = other.luma.width;
    const float last_x = static_cast<float>(other_width - 1), last_y = static_cast<float>(other.luma.height - 1);
    for (size_t i = 0; i < pixels_; ++i) {
      raw_.count[i] = raw_.own[i] = raw_.own2[i] = raw_.other[i] = raw_.other2[i] = raw_.product[i] = 0;
      const Vec3f p = factor * carried.direction[i] + carried.origin;
      if (!(p.z > 0) || !(view_.depth.data[i] > 0)) continue;
      const float inverse = 1 / p.z, u = fx * p.x * inverse + cx, v = fy * p.y * inverse + cy;
      if (!(u >= 0 && v >= 0 && u <= last_x && v <= last_y)) continue;
      const int x0 = std::min(static_cast<int>(u), other_width - 2), y0 = std::min(static_cast<int>(v), other.luma.height - 2);
      const float a = u - static_cast<float>(x0), b = v - static_cast<float>(y0);
      const float* top = &other.luma.data[size_t(y0) * other_width + x0];
      const float* bottom = top + other_width;
      const float j = (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]) - kMiddleGrey;
      const float own = view_.luma.data[i] - kMiddleGrey;
      raw_.count[i] = 1;
      raw_.own[i] = own;
      raw_.own2[i] = own * own;
      raw_.other[i] = j;
      raw_.other2[i] = j * j;
      raw_.product[i] = own * j;
    }
  }

  void compare(const MatchView& other, const Carried& carried, double factor) {
    warp(other, carried, static_cast<float>(factor));
    box_.sum(raw_.count, sums_.count);
    box_.sum(raw_.own, sums_.own);
    box_.sum(raw_.own2, sums_.own2);
    box_.sum(raw_.other, sums_.other);
    box_.sum(raw_.other2, sums_.other2);
    box_.sum(raw_.product, sums_.product);
    const int side = 2 * settings_.half_window + 1;
    const float least = static_cast<float>(settings_.least_share * side * side);
    const float contrast = static_cast<float>(settings_.least_contrast * settings_.least_contrast);
    for (size_t i = 0; i < pixels_; ++i) {
      if (raw_.count[i] == 0 || sums_.count[i] < least) continue;
      const float share = 1 / sums_.count[i], mean = sums_.own[i] * share, mean_other = sums_.other[i] * share;
      const float variance = sums_.own2[i] * share - mean * mean, variance_other = sums_.other2[i] * share - mean_other * mean_other;
      if (variance < contrast) continue;
      const float covariance = sums_.product[i] * share - mean * mean_other;
      // A flat window on the other side says that the place looks different there, not that nothing is known.
      const float score = variance_other < 0.25f * contrast ? 0 : covariance / std::sqrt(variance * variance_other);
      keep_best(i, std::clamp(score, -1.0f, 1.0f));
    }
  }

  void keep_best(size_t i, float score) {
    for (auto& s : scores_) {
      if (score > s[i]) std::swap(score, s[i]);
    }
  }

  const MatchView& view_;
  const std::vector<const MatchView*>& others_;
  const SweepSettings& settings_;
  int width_, height_;
  BoxFilter box_;
  size_t pixels_;
  Sums sums_, raw_;
  std::vector<std::vector<float>> scores_;  ///< the best of all photos, best first
};

}  // namespace

CostVolume sweep_prior_depth(const MatchView& view, const std::vector<const MatchView*>& others, const SweepSettings& settings) {
  return Sweep(view, others, settings).run();
}

}  // namespace aligngs
