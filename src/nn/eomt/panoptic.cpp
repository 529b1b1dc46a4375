#include "nn/eomt/panoptic.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "nn/cpu/row_kernels.h"
#include "nn/ops/resize.h"

namespace aligngs::nn {
namespace {

/// A query whose best class is one, and sure enough.
struct Candidate {
  int64_t query;
  int category;
  float score;
};

std::vector<Candidate> candidates_of(const Matrix& classes, double threshold) {
  Matrix shares = classes;
  softmax_rows(shares.data.data(), shares.rows, shares.columns);
  std::vector<Candidate> out;
  for (int64_t q = 0; q < shares.rows; ++q) {
    const float* const row = shares.row(q);
    const auto best = int(std::max_element(row, row + shares.columns) - row);
    if (best + 1 < shares.columns && double(row[best]) > threshold) out.push_back({q, best, row[best]});
  }
  return out;
}

/// The masks of the candidates alone, in their order.
FeatureMap masks_of(const FeatureMap& masks, const std::vector<Candidate>& candidates) {
  FeatureMap out(masks.height, masks.width, int64_t(candidates.size()));
  for (int64_t p = 0; p < masks.places(); ++p) {
    const float* const from = masks.data.data() + p * masks.channels;
    for (size_t k = 0; k < candidates.size(); ++k)
      out.data[size_t(p) * candidates.size() + k] = from[candidates[k].query];
  }
  return out;
}

/// Who wins each pixel, and how many pixels each has.
struct Ownership {
  std::vector<int> owner;       ///< candidate per pixel
  std::vector<uint8_t> inside;  ///< whether the pixel lies in its owner's mask
  std::vector<int64_t> own, mask, both;
};

Ownership ownership_of(Compute& compute, const FeatureMap& logits, const std::vector<Candidate>& candidates, int width,
                       int height) {
  constexpr float kHalf = 0.5f;
  constexpr int64_t kBand = 64;  // rows at a time: masks at the size of the photo are large
  const ResampleAxis rows = bilinear_axis(logits.height, height, false);
  const ResampleAxis columns = bilinear_axis(logits.width, width, false);
  const size_t n = candidates.size();
  Ownership out;
  out.own = out.mask = out.both = std::vector<int64_t>(n);
  for (int64_t begin = 0; begin < height; begin += kBand) {
    const FeatureMap band =
        resample(compute, logits, part_of_axis(rows, begin, std::min<int64_t>(kBand, height - begin)), columns);
    for (int64_t p = 0; p < band.places(); ++p) {
      const float* const v = band.data.data() + size_t(p) * n;
      size_t owner = 0;
      float best = -1;
      bool inside = false;
      for (size_t k = 0; k < n; ++k) {
        const float share = 1 / (1 + std::exp(-v[k])), worth = candidates[k].score * share;
        const bool hot = share >= kHalf;
        out.mask[k] += hot;
        if (!(worth > best)) continue;
        best = worth;
        owner = k;
        inside = hot;
      }
      out.owner.push_back(int(owner));
      out.inside.push_back(inside);
      ++out.own[owner];
      out.both[owner] += inside;
    }
  }
  return out;
}

}  // namespace

PanopticMap panoptic_map(Compute& compute, const EomtPrediction& prediction, const EomtPadded& padded, int width,
                         int height, const PanopticOptions& options) {
  PanopticMap out;
  out.width = width;
  out.height = height;
  const size_t pixels = size_t(width) * size_t(height);
  out.segments.assign(pixels, -1);
  out.categories.assign(pixels, int(prediction.classes.columns) - 1);
  const std::vector<Candidate> candidates = candidates_of(prediction.classes, options.class_threshold);
  if (candidates.empty()) return out;

  // Two resizes, as published: to the padded square, of which the photo is cut out, and to the result.
  const FeatureMap masks = masks_of(prediction.masks, candidates);
  const FeatureMap square =
      resample(compute, masks, part_of_axis(bilinear_axis(masks.height, padded.image.height, false), 0, padded.height),
               part_of_axis(bilinear_axis(masks.width, padded.image.width, false), 0, padded.width));
  const Ownership won = ownership_of(compute, square, candidates, width, height);

  std::vector<int> id_of(candidates.size(), -1);
  std::map<int, int> stuff_ids;
  for (size_t k = 0; k < candidates.size(); ++k) {
    const int category = candidates[k].category;
    const bool rejected = won.both[k] == 0 || double(won.own[k]) / double(won.mask[k]) < options.overlap_threshold;
    if (rejected) continue;  // what it won stays without a segment
    const bool stuff = std::find(options.stuff.begin(), options.stuff.end(), category) != options.stuff.end();
    const auto known = stuff ? stuff_ids.find(category) : stuff_ids.end();
    if (known != stuff_ids.end()) {
      id_of[k] = known->second;
      continue;
    }
    id_of[k] = int(out.list.size());
    out.list.push_back({id_of[k], category, candidates[k].score});
    if (stuff) stuff_ids[category] = id_of[k];
  }
  for (size_t p = 0; p < pixels; ++p) {
    const auto owner = size_t(won.owner[p]);
    if (id_of[owner] < 0 || won.inside[p] == 0) continue;
    out.segments[p] = id_of[owner];
    out.categories[p] = candidates[owner].category;
  }
  return out;
}

}  // namespace aligngs::nn
