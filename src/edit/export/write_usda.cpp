#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/srgb.h"
#include "core/version.h"
#include "edit/export/scene_export.h"
#include "edit/export/upright.h"
#include "io/atomic_file.h"
#include "io/drawn_picture.h"
#include "io/image_file.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

constexpr double kReach = 3;  // standard deviations of a Gaussian that its extent takes in

/// One object or structural part: its surface, its Gaussians, or both.
struct Part {
  std::string name, class_name;
  const ObjectMesh* surface = nullptr;
  const TriangleMesh* collider = nullptr;
  std::vector<uint32_t> rows;
};

/// By class, then number; what has no class comes last.
using Parts = std::map<std::pair<uint16_t, uint16_t>, Part>;

Parts parts_of(const EditableRoom& room, const ExportMesh& surfaces, const ExportMesh& colliders, bool with_splats) {
  Parts parts;
  const auto part_of = [&](const ObjectMesh& object) -> Part& {
    Part& part = parts[{object.label < 0 ? kNoLabel : static_cast<uint16_t>(object.label),
                        static_cast<uint16_t>(object.instance)}];
    part.name = object.name;
    part.class_name = object.class_name;
    return part;
  };
  for (const ObjectMesh& object : surfaces.objects) part_of(object).surface = &object;
  for (const ObjectMesh& object : colliders.objects) part_of(object).collider = &object.mesh;
  const LabelledGaussians& g = room.gaussians;
  for (size_t i = 0; with_splats && i < g.model.size(); ++i) {
    const uint16_t label =
        i < g.labels.label.size() && g.labels.label[i] < room.labels.size() ? g.labels.label[i] : kNoLabel;
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
  explicit Writer(std::function<void(const std::string&)> sink) : sink_(std::move(sink)) {}
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
    sink_(text_);
    text_.clear();
  }

 private:
  static constexpr size_t kPiece = 1 << 20;
  std::function<void(const std::string&)> sink_;
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

void write_triangles(Writer& out, const TriangleMesh& mesh, const Mat3d& rotation) {
  Extent extent;
  for (const Vec3f& v : mesh.vertices) extent.take(rotation * v.cast<double>(), 0);
  out.line(3, extent.text());
  out.list(3, "int[] faceVertexCounts", mesh.triangles.size(), [](size_t) { return "3"; });
  out.list(3, "int[] faceVertexIndices", 3 * mesh.triangles.size(),
           [&](size_t i) { return fmt::format("{}", mesh.triangles[i / 3][i % 3]); });
  out.list(3, "point3f[] points", mesh.vertices.size(),
           [&](size_t i) { return triple(rotation * mesh.vertices[i].cast<double>()); });
  out.line(3, "uniform token subdivisionScheme = \"none\"");
}

void write_surface(Writer& out, const ObjectMesh& object, const Mat3d& rotation) {
  const TriangleMesh& mesh = object.mesh;
  const bool textured = !object.uv.empty();
  out.line(2, std::string("def Mesh \"mesh\"") + (textured ? " (" : ""));
  if (textured) out.line(3, "prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )");
  out.line(2, "{");
  write_triangles(out, mesh, rotation);
  out.line(3, "uniform bool doubleSided = true");
  if (!mesh.normals.empty()) {
    out.list(
        3, "normal3f[] normals", mesh.normals.size(),
        [&](size_t i) { return triple(rotation * mesh.normals[i].cast<double>()); }, kPerVertex);
  }
  if (textured) {
    out.list(
        3, "texCoord2f[] primvars:st", object.uv.size(),
        [&](size_t i) { return fmt::format("({:.6f}, {:.6f})", object.uv[i][0], 1 - object.uv[i][1]); }, kPerVertex);
    out.line(3, "rel material:binding = </room/photos>");
  } else if (!mesh.colors.empty()) {
    const auto linear = [](uint8_t c) { return static_cast<double>(srgb_decode(static_cast<float>(c) / 255)); };
    out.list(
        3, "color3f[] primvars:displayColor", mesh.colors.size(),
        [&](size_t i) {
          return triple(linear(mesh.colors[i][0]), linear(mesh.colors[i][1]), linear(mesh.colors[i][2]));
        },
        kPerVertex);
  }
  out.line(2, "}");
}

/// Invisible. The triangles themselves: a room is hollow, so that its hull would fill it.
void write_collider(Writer& out, const TriangleMesh& mesh, const Mat3d& rotation) {
  out.line(2, "def Mesh \"collider\" (");
  out.line(3, "prepend apiSchemas = [\"PhysicsCollisionAPI\", \"PhysicsMeshCollisionAPI\"]");
  out.line(2, ")");
  out.line(2, "{");
  write_triangles(out, mesh, rotation);
  out.line(3, "uniform token physics:approximation = \"none\"");
  out.line(3, "uniform token purpose = \"guide\"");
  out.line(2, "}");
}

/// The photos' light is in the texture: it shines by itself and takes no light.
void write_material(Writer& out, const std::string& texture) {
  out.line(0, R"(    def Material "photos"
    {
        token outputs:surface.connect = </room/photos/surface.outputs:surface>
        def Shader "surface"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0, 0, 0)
            color3f inputs:emissiveColor.connect = </room/photos/texture.outputs:rgb>
            float inputs:roughness = 1
            int inputs:useSpecularWorkflow = 1
            color3f inputs:specularColor = (0, 0, 0)
            token outputs:surface
        }
        def Shader "texture"
        {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @)" +
                  texture + R"(@
            token inputs:sourceColorSpace = "sRGB"
            float2 inputs:st.connect = </room/photos/st.outputs:result>
            token inputs:wrapS = "clamp"
            token inputs:wrapT = "clamp"
            float3 outputs:rgb
        }
        def Shader "st"
        {
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "st"
            float2 outputs:result
        }
    })");
}

void write_splats(Writer& out, const GaussianModel& model, const std::vector<uint32_t>& rows) {
  const auto position = [&](size_t i) {
    return Vec3d{model.positions[3 * i], model.positions[3 * i + 1], model.positions[3 * i + 2]};
  };
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
  out.list(3, "float3[] scales", rows.size(),
           [&](size_t r) { return triple(scale(rows[r], 0), scale(rows[r], 1), scale(rows[r], 2)); });
  out.list(3, "float[] opacities", rows.size(),
           [&](size_t r) { return fmt::format("{:.5g}", opacity_of(model, rows[r])); });
  out.line(3, fmt::format("int radiance:sphericalHarmonicsDegree = {}", model.sh_degree));
  out.list(3, "float3[] radiance:sphericalHarmonicsCoefficients", coefficients * rows.size(), [&](size_t c) {
    const float* sh = &model.sh[3 * (size_t(kShCoefficients) * rows[c / coefficients] + c % coefficients)];
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", sh[0], sh[1], sh[2]);
  });
  out.line(2, "}");
}

/// USD multiplies row vectors: its rows are our columns.
void write_root_matrix(Writer& out, const std::array<double, 16>& m) {
  std::string rows;
  for (size_t c = 0; c < 4; ++c)
    rows += fmt::format("{}({}, {}, {}, {})", c > 0 ? ", " : "", m[c], m[4 + c], m[8 + c], m[12 + c]);
  out.line(1, "matrix4d xformOp:transform = ( " + rows + " )");
  out.line(1, "uniform token[] xformOpOrder = [\"xformOp:transform\"]");
}

/// The turn of the positions, and the matrix above them: with an offset they keep their own axes.
struct StageAxes {
  StageAxes(const EditableRoom& room, const ExportOptions& options) : turn(rotation_to_y_up(room.up)) {
    if (!options.offset) return;
    root = root_matrix(turn, *options.offset);
    turn = Mat3d::identity();
  }
  Mat3d turn;
  std::optional<std::array<double, 16>> root;
};

/// The file as text. `texture`: the name by which the surfaces refer to their texture.
void write_stage(Writer& out, const Parts& parts, const GaussianModel& splats, const Mat3d& rotation,
                 const std::string& texture, const std::optional<std::array<double, 16>>& root) {
  out.line(0, std::string("#usda 1.0\n(\n    defaultPrim = \"room\"\n    doc = \"aligngs ") + version() +
                  "\"\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n");
  out.line(0, "def Xform \"room\"\n{");
  if (root) write_root_matrix(out, *root);
  if (!texture.empty()) write_material(out, texture);
  for (const auto& [key, part] : parts) {
    if (part.class_name.empty()) {
      out.line(1, "def Xform \"" + identifier(part.name) + "\"\n    {");
    } else {
      out.line(1, "def Xform \"" + identifier(part.name) +
                      "\" (\n        prepend apiSchemas = [\"SemanticsLabelsAPI:class\"]\n    )\n    {");
      out.line(2, "token[] semantics:labels:class = [" + quoted(part.class_name) + "]");
    }
    if (part.surface) write_surface(out, *part.surface, rotation);
    if (part.collider) write_collider(out, *part.collider, rotation);
    if (!part.rows.empty()) write_splats(out, splats, part.rows);
    out.line(1, "}");
  }
  out.line(0, "}");
  out.flush();
}

}  // namespace

ExportReport write_usda(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                        const ExportOptions& options) {
  if (options.parts == RoomParts::kMesh && room.mesh.empty()) {
    throw Error({ErrorKind::kUsage, "the run has no mesh", path, "--mesh-only", "make it first: aligngs mesh RUN"});
  }
  const StageAxes axes(room, options);
  const Mat3d& rotation = axes.turn;
  const bool with_splats = options.parts != RoomParts::kMesh,
             with_mesh = options.parts != RoomParts::kSplats && !room.mesh.empty();
  const ExportMesh surfaces = with_mesh ? export_mesh(room, options.mesh, pool) : ExportMesh(),
                   colliders = with_mesh ? collision_mesh(room, options.mesh, pool) : ExportMesh();
  const GaussianModel splats = with_splats ? rotated(room.gaussians.model, rotation) : GaussianModel();
  const Parts parts = parts_of(room, surfaces, colliders, with_splats);
  ExportReport report{.files = {path}, .gaussians = splats.size()};
  report.describe(surfaces);
  report.objects = parts.size();
  std::string texture;
  if (!surfaces.texture.empty()) {
    const std::filesystem::path picture = texture_beside(path);
    write_drawn_jpeg(picture, surfaces.texture, kTextureQuality);
    report.files.push_back(picture);
    texture = "./" + picture.filename().string();
  }
  AtomicFile file(path);
  Writer out([&](const std::string& text) { file.write(text); });
  write_stage(out, parts, splats, rotation, texture, axes.root);
  file.commit();
  return report;
}

ExportReport write_usdz(const std::filesystem::path& path, const EditableRoom& room, ThreadPool& pool,
                        const ExportOptions& options) {
  constexpr size_t kAlignment = 64;  // bytes; specification of USDZ
  if (room.mesh.empty())
    throw Error({ErrorKind::kUsage, "a USDZ holds a mesh, and the run has none", path, "-f",
                 "make it first: aligngs mesh RUN"});
  const ExportMesh surfaces = export_mesh(room, options.mesh, pool);
  ExportReport report{.files = {path}};
  report.describe(surfaces);
  const std::string name = "texture.jpg";
  std::string stage;
  Writer out([&](const std::string& text) { stage += text; });
  const StageAxes axes(room, options);
  write_stage(out, parts_of(room, surfaces, {}, false), {}, axes.turn, surfaces.texture.empty() ? "" : name, axes.root);
  // The first file is the stage.
  std::vector<std::pair<std::string, std::string_view>> files = {{"room.usda", stage}};
  std::vector<uint8_t> picture;
  if (!surfaces.texture.empty()) {
    picture = encode_jpeg(surfaces.texture, kTextureQuality);
    files.emplace_back(name, std::string_view(reinterpret_cast<const char*>(picture.data()), picture.size()));
  }
  write_file_atomically(path, make_stored_zip(files, kAlignment));
  return report;
}

}  // namespace aligngs
