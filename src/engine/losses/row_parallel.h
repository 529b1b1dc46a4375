// Work over the rows of an image whose results do not depend on the number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/thread_pool.h"

namespace aligngs {

inline constexpr size_t kRowsPerChunk = 8;  ///< rows per task: small enough to balance 240 rows on 16 threads

/// Calls body(y) for every row; a body writes only what belongs to its row.
template <class Body>
void for_each_row(ThreadPool* pool, int rows, const Body& body) {
  const auto run = [&](size_t begin, size_t end, int) {
    for (size_t y = begin; y < end; ++y) body(static_cast<int>(y));
  };
  if (pool) {
    pool->parallel_for(static_cast<size_t>(rows), kRowsPerChunk, run);
  } else {
    run(0, static_cast<size_t>(rows), 0);
  }
}

/// Sums of K numbers over all rows: body(y) returns the row's own sums, which are added in row order.
/// `partial` is scratch memory.
template <int K, class Body>
std::array<double, K> sum_rows(ThreadPool* pool, int rows, std::vector<double>& partial, const Body& body) {
  partial.resize(static_cast<size_t>(rows) * K);
  for_each_row(pool, rows, [&](int y) {
    const std::array<double, K> s = body(y);
    for (int k = 0; k < K; ++k) partial[static_cast<size_t>(y) * K + k] = s[k];
  });
  std::array<double, K> total{};
  for (int y = 0; y < rows; ++y) {
    for (int k = 0; k < K; ++k) total[k] += partial[static_cast<size_t>(y) * K + k];
  }
  return total;
}

inline constexpr int kScatterRows = 4;  ///< how far above and below its own row a scattering body may write
inline constexpr int kBandRows = 16;    ///< rows of one band, at least 2 * kScatterRows

/// Like for_each_row for bodies that add to rows y - kScatterRows .. y + kScatterRows. Bands of rows are run in two
/// rounds, even bands then odd ones. No two concurrent bodies touch the same row. Every sum is formed in the same order
/// whatever the number of threads.
template <class Body>
void for_each_row_scattering(ThreadPool* pool, int rows, const Body& body) {
  const int bands = (rows + kBandRows - 1) / kBandRows;
  for (int parity = 0; parity < 2; ++parity) {
    const auto run = [&](size_t begin, size_t end, int) {
      for (size_t i = begin; i < end; ++i) {
        const int first = (2 * static_cast<int>(i) + parity) * kBandRows;
        const int last = first + kBandRows < rows ? first + kBandRows : rows;
        for (int y = first; y < last; ++y) body(y);
      }
    };
    const size_t count = static_cast<size_t>((bands + 1 - parity) / 2);
    if (pool) {
      pool->parallel_for(count, 1, run);
    } else {
      run(0, count, 0);
    }
  }
}

}  // namespace aligngs
