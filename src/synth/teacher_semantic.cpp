#include "synth/teacher_semantic.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/half.h"
#include "scene/label_set.h"
#include "scene/triangle_mesh.h"
#include "synth/class_confusions.h"
#include "synth/noise.h"
#include "synth/synth_purpose.h"
#include "synth/teacher_regions.h"

namespace aligngs {
namespace {

constexpr double kUnknown = 0.3;       // score sum below which a pixel counts as unknown
constexpr double kSmallShare = 0.015;  // of the image: objects below are missed more often
constexpr double kLargeShare = 0.06;   // of the image: objects above are hardly ever missed

/// p_q: the classes of a query, with their scores.
std::vector<std::pair<uint16_t, double>> class_scores(const QueryRegion& region, const RenderedView& view,
                                                      const std::vector<ObjectConfusion>& confusions,
                                                      const SemanticTeacherSettings& s, bool duplicate,
                                                      Random& random) {
  double top = random.uniform(s.low_top, s.high_top);
  if (duplicate) top *= random.uniform(0.3, 0.55);
  uint16_t first = region.label;
  const std::vector<uint16_t> others = confusable_classes(region.label);
  uint16_t second = others.empty() ? region.label : others[0];
  const bool applies = random.chance(s.confused_view_share);
  double split = random.uniform(0.75, 0.92);  // share of the score that the first class keeps
  if (region.key >= 0 && confusions[static_cast<size_t>(region.key)].confused && applies) {
    const ObjectConfusion& c = confusions[static_cast<size_t>(region.key)];
    second = region.label;
    first = c.other;
    if (c.ambiguous) split = random.uniform(0.48, 0.65);
  }
  // A one-off mistake is likelier far away and for objects cut off by the image border.
  const double distance = region.depth_sum / static_cast<double>(std::max<size_t>(1, region.pixels));
  const double cut = std::min(
      1.0, 12.0 * static_cast<double>(region.border) / static_cast<double>(std::max<size_t>(1, region.pixels)));
  const double chance = s.flip * (0.06 + 0.1 * distance + 0.35 * cut);
  const bool flip = random.chance(chance);
  const size_t pick = others.empty() ? 0 : static_cast<size_t>(random.below(static_cast<int>(others.size())));
  if ((flip || duplicate) && !others.empty()) {
    first = others[pick];
    second = region.label;
    split = random.uniform(0.55, 0.85);
  }
  std::vector<std::pair<uint16_t, double>> out = {{first, top * split}};
  if (second != first)
    out.push_back({second, top * (1 - split)});
  else
    out[0].second = top;
  // The tail goes to random classes, as it does in a trained network.
  for (int i = 0; i < 3; ++i) {
    out.push_back({static_cast<uint16_t>(random.below(ade20k_labels().size())),
                   (1 - std::min(1.0, top)) * 0.25 * random.uniform()});
  }
  return out;
}

ScoreMap one_view(const RenderedView& view, const std::vector<ObjectConfusion>& confusions,
                  const SemanticTeacherSettings& s, int out_w, int out_h, Random random) {
  const int w = view.labels.width, h = view.labels.height, classes = ade20k_labels().size();
  const size_t n = static_cast<size_t>(out_w) * out_h;
  std::vector<float> scores(static_cast<size_t>(classes) * n, 0.0f);
  const auto add = [&](const SoftMask& m, const std::vector<std::pair<uint16_t, double>>& classes_of_query) {
    for (const auto& [label, p] : classes_of_query) {
      float* plane = &scores[label * n];
      for (int y = 0; y < m.value.height && m.y0 + y < out_h; ++y) {
        for (int x = 0; x < m.value.width && m.x0 + x < out_w; ++x) {
          plane[static_cast<size_t>(m.y0 + y) * out_w + m.x0 + x] += static_cast<float>(p) * m.value.at(x, y);
        }
      }
    }
  };
  ImageF strongest(out_w, out_h, 1);  // the best mask: low along borders between objects
  for (const QueryRegion& region : query_regions(view)) {
    Random own = random.fork(static_cast<uint64_t>(region.key + 1000));
    const bool small = static_cast<double>(region.pixels) < kSmallShare * static_cast<double>(view.labels.pixels());
    const bool stuff = region.key < 0;
    if (region.pixels < 6) continue;  // below the network's resolution
    const bool large = static_cast<double>(region.pixels) > kLargeShare * static_cast<double>(view.labels.pixels());
    const bool dropped = own.chance(small ? s.dropped_small : large ? s.dropped_large : s.dropped) && !stuff;
    const bool twice = own.chance(s.duplicate) && !stuff;
    const SoftMask mask = soft_mask(region, w, h, out_w, out_h, s.outline_rms, own);
    if (dropped) continue;
    add(mask, class_scores(region, view, confusions, s, false, own));
    for (int y = 0; y < mask.value.height && mask.y0 + y < out_h; ++y) {
      for (int x = 0; x < mask.value.width && mask.x0 + x < out_w; ++x) {
        float& best = strongest.at(mask.x0 + x, mask.y0 + y);
        best = std::max(best, mask.value.at(x, y));
      }
    }
    if (twice) {
      const SoftMask again = soft_mask(region, w, h, out_w, out_h, s.outline_rms * 1.5, own);
      add(again, class_scores(region, view, confusions, s, true, own));
    }
  }
  // Along borders no query is sure, and here and there "no object" wins.
  Random dips = random.fork(7);
  const ImageF dip = smooth_random_map(out_w, out_h, std::max(1, out_w / 8), std::max(1, out_h / 8), 1, dips);
  ScoreMap out;
  out.channels = classes;
  out.width = out_w;
  out.height = out_h;
  out.values.resize(scores.size());
  for (size_t i = 0; i < n; ++i) {
    const float factor = strongest.data[i] < 0.75f && dip.data[i] > 1.5f ? 0.3f : 1.0f;
    for (int c = 0; c < classes; ++c) {
      const size_t k = static_cast<size_t>(c) * n + i;
      out.values[k] = float_to_half(std::min(1.0f, scores[k]) * factor);
    }
  }
  return out;
}

void scaled_size(const RenderedView& view, double scale, int& w, int& h) {
  w = std::max(1, static_cast<int>(std::lround(view.labels.width * scale)));
  h = std::max(1, static_cast<int>(std::lround(view.labels.height * scale)));
}

}  // namespace

std::vector<ObjectConfusion> draw_object_confusions(const std::vector<RenderedView>& views, const RoomModel& room,
                                                    const SemanticTeacherSettings& s, Random random) {
  constexpr int kDraws = 256;
  constexpr double kLargeAreClearer = 0.8;  // confused share of the pixels over that of the objects
  constexpr double kPresent = 1e-3;         // share of the pixels from which a class counts, as in the acceptance check
  std::vector<double> pixels(room.objects.size(), 0);
  std::map<uint16_t, double> class_pixels;
  double things = 0, all = 0;
  for (const RenderedView& view : views) {
    for (size_t i = 0; i < view.instances.data.size(); ++i) {
      const uint16_t object = view.instances.data[i];
      if (object >= room.objects.size()) continue;
      all += 1;
      const uint16_t label = room.objects[object].label;
      if (is_stuff(label)) continue;
      pixels[object] += 1;
      class_pixels[label] += 1;
      things += 1;
    }
  }
  std::vector<ObjectConfusion> best(room.objects.size());
  double best_error = 1e9;
  for (int attempt = 0; attempt < kDraws && things > 0; ++attempt) {
    std::vector<ObjectConfusion> draw(room.objects.size());
    double share = 0, class_share = 0, classes = 0;
    std::map<uint16_t, double> confused_pixels;
    for (size_t i = 0; i < draw.size(); ++i) {
      const std::vector<uint16_t> others = confusable_classes(room.objects[i].label);
      if (others.empty()) continue;
      const bool confused = random.chance(s.confused_share), ambiguous = random.chance(0.4);
      // The likeliest confusion half of the time, the others share the rest.
      const size_t other = random.chance(0.5) ? 0 : static_cast<size_t>(random.below(static_cast<int>(others.size())));
      if (!confused) continue;
      draw[i] = {true, ambiguous, others[other]};
      share += pixels[i] / things;
      confused_pixels[room.objects[i].label] += pixels[i];
    }
    for (const auto& [label, count] : class_pixels) {
      if (count < kPresent * all) continue;
      class_share += confused_pixels[label] / count;
      classes += 1;
    }
    if (classes > 0) class_share /= classes;
    const double error =
        std::fabs(share - kLargeAreClearer * s.confused_share) + std::fabs(class_share - s.confused_share);
    if (error < best_error) best_error = error, best = std::move(draw);
  }
  return best;
}

SemanticTeacherSettings semantic_teacher_settings(TeacherLevel level) {
  SemanticTeacherSettings s;
  const bool low = level == TeacherLevel::kLow, high = level == TeacherLevel::kHigh;
  s.outline_rms = low ? 2 : (high ? 6 : 3.5);
  s.confused_share = low ? 0.15 : (high ? 0.30 : 0.22);
  return s;
}

float ScoreMap::score(int channel, int x, int y) const {
  return half_to_float(values[(static_cast<size_t>(channel) * height + y) * width + x]);
}

std::vector<ScoreMap> simulate_semantic_teacher(const std::vector<RenderedView>& views, const RoomModel& room,
                                                const SemanticTeacherSettings& settings, double scale, Random random,
                                                ThreadPool& pool) {
  const std::vector<ObjectConfusion> confusions =
      draw_object_confusions(views, room, settings, stream_of(random, ClassPurpose::kConfusions));
  std::vector<ScoreMap> out(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      int w = 0, h = 0;
      scaled_size(views[i], scale, w, h);
      out[i] = one_view(views[i], confusions, settings, w, h, random.fork(1000 + i));
    }
  });
  return out;
}

std::vector<ScoreMap> exact_semantic_teacher(const std::vector<RenderedView>& views, double scale, ThreadPool& pool) {
  constexpr float kTop = 0.97f;
  std::vector<ScoreMap> out(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Image<uint16_t>& labels = views[i].labels;
      ScoreMap& s = out[i];
      scaled_size(views[i], scale, s.width, s.height);
      s.channels = ade20k_labels().size();
      std::vector<float> sums(static_cast<size_t>(s.channels) * s.width * s.height, 0.0f);
      for (int y = 0; y < s.height; ++y) {
        const int y0 = y * labels.height / s.height, y1 = std::max(y0 + 1, (y + 1) * labels.height / s.height);
        for (int x = 0; x < s.width; ++x) {
          const int x0 = x * labels.width / s.width, x1 = std::max(x0 + 1, (x + 1) * labels.width / s.width);
          const float share = kTop / static_cast<float>((x1 - x0) * (y1 - y0));
          for (int v = y0; v < y1; ++v) {
            for (int u = x0; u < x1; ++u) {
              const uint16_t label = labels.at(u, v);
              if (label != kNoLabel) sums[(static_cast<size_t>(label) * s.height + y) * s.width + x] += share;
            }
          }
        }
      }
      s.values.resize(sums.size());
      for (size_t k = 0; k < sums.size(); ++k) s.values[k] = float_to_half(sums[k]);
    }
  });
  return out;
}

Image<uint16_t> semantic_labels(const ScoreMap& s, int width, int height) {
  Image<uint16_t> labels(width, height, 1, kNoLabel);
  const size_t n = static_cast<size_t>(s.width) * s.height;
  std::vector<int> present;  // classes with any score: most of the 150 have none
  for (int c = 0; c < s.channels; ++c) {
    const auto first = s.values.begin() + static_cast<std::ptrdiff_t>(c * n);
    if (std::any_of(first, first + static_cast<std::ptrdiff_t>(n), [](uint16_t v) { return v != 0; }))
      present.push_back(c);
  }
  ImageF planes(s.width, s.height, static_cast<int>(present.size()));
  for (size_t k = 0; k < present.size(); ++k) {
    for (size_t i = 0; i < n; ++i)
      planes.data[i * present.size() + k] = half_to_float(s.values[static_cast<size_t>(present[k]) * n + i]);
  }
  for (int y = 0; y < height; ++y) {
    const double v = std::clamp((y + 0.5) * s.height / height - 0.5, 0.0, s.height - 1.0);
    const int j = static_cast<int>(v), j1 = std::min(j + 1, s.height - 1);
    for (int x = 0; x < width; ++x) {
      const double u = std::clamp((x + 0.5) * s.width / width - 0.5, 0.0, s.width - 1.0);
      const int i = static_cast<int>(u), i1 = std::min(i + 1, s.width - 1);
      const float a = static_cast<float>(u - i), b = static_cast<float>(v - j);
      float best = 0, sum = 0;
      for (size_t k = 0; k < present.size(); ++k) {
        const int c = static_cast<int>(k);
        const float value = (planes.at(i, j, c) * (1 - a) + planes.at(i1, j, c) * a) * (1 - b) +
                            (planes.at(i, j1, c) * (1 - a) + planes.at(i1, j1, c) * a) * b;
        sum += value;
        if (value > best) best = value, labels.at(x, y) = static_cast<uint16_t>(present[k]);
      }
      if (sum < kUnknown) labels.at(x, y) = kNoLabel;
    }
  }
  return labels;
}

}  // namespace aligngs
