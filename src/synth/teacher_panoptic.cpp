#include "synth/teacher_panoptic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/disjoint_sets.h"
#include "core/error.h"
#include "core/quantile.h"
#include "scene/stuff_classes.h"
#include "synth/class_confusions.h"
#include "synth/teacher_regions.h"

namespace aligngs {
namespace {

constexpr int kTouching = 2, kNearby = 10;                 // pixels between two things
constexpr size_t kContacts = 4;                            // pairs of pixels: fewer are corners that meet
constexpr size_t kLeastSegment = 6;                        // pixels: below the network's resolution
constexpr double kSmallThing = 0.015, kLargeThing = 0.06;  // of the image, as in the semantic teacher
constexpr double kLeastOwned = 0.8;  // of a mask's pixels that it must win, the publisher's overlap threshold

bool is_panoptic_stuff(uint16_t label) {
  const std::vector<int>& stuff = ade20k_stuff_classes();
  return std::binary_search(stuff.begin(), stuff.end(), int(label));
}

/// A region with the name that the network gives it.
struct NamedRegion {
  QueryRegion region;
  uint16_t label = 0;
};

/// Numbers of the things of each class, in the order in which they come; all of a stuff class is one.
class SegmentList {
 public:
  uint16_t add(uint16_t label) {
    if (!is_panoptic_stuff(label)) return append({label, static_cast<uint16_t>(things_[label]++)});
    const auto known = stuff_.find(label);
    return known != stuff_.end() ? known->second : stuff_[label] = append({label, Segment::kStuff});
  }
  std::vector<Segment> list;

 private:
  uint16_t append(const Segment& segment) {
    if (list.size() >= SegmentMap::kNone || (segment.is_thing() && things_[segment.label] > Segment::kStuff))
      throw_usage("a view shows more things of one class than a file of segments holds", "use fewer objects");
    list.push_back(segment);
    return static_cast<uint16_t>(list.size() - 1);
  }
  std::map<uint16_t, int> things_;
  std::map<uint16_t, uint16_t> stuff_;
};

/// Leaves out segments without pixels and brings the others into the order of the file.
SegmentMap tidied(SegmentMap map) {
  std::vector<uint8_t> seen(map.list.size(), 0);
  for (const uint16_t s : map.of_pixel) {
    if (s != SegmentMap::kNone) seen[s] = 1;
  }
  std::vector<uint16_t> order;
  for (size_t s = 0; s < map.list.size(); ++s) {
    if (seen[s]) order.push_back(static_cast<uint16_t>(s));
  }
  std::sort(order.begin(), order.end(), [&](uint16_t a, uint16_t b) {
    return std::pair(map.list[a].label, map.list[a].number) < std::pair(map.list[b].label, map.list[b].number);
  });
  std::vector<uint16_t> to(map.list.size(), SegmentMap::kNone);
  std::vector<Segment> list;
  for (const uint16_t s : order) {
    to[s] = static_cast<uint16_t>(list.size());
    list.push_back(map.list[s]);
  }
  for (uint16_t& s : map.of_pixel) s = s == SegmentMap::kNone ? s : to[s];
  map.list = std::move(list);
  return map;
}

/// Pairs of objects of one class with pixels at most `reach` columns or rows apart.
std::set<std::pair<int, int>> pairs_within(const RenderedView& view, const RoomModel& room, int reach) {
  std::map<std::pair<int, int>, size_t> contacts;
  const Image<uint16_t>& objects = view.instances;
  const auto look = [&](uint16_t a, uint16_t b) {
    if (a == b || a >= room.objects.size() || b >= room.objects.size()) return;
    if (room.objects[a].label == room.objects[b].label) ++contacts[{std::min(a, b), std::max(a, b)}];
  };
  for (int y = 0; y < objects.height; ++y) {
    for (int x = 0; x < objects.width; ++x) {
      for (int d = 1; d <= reach; ++d) {
        if (x + d < objects.width) look(objects.at(x, y), objects.at(x + d, y));
        if (y + d < objects.height) look(objects.at(x, y), objects.at(x, y + d));
      }
    }
  }
  std::set<std::pair<int, int>> pairs;
  for (const auto& [pair, count] : contacts) {
    if (count >= kContacts) pairs.insert(pair);
  }
  return pairs;
}

void join(const QueryRegion& from, QueryRegion& to) {
  for (size_t p = 0; p < to.mask.size(); ++p) to.mask[p] |= from.mask[p];
  to.x0 = std::min(to.x0, from.x0), to.x1 = std::max(to.x1, from.x1);
  to.y0 = std::min(to.y0, from.y0), to.y1 = std::max(to.y1, from.y1);
  to.pixels += from.pixels;
  to.depth_sum += from.depth_sum;
  to.border += from.border;
}

/// The part of a region on one side of a line.
QueryRegion part_of(const QueryRegion& region, int width, double normal_x, double normal_y, double offset, bool above) {
  QueryRegion part = region;
  part.pixels = 0;
  for (size_t p = 0; p < part.mask.size(); ++p) {
    if (!part.mask[p]) continue;
    const auto x = static_cast<double>(p % static_cast<size_t>(width)), y = std::floor(static_cast<double>(p) / width);
    if ((normal_x * x + normal_y * y > offset) != above) part.mask[p] = 0;
    part.pixels += part.mask[p];
  }
  return part;
}

/// The name of an object in a view; nothing when it gets no segment.
bool named(const QueryRegion& region, size_t image_pixels, const std::vector<ObjectConfusion>& confusions,
           const PanopticTeacherSettings& s, const SemanticTeacherSettings& semantic, Random& random, uint16_t& label) {
  const double share = static_cast<double>(region.pixels) / static_cast<double>(image_pixels);
  label = region.label;
  const bool missed = random.chance(share < kSmallThing   ? s.missed_small
                                    : share > kLargeThing ? s.missed_large
                                                          : s.missed);
  const bool applies = random.chance(semantic.confused_view_share), unsure = random.chance(s.unsure);
  const bool flip = random.chance(s.flip);
  const std::vector<uint16_t> others = confusable_classes(region.label);
  const size_t pick = others.empty() ? 0 : static_cast<size_t>(random.below(static_cast<int>(others.size())));
  if (region.key < 0) return true;  // wall, floor and ceiling are found
  if (missed || region.pixels < kLeastSegment) return false;
  const ObjectConfusion& confusion = confusions[static_cast<size_t>(region.key)];
  if (confusion.confused && applies) {
    if (confusion.ambiguous && unsure) return false;
    label = confusion.other;
  }
  if (flip && !others.empty()) label = others[pick];
  return true;
}

/// Regions as the network sees them: named, merged and split.
std::vector<NamedRegion> seen_regions(const RenderedView& view, const RoomModel& room,
                                      const std::vector<ObjectConfusion>& confusions, const PanopticTeacherSettings& s,
                                      const SemanticTeacherSettings& semantic, const Random& random) {
  const int width = view.labels.width;
  std::vector<NamedRegion> found;
  std::map<int, uint32_t> index;  // by object
  for (QueryRegion& region : query_regions(view)) {
    Random own = random.fork(static_cast<uint64_t>(region.key + 1000));
    uint16_t label = 0;
    if (!named(region, view.labels.pixels(), confusions, s, semantic, own, label)) continue;
    index[region.key] = static_cast<uint32_t>(found.size());
    found.push_back({std::move(region), label});
  }
  DisjointSets sets(found.size());
  const std::set<std::pair<int, int>> touching = pairs_within(view, room, kTouching);
  for (const auto& pair : pairs_within(view, room, kNearby)) {
    Random own = random.fork(static_cast<uint64_t>(100000 + 1000 * pair.first + pair.second));
    const bool merged = own.chance(touching.count(pair) ? s.merged : s.merged_apart);
    if (merged && index.count(pair.first) && index.count(pair.second))
      sets.unite(index[pair.first], index[pair.second]);
  }
  std::vector<NamedRegion> out;
  for (uint32_t i = 0; i < found.size(); ++i) {
    if (sets.find(i) != i) continue;
    NamedRegion all = found[i];
    for (uint32_t j = i + 1; j < found.size(); ++j) {
      if (sets.find(j) == i) join(found[j].region, all.region);
    }
    Random own = random.fork(static_cast<uint64_t>(all.region.key + 10000000));
    const bool split = own.chance(s.split) && !is_panoptic_stuff(all.region.label) && all.region.key >= 0;
    const double angle = own.uniform(0, 2 * 3.14159265358979), where = own.uniform(0.3, 0.7);
    const bool half_missed = own.chance(s.half_missed);
    if (!split) {
      out.push_back(std::move(all));
      continue;
    }
    const double nx = std::cos(angle), ny = std::sin(angle);
    std::vector<double> along;
    for (size_t p = 0; p < all.region.mask.size(); ++p) {
      if (all.region.mask[p])
        along.push_back(nx * static_cast<double>(p % static_cast<size_t>(width)) +
                        ny * std::floor(static_cast<double>(p) / width));
    }
    const double middle = quantile_of(std::move(along), where);
    for (const bool above : {false, true}) {
      NamedRegion part{part_of(all.region, width, nx, ny, middle, above), all.label};
      if (part.region.pixels >= kLeastSegment && !(above && half_missed)) out.push_back(std::move(part));
    }
  }
  return out;
}

/// The publisher's rule: pixels belong to the strongest mask, and a mask that wins too little of itself is dropped.
SegmentMap painted(const std::vector<NamedRegion>& regions, int w, int h, double outline_rms, const Random& random) {
  SegmentMap map;
  map.width = w;
  map.height = h;
  const size_t pixels = static_cast<size_t>(w) * static_cast<size_t>(h);
  std::vector<uint32_t> owner(pixels, 0);
  std::vector<float> strongest(pixels, 0.0f);
  std::vector<size_t> hot(regions.size(), 0), own(regions.size(), 0);
  for (size_t r = 0; r < regions.size(); ++r) {
    Random outline = random.fork(20000000 + r);
    const SoftMask mask = soft_mask(regions[r].region, w, h, w, h, outline_rms, outline);
    for (int y = 0; y < mask.value.height && mask.y0 + y < h; ++y) {
      for (int x = 0; x < mask.value.width && mask.x0 + x < w; ++x) {
        const size_t p = static_cast<size_t>(mask.y0 + y) * static_cast<size_t>(w) + static_cast<size_t>(mask.x0 + x);
        const float value = mask.value.at(x, y);
        hot[r] += value >= 0.5f;
        if (value > strongest[p]) strongest[p] = value, owner[p] = static_cast<uint32_t>(r);
      }
    }
  }
  for (size_t p = 0; p < pixels; ++p) own[owner[p]] += strongest[p] > 0;
  SegmentList segments;
  std::vector<uint16_t> id(regions.size(), SegmentMap::kNone);
  for (size_t r = 0; r < regions.size(); ++r) {
    if (hot[r] > 0 && static_cast<double>(own[r]) >= kLeastOwned * static_cast<double>(hot[r]))
      id[r] = segments.add(regions[r].label);
  }
  map.list = std::move(segments.list);
  map.of_pixel.assign(pixels, SegmentMap::kNone);
  for (size_t p = 0; p < pixels; ++p) {
    if (strongest[p] >= 0.5f) map.of_pixel[p] = id[owner[p]];
  }
  return tidied(std::move(map));
}

}  // namespace

PanopticTeacherSettings panoptic_teacher_settings(TeacherLevel level) {
  PanopticTeacherSettings s;
  s.outline_rms *= semantic_teacher_settings(level).outline_rms / SemanticTeacherSettings().outline_rms;
  return s;
}

std::vector<SegmentMap> simulate_panoptic_teacher(const std::vector<RenderedView>& views, const RoomModel& room,
                                                  const std::vector<ObjectConfusion>& confusions,
                                                  const PanopticTeacherSettings& settings,
                                                  const SemanticTeacherSettings& semantic, Random random,
                                                  ThreadPool& pool) {
  std::vector<SegmentMap> out(views.size());
  pool.parallel_for(views.size(), 1, [&](size_t begin, size_t end, int) {
    for (size_t i = begin; i < end; ++i) {
      const Random own = random.fork(1000 + i);
      out[i] = painted(seen_regions(views[i], room, confusions, settings, semantic, own), views[i].labels.width,
                       views[i].labels.height, settings.outline_rms, own);
    }
  });
  return out;
}

SegmentMap exact_segments(const RenderedView& view) {
  SegmentMap map;
  map.width = view.labels.width;
  map.height = view.labels.height;
  map.of_pixel.assign(view.labels.pixels(), SegmentMap::kNone);
  SegmentList segments;
  for (const QueryRegion& region : query_regions(view)) {
    const uint16_t segment = segments.add(region.label);
    for (size_t p = 0; p < region.mask.size(); ++p) {
      if (region.mask[p]) map.of_pixel[p] = segment;
    }
  }
  map.list = std::move(segments.list);
  return tidied(std::move(map));
}

double panoptic_quality(const std::vector<SegmentMap>& truth, const std::vector<SegmentMap>& said) {
  struct Tally {
    double iou = 0, matched = 0, truths = 0, said = 0;
  };
  std::map<uint16_t, Tally> tallies;
  for (size_t v = 0; v < truth.size(); ++v) {
    const SegmentMap &t = truth[v], &s = said[v];
    std::vector<size_t> t_size(t.list.size(), 0), s_size(s.list.size(), 0), both(t.list.size() * s.list.size(), 0);
    for (size_t p = 0; p < t.of_pixel.size(); ++p) {
      const uint16_t a = t.of_pixel[p], b = s.of_pixel[p];
      if (a == SegmentMap::kNone) continue;  // nothing there to be right about
      ++t_size[a];
      if (b == SegmentMap::kNone) continue;
      ++s_size[b];
      ++both[a * s.list.size() + b];
    }
    for (size_t a = 0; a < t.list.size(); ++a) {
      tallies[t.list[a].label].truths += 1;
      for (size_t b = 0; b < s.list.size(); ++b) {
        if (t.list[a].label != s.list[b].label) continue;
        const auto shared = static_cast<double>(both[a * s.list.size() + b]);
        const double iou = shared > 0 ? shared / (static_cast<double>(t_size[a] + s_size[b]) - shared) : 0;
        if (iou > 0.5) tallies[t.list[a].label].iou += iou, tallies[t.list[a].label].matched += 1;
      }
    }
    for (size_t b = 0; b < s.list.size(); ++b) {
      if (s_size[b] > 0) tallies[s.list[b].label].said += 1;
    }
  }
  double sum = 0, classes = 0;
  for (const auto& [label, c] : tallies) {
    if (c.truths == 0) continue;
    sum += c.iou / (c.matched + 0.5 * (c.truths - c.matched) + 0.5 * (c.said - c.matched));
    classes += 1;
  }
  return classes > 0 ? sum / classes : 0;
}

}  // namespace aligngs
