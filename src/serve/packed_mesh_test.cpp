#include "serve/packed_mesh.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/json_text.h"
#include "mesh/neighbour_order.h"

namespace aligngs {
namespace {

/// Reads planes of bytes behind each other.
class PlaneReader {
 public:
  explicit PlaneReader(std::string bytes) : bytes_(std::move(bytes)) {}
  std::vector<uint32_t> numbers(size_t count, size_t planes) {
    std::vector<uint32_t> out(count, 0);
    for (size_t p = 0; p < planes; ++p) {
      for (size_t i = 0; i < count; ++i)
        out[i] |= static_cast<uint32_t>(static_cast<unsigned char>(bytes_.at(at_++))) << (8 * p);
    }
    return out;
  }
  std::vector<int> sums(size_t count, size_t planes) {
    std::vector<int> out;
    int value = 0;
    for (const uint32_t code : numbers(count, planes)) {
      value += code & 1 ? -static_cast<int>(code / 2) - 1 : static_cast<int>(code / 2);
      out.push_back(planes == 1 ? value & 255 : value);
    }
    return out;
  }
  size_t left() const { return bytes_.size() - at_; }

 private:
  std::string bytes_;
  size_t at_ = 0;
};

TriangleMesh strip() {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < 400; ++i) {
    mesh.vertices.push_back({0.37f * float(i), i % 2 ? 1.5f : -2.f, 0.001f * float(i * i % 91)});
    mesh.colors.push_back({uint8_t(i * 37), uint8_t(255 - i), uint8_t(i % 3 ? 0 : 255)});
    mesh.labels.push_back(i < 100 ? kNoLabel : uint16_t(i / 100));
    if (i >= 2) mesh.triangles.push_back({i - 2, i - 1, i});
  }
  return mesh;
}

TEST(PackedMesh, TheReaderGetsTheMeshBack) {
  TriangleMesh mesh = strip();
  const std::string packed = packed_mesh(mesh);
  order_by_neighbours(mesh);
  const size_t line = packed.find('\n'), n = mesh.vertices.size();
  const nlohmann::json head = parse_json(packed.substr(0, line));
  ASSERT_EQ(head["vertices"], n);
  ASSERT_EQ(head["triangles"], mesh.triangles.size());
  PlaneReader reader(packed.substr(line + 1));
  const float step = head["step"].get<float>();
  EXPECT_LT(step, 0.37f * 400 / 10000);
  for (int k = 0; k < 3; ++k) {
    const std::vector<int> places = reader.sums(n, 2);
    for (size_t i = 0; i < n; ++i)
      ASSERT_NEAR(head["low"][size_t(k)].get<float>() + step * float(places[i]), mesh.vertices[i][k], 0.51f * step);
  }
  for (size_t k = 0; k < 3; ++k) {
    const std::vector<int> colors = reader.sums(n, 1);
    for (size_t i = 0; i < n; ++i) ASSERT_EQ(colors[i], mesh.colors[i][k]);
  }
  const std::vector<int> labels = reader.sums(n, 2);
  for (size_t i = 0; i < n; ++i) ASSERT_EQ(labels[i], mesh.labels[i] == kNoLabel ? 0 : mesh.labels[i] + 1);
  const std::vector<uint32_t> corners = reader.numbers(3 * mesh.triangles.size(), 4);
  uint32_t next = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const uint32_t v = next - corners[i];
    ASSERT_EQ(v, mesh.triangles[i / 3][i % 3]);
    next = std::max(next, v + 1);
  }
  EXPECT_EQ(reader.left(), 0u);
}

TEST(PackedMesh, ColoursAndLabelsMayBeAbsent) {
  TriangleMesh mesh = strip();
  mesh.colors.clear();
  mesh.labels.clear();
  const std::string packed = packed_mesh(mesh);
  const nlohmann::json head = parse_json(packed.substr(0, packed.find('\n')));
  EXPECT_EQ(head["colors"], false);
  EXPECT_EQ(head["labels"], false);
  EXPECT_EQ(packed.size() - packed.find('\n') - 1, 6 * mesh.vertices.size() + 12 * mesh.triangles.size());
}

TEST(PackedMesh, AFlatPointHasAPlace) {
  TriangleMesh mesh;
  mesh.vertices = {{2, 3, 4}};
  mesh.triangles = {{0, 0, 0}};
  const std::string packed = packed_mesh(mesh);
  EXPECT_EQ(parse_json(packed.substr(0, packed.find('\n')))["low"], (nlohmann::json{2, 3, 4}));
}

}  // namespace
}  // namespace aligngs
