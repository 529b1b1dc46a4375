// The two shapes that activations have: rows of features, and maps of features.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "nn/values.h"

namespace aligngs::nn {

/// Rows of features (tokens, queries), row after row.
struct Matrix {
  int64_t rows = 0, columns = 0;
  Values data;

  Matrix() = default;
  Matrix(int64_t r, int64_t c) : rows(r), columns(c), data(static_cast<size_t>(r * c)) {}
  float* row(int64_t i) { return data.data() + i * columns; }
  const float* row(int64_t i) const { return data.data() + i * columns; }
};

/// A map with its channels innermost (NHWC without the N). Its memory is that of a Matrix with one
/// row per place, row-major from the top left.
struct FeatureMap {
  int64_t height = 0, width = 0, channels = 0;
  Values data;

  FeatureMap() = default;
  FeatureMap(int64_t h, int64_t w, int64_t c)
      : height(h), width(w), channels(c), data(static_cast<size_t>(h * w * c)) {}
  FeatureMap(int64_t h, int64_t w, Matrix rows)
      : height(h), width(w), channels(rows.columns), data(std::move(rows.data)) {}

  int64_t places() const { return height * width; }
  float* at(int64_t y, int64_t x) { return data.data() + (y * width + x) * channels; }
  const float* at(int64_t y, int64_t x) const { return data.data() + (y * width + x) * channels; }
  Matrix take_rows() && {
    Matrix rows;
    rows.rows = places();
    rows.columns = channels;
    rows.data = std::move(data);
    return rows;
  }
};

}  // namespace aligngs::nn
