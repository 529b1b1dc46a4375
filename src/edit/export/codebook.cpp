#include "edit/export/codebook.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aligngs {

std::vector<float> scalar_codebook(const std::vector<float>& values) {
  constexpr size_t kLevels = 256, kMostSamples = 1 << 18;
  constexpr int kRounds = 12;
  std::vector<float> sorted;
  const size_t step = std::max<size_t>(1, values.size() / kMostSamples);
  for (size_t i = 0; i < values.size(); i += step) sorted.push_back(values[i]);
  std::sort(sorted.begin(), sorted.end());
  std::vector<float> levels(kLevels, 0.f);
  if (sorted.empty()) return levels;
  for (size_t k = 0; k < kLevels; ++k)
    levels[k] = sorted[std::min(sorted.size() - 1, (2 * k + 1) * sorted.size() / (2 * kLevels))];
  levels.front() = sorted.front();
  levels.back() = sorted.back();
  for (int round = 0; round < kRounds; ++round) {
    size_t begin = 0;
    for (size_t k = 0; k < kLevels; ++k) {
      size_t end = sorted.size();
      if (k + 1 < kLevels) {
        const float border = 0.5f * (levels[k] + levels[k + 1]);
        end = static_cast<size_t>(
            std::upper_bound(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.end(), border) -
            sorted.begin());
      }
      double sum = 0;
      for (size_t i = begin; i < end; ++i) sum += sorted[i];
      if (end > begin) levels[k] = static_cast<float>(sum / static_cast<double>(end - begin));
      begin = end;
    }
    std::sort(levels.begin(), levels.end());
  }
  return levels;
}

uint8_t nearest_level(const std::vector<float>& codebook, float value) {
  const auto above = std::lower_bound(codebook.begin(), codebook.end(), value);
  if (above == codebook.begin()) return 0;
  if (above == codebook.end()) return static_cast<uint8_t>(codebook.size() - 1);
  const size_t i = static_cast<size_t>(above - codebook.begin());
  return static_cast<uint8_t>(value - codebook[i - 1] <= codebook[i] - value ? i - 1 : i);
}

Palette make_palette(const std::vector<float>& rows, size_t width, size_t count, int rounds, ThreadPool& pool) {
  constexpr size_t kGrain = 256;  // rows per chunk
  Palette palette;
  palette.width = width;
  const size_t n = width ? rows.size() / width : 0;
  count = std::min(count, n);
  palette.index.assign(n, 0);
  for (size_t k = 0; k < count; ++k) {
    const float* row = &rows[(k * n / count) * width];
    palette.entries.insert(palette.entries.end(), row, row + width);
  }
  for (int round = 0; round < rounds && count > 0; ++round) {
    pool.parallel_for(n, kGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        float best = std::numeric_limits<float>::infinity();
        for (size_t k = 0; k < count; ++k) {
          float distance = 0;
          for (size_t d = 0; d < width; ++d) {
            const float x = rows[i * width + d] - palette.entries[k * width + d];
            distance += x * x;
          }
          if (distance < best) {
            best = distance;
            palette.index[i] = static_cast<uint16_t>(k);
          }
        }
      }
    });
    if (round + 1 == rounds) break;  // the indices belong to the entries as they are
    std::vector<double> sum(count * width, 0.0);
    std::vector<size_t> members(count, 0);
    for (size_t i = 0; i < n; ++i) {
      ++members[palette.index[i]];
      for (size_t d = 0; d < width; ++d) sum[palette.index[i] * width + d] += rows[i * width + d];
    }
    for (size_t k = 0; k < count; ++k) {
      if (members[k] == 0) continue;
      for (size_t d = 0; d < width; ++d)
        palette.entries[k * width + d] = static_cast<float>(sum[k * width + d] / static_cast<double>(members[k]));
    }
  }
  return palette;
}

}  // namespace aligngs
