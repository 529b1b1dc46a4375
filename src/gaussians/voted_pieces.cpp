#include "gaussians/voted_pieces.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace aligngs {
namespace {

constexpr size_t kPieceLinkGrain = 256;  // links per chunk

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

}  // namespace

bool before(const PieceView& a, const PieceView& b) {
  return std::tie(a.photo, a.segment) < std::tie(b.photo, b.segment);
}

void Pieces::join(std::vector<PieceLink> links) {
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

std::vector<PieceLink> Pieces::links_by_segments(size_t least) {
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

void Pieces::join_small(size_t least) {
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

void Pieces::renew(std::vector<PieceLink>& links) {
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
  pool_.parallel_for(links.size(), kPieceLinkGrain, [&](size_t begin, size_t end, int) {
    for (size_t l = begin; l < end; ++l) {
      links[l].votes = votes_for(views_[links[l].a], views_[links[l].b], options_.enough_pixels) +
                       (links[l].touches ? options_.touching : -options_.apart);
    }
  });
}

void Pieces::unite(uint32_t a, uint32_t b) {
  if (a == b) return;
  sets_.unite(a, b);
  const uint32_t kept = sets_.find(a), gone = kept == a ? b : a;
  views_[kept] = joined(views_[kept], views_[gone]);
  views_[gone].clear();
  sizes_[kept] += sizes_[gone];
}

}  // namespace aligngs
