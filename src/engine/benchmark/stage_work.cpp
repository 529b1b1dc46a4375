// The least that each stage must compute and move. Counts per item are of the formulas in engine/formulas; an
// exponential counts as 12 operations. Bytes are those of the arrays that cannot stay in a cache from one stage to the
// next.
#include "engine/benchmark/step_benchmark.h"
#include "engine/cpu/blend_backward.h"
#include "engine/cpu/splats.h"

namespace aligngs {
namespace {

constexpr double kFloat = 4;         // bytes
constexpr double kShapeFloats = 11;  // position, scale, rotation, opacity
constexpr double kShFloats = 48;     // degree 3
constexpr double kAdamBytes = 28;    // read p, m, v, g; write p, m, v
constexpr double kSplatBytes = sizeof(cpu::Splat);
constexpr double kSlotBytes = sizeof(cpu::CoupledSplatGradient);

}  // namespace

StageWork stage_work(const std::string& stage, const StepTiming& timing, const BenchmarkRoom& room) {
  const cpu::TileStatistics& t = timing.tiles;
  const double n = static_cast<double>(t.gaussians), visible = static_cast<double>(t.visible),
               pairs = static_cast<double>(t.pairs), used = static_cast<double>(t.used),
               active = static_cast<double>(t.active), entries = static_cast<double>(t.entries),
               pixels = static_cast<double>(t.pixels), touched = static_cast<double>(timing.touched),
               channels = room.channels;
  if (stage == "project") {
    // Frame, covariance and rectangle of every row; colour and record of the visible ones.
    return {200 * n + 250 * visible, 0,
            (kShapeFloats * kFloat + 12) * n + (kShFloats * kFloat + kSplatBytes) * visible};
  }
  if (stage == "bin") {
    // Rectangles; three passes over (key, row); the rows by tile, counted and written.
    return {0, 0, 16 * n + 3 * 16 * visible + 8 * visible + 8 * pairs};
  }
  if (stage == "forward") {
    // Alpha 26; weight, colour, normal, distance, depth 28. Eleven maps are written.
    return {54 * active, 0, kSplatBytes * used + 11 * kFloat * pixels};
  }
  if (stage == "semantic_rows") {
    // The rows that some pixel used, in and out; a softmax of each, unless logits are blended.
    const double softmax = timing.blend == SemanticBlend::kProbabilities ? 20 : 0;
    return {softmax * touched * channels, 0, 2 * kFloat * touched * channels};
  }
  if (stage == "losses") {
    // SSIM by two separable passes: 306 per channel; depth, normals and edges: about 250.
    return {(3 * 306 + 250) * pixels, 0, 60 * kFloat * pixels};
  }
  if (stage == "backward") {
    // Alpha 26; sums of colour, geometry and density 40; gradient and moments 45. Sums leave once per pair.
    return {111 * active, 0, (kSplatBytes + kSlotBytes) * used + 10 * kFloat * pixels};
  }
  if (stage == "semantics") {
    // Three products over blocks of 64 pixels; softmax, loss and gradient 40 per pixel and class; rows in and out once.
    const double share = timing.pixel_share;
    return {40 * share * pixels * channels, 3 * 2 * 64 * share * entries * channels,
            2 * kFloat * share * touched * channels};
  }
  if (stage == "parameter_gradients") {
    return {700 * touched, 0,
            kSlotBytes * used + (kSlotBytes + kSplatBytes + 2 * (kShapeFloats + kShFloats) * kFloat) * touched};
  }
  if (stage == "optimise") {
    // A share of the pixels reaches at least that share of the rows, on the mean over the phases of the sample.
    const double numbers = (kShapeFloats + kShFloats) * n + timing.pixel_share * channels * touched;
    return {14 * numbers, 0, kAdamBytes * numbers};
  }
  if (stage == "densify") {
    // The plan is made from a copy of the shapes (Engine::store_shapes); then parameters and both moments move to their
    // new rows.
    const double per_row = kFloat * (kShapeFloats + kShFloats + channels);
    return {0, 0, kFloat * kShapeFloats * 2 * n + per_row * 3 * (n + static_cast<double>(timing.densified))};
  }
  return {};
}

}  // namespace aligngs
