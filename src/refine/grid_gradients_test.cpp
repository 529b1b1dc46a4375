#include "refine/grid_gradients.h"

#include <gtest/gtest.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cmath>

#include "core/random.h"

namespace aligngs {
namespace {

/// Weights of very different size, as jumps of depth make them, and a few pixels whose value is known.
struct Problem {
  Problem(int width, int height) : matrix(width, height), b(width * height), start(width * height) {
    Random random(11);
    for (int i = 0; i < width * height; ++i) {
      const auto at = static_cast<size_t>(i);
      const bool known = random.chance(0.1);
      matrix.diagonal[at] += 1e-4 + (known ? 1 : 0);
      b[i] = known ? random.normal() : 0;
      start[i] = random.chance(0.5) ? 0.1 * random.normal() : 0;
      if (i % width + 1 < width) link(at, at + 1, matrix.right[at], random);
      if (i + width < width * height) link(at, at + static_cast<size_t>(width), matrix.lower[at], random);
    }
  }
  void link(size_t i, size_t j, double& entry, Random& random) {
    const double weight = random.chance(0.2) ? 0.005 : random.uniform(0.1, 0.5);
    matrix.diagonal[i] += weight;
    matrix.diagonal[j] += weight;
    entry = -weight;
  }
  Eigen::VectorXd by_eigen(int iterations, double tolerance) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < matrix.width * matrix.height; ++i) {
      const auto at = static_cast<size_t>(i);
      entries.emplace_back(i, i, matrix.diagonal[at]);
      if (matrix.right[at] != 0) entries.emplace_back(i + 1, i, matrix.right[at]);
      if (matrix.lower[at] != 0) entries.emplace_back(i + matrix.width, i, matrix.lower[at]);
    }
    Eigen::SparseMatrix<double> sparse(b.size(), b.size());
    sparse.setFromTriplets(entries.begin(), entries.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
    solver.setMaxIterations(iterations);
    solver.setTolerance(tolerance);
    solver.compute(sparse);
    return solver.solveWithGuess(b, start);
  }

  GridMatrix matrix;
  Eigen::VectorXd b, start;
};

TEST(GridGradients, HaveTheBitsOfEigensOnASparseMatrix) {
  for (const auto& [width, height] : {std::pair{80, 60}, {37, 21}, {2, 9}, {64, 1}}) {
    const Problem problem(width, height);
    for (const int iterations : {1, 7, 300}) {
      Eigen::VectorXd x = problem.start;
      solve_on_grid(problem.matrix, problem.b, iterations, 3e-4, x);
      const Eigen::VectorXd expected = problem.by_eigen(iterations, 3e-4);
      for (int i = 0; i < x.size(); ++i)
        ASSERT_EQ(x[i], expected[i]) << width << " x " << height << ", " << iterations << ": " << i;
    }
  }
}

TEST(GridGradients, WithoutAnythingKnownNothingIsCorrected) {
  Problem problem(8, 8);
  problem.b.setZero();
  Eigen::VectorXd x = problem.start;
  solve_on_grid(problem.matrix, problem.b, 300, 3e-4, x);
  EXPECT_EQ(x, Eigen::VectorXd::Zero(64));
}

}  // namespace
}  // namespace aligngs
