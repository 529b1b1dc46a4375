// Time of one training step and of its stages. Arguments of a benchmark: image width, Gaussians, channels.
//   engine_benchmark --benchmark_filter=Step
// The room is made up but has the statistics that decide the cost: flat splats on the walls, floor, ceiling and a few
// boxes, opacity about 0.7, sized so that a few hundred of them meet in a tile of 16 x 16 pixels.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "core/half.h"
#include "core/random.h"
#include "engine/engine.h"
#include "engine/losses/map_losses.h"

namespace aligngs {
namespace {

constexpr int kViews = 4;

struct RoomScene {
  int width = 320, height = 240, channels = 150;
  size_t gaussians = 50000;
};

/// Half extents of the room, metres.
constexpr double kHalf[3] = {2.0, 1.3, 2.5};

Camera room_camera(const RoomScene& s, int view) {
  Camera c;
  c.width = s.width;
  c.height = s.height;
  c.fx = c.fy = 0.7 * s.width;
  c.cx = 0.5 * s.width;
  c.cy = 0.5 * s.height;
  // From near a corner, across the room: about half of the Gaussians are in view.
  const double x = view & 1 ? 1.6 : -1.6, z = view & 2 ? 2.1 : -2.1;
  const double angle = std::atan2(x, z) + 3.14159265;  // turns the camera's z axis to the middle
  const Mat3d to_world = rotation_matrix(normalized(Quaterniond{std::cos(angle / 2), 0, std::sin(angle / 2), 0}));
  c.world_to_camera = Rigidd{to_world, {x, 0.1, z}}.inverse();
  return c;
}

/// A point and an inward normal on the faces of a box with the given centre and half extents.
void sample_face(Random& random, const Vec3d& centre, const Vec3d& half, bool inward, Vec3d& point, Vec3d& normal) {
  const double area[3] = {half.y * half.z, half.x * half.z, half.x * half.y};
  double pick = random.uniform() * (area[0] + area[1] + area[2]);
  int axis = 0;
  while (axis < 2 && pick > area[axis]) pick -= area[axis++];
  const double side = random.chance(0.5) ? 1 : -1;
  for (int k = 0; k < 3; ++k) point[k] = centre[k] + (k == axis ? side : random.uniform(-1, 1)) * half[k];
  normal = {};
  normal[axis] = inward ? -side : side;
}

GaussianModel room_model(const RoomScene& s) {
  Random random(7);
  GaussianModel m;
  m.semantic_channels = s.channels;
  m.sh_degree = 3;
  m.resize(s.gaussians);
  // Spacing of the points on about 60 m^2. A standard deviation of 1.2 times that lets some 50 splats reach a pixel,
  // as measured on a real room.
  const double spacing = std::sqrt(60.0 / static_cast<double>(s.gaussians));
  for (size_t i = 0; i < s.gaussians; ++i) {
    Vec3d p, n;
    if (random.chance(0.75)) {
      sample_face(random, {}, {kHalf[0], kHalf[1], kHalf[2]}, true, p, n);
    } else {
      const int box = random.below(4);
      sample_face(random, {box % 2 ? 1.2 : -1.2, 0.8, box / 2 ? 1.5 : -1.5}, {0.5, 0.5, 0.6}, false, p, n);
    }
    p += n * (0.3 * spacing * random.normal());
    const Quaterniond q = quaternion_from_z_to(normalized(n + Vec3d{0.1 * random.normal(), 0.1 * random.normal(), 0}));
    const float rotation[4] = {float(q.w), float(q.x), float(q.y), float(q.z)};
    for (int k = 0; k < 3; ++k) m.positions[3 * i + k] = static_cast<float>(p[k]);
    for (int k = 0; k < 4; ++k) m.rotations[4 * i + k] = rotation[k];
    for (int k = 0; k < 3; ++k) {
      const double size = (k == 2 ? 0.1 : 1.2) * spacing * std::exp(0.4 * random.normal());
      m.log_scales[3 * i + k] = static_cast<float>(std::log(size));
    }
    const double opacity = random.uniform(0.5, 0.9);
    m.opacity_logits[i] = static_cast<float>(std::log(opacity / (1 - opacity)));
    for (int k = 0; k < 3 * kShCoefficients; ++k) {
      m.sh[3 * kShCoefficients * i + k] = static_cast<float>((k < 3 ? 0.8 : 0.05) * random.normal());
    }
    for (int c = 0; c < s.channels; ++c) m.semantics[i * s.channels + c] = static_cast<float>(random.normal());
  }
  return m;
}

TrainingView room_view(const RoomScene& s, int index) {
  Random random(100 + index);
  TrainingView v;
  v.data.camera = room_camera(s, index);
  v.data.color = ImageF(s.width, s.height, 3);
  v.data.prior_depth = ImageF(s.width, s.height, 1, 2.5f);
  v.prior_normal = ImageF(s.width, s.height, 3);
  v.label_edge = Image<uint8_t>(s.width, s.height, 1);
  for (float& x : v.data.color.data) x = static_cast<float>(random.uniform());
  for (size_t i = 2; i < v.prior_normal.data.size(); i += 3) v.prior_normal.data[i] = -1;
  if (s.channels > 0) {
    SemanticTarget& t = v.data.semantics;
    t.channels = s.channels;
    t.width = s.width / 2;
    t.height = s.height / 2;
    t.confidence.assign(size_t(t.width) * t.height, 1.0f);
    v.data.labels = Image<uint16_t>(s.width, s.height, 1);
    std::vector<double> p(static_cast<size_t>(s.channels));
    for (int i = 0; i < t.width * t.height; ++i) {
      double sum = 0;
      for (double& x : p) sum += x = random.uniform(0.0, 0.2);
      const size_t top = static_cast<size_t>(random.below(s.channels));
      sum += 30;
      p[top] += 30;
      for (const double x : p) t.probabilities.push_back(float_to_half(static_cast<float>(x / sum)));
    }
  }
  return v;
}

StepRequest room_request(bool geometry) {
  StepRequest r;
  r.sh_degree = 3;
  r.extent = 3;
  r.rates = {1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f, 1e-7f};  // the scene stays as it is
  if (geometry) {
    r.losses.log_depth_weight = 0.5f;
    r.losses.normal_consistency_weight = 0.05f;
    r.losses.prior_normal_weight = 0.05f;
  }
  return r;
}

void run_step(benchmark::State& state, bool geometry) {
  RoomScene s;
  s.width = static_cast<int>(state.range(0));
  s.height = s.width * 3 / 4;
  s.gaussians = static_cast<size_t>(state.range(1));
  s.channels = static_cast<int>(state.range(2));
  const std::unique_ptr<Engine> engine = make_cpu_engine(static_cast<int>(state.range(3)));
  engine->load(room_model(s));
  std::vector<TrainingView> views;
  for (int i = 0; i < kViews; ++i) views.push_back(room_view(s, i));
  engine->set_training_views(std::move(views));
  StepRequest request = room_request(geometry);
  for (; request.step <= kViews; ++request.step) {  // warm: buffers, per-view preparation
    request.view = static_cast<int>(request.step % kViews);
    engine->step(request);
  }
  std::map<std::string, double> stages;
  double steps = 0, visible = 0;
  for (auto _ : state) {
    request.view = static_cast<int>(request.step++ % kViews);
    const StepReport report = engine->step(request);
    for (const auto& [name, seconds] : report.seconds) {  // the fastest, which other programs disturb least
      const auto [stage, first] = stages.try_emplace(name, 1e3 * seconds);
      if (!first) stage->second = std::min(stage->second, 1e3 * seconds);
    }
    visible += static_cast<double>(report.visible);
    ++steps;
  }
  for (const auto& [name, ms] : stages) state.counters[name] = ms;
  state.counters["visible"] = visible / steps;
}

void Step(benchmark::State& state) { run_step(state, true); }

BENCHMARK(Step)
    ->ArgNames({"width", "gaussians", "channels", "threads"})
    ->Args({320, 50000, 150, 2})
    ->Args({320, 50000, 0, 2})
    ->Args({640, 200000, 0, 2})
    ->Args({640, 200000, 150, 2})
    ->Args({320, 50000, 150, 1})
    ->Args({320, 50000, 0, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace aligngs

BENCHMARK_MAIN();
