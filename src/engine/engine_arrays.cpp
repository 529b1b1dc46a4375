#include "engine/engine_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "core/error.h"

namespace aligngs {
namespace {

constexpr const char* kSemanticUpdates = "adam_updates.semantics";
/// beyond every step: corrected by the number of the step, as before they were counted
constexpr float kManyUpdates = 1e7f;
constexpr size_t kBalanceFloats = 2 * sizeof(double) / sizeof(float);

/// A copy of a named array of the state.
std::vector<float> take(const EngineState& state, const std::string& name, size_t length) {
  const auto found = state.arrays.find(name);
  if (found == state.arrays.end()) {
    throw_bad_input({}, name, "the checkpoint lacks this array", "resume from an older checkpoint");
  }
  if (found->second.size() != length) {
    throw_bad_input({}, name,
                    "the checkpoint's array has " + std::to_string(found->second.size()) + " numbers instead of " +
                        std::to_string(length),
                    "resume from an older checkpoint");
  }
  return found->second;
}

}  // namespace

std::vector<NamedArray> arrays_of(GaussianModel& model) {
  return {{"positions", &model.positions, 3},
          {"log_scales", &model.log_scales, 3},
          {"rotations", &model.rotations, 4},
          {"opacity_logits", &model.opacity_logits, 1},
          {"sh", &model.sh, size_t(3) * kShCoefficients},
          {"semantics", &model.semantics, static_cast<size_t>(model.semantic_channels)}};
}

std::vector<NamedArray> arrays_of(DensityStatistics& s) {
  return {{"gradient", &s.gradient, 1},      {"gradient_abs", &s.gradient_abs, 1},
          {"visible", &s.visible, 1},        {"radius", &s.radius, 1},
          {"weight", &s.weight, 1},          {"residual", &s.residual, 1},
          {"unsupported", &s.unsupported, 1}};
}

void check_model(const GaussianModel& model) {
  GaussianModel& arrays = const_cast<GaussianModel&>(model);  // only sizes are read
  for (const NamedArray& a : arrays_of(arrays)) {
    if (a.values->size() == a.width * model.size()) continue;
    throw Error({ErrorKind::kFailed,
                 std::string(a.name) + " holds " + std::to_string(a.values->size()) + " numbers for " +
                     std::to_string(model.size()) + " Gaussians",
                 {},
                 a.name,
                 "the model was not resized as a whole"});
  }
  if (model.size() > 0xffffffffull) throw_resources({}, "more than 2^32 Gaussians", "lower the cap on Gaussians");
}

void check_step_request(const StepRequest& request, size_t views) {
  if (request.view < 0 || static_cast<size_t>(request.view) >= views) {
    throw Error({ErrorKind::kFailed,
                 "training view " + std::to_string(request.view) + " does not exist",
                 {},
                 "view",
                 "set the training views before the first step"});
  }
  if (request.has_multi_view_terms() &&
      (static_cast<size_t>(request.neighbour.view) >= views || request.neighbour.view == request.view)) {
    throw Error({ErrorKind::kFailed,
                 "view " + std::to_string(request.neighbour.view) + " cannot be the neighbour of training view " +
                     std::to_string(request.view),
                 {},
                 "neighbour",
                 "choose another training view"});
  }
  const SemanticSample& sample = request.losses.semantic_sample;
  if ((sample.quarters != 4 && sample.quarters != 2 && sample.quarters != 1) || sample.phase < 0 ||
      sample.square_shift < SemanticSample::kTileShift || sample.square_shift > 30) {
    throw_usage(
        "the semantic loss takes 4, 2 or 1 of four squares of 16 pixels or more, in a phase that is not negative");
  }
  if (!(request.raster.dropout.rate >= 0 && request.raster.dropout.rate <= kDropoutRateMax)) {
    throw_usage("a step leaves out none to nine tenths of the Gaussians");
  }
  if (request.sh_degree < 0 || request.sh_degree > kMaxShDegree || !(request.extent > 0)) {
    throw_usage("a step needs a degree of spherical harmonics in [0, 3] and a positive extent");
  }
}

const char* non_finite_loss(const LossTerms& terms) {
  for (const LossRow& row : kLossCatalogue) {
    if (!std::isfinite(terms[row.loss])) return row.name.data();
  }
  return std::isfinite(terms.total) ? nullptr : "total";
}

void check_plan(const RestructurePlan& plan, size_t rows) {
  for (const RowOrigin& row : plan.rows) {
    if (row.source < rows) continue;
    throw Error({ErrorKind::kFailed,
                 "a plan names row " + std::to_string(row.source) + " of " + std::to_string(rows),
                 {},
                 "source",
                 "make the plan from this model"});
  }
}

float reset_logit(float maximum) {
  if (!(maximum > 0 && maximum < 1)) throw_usage("an opacity to reset to lies between 0 and 1");
  return std::log(maximum / (1 - maximum));
}

void check_floors(const std::vector<float>& log_floors, size_t rows) {
  if (log_floors.size() == rows) return;
  throw Error({ErrorKind::kFailed,
               std::to_string(log_floors.size()) + " floors of scales for " + std::to_string(rows) + " Gaussians",
               {},
               {},
               {}});
}

void AdamMoments::reset(const GaussianModel& like) {
  m = v = like;
  for (GaussianModel* x : {&m, &v}) {
    for (const NamedArray& a : arrays_of(*x)) std::fill(a.values->begin(), a.values->end(), 0.0f);
  }
  semantic_updates.assign(like.size(), 0.0f);
  sh_used = 3;
}

void pack_state(GaussianModel model, EngineMemory memory, EngineState& state) {
  state.model = std::move(model);
  state.arrays.clear();
  const auto keep = [&](const char* prefix, const std::vector<NamedArray>& arrays) {
    for (const NamedArray& a : arrays) state.arrays[std::string(prefix) + a.name] = std::move(*a.values);
  };
  keep("adam_m.", arrays_of(memory.moments.m));
  keep("adam_v.", arrays_of(memory.moments.v));
  state.arrays[kSemanticUpdates] = std::move(memory.moments.semantic_updates);
  keep("density.", arrays_of(memory.statistics));
  const double running[2] = {memory.balance.photometric, memory.balance.semantic};
  std::vector<float>& balance = state.arrays["coupling.balance"];
  balance.resize(kBalanceFloats);
  std::memcpy(balance.data(), running, sizeof(running));
}

EngineMemory unpack_state(const EngineState& state) {
  check_model(state.model);
  EngineMemory memory;
  AdamMoments& moments = memory.moments;
  moments.m = moments.v = state.model;
  const auto fetch = [&](const char* prefix, const std::vector<NamedArray>& arrays) {
    for (const NamedArray& a : arrays) {
      *a.values = take(state, std::string(prefix) + a.name, a.width * state.model.size());
    }
  };
  fetch("adam_m.", arrays_of(moments.m));
  fetch("adam_v.", arrays_of(moments.v));
  if (state.arrays.count(kSemanticUpdates) > 0) {
    moments.semantic_updates = take(state, kSemanticUpdates, state.model.size());
  } else {
    moments.semantic_updates.assign(state.model.size(), kManyUpdates);
  }
  fetch("density.", arrays_of(memory.statistics));
  const std::vector<float> balance = take(state, "coupling.balance", kBalanceFloats);
  double running[2];
  std::memcpy(running, balance.data(), sizeof(running));
  memory.balance = {running[0], running[1]};
  constexpr size_t kShRow = size_t(3) * kShCoefficients;
  for (size_t i = 0; i < moments.m.sh.size(); ++i) {
    if (moments.m.sh[i] != 0 || moments.v.sh[i] != 0) moments.sh_used = std::max(moments.sh_used, i % kShRow + 1);
  }
  return memory;
}

}  // namespace aligngs
