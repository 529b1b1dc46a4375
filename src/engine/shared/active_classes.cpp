#include "engine/shared/active_classes.h"

#include <algorithm>
#include <cmath>

#include "core/half.h"
#include "scene/semantic_target.h"

namespace aligngs {
namespace {

constexpr size_t kPixelsPerTask = 4096;

/// Sets seen[c] for the top_k classes of each pixel of [begin, end).
void mark_top_classes(const SemanticTarget& target, int top_k, size_t begin, size_t end, std::vector<uint8_t>& seen) {
  const size_t channels = static_cast<size_t>(target.channels), k = std::min(static_cast<size_t>(top_k), channels);
  std::vector<std::pair<float, size_t>> best(k);
  for (size_t i = begin; i < end; ++i) {
    if (!target.confidence.empty() && !(target.confidence[i] > 0)) continue;
    const uint16_t* row = &target.probabilities[i * channels];
    std::fill(best.begin(), best.end(), std::pair<float, size_t>{0.0f, channels});
    for (size_t c = 0; c < channels; ++c) {
      const float p = half_to_float(row[c]);
      if (!(p > best.back().first)) continue;
      size_t at = k - 1;
      for (; at > 0 && p > best[at - 1].first; --at) best[at] = best[at - 1];
      best[at] = {p, c};
    }
    for (const auto& [p, c] : best) {
      if (c < channels) seen[c] = 1;
    }
  }
}

/// Index of each class among the channels.
std::vector<size_t> channel_of_class(const ActiveClasses& map) {
  std::vector<size_t> channel(static_cast<size_t>(map.classes), map.active.size());
  for (size_t k = 0; k < map.active.size(); ++k) channel[map.active[k]] = k;
  return channel;
}

float common_number(RowKind kind, const float* row, const std::vector<size_t>& members) {
  const float first = row[members[0]];
  double top = static_cast<double>(first), sum = 0;
  bool equal = true;
  for (const size_t c : members) {
    equal = equal && row[c] == first;
    top = std::max(top, static_cast<double>(row[c]));
  }
  if (equal) return first;
  for (const size_t c : members) {
    const double x = static_cast<double>(row[c]);
    sum += kind == RowKind::kLogits ? std::exp(x - top) : x;
  }
  const double mean = sum / static_cast<double>(members.size());
  return static_cast<float>(kind == RowKind::kLogits ? top + std::log(mean) : mean);
}

}  // namespace

ActiveClasses find_active_classes(const std::vector<TrainingView>& views, int top_k, ThreadPool& pool) {
  ActiveClasses map;
  for (const TrainingView& view : views) {
    const SemanticTarget& target = view.data.semantics;
    if (target.empty()) continue;
    if (map.classes != 0 && map.classes != target.channels) return {};
    map.classes = target.channels;
  }
  if (top_k <= 0 || map.classes == 0) return map;
  std::vector<uint8_t> seen(static_cast<size_t>(map.classes), 0);
  for (const TrainingView& view : views) {
    const SemanticTarget& target = view.data.semantics;
    if (target.empty()) continue;
    const size_t pixels = size_t(target.width) * target.height;
    std::vector<std::vector<uint8_t>> marks((pixels + kPixelsPerTask - 1) / kPixelsPerTask);
    pool.parallel_for(pixels, kPixelsPerTask, [&](size_t begin, size_t end, int) {
      std::vector<uint8_t>& mark = marks[begin / kPixelsPerTask];
      mark.assign(seen.size(), 0);
      mark_top_classes(target, top_k, begin, end, mark);
    });
    for (const std::vector<uint8_t>& mark : marks) {
      for (size_t c = 0; c < seen.size(); ++c) seen[c] |= mark[c];
    }
  }
  const size_t active = static_cast<size_t>(std::count(seen.begin(), seen.end(), uint8_t(1)));
  if (active == 0 || seen.size() < active + 2) return map;
  for (size_t c = 0; c < seen.size(); ++c) {
    if (seen[c] != 0) map.active.push_back(static_cast<uint16_t>(c));
  }
  return map;
}

void compress_target(const ActiveClasses& map, ThreadPool& pool, SemanticTarget& target) {
  if (!map.has_remainder() || target.empty()) return;
  const size_t classes = static_cast<size_t>(map.classes), channels = static_cast<size_t>(map.channels());
  const size_t pixels = size_t(target.width) * target.height;
  const std::vector<size_t> channel = channel_of_class(map);
  std::vector<uint16_t> compact(pixels * channels);
  pool.parallel_for(pixels, kPixelsPerTask, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const uint16_t* from = &target.probabilities[i * classes];
      uint16_t* to = &compact[i * channels];
      float rest = 0;
      for (size_t c = 0; c < classes; ++c) {
        if (channel[c] + 1 < channels) {
          to[channel[c]] = from[c];
        } else {
          rest += half_to_float(from[c]);
        }
      }
      to[channels - 1] = float_to_half(rest);
    }
  });
  target.probabilities = std::move(compact);
  target.channels = static_cast<int>(channels);
  normalise_target(target);
}

std::vector<float> compress_rows(const ActiveClasses& map, RowKind kind, const std::vector<float>& rows) {
  if (!map.has_remainder()) return rows;
  const size_t classes = static_cast<size_t>(map.classes), channels = static_cast<size_t>(map.channels());
  const std::vector<size_t> channel = channel_of_class(map);
  std::vector<size_t> members;
  for (size_t c = 0; c < classes; ++c) {
    if (channel[c] + 1 == channels) members.push_back(c);
  }
  std::vector<float> out(rows.size() / classes * channels);
  for (size_t i = 0; i < rows.size() / classes; ++i) {
    const float* from = &rows[i * classes];
    float* to = &out[i * channels];
    for (size_t k = 0; k < map.active.size(); ++k) to[k] = from[map.active[k]];
    to[channels - 1] = common_number(kind, from, members);
  }
  return out;
}

std::vector<float> expand_rows(const ActiveClasses& map, const std::vector<float>& rows) {
  if (!map.has_remainder()) return rows;
  const size_t classes = static_cast<size_t>(map.classes), channels = static_cast<size_t>(map.channels());
  const std::vector<size_t> channel = channel_of_class(map);
  std::vector<float> out(rows.size() / channels * classes);
  for (size_t i = 0; i < rows.size() / channels; ++i) {
    for (size_t c = 0; c < classes; ++c) out[i * classes + c] = rows[i * channels + channel[c]];
  }
  return out;
}

}  // namespace aligngs
