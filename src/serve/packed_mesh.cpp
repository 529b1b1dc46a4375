#include "serve/packed_mesh.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "mesh/neighbour_order.h"

namespace aligngs {
namespace {

constexpr int kPlacePlanes = 2, kColorPlanes = 1, kLabelPlanes = 2, kCornerPlanes = 4;  // bytes of a number
constexpr float kLargestPlace = 65535 / 2;  // differences and their sign fill two bytes

/// Appends numbers as planes of bytes.
template <class Number>
void append_planes(std::string& out, size_t count, int planes, const Number& number) {
  for (int plane = 0; plane < planes; ++plane) {
    for (size_t i = 0; i < count; ++i) out += static_cast<char>(number(i) >> (8 * plane) & 0xff);
  }
}

uint32_t signed_code(int64_t difference) {
  return static_cast<uint32_t>(difference < 0 ? -2 * difference - 1 : 2 * difference);
}

/// Differences of a column. Those of one byte are modulo 256.
template <class Value>
void append_differences(std::string& out, size_t count, int planes, const Value& value) {
  std::vector<uint32_t> codes(count);
  int64_t before = 0;
  for (size_t i = 0; i < count; ++i) {
    const int64_t now = value(i), difference = now - before;
    codes[i] = signed_code(planes == 1 ? static_cast<int8_t>(difference) : difference);
    before = now;
  }
  append_planes(out, count, planes, [&](size_t i) { return codes[i]; });
}

}  // namespace

std::string packed_mesh(TriangleMesh mesh) {
  order_by_neighbours(mesh);
  const size_t n = mesh.vertices.size();
  Vec3f low = n > 0 ? mesh.vertices[0] : Vec3f(), high = low;
  for (const Vec3f& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], v[k]);
      high[k] = std::max(high[k], v[k]);
    }
  }
  const float side = std::max({high.x - low.x, high.y - low.y, high.z - low.z}),
              step = side > 0 ? side / kLargestPlace : 1;
  const nlohmann::json head = {{"vertices", n}, {"triangles", mesh.triangles.size()}, {"low", {low.x, low.y, low.z}},
                               {"step", step},  {"colors", !mesh.colors.empty()},     {"labels", !mesh.labels.empty()}};
  std::string out = json_line(head) + "\n";
  for (int k = 0; k < 3; ++k) {
    append_differences(out, n, kPlacePlanes,
                       [&](size_t i) { return std::lround((mesh.vertices[i][k] - low[k]) / step); });
  }
  if (!mesh.colors.empty()) {
    for (size_t k = 0; k < 3; ++k)
      append_differences(out, n, kColorPlanes, [&](size_t i) { return mesh.colors[i][k]; });
  }
  // Every label is one of at most 32767 classes, or none.
  if (!mesh.labels.empty()) {
    append_differences(out, n, kLabelPlanes, [&](size_t i) {
      return mesh.labels[i] == kNoLabel ? int64_t(0) : int64_t(1) + std::min<uint16_t>(mesh.labels[i], 32766);
    });
  }
  std::vector<uint32_t> corners;
  corners.reserve(3 * mesh.triangles.size());
  uint32_t next = 0;
  for (const auto& t : mesh.triangles) {
    for (const uint32_t v : t) {
      corners.push_back(next - v);
      next = std::max(next, v + 1);
    }
  }
  append_planes(out, corners.size(), kCornerPlanes, [&](size_t i) { return corners[i]; });
  return out;
}

}  // namespace aligngs
