// Why teacher maps are kept as float16 of the active classes: bytes and errors beside 8-bit log-probabilities and the
// sixteen best classes. The maps are like those of a segmentation network (a winner, a runner-up, a tail over decades).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/half.h"
#include "core/random.h"
#include "engine/shared/active_classes.h"

namespace aligngs::cpu {
namespace {

constexpr int kStoredClasses = 150, kShown = 45;  ///< of the label set; ever among the two best
constexpr int kWidth = 32, kHeight = 24;
using Row = std::vector<double>;

std::vector<Row> make_teacher() {
  Random random(11);
  std::vector<Row> rows;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    Row p(kStoredClasses);
    for (double& x : p) x = std::exp(-7 + 2.5 * random.normal());
    const size_t first = random.below(kShown), second = random.below(kShown);
    double tail = 0, sum = 0;
    for (const double x : p) tail = std::max(tail, x);
    p[second] += (1.0 + random.uniform()) * tail;
    p[first] += 3 * p[second] + 8 * random.uniform();
    for (const double x : p) sum += x;
    for (double& x : p) x /= sum;
    rows.push_back(p);
  }
  return rows;
}

/// KL(teacher || stored) in nats, the part of the loss that storing costs, as mean and median over the pixels, and the
/// largest error of a probability.
struct StorageError {
  double kl = 0, median = 0, largest = 0;
};
StorageError storage_error(const std::vector<Row>& teacher, const std::vector<Row>& stored) {
  StorageError e;
  std::vector<double> pixels;
  for (size_t i = 0; i < teacher.size(); ++i) {
    double sum = 0, kl = 0;
    for (const double q : stored[i]) sum += q;
    for (size_t c = 0; c < kStoredClasses; ++c) {
      const double p = teacher[i][c], q = stored[i][c] / sum;
      e.largest = std::max(e.largest, std::abs(p - q));
      if (p > 0) kl += p * std::log(p / std::max(q, 1e-12));
    }
    pixels.push_back(kl);
    e.kl += kl;
  }
  e.kl /= static_cast<double>(teacher.size());
  const auto middle = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() / 2);
  std::nth_element(pixels.begin(), middle, pixels.end());
  e.median = *middle;
  return e;
}

std::vector<Row> as_float16(std::vector<Row> rows) {
  for (Row& r : rows) {
    for (double& x : r) x = static_cast<double>(half_to_float(float_to_half(static_cast<float>(x))));
  }
  return rows;
}

/// Log-probability in 255 steps over ln 1e-7 .. 0, 0 = none: a step of 0.063, so up to 3.2 % of a probability.
std::vector<Row> as_log8(std::vector<Row> rows) {
  const double lowest = std::log(1e-7), step = -lowest / 254;
  for (Row& r : rows) {
    for (double& x : r) {
      const double code = std::round((std::log(std::max(x, 1e-30)) - lowest) / step);
      x = code < 0 ? 0.0 : std::exp(lowest + code * step);
    }
  }
  return rows;
}

/// The sixteen best in float16, the rest of the mass spread over the others.
std::vector<Row> as_top16(std::vector<Row> rows) {
  for (Row& r : rows) {
    Row sorted = r;
    std::nth_element(sorted.begin(), sorted.begin() + 15, sorted.end(), std::greater<double>());
    double kept = 0;
    for (double& x : r) {
      x = x >= sorted[15] ? static_cast<double>(half_to_float(float_to_half(static_cast<float>(x)))) : 0.0;
      kept += x;
    }
    for (double& x : r) x = x > 0 ? x : std::max(0.0, 1 - kept) / (kStoredClasses - 16);
  }
  return rows;
}

/// The figures of benchmarks/README.md, two digits; MB per teacher of 320 x 240, half the size of a photo.
struct TableRow {
  double mean, median, largest;
};
constexpr TableRow kFloat16{3.9e-8, 1.6e-8, 1.5e-4}, kLog8{8.5e-5, 7.5e-5, 1.2e-2}, kTop16{3.8e-2, 3.3e-2, 1.1e-2};
constexpr double kPixelsPerView = 320 * 240, kActiveMegabytes = 8.8;

void expect_row(const TableRow& row, const StorageError& error) {
  constexpr double kDigits = 0.05;
  EXPECT_NEAR(error.kl, row.mean, kDigits * row.mean);
  EXPECT_NEAR(error.median, row.median, kDigits * row.median);
  EXPECT_NEAR(error.largest, row.largest, kDigits * row.largest);
}

TEST(TeacherStorage, Float16OfActiveClassesIsBothSmallerAndMoreExact) {
  const std::vector<Row> teacher = make_teacher();
  const StorageError half = storage_error(teacher, as_float16(teacher)),
                     log8 = storage_error(teacher, as_log8(teacher)), top16 = storage_error(teacher, as_top16(teacher));
  expect_row(kFloat16, half);
  expect_row(kLog8, log8);
  expect_row(kTop16, top16);
  EXPECT_LT(half.largest, 2.5e-4);  // 2^-12, half a unit of the last place below 1

  TrainingView view;
  SemanticTarget& t = view.data.semantics;
  t.channels = kStoredClasses;
  t.width = kWidth;
  t.height = kHeight;
  for (const Row& r : teacher) {
    for (const double x : r) t.probabilities.push_back(float_to_half(static_cast<float>(x)));
  }
  ThreadPool pool(1);
  const ActiveClasses map = find_active_classes({view}, 2, pool);
  compress_target(map, pool, t);
  const size_t pixels = teacher.size(), bytes = t.probabilities.size() * sizeof(uint16_t);
  EXPECT_GE(map.active.size(), static_cast<size_t>(kShown) / 2);
  EXPECT_NEAR(1e-6 * kPixelsPerView * static_cast<double>(bytes) / static_cast<double>(pixels), kActiveMegabytes, 0.05);
  EXPECT_LT(bytes, pixels * kStoredClasses * sizeof(uint8_t));  // less than 8 bits of every class
  // The active classes hold exactly the given probabilities; the remainder is the rest of the mass.
  for (size_t i = 0; i < pixels; ++i) {
    double rest = 0;
    for (size_t c = 0; c < kStoredClasses; ++c)
      rest += static_cast<double>(half_to_float(float_to_half(static_cast<float>(teacher[i][c]))));
    for (size_t k = 0; k < map.active.size(); ++k) {
      const uint16_t stored = t.probabilities[i * static_cast<size_t>(t.channels) + k];
      ASSERT_EQ(stored, float_to_half(static_cast<float>(teacher[i][map.active[k]])));
      rest -= static_cast<double>(half_to_float(stored));
    }
    const double stored_rest =
        static_cast<double>(half_to_float(t.probabilities[(i + 1) * static_cast<size_t>(t.channels) - 1]));
    ASSERT_NEAR(stored_rest, rest, 5e-4 * rest + 1e-6);
  }
}

}  // namespace
}  // namespace aligngs::cpu
