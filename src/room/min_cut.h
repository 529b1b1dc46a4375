// The cheapest division of a small graph into two parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aligngs {

/// Nodes 0 .. n - 1; each is in or out. Costs are >= 0 and finite.
class MinCut {
 public:
  explicit MinCut(size_t nodes);
  /// Cost of a node's being in, and of its being out.
  void add_node_costs(size_t node, double in, double out);
  /// Cost of two nodes' being in different parts.
  void add_edge_cost(size_t a, size_t b, double cost);
  /// 1 for each node that is in, in a division of least cost (max-flow, Edmonds and Karp 1972). Among equal ones, that
  /// with fewest in.
  std::vector<uint8_t> solve();

 private:
  struct Arc {
    uint32_t to;
    double capacity;
  };
  void add_arc(size_t from, size_t to, double capacity, double back);

  size_t nodes_;
  std::vector<Arc> arcs_;  ///< an arc and its reverse are neighbours
  std::vector<std::vector<uint32_t>> out_;
};

}  // namespace aligngs
