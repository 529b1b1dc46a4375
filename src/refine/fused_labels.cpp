#include "refine/fused_labels.h"

#include <array>
#include <cmath>

#include "refine/view_overlap.h"
#include "scene/triangle_mesh.h"

namespace aligngs {
namespace {

bool has_say(const PlaneView& view) { return !view.labels.data.empty() && !view.depth.empty(); }

/// Votes for the classes of one place.
class Votes {
 public:
  void add(uint16_t label) {
    if (label == kNoLabel) return;
    ++total_;
    for (size_t i = 0; i < used_; ++i) {
      if (entries_[i].label != label) continue;
      ++entries_[i].count;
      return;
    }
    if (used_ < entries_.size()) entries_[used_++] = {label, 1};
  }

  struct Winner {
    uint16_t label;
    float share;  ///< of all votes; 0 without any
  };
  Winner winner(uint16_t own) const {
    Entry best{own, 0};
    for (size_t i = 0; i < used_; ++i) {
      const Entry& e = entries_[i];
      const bool wins_tie = e.count == best.count && best.label != own && (e.label == own || e.label < best.label);
      if (e.count > best.count || wins_tie) best = e;
    }
    return {best.label, total_ == 0 ? 0.0f : static_cast<float>(best.count) / static_cast<float>(total_)};
  }

 private:
  static constexpr size_t kMostClasses = 8;  // of one place; a ninth would win with a ninth of the votes at best
  struct Entry {
    uint16_t label = kNoLabel;
    int count = 0;
  };

  std::array<Entry, kMostClasses> entries_{};
  size_t used_ = 0;
  int total_ = 0;
};

/// Label of a place in another photo; kNoLabel where it does not show it.
uint16_t label_of(const Vec3d& x, const PlaneView& view, double agreement) {
  const std::optional<PixelIndex> pixel = pixel_showing(x, view.camera, view.depth, agreement);
  return pixel ? view.labels.at(pixel->x, pixel->y) : kNoLabel;
}

FusedLabels fused(const std::vector<PlaneView>& views, size_t index, double agreement) {
  const PlaneView& view = views[index];
  FusedLabels out{view.labels, ImageF(view.labels.width, view.labels.height, 1)};
  const Rigidd to_world = view.camera.world_to_camera.inverse();
  for (int y = 0; y < out.labels.height; ++y) {
    for (int x = 0; x < out.labels.width; ++x) {
      const uint16_t own = view.labels.at(x, y);
      Votes votes;
      votes.add(own);
      const float z = view.depth.at(x, y);
      if (z > 0 && std::isfinite(z)) {
        const Vec3d place = to_world * (view.camera.ray(x + 0.5, y + 0.5) * static_cast<double>(z));
        for (size_t other = 0; other < views.size(); ++other) {
          if (other != index && has_say(views[other])) votes.add(label_of(place, views[other], agreement));
        }
      }
      const Votes::Winner winner = votes.winner(own);
      out.labels.at(x, y) = winner.label;
      out.share.at(x, y) = winner.share;
    }
  }
  return out;
}

}  // namespace

std::vector<FusedLabels> fuse_labels(const std::vector<PlaneView>& views, const LabelFusionSettings& settings,
                                     ThreadPool& pool) {
  std::vector<FusedLabels> out(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      if (has_say(views[i])) out[i] = fused(views, i, settings.agreement);
    }
  });
  return out;
}

}  // namespace aligngs
