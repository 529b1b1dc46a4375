#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/srgb.h"
#include "edit/export/object_meshes.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "io/atomic_file.h"

namespace aligngs {
namespace {

constexpr double kReach = 3;  // standard deviations of a Gaussian that its extent takes in

/// One object or structural part: its surface, its Gaussians, or both.
struct Part {
  std::string name, class_name;
  const TriangleMesh* mesh = nullptr;
  std::vector<uint32_t> rows;
};

/// By class, then number; what has no class comes last.
using Parts = std::map<std::pair<uint16_t, uint16_t>, Part>;

Parts parts_of(const EditableRoom& room, const std::vector<ObjectMesh>& meshes, bool with_splats) {
  Parts parts;
  for (const ObjectMesh& object : meshes) {
    Part& part = parts[{object.label < 0 ? kNoLabel : static_cast<uint16_t>(object.label), static_cast<uint16_t>(object.instance)}];
    part.name = object.name;
    part.class_name = object.class_name;
    part.mesh = &object.mesh;
  }
  const LabelledGaussians& g = room.gaussians;
  for (size_t i = 0; with_splats && i < g.model.size(); ++i) {
    const uint16_t label = i < g.labels.label.size() && g.labels.label[i] < room.labels.size() ? g.labels.label[i] : kNoLabel;
    Part& part = parts[{label, label == kNoLabel ? uint16_t(0) : g.labels.instance[i]}];
    if (part.name.empty()) {
      part.class_name = label == kNoLabel ? "" : room.labels.classes[label].name;
      part.name = label == kNoLabel ? "unlabelled" : fmt::format("{}.{:03}", part.class_name, g.labels.instance[i]);
    }
    part.rows.push_back(static_cast<uint32_t>(i));
  }
  return parts;
}

/// A name that USD allows: letters, digits, underscores, no digit first.
std::string identifier(const std::string& name) {
  std::string out;
  for (const char c : name) out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  return out.empty() || (out[0] >= '0' && out[0] <= '9') ? "_" + out : out;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + '"';
}

/// Text of USD, written piece by piece: a room has hundreds of megabytes of it.
class Writer {
 public:
  explicit Writer(AtomicFile& file) : file_(file) {}
  void line(int depth, const std::string& text) {
    text_.append(4 * static_cast<size_t>(depth), ' ');
    text_ += text;
    text_ += '\n';
  }
  /// name = [item(0), item(1), ...] with what follows.
  template <class Item>
  void list(int depth, const std::string& name, size_t count, Item&& item, const char* after = "") {
    text_.append(4 * static_cast<size_t>(depth), ' ');
    text_ += name + " = [";
    for (size_t i = 0; i < count; ++i) {
      if (i > 0) text_ += ", ";
      text_ += item(i);
      if (text_.size() > kPiece) flush();
    }
    text_ += std::string("]") + after + "\n";
  }
  void flush() {
    file_.write(text_);
    text_.clear();
  }

 private:
  static constexpr size_t kPiece = 1 << 20;
  AtomicFile& file_;
  std::string text_;
};

std::string triple(double x, double y, double z) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", x, y, z); }
std::string triple(const Vec3d& p) { return triple(p.x, p.y, p.z); }

struct Extent {
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void take(const Vec3d& p, double around) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k] - around);
      high[k] = std::max(high[k], p[k] + around);
    }
  }
  std::string text() const { return "float3[] extent = [" + triple(low) + ", " + triple(high) + "]"; }
};

constexpr const char* kPerVertex = " (\n                interpolation = \"vertex\"\n            )";

void write_mesh(Writer& out, const TriangleMesh& mesh, const Mat3d& rotation) {
  Extent extent;
  for (const Vec3f& v : mesh.vertices) extent.take(rotation * v.cast<double>(), 0);
  out.line(2, "def Mesh \"mesh\" (");
  out.line(3, "prepend apiSchemas = [\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]");
  out.line(2, ")");
  out.line(2, "{");
  out.line(3, extent.text());
  out.list(3, "int[] faceVertexCounts", mesh.triangles.size(), [](size_t) { return "3"; });
  out.list(3, "int[] faceVertexIndices", 3 * mesh.triangles.size(), [&](size_t i) { return fmt::format("{}", mesh.triangles[i / 3][i % 3]); });
  out.list(3, "point3f[] points", mesh.vertices.size(), [&](size_t i) { return triple(rotation * mesh.vertices[i].cast<double>()); });
  if (!mesh.normals.empty()) {
    out.list(3, "normal3f[] normals", mesh.normals.size(), [&](size_t i) { return triple(rotation * mesh.normals[i].cast<double>()); }, kPerVertex);
  }
  if (!mesh.colors.empty()) {
    const auto linear = [](uint8_t c) { return static_cast<double>(srgb_decode(static_cast<float>(c) / 255)); };
    out.list(3, "color3f[] primvars:displayColor", mesh.colors.size(),
             [&](size_t i) { return triple(linear(mesh.colors[i][0]), linear(mesh.colors[i][1]), linear(mesh.colors[i][2])); }, kPerVertex);
  }
  // The triangles themselves: a room is hollow, so that its hull would fill it.
  out.line(3, "uniform token physics:approximation = \"none\"");
  out.line(3, "uniform token subdivisionScheme = \"none\"");
  out.line(2, "}");
}

void write_splats(Writer& out, const GaussianModel& model, const std::vector<uint32_t>& rows) {
  const auto position = [&](size_t i) { return Vec3d{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]}; };
  const auto scale = [&](size_t i, size_t k) { return std::exp(static_cast<double>(model.log_scales[3 * i + k])); };
  Extent extent;
  for (const uint32_t i : rows) extent.take(position(i), kReach * std::max({scale(i, 0), scale(i, 1), scale(i, 2)}));
  const size_t coefficients = static_cast<size_t>((model.sh_degree + 1) * (model.sh_degree + 1));
  out.line(2, "def ParticleField3DGaussianSplat \"splats\"");
  out.line(2, "{");
  out.line(3, extent.text());
  out.list(3, "point3f[] positions", rows.size(), [&](size_t r) { return triple(position(rows[r])); });
  out.list(3, "quatf[] orientations", rows.size(), [&](size_t r) {
    const float* q = &model.rotations[4 * size_t(rows[r])];
    const Quaterniond n = normalized(Quaterniond{q[0], q[1], q[2], q[3]});
    return fmt::format("({:.5g}, {:.5g}, {:.5g}, {:.5g})", n.w, n.x, n.y, n.z);
  });
  out.list(3, "float3[] scales", rows.size(), [&](size_t r) { return triple(scale(rows[r], 0), scale(rows[r], 1), scale(rows[r], 2)); });
  out.list(3, "float[] opacities", rows.size(), [&](size_t r) { return fmt::format("{:.5g}", opacity_of(model, rows[r])); });
  out.line(3, fmt::format("int radiance:sphericalHarmonicsDegree = {}", model.sh_degree));
  out.list(3, "float3[] radiance:sphericalHarmonicsCoefficients", coefficients * rows.size(), [&](size_t c) {
    const float* sh = &model.sh[3 * (size_t(kShCoefficients) * rows[c / coefficients] + c % coefficients)];
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", sh[0], sh[1], sh[2]);
  });
  out.line(2, "}");
}

}  // namespace

ExportReport write_usda(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool, RoomParts which) {
  if (which == RoomParts::kMesh && room.mesh.empty()) {
    throw Error({ErrorKind::kUsage, "the run has no mesh", path, "--only", "make it first: aligngs mesh RUN"});
  }
  const Mat3d rotation = rotation_to_y_up(room.up);
  const bool splats = which != RoomParts::kMesh;
  const std::vector<ObjectMesh> meshes = which == RoomParts::kSplats ? std::vector<ObjectMesh>() : object_meshes(room, pool);
  const GaussianModel model = splats ? rotated(room.gaussians.model, rotation) : GaussianModel();
  const Parts parts = parts_of(room, meshes, splats);
  AtomicFile file(path);
  Writer out(file);
  out.line(0, "#usda 1.0\n(\n    defaultPrim = \"room\"\n    doc = \"aligngs " + std::string(ALIGNGS_VERSION) + "\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n");
  out.line(0, "def Xform \"room\"\n{");
  for (const auto& [key, part] : parts) {
    if (part.class_name.empty()) {
      out.line(1, "def Xform \"" + identifier(part.name) + "\"\n    {");
    } else {
      out.line(1, "def Xform \"" + identifier(part.name) + "\" (\n        prepend apiSchemas = [\"SemanticsLabelsAPI:class\"]\n    )\n    {");
      out.line(2, "token[] semantics:labels:class = [" + quoted(part.class_name) + "]");
    }
    if (part.mesh && !part.mesh->empty()) write_mesh(out, *part.mesh, rotation);
    if (!part.rows.empty()) write_splats(out, model, part.rows);
    out.line(1, "}");
  }
  out.line(0, "}");
  out.flush();
  file.commit();
  return {{path}, splats ? model.size() : 0, parts.size()};
}

}  // namespace aligngs
