// Builds furniture from finely tessellated primitives: boxes, rounded boxes, pillows, turned and bent shapes.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/random.h"
#include "synth/room_model.h"

namespace aligngs {

/// Longest side of a tessellation cell, metres: the diagonal stays below 5 cm, so that metrics on mesh vertices
/// see the surface densely.
inline constexpr double kCellSize = 0.034;

/// Turn about the z axis by `degrees` followed by a shift.
Rigidd placement(const Vec3d& origin, double degrees);
/// Turn about the x axis, then about y (leaning cushions, open laptop lids).
Rigidd tilt(const Vec3d& origin, double about_x_degrees, double about_y_degrees);

struct RoundedBoxShape {
  Vec3d low, high;       ///< corners, metres
  double radius = 0.03;  ///< of the edges
  double bulge = 0;      ///< how much the top and bottom faces swell in the middle
  double wrinkle = 0;    ///< amplitude of folds along the normal
};

/// Adds objects to a room. Everything is given in the current frame; `begin` starts an object, `material`
/// chooses what its next primitives are made of.
class MeshBuilder {
 public:
  MeshBuilder(RoomModel& room, uint64_t seed);

  uint16_t add_material(const Material& material);
  void begin(const std::string& class_name);  ///< a new object of this ADE20K class
  void use(uint16_t material) { material_ = material; }
  void use(const Material& material) { material_ = add_material(material); }

  const Rigidd& frame() const { return frame_; }
  void set_frame(const Rigidd& frame) { frame_ = frame; }
  /// Runs `body` in a frame nested in the current one.
  void nested(const Rigidd& inner, const std::function<void()>& body);

  /// Axis-aligned in the current frame; texture u runs along the longer side of each face (grain of wood).
  void box(const Vec3d& low, const Vec3d& high);
  void rounded_box(const RoundedBoxShape& shape);
  /// Two swollen sheets of cloth: centre of the pillow, half sizes in x and y, half thickness in z.
  void pillow(const Vec3d& centre, double half_x, double half_y, double half_thickness);
  /// A solid of revolution about a vertical axis through `base`. The profile is (radius, height) from the bottom;
  /// smooth: shading follows the curve, otherwise every segment has its own edge.
  void turned(const Vec3d& base, const std::vector<std::pair<double, double>>& profile, bool smooth, int segments = 24);
  void cylinder(const Vec3d& base, double radius, double height, int segments = 20);
  /// A round bar between two points.
  void bar(const Vec3d& from, const Vec3d& to, double radius);
  /// A thin sheet (curtain, leaf): centre surface over u, v in [0, 1] and its thickness; both sides are built.
  void sheet(const std::function<Vec3d(double, double)>& surface, double size_u, double size_v, double thickness);
  /// One flat rectangle, corner + u * edge_u + v * edge_v, facing edge_u x edge_v. Texture coordinates in metres,
  /// starting at `uv_origin`, or the unit square when `unit_uv`.
  void rectangle(const Vec3d& corner, const Vec3d& edge_u, const Vec3d& edge_v, bool unit_uv = false,
                 Vec2d uv_origin = {});

  /// Notes the floor area that the box low..high of the current frame takes.
  void occupy(const Vec3d& low, const Vec3d& high);

  Random& random() { return random_; }
  RoomModel& room() { return room_; }

 private:
  using Surface = std::function<Vec3d(double, double)>;
  using TextureMap = std::function<Vec2f(double, double)>;
  /// A grid of the given lines in u and v; triangles face du x dv. Normals are filled by the caller.
  void grid(const std::vector<double>& us, const std::vector<double>& vs, const Surface& surface, const TextureMap& uv);
  /// Area-weighted normals of all vertices from `first` on, shared by vertices at the same place when `weld`.
  void compute_normals(size_t first_vertex, size_t first_triangle, bool weld);
  Vec2f texture_offset();  ///< so that equal boards do not show equal grain

  RoomModel& room_;
  Random random_;
  Rigidd frame_;
  uint16_t object_ = 0, material_ = 0;
};

}  // namespace aligngs
