#include "refine/grid_gradients.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "core/target_clones.h"

namespace aligngs {
namespace {

/// Numbers per pixel with a row of zeros on both sides, for neighbours that are not there.
class Padded {
 public:
  Padded(int width, size_t count) : before_(static_cast<size_t>(width)), numbers_(count + 2 * before_, 0.0) {}
  Padded(int width, const std::vector<double>& numbers) : Padded(width, numbers.size()) {
    std::copy(numbers.begin(), numbers.end(), data());
  }
  double* data() { return numbers_.data() + before_; }
  const double* data() const { return numbers_.data() + before_; }

 private:
  size_t before_;
  std::vector<double> numbers_;
};

/// Rows of the matrix; each starts at the first pixel and may be read a row before it.
struct Rows {
  const double *diagonal, *right, *lower;
  ptrdiff_t width, count;
};

// Terms are added in the order in which the columns of a sparse lower half come to a row.
ALIGNGS_TARGET_CLONES
void multiply(const Rows& m, const double* p, double* out) {
  for (ptrdiff_t i = 0; i < m.count; ++i) {
    const double before = m.lower[i - m.width] * p[i - m.width] + m.right[i - 1] * p[i - 1];
    const double after = m.right[i] * p[i + 1] + m.lower[i] * p[i + m.width];
    out[i] = before + m.diagonal[i] * p[i] + after;
  }
}

ALIGNGS_TARGET_CLONES
void subtract_product(const Rows& m, const double* p, double* out) {
  for (ptrdiff_t i = 0; i < m.count; ++i) {
    const double after = m.right[i] * p[i + 1] + m.lower[i] * p[i + m.width];
    out[i] = out[i] - m.lower[i - m.width] * p[i - m.width] - m.right[i - 1] * p[i - 1] - m.diagonal[i] * p[i] - after;
  }
}

/// x += alpha p, residual -= alpha q
ALIGNGS_TARGET_CLONES
void step(ptrdiff_t count, double alpha, const double* p, const double* q, double* x, double* residual) {
  for (ptrdiff_t i = 0; i < count; ++i) {
    x[i] += alpha * p[i];
    residual[i] -= alpha * q[i];
  }
}

/// p = z + beta p
ALIGNGS_TARGET_CLONES
void turn(ptrdiff_t count, double beta, const double* z, double* p) {
  for (ptrdiff_t i = 0; i < count; ++i) p[i] = z[i] + beta * p[i];
}

}  // namespace

GridMatrix::GridMatrix(int w, int h)
    : width(w),
      height(h),
      diagonal(static_cast<size_t>(w) * static_cast<size_t>(h), 0.0),
      right(diagonal.size(), 0.0),
      lower(diagonal.size(), 0.0) {}

void solve_on_grid(const GridMatrix& matrix, const Eigen::VectorXd& b, int iterations, double tolerance,
                   Eigen::VectorXd& x) {
  const size_t size = matrix.diagonal.size();
  const auto count = static_cast<ptrdiff_t>(size);
  const Padded right(matrix.width, matrix.right), lower(matrix.width, matrix.lower);
  const Rows rows{matrix.diagonal.data(), right.data(), lower.data(), matrix.width, count};
  const double norm = b.squaredNorm();
  if (norm == 0) {
    x.setZero();
    return;
  }
  Eigen::VectorXd inverse(count);
  for (ptrdiff_t i = 0; i < count; ++i) inverse[i] = rows.diagonal[i] != 0 ? 1 / rows.diagonal[i] : 1.0;

  Padded direction(matrix.width, size);
  double* const p = direction.data();
  Eigen::Map<Eigen::VectorXd> along(p, count);
  along = x;
  Eigen::VectorXd residual = b, product(count), scaled(count);
  subtract_product(rows, p, residual.data());
  const double threshold = std::max(tolerance * tolerance * norm, std::numeric_limits<double>::min());
  if (residual.squaredNorm() < threshold) return;
  along = inverse.cwiseProduct(residual);
  double slope = residual.dot(along);
  for (int i = 0; i < iterations; ++i) {
    multiply(rows, p, product.data());
    step(count, slope / along.dot(product), p, product.data(), x.data(), residual.data());
    if (residual.squaredNorm() < threshold) return;
    scaled = inverse.cwiseProduct(residual);
    const double next = residual.dot(scaled);
    turn(count, next / slope, scaled.data(), p);
    slope = next;
  }
}

}  // namespace aligngs
