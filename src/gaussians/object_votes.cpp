#include "gaussians/object_votes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "gaussians/density_links.h"
#include "gaussians/soft_labels.h"
#include "gaussians/voted_pieces.h"

namespace aligngs {
namespace {

constexpr size_t kVoteGrain = 256;  // Gaussians or pieces per chunk

/// Sightings of the Gaussians of one class, by their place among its rows.
using ClassSightings = std::vector<std::pair<uint32_t, PieceView>>;

/// Cells of a grid, each of one group of the density links. kNoPiece for noise.
std::vector<uint32_t> cells_of(const std::vector<Vec3f>& points, const DensityLinks& links, double side,
                               size_t& count) {
  std::map<std::tuple<uint32_t, int64_t, int64_t, int64_t>, uint32_t> known;
  std::vector<uint32_t> cell(points.size(), kNoPiece);
  for (size_t i = 0; i < points.size(); ++i) {
    if (links.group[i] == DensityLinks::kNoise) continue;
    const auto at = [&](float x) { return static_cast<int64_t>(std::floor(static_cast<double>(x) / side)); };
    const auto key = std::tuple(links.group[i], at(points[i].x), at(points[i].y), at(points[i].z));
    cell[i] = known.emplace(key, static_cast<uint32_t>(known.size())).first->second;
  }
  count = known.size();
  return cell;
}

/// Gaussians at borders go to the object, of those around them, in whose segments the photos show most of them: cells
/// are coarser than outlines.
void settle_borders(const DensityLinks& links, const ClassSightings& sightings, ThreadPool& pool,
                    std::vector<uint32_t>& group) {
  constexpr int kRounds = 2;  // each reaches as far as a link, which is about a cell
  const size_t n = group.size();
  std::vector<std::vector<PieceView>> seen(n);
  for (const auto& [i, view] : sightings) {
    if (view.is_thing()) seen[i].push_back(view);
  }
  for (int round = 0; round < kRounds; ++round) {
    std::map<std::pair<uint32_t, uint16_t>, std::map<uint32_t, double>> shares;  // of a segment, by object
    for (size_t i = 0; i < n; ++i) {
      for (const PieceView& v : seen[i]) {
        if (group[i] != DensityLinks::kNoise) shares[{v.photo, v.segment}][group[i]] += v.pixels;
      }
    }
    for (auto& [segment, objects] : shares) {
      double all = 0;
      for (const auto& [object, pixels] : objects) all += pixels;
      for (auto& [object, pixels] : objects) pixels /= all;
    }
    const std::vector<uint32_t> before = group;
    pool.parallel_for(n, kVoteGrain, [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        if (before[i] == DensityLinks::kNoise || seen[i].empty()) continue;
        std::map<uint32_t, double> scores = {{before[i], 0.0}};
        for (const uint32_t j : links.near[i]) {
          if (before[j] != DensityLinks::kNoise) scores.emplace(before[j], 0.0);
        }
        if (scores.size() == 1) continue;
        for (const PieceView& v : seen[i]) {
          for (const auto& [object, share] : shares.at({v.photo, v.segment})) {
            const auto candidate = scores.find(object);
            if (candidate != scores.end()) candidate->second += v.pixels * share;
          }
        }
        for (const auto& [object, score] : scores) {
          if (score > scores[group[i]]) group[i] = object;
        }
      }
    });
  }
}

std::vector<uint32_t> voted_groups(const std::vector<Vec3f>& points, const DensityLinks& links,
                                   const ClassSightings& sightings, const InstanceOptions& options,
                                   const ObjectVoteOptions& votes, ThreadPool& pool) {
  const bool any = std::any_of(sightings.begin(), sightings.end(), [](const auto& s) { return s.second.is_thing(); });
  if (!any || !(links.reach > 0)) return links.group;
  size_t count = 0;
  const std::vector<uint32_t> cell = cells_of(points, links, votes.cell * static_cast<double>(links.reach), count);
  std::vector<size_t> sizes(count, 0);
  for (const uint32_t c : cell) {
    if (c != kNoPiece) ++sizes[c];
  }
  std::vector<PieceViews> views(count);
  for (const auto& [i, view] : sightings) {
    if (cell[i] != kNoPiece) views[cell[i]].push_back(view);
  }
  pool.parallel_for(count, kVoteGrain, [&](size_t begin, size_t end, int) {
    for (size_t c = begin; c < end; ++c) {
      std::stable_sort(views[c].begin(), views[c].end(), before);
      PieceViews once;
      for (const PieceView& v : views[c]) {
        if (!once.empty() && !before(once.back(), v))
          once.back().pixels += v.pixels;
        else
          once.push_back(v);
      }
      views[c] = std::move(once);
    }
  });
  std::vector<PieceLink> touching;
  for (uint32_t i = 0; i < points.size(); ++i) {
    if (cell[i] == kNoPiece) continue;
    for (const uint32_t j : links.near[i]) {
      if (cell[j] == kNoPiece || cell[j] == cell[i] || !links.core[j]) continue;
      touching.push_back({std::min(cell[i], cell[j]), std::max(cell[i], cell[j]), true, 0});
      if (!links.core[i]) break;  // hangs on its nearest core point alone
    }
  }
  Pieces pieces(std::move(views), std::move(sizes), votes, pool);
  pieces.join(std::move(touching));
  pieces.join(pieces.links_by_segments(options.min_gaussians));
  size_t largest = 0;
  for (uint32_t c = 0; c < count; ++c) {
    if (pieces.of(c) == c) largest = std::max(largest, pieces.size(c));
  }
  pieces.join_small(std::max(options.min_gaussians,
                             static_cast<size_t>(std::ceil(options.min_share * static_cast<double>(largest)))));

  std::vector<uint32_t> group(points.size(), DensityLinks::kNoise), first(count, kNoPiece);
  for (uint32_t i = 0; i < points.size(); ++i) {
    if (cell[i] == kNoPiece) continue;
    uint32_t& smallest = first[pieces.of(cell[i])];
    if (smallest == kNoPiece) smallest = i;
    group[i] = smallest;
  }
  settle_borders(links, sightings, pool, group);
  return group;
}

}  // namespace

std::vector<Instance> vote_instances(const GaussianModel& model, GaussianLabels& labels,
                                     const std::vector<PhotoSegments>& photos, double extent,
                                     const InstanceOptions& options, const ObjectVoteOptions& votes, ThreadPool& pool) {
  const std::vector<Vec3f> positions = positions_of(model);
  labels.instance.assign(positions.size(), 0);
  const std::map<uint16_t, std::vector<uint32_t>> rows = rows_by_class(model, labels, options);
  std::vector<uint32_t> place(positions.size(), kNoPiece);  // of a row among those of its class
  for (const auto& [label, members] : rows) {
    for (uint32_t i = 0; i < members.size(); ++i) place[members[i]] = i;
  }
  std::map<uint16_t, ClassSightings> sightings;
  for (uint32_t p = 0; p < photos.size(); ++p) {
    for (const SegmentSighting& s : photos[p].seen) {
      if (s.gaussian >= place.size() || place[s.gaussian] == kNoPiece || !(s.pixels > 0)) continue;
      const bool thing = s.segment != SegmentMap::kNone && photos[p].segments.at(s.segment).is_thing();
      const PieceView view = {p, thing ? s.segment : SegmentMap::kNone,
                              thing ? photos[p].segments[s.segment].label : uint16_t(0), static_cast<double>(s.pixels)};
      sightings[labels.label[s.gaussian]].push_back({place[s.gaussian], view});
    }
  }
  for (const auto& [label, members] : rows) {
    std::vector<Vec3f> points;
    for (const uint32_t i : members) points.push_back(positions[i]);
    const DensityLinks links = density_links(points, extent, options, pool);
    number_groups(members, voted_groups(points, links, sightings[label], options, votes, pool), options, labels);
  }
  return list_instances(model, labels);
}

}  // namespace aligngs
