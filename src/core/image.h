// A dense image of any element type, interleaved channels, row-major from the top left.
#pragma once

#include <cstddef>
#include <vector>

namespace aligngs {

template <class T>
struct Image {
  int width = 0;     ///< pixels
  int height = 0;    ///< pixels
  int channels = 0;  ///< values per pixel
  std::vector<T> data;

  Image() = default;
  Image(int w, int h, int c, T value = T()) : width(w), height(h), channels(c), data(size_t(w) * h * c, value) {}

  bool empty() const { return data.empty(); }
  size_t pixels() const { return size_t(width) * height; }
  T& at(int x, int y, int c = 0) { return data[(size_t(y) * width + x) * channels + c]; }
  const T& at(int x, int y, int c = 0) const { return data[(size_t(y) * width + x) * channels + c]; }
  T* pixel(int x, int y) { return &data[(size_t(y) * width + x) * channels]; }
  const T* pixel(int x, int y) const { return &data[(size_t(y) * width + x) * channels]; }
};

using ImageF = Image<float>;

}  // namespace aligngs
