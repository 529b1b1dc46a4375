#include "engine/benchmark/benchmark_room.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/half.h"
#include "core/quaternion.h"
#include "core/random.h"
#include "engine/prepare_view.h"
#include "gaussians/morton_order.h"
#include "scene/semantic_target.h"

namespace aligngs {
namespace {

/// Half extents of the room, metres. The cameras are at one end and look to the other.
constexpr double kHalf[3] = {2.2, 1.3, 3.4};
constexpr int kFurniture = 9;            ///< boxes along the walls
constexpr double kFurnitureShare = 0.3;  ///< of the Gaussians
/// Standard deviation of a splat along its plane, in units of the spacing of the splats. About 55 splats reach a pixel.
constexpr double kSizeInSpacings = 1.12;

struct Box {
  Vec3d centre, half;
  int label = 0;
};

/// The room itself first, then the furniture.
std::vector<Box> make_boxes() {
  std::vector<Box> boxes{{{0, 0, 0}, {kHalf[0], kHalf[1], kHalf[2]}, 0}};
  Random random(3);
  for (int i = 0; i < kFurniture; ++i) {
    const Vec3d half{random.uniform(0.2, 0.6), random.uniform(0.2, 0.7), random.uniform(0.2, 0.6)};
    const double x = (i % 3 - 1) * 1.5 + random.uniform(-0.2, 0.2),
                 z = -1.2 + 1.7 * (i / 3) + random.uniform(-0.2, 0.2);
    boxes.push_back({{x, kHalf[1] - half.y, z}, half, 6 + i});
  }
  return boxes;
}

/// Face of a box whose normal is along `axis`; the room's six faces have labels of their own.
int label_of(const Box& box, int axis, double side) {
  return box.label > 0 ? box.label : 2 * axis + (side > 0 ? 1 : 0);
}

Vec3d color_of(int label, const Vec3d& p) {
  const bool odd = (int(std::floor(4 * p.x)) + int(std::floor(4 * p.y)) + int(std::floor(4 * p.z))) & 1;
  const double shade = odd ? 0.75 : 1.0;
  return {shade * (0.3 + 0.04 * (label * 7 % 16)), shade * (0.3 + 0.04 * (label * 11 % 16)),
          shade * (0.3 + 0.04 * (label * 13 % 16))};
}

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  int label = 0;
};

/// Slab test. The room is hit from inside, where the ray leaves it, furniture where the ray enters it.
void intersect(const Box& box, bool inside, const Vec3d& origin, const Vec3d& ray, Hit& hit) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  int enter_axis = 0, leave_axis = 0;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(ray[k]) < 1e-12) {
      if (std::abs(origin[k] - box.centre[k]) > box.half[k]) return;
      continue;
    }
    const double a = (box.centre[k] - box.half[k] - origin[k]) / ray[k];
    const double b = (box.centre[k] + box.half[k] - origin[k]) / ray[k];
    if (std::min(a, b) > enter) enter = std::min(a, b), enter_axis = k;
    if (std::max(a, b) < leave) leave = std::max(a, b), leave_axis = k;
  }
  const double t = inside ? leave : enter;
  if (enter > leave || !(t > 0) || t >= hit.t) return;
  const int axis = inside ? leave_axis : enter_axis;
  hit = {t, label_of(box, axis, inside ? ray[axis] : -ray[axis])};
}

Camera room_camera(const BenchmarkRoom& room, int view) {
  Camera c;
  c.width = room.width;
  c.height = room.height;
  c.fx = c.fy = 0.7 * room.width;
  c.cx = 0.5 * room.width;
  c.cy = 0.5 * room.height;
  const double x = -1.5 + view * (3.0 / (kBenchmarkViews - 1)), z = -0.85 * kHalf[2];
  const double angle = std::atan2(-x, -2 * z);  // turns the camera's z axis to the middle of the far end
  const Mat3d to_world = rotation_matrix(normalized(Quaterniond{std::cos(angle / 2), 0, std::sin(angle / 2), 0}));
  c.world_to_camera = Rigidd{to_world, {x, -0.2, z}}.inverse();
  return c;
}

/// A point on one of the faces of a box, its normal (outward for furniture, inward for the room) and label.
void sample_face(Random& random, const Box& box, bool inward, Vec3d& point, Vec3d& normal, int& label) {
  const double area[3] = {box.half.y * box.half.z, box.half.x * box.half.z, box.half.x * box.half.y};
  double pick = random.uniform() * (area[0] + area[1] + area[2]);
  int axis = 0;
  while (axis < 2 && pick > area[axis]) pick -= area[axis++];
  const double side = random.chance(0.5) ? 1 : -1;
  for (int k = 0; k < 3; ++k) {
    point[k] = box.centre[k] + (k == axis ? side : random.uniform(-1, 1)) * box.half[k];
  }
  normal = {};
  normal[axis] = inward ? -side : side;
  label = label_of(box, axis, side);
}

/// Area of all faces, square metres.
double surface_area(const std::vector<Box>& boxes) {
  double area = 0;
  for (const Box& b : boxes) area += 8 * (b.half.x * b.half.y + b.half.y * b.half.z + b.half.x * b.half.z);
  return area;
}

SemanticTarget make_teacher(const BenchmarkRoom& room, const Image<uint16_t>& labels, uint64_t seed) {
  Random random(seed);
  SemanticTarget t;
  t.channels = room.channels;
  t.width = std::max(1, room.width / 2);
  t.height = std::max(1, room.height / 2);
  t.confidence.assign(size_t(t.width) * t.height, 1.0f);
  t.probabilities.reserve(t.confidence.size() * static_cast<size_t>(room.channels));
  std::vector<double> p(static_cast<size_t>(room.channels));
  for (int y = 0; y < t.height; ++y) {
    for (int x = 0; x < t.width; ++x) {
      double sum = 0;
      for (double& value : p) sum += value = random.uniform(0.0, 2.0 / room.channels);
      p[labels.at(std::min(2 * x, room.width - 1), std::min(2 * y, room.height - 1))] += 9;
      for (const double value : p) t.probabilities.push_back(float_to_half(static_cast<float>(value / (sum + 9))));
    }
  }
  normalise_target(t);
  return t;
}

}  // namespace

void check_benchmark_room(const BenchmarkRoom& room) {
  const auto check = [](const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    throw_usage(std::string(name) + " of the benchmark's room must lie between " + std::to_string(int64_t(low)) +
                " and " + std::to_string(int64_t(high)));
  };
  check("width", room.width, 16, 16384);
  check("height", room.height, 16, 16384);
  check("the number of Gaussians", static_cast<double>(room.gaussians), 1, 1e8);
  check("the number of channels", room.channels, 0, 65000);
}

GaussianModel benchmark_model(const BenchmarkRoom& room) {
  check_benchmark_room(room);
  Random random(7);
  const std::vector<Box> boxes = make_boxes();
  GaussianModel m;
  m.semantic_channels = room.channels;
  m.sh_degree = kMaxShDegree;
  m.resize(room.gaussians);
  const double spacing = std::sqrt(surface_area(boxes) / static_cast<double>(room.gaussians));
  for (size_t i = 0; i < room.gaussians; ++i) {
    Vec3d p, n;
    int label = 0;
    const size_t box = random.chance(kFurnitureShare) ? 1 + static_cast<size_t>(random.below(kFurniture)) : 0;
    sample_face(random, boxes[box], box == 0, p, n, label);
    p += n * (0.3 * spacing * random.normal());
    const Quaterniond q = quaternion_from_z_to(normalized(n + Vec3d{0.1 * random.normal(), 0.1 * random.normal(), 0}));
    const double rotation[4] = {q.w, q.x, q.y, q.z};
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = static_cast<float>(p[k]);
    for (int k = 0; k < 4; ++k) m.rotations[4 * i + k] = static_cast<float>(rotation[k]);
    for (int k = 0; k < 3; ++k) {
      const double size = (k == 2 ? 0.1 : kSizeInSpacings) * spacing * std::exp(0.4 * random.normal());
      m.log_scales[3 * i + k] = static_cast<float>(std::log(size));
    }
    const double opacity = random.uniform(0.5, 0.9);
    m.opacity_logits[i] = static_cast<float>(std::log(opacity / (1 - opacity)));
    const Vec3d color = color_of(label, p);
    for (int k = 0; k < 3 * kShCoefficients; ++k) {
      const double mean = k < 3 ? (color[k] - 0.5) / kSh0 : 0.0;
      m.sh[3 * kShCoefficients * i + k] = static_cast<float>(mean + 0.05 * random.normal());
    }
    for (int c = 0; c < room.channels; ++c) {
      const double mean = c == label % room.channels ? 4.0 : 0.0;
      m.semantics[i * static_cast<size_t>(room.channels) + c] = static_cast<float>(mean + random.uniform(-1, 1));
    }
  }
  if (room.morton_order) sort_by_morton(m);
  return m;
}

TrainingView benchmark_view(const BenchmarkRoom& room, int index) {
  check_benchmark_room(room);
  const std::vector<Box> boxes = make_boxes();
  ViewData data;
  data.name = "benchmark " + std::to_string(index);
  data.camera = room_camera(room, index);
  data.color = ImageF(room.width, room.height, 3);
  data.prior_depth = ImageF(room.width, room.height, 1);
  if (room.channels > 0) data.labels = Image<uint16_t>(room.width, room.height, 1);
  const Rigidd to_world = data.camera.world_to_camera.inverse();
  const Vec3d origin = to_world * Vec3d{};
  for (int y = 0; y < room.height; ++y) {
    for (int x = 0; x < room.width; ++x) {
      const Vec3d ray = to_world * data.camera.ray(x + 0.5, y + 0.5) - origin;  // one unit of depth long
      Hit hit;
      for (size_t b = 0; b < boxes.size(); ++b) intersect(boxes[b], b == 0, origin, ray, hit);
      const Vec3d color = color_of(hit.label, origin + ray * hit.t);
      for (int c = 0; c < 3; ++c) data.color.at(x, y, c) = static_cast<float>(color[c]);
      data.prior_depth.at(x, y) = static_cast<float>(hit.t);
      if (room.channels > 0) data.labels.at(x, y) = static_cast<uint16_t>(hit.label % room.channels);
    }
  }
  if (room.channels > 0) data.semantics = make_teacher(room, data.labels, 100 + static_cast<uint64_t>(index));
  return prepare_view(std::move(data));
}

StepRequest benchmark_request() {
  StepRequest r;
  r.sh_degree = kMaxShDegree;
  r.extent = 3;
  r.rates = {1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f};
  r.losses.weight = benchmark_weights();
  r.losses.semantic_blend = SemanticBlend::kProbabilities;
  r.losses.coupling = SemanticCoupling::kBounded;
  r.losses.coupling_strength = 0.1f;
  r.losses.log_depth_huber = 0.02f;
  r.adam.skip_invisible_semantics = true;
  return r;
}

}  // namespace aligngs
