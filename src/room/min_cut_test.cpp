#include "room/min_cut.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace aligngs {
namespace {

TEST(MinCut, WithoutNodesNothingIsIn) { EXPECT_TRUE(MinCut(0).solve().empty()); }

TEST(MinCut, ANodeGoesWhereItIsCheaper) {
  MinCut graph(2);
  graph.add_node_costs(0, 1, 2);
  graph.add_node_costs(1, 2, 1);
  EXPECT_EQ(graph.solve(), (std::vector<uint8_t>{1, 0}));
}

TEST(MinCut, AnExpensiveEdgeKeepsNodesTogether) {
  MinCut graph(2);
  graph.add_node_costs(0, 0, 3);
  graph.add_node_costs(1, 1, 0);
  graph.add_edge_cost(0, 1, 2);
  EXPECT_EQ(graph.solve(), (std::vector<uint8_t>{1, 1}));
}

TEST(MinCut, IsAsCheapAsTheBestOfAllDivisions) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    constexpr size_t kNodes = 7;
    double in[kNodes], out[kNodes], edge[kNodes][kNodes] = {};
    MinCut graph(kNodes);
    for (size_t i = 0; i < kNodes; ++i) {
      graph.add_node_costs(i, in[i] = random.uniform(0, 1), out[i] = random.uniform(0, 1));
      for (size_t j = 0; j < i; ++j) {
        if (random.chance(0.5)) graph.add_edge_cost(i, j, edge[i][j] = random.uniform(0, 0.5));
      }
    }
    const auto cost = [&](auto&& is_in) {
      double sum = 0;
      for (size_t i = 0; i < kNodes; ++i) {
        sum += is_in(i) ? in[i] : out[i];
        for (size_t j = 0; j < i; ++j) sum += is_in(i) != is_in(j) ? edge[i][j] : 0;
      }
      return sum;
    };
    double least = 1e9;
    for (unsigned set = 0; set < 1u << kNodes; ++set)
      least = std::min(least, cost([set](size_t i) { return (set >> i & 1) != 0; }));
    const std::vector<uint8_t> solved = graph.solve();
    EXPECT_NEAR(cost([&solved](size_t i) { return solved[i] != 0; }), least, 1e-9);
  }
}

}  // namespace
}  // namespace aligngs
