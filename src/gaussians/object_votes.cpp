#include "gaussians/object_votes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/disjoint_sets.h"
#include "gaussians/density_links.h"
#include "gaussians/soft_labels.h"

namespace aligngs {
namespace {

constexpr uint32_t kNoPiece = ~0u;
constexpr size_t kLinkGrain = 256;  // links per chunk

/// Pixels of a piece in a segment of a photo.
struct PieceView {
  uint32_t photo = 0;
  uint16_t segment = 0;  ///< SegmentMap::kNone: in no segment of a thing
  uint16_t label = 0;    ///< class that the photo gives the segment
  double pixels = 0;
  bool is_thing() const { return segment != SegmentMap::kNone; }
};
using PieceViews = std::vector<PieceView>;  // by photo, then segment

bool before(const PieceView& a, const PieceView& b) {
  return std::tie(a.photo, a.segment) < std::tie(b.photo, b.segment);
}

PieceViews joined(const PieceViews& a, const PieceViews& b) {
  PieceViews out;
  size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    if (j == b.size() || (i < a.size() && before(a[i], b[j]))) {
      out.push_back(a[i++]);
    } else if (i == a.size() || before(b[j], a[i])) {
      out.push_back(b[j++]);
    } else {
      out.push_back(a[i++]);
      out.back().pixels += b[j++].pixels;
    }
  }
  return out;
}

size_t end_of_photo(const PieceViews& views, size_t begin) {
  size_t end = begin;
  while (end < views.size() && views[end].photo == views[begin].photo) ++end;
  return end;
}

/// Votes of the photos for joining two pieces.
double votes_for(const PieceViews& a, const PieceViews& b, double enough) {
  double votes = 0;
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (a[i].photo != b[j].photo) {
      (a[i].photo < b[j].photo ? i : j) = a[i].photo < b[j].photo ? end_of_photo(a, i) : end_of_photo(b, j);
      continue;
    }
    const size_t i_end = end_of_photo(a, i), j_end = end_of_photo(b, j);
    double all_a = 0, all_b = 0, same = 0, other = 0;
    for (size_t k = i; k < i_end; ++k) all_a += a[k].pixels;
    for (size_t k = j; k < j_end; ++k) all_b += b[k].pixels;
    for (size_t k = i; k < i_end; ++k) {
      for (size_t l = j; l < j_end; ++l) {
        if (!a[k].is_thing() || !b[l].is_thing()) continue;
        const double both = a[k].pixels * b[l].pixels;
        if (a[k].segment == b[l].segment)
          same += both;
        else if (a[k].label == b[l].label)
          other += both;
      }
    }
    votes += (same - other) / (all_a * all_b) * std::min(1.0, std::min(all_a, all_b) / enough);
    i = i_end;
    j = j_end;
  }
  return votes;
}

/// Two pieces that may join; a < b.
struct PieceLink {
  uint32_t a = 0, b = 0;
  bool touches = false;
  double votes = 0;
};

/// An order of links with equal votes in which neighbours of one piece are far apart.
uint64_t shuffled(const PieceLink& link) {
  uint64_t x = (uint64_t(link.a) << 32 | link.b) + 0x9e3779b97f4a7c15ull;  // splitmix64 (Steele et al. 2014)
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

bool stronger(const PieceLink& a, const PieceLink& b) {
  if (a.votes != b.votes) return a.votes > b.votes;
  return shuffled(a) > shuffled(b);
}

/// Pieces of one class that join.
class Pieces {
 public:
  Pieces(std::vector<PieceViews> views, std::vector<size_t> sizes, const ObjectVoteOptions& options, ThreadPool& pool)
      : views_(std::move(views)), sizes_(std::move(sizes)), sets_(views_.size()), options_(options), pool_(pool) {}

  uint32_t of(uint32_t cell) { return sets_.find(cell); }
  size_t size(uint32_t piece) const { return sizes_[piece]; }

  /// Joins each time all pairs that are each other's best, until no votes are for joining.
  void join(std::vector<PieceLink> links) {
    while (true) {
      renew(links);
      std::vector<uint32_t> best(views_.size(), kNoPiece);
      for (uint32_t l = 0; l < links.size(); ++l) {
        for (const uint32_t piece : {links[l].a, links[l].b}) {
          if (best[piece] == kNoPiece || stronger(links[l], links[best[piece]])) best[piece] = l;
        }
      }
      bool any = false;
      for (uint32_t l = 0; l < links.size(); ++l) {
        if (!(links[l].votes > 0) || best[links[l].a] != l || best[links[l].b] != l) continue;
        unite(links[l].a, links[l].b);
        any = true;
      }
      if (!any) break;
    }
    links_ = std::move(links);
  }

  /// Links between pieces of at least `least` members that touch nothing of each other, but share a segment.
  std::vector<PieceLink> links_by_segments(size_t least) {
    std::map<std::pair<uint32_t, uint16_t>, std::vector<uint32_t>> by_segment;
    for (uint32_t c = 0; c < views_.size(); ++c) {
      if (of(c) != c || sizes_[c] < least) continue;
      for (size_t i = 0; i < views_[c].size();) {
        const size_t end = end_of_photo(views_[c], i);
        const auto most = std::max_element(views_[c].begin() + static_cast<std::ptrdiff_t>(i),
                                           views_[c].begin() + static_cast<std::ptrdiff_t>(end),
                                           [](const auto& x, const auto& y) { return x.pixels < y.pixels; });
        if (most->is_thing()) by_segment[{most->photo, most->segment}].push_back(c);
        i = end;
      }
    }
    std::vector<PieceLink> links = links_;
    for (const auto& [segment, pieces] : by_segment) {
      for (size_t i = 0; i < pieces.size(); ++i) {
        for (size_t j = i + 1; j < pieces.size(); ++j) links.push_back({pieces[i], pieces[j], false, 0});
      }
    }
    return links;
  }

  /// Pieces of fewer than `least` members join the touching piece of more for which most votes are.
  void join_small(size_t least) {
    renew(links_);
    std::map<uint32_t, PieceLink> best;  // by small piece
    for (const PieceLink& link : links_) {
      for (const auto& [small, large] : {std::pair(link.a, link.b), std::pair(link.b, link.a)}) {
        if (!link.touches || sizes_[small] >= least || sizes_[large] < least) continue;
        const auto known = best.find(small);
        if (known == best.end() || stronger(link, known->second)) best[small] = link;
      }
    }
    for (const auto& [small, link] : best) unite(of(link.a), of(link.b));
  }

 private:
  /// Brings links to the pieces of now: one for each pair, with its votes.
  void renew(std::vector<PieceLink>& links) {
    for (PieceLink& link : links) {
      const uint32_t a = of(link.a), b = of(link.b);
      link.a = std::min(a, b);
      link.b = std::max(a, b);
    }
    std::erase_if(links, [](const PieceLink& l) { return l.a == l.b; });
    std::sort(links.begin(), links.end(), [](const auto& x, const auto& y) {
      return std::tuple(x.a, x.b, !x.touches) < std::tuple(y.a, y.b, !y.touches);
    });
    links.erase(
        std::unique(links.begin(), links.end(), [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; }),
        links.end());
    pool_.parallel_for(links.size(), kLinkGrain, [&](size_t begin, size_t end, int) {
      for (size_t l = begin; l < end; ++l) {
        links[l].votes = votes_for(views_[links[l].a], views_[links[l].b], options_.enough_pixels) +
                         (links[l].touches ? options_.touching : -options_.apart);
      }
    });
  }

  void unite(uint32_t a, uint32_t b) {
    if (a == b) return;
    sets_.unite(a, b);
    const uint32_t kept = sets_.find(a), gone = kept == a ? b : a;
    views_[kept] = joined(views_[kept], views_[gone]);
    views_[gone].clear();
    sizes_[kept] += sizes_[gone];
  }

  std::vector<PieceViews> views_;
  std::vector<size_t> sizes_;
  DisjointSets sets_;
  ObjectVoteOptions options_;
  ThreadPool& pool_;
  std::vector<PieceLink> links_;
};

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
    pool.parallel_for(n, kLinkGrain, [&](size_t begin, size_t end, int) {
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
  pool.parallel_for(count, kLinkGrain, [&](size_t begin, size_t end, int) {
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
