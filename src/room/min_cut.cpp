#include "room/min_cut.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace aligngs {
namespace {

constexpr double kNothing = 1e-12;  // capacity that rounding leaves

}  // namespace

MinCut::MinCut(size_t nodes) : nodes_(nodes), out_(nodes + 2) {}

void MinCut::add_arc(size_t from, size_t to, double capacity, double back) {
  out_[from].push_back(static_cast<uint32_t>(arcs_.size()));
  arcs_.push_back({static_cast<uint32_t>(to), capacity});
  out_[to].push_back(static_cast<uint32_t>(arcs_.size()));
  arcs_.push_back({static_cast<uint32_t>(from), back});
}

void MinCut::add_node_costs(size_t node, double in, double out) {
  add_arc(nodes_, node, out, 0);     // cut when the node is out
  add_arc(node, nodes_ + 1, in, 0);  // cut when it is in
}

void MinCut::add_edge_cost(size_t a, size_t b, double cost) { add_arc(a, b, cost, cost); }

std::vector<uint8_t> MinCut::solve() {
  const size_t source = nodes_, sink = nodes_ + 1;
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  for (;;) {
    std::vector<uint32_t> by(out_.size(), kNone);  // arc by which a node was reached
    std::vector<uint8_t> reached(out_.size());
    std::queue<size_t> queue;
    queue.push(source);
    reached[source] = 1;
    while (!queue.empty() && !reached[sink]) {
      const size_t at = queue.front();
      queue.pop();
      for (const uint32_t arc : out_[at]) {
        const size_t to = arcs_[arc].to;
        if (reached[to] || arcs_[arc].capacity <= kNothing) continue;
        reached[to] = 1;
        by[to] = arc;
        queue.push(to);
      }
    }
    if (!reached[sink]) return {reached.begin(), reached.begin() + static_cast<std::ptrdiff_t>(nodes_)};
    double flow = std::numeric_limits<double>::max();
    for (size_t at = sink; at != source; at = arcs_[by[at] ^ 1].to) flow = std::min(flow, arcs_[by[at]].capacity);
    for (size_t at = sink; at != source; at = arcs_[by[at] ^ 1].to) {
      arcs_[by[at]].capacity -= flow;
      arcs_[by[at] ^ 1].capacity += flow;
    }
  }
}

}  // namespace aligngs
