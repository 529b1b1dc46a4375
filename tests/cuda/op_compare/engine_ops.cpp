#include <memory>

#include "compare_ops.h"
#include "device/tolerances.h"
#include "engine/cpu/cpu_engine.h"
#include "engine/cuda/cuda_engine.h"
#include "engine/engine_arrays.h"

namespace aligngs::op_compare {
namespace {

using cuda::CudaTolerance;

/// Both engines with the scene, and a balance with which the coupling acts in the first step.
struct Engines {
  cpu::CpuEngine cpu{1};
  cuda::CudaEngine device;

  Engines(int index, const CompareScene& scene) : device(index, 0, 1) {
    const CouplingBalance balance{2e-4, 1e-3};
    cpu.set_semantic_products(cpu::SemanticProducts::kFloat32);
    cpu.keep_features(true);
    for (Engine* e : {static_cast<Engine*>(&cpu), static_cast<Engine*>(&device)}) {
      e->set_training_views({scene.training});
      e->load(scene.model);
    }
    cpu.set_coupling_balance(balance);
    device.set_coupling_balance(balance);
  }
};

void compare_models(const char* op, const std::string& prefix, GaussianModel got, GaussianModel want,
                    const Limit& shape, const Limit& colour, const Limit& semantic, OpTable& table) {
  const std::vector<NamedArray> a = arrays_of(got), b = arrays_of(want);
  for (size_t k = 0; k < b.size(); ++k) {
    const std::string name = b[k].name;
    table.compare(op, prefix + name, *a[k].values, *b[k].values,
                  name == "sh"          ? colour
                  : name == "semantics" ? semantic
                                        : shape);
  }
}

void compare_rendering(Engines& engines, const CompareScene& scene, OpTable& table) {
  RenderOptions options;
  options.labels = scene.model.semantic_channels > 0;
  const Camera& camera = scene.training.data.camera;
  const Rendering got = engines.device.render(camera, options), want = engines.cpu.render(camera, options);
  const CudaTolerance t;
  const Limit depth = with_large_flips(tight(t.depth));
  table.compare("finish_maps", "colour", got.color.data, want.color.data, tight(t.map));
  table.compare("finish_maps", "alpha", got.alpha.data, want.alpha.data, tight(t.map));
  table.compare("finish_maps", "normal", got.normal.data, want.normal.data, tight(t.unit_normal));
  table.compare("finish_maps", "plane depth", got.depth_plane.data, want.depth_plane.data, depth);
  table.compare("finish_maps", "median depth", got.depth_median.data, want.depth_median.data, depth);
  table.compare("finish_maps", "expected depth", got.depth_expected.data, want.depth_expected.data, depth);
  if (!options.labels) return;
  table.compare("label_map", "label", got.label.data, want.label.data, exact(t.large_flips));
  table.compare("label_map", "probability", got.label_probability.data, want.label_probability.data,
                tight(t.label_probability));
}

void compare_step(Engines& engines, const CompareScene& scene, OpTable& table) {
  const StepReport got = engines.device.step(scene.request), want = engines.cpu.step(scene.request);
  const CudaTolerance t;
  const char* op = "step";
  table.compare_number(op, "finite", got.non_finite.found ? 0 : 1, want.non_finite.found ? 0 : 1, exact());
  table.compare_number(op, "visible", static_cast<double>(got.visible), static_cast<double>(want.visible),
                       tight(t.flips));
  table.compare_number(op, "coupling scale", got.coupling_scale, want.coupling_scale, exact());
  for (const Loss loss : losses_of(LossStage::kColor, LossStage::kGeometry, LossStage::kShape)) {
    table.compare_number(op, row_of(loss).name.data(), got.losses[loss], want.losses[loss],
                         absolute(tight(loss == Loss::kNormalConsistency ? t.normal_consistency : t.loss)));
  }
  table.compare_number(op, "soft loss", got.losses[Loss::kSemanticSoft], want.losses[Loss::kSemanticSoft],
                       absolute(loose(t.semantic_loss)));
  table.compare_number(op, "hard loss", got.losses[Loss::kSemanticHard], want.losses[Loss::kSemanticHard],
                       absolute(loose(t.semantic_loss)));
  const bool semantics = scene.model.semantic_channels > 0;
  compare_models(op, "d ", engines.device.last_gradients(), engines.cpu.last_gradients(),
                 semantics ? loose(t.gradient + t.coupling) : tight(t.gradient), tight(t.gradient),
                 loose(t.semantic_gradient), table);
  DensityStatistics a = engines.device.density_statistics(), b = engines.cpu.density_statistics();
  const std::vector<NamedArray> got_arrays = arrays_of(a), want_arrays = arrays_of(b);
  for (size_t k = 0; k < want_arrays.size(); ++k) {
    table.compare(op, std::string("density ") + want_arrays[k].name, *got_arrays[k].values, *want_arrays[k].values,
                  tight(t.statistic));
  }
}

/// From one state, rows kept, copied, split and left out: copies are exact, and so is what is added to them.
void compare_restructuring(Engines& engines, OpTable& table) {
  EngineState state;
  engines.device.save_state(state);
  engines.cpu.load_state(state);
  RestructurePlan plan;
  for (size_t i = 0; i < state.model.size(); ++i) {
    if (i % 5 == 0) continue;
    RowOrigin row;
    row.source = static_cast<uint32_t>(i);
    plan.rows.push_back(row);
    if (i % 7 != 0) continue;
    row.kind = i % 2 == 0 ? RowOrigin::Kind::kClone : RowOrigin::Kind::kSplit;
    row.offset[i % 3] = 0.125f;
    row.shrink = i % 2 == 0 ? 1.0f : 1.6f;
    plan.rows.push_back(row);
  }
  engines.device.restructure(plan);
  engines.cpu.restructure(plan);
  EngineState got, want;
  engines.device.save_state(got);
  engines.cpu.save_state(want);
  compare_models("restructure", "", got.model, want.model, exact(), exact(), exact(), table);
  for (const auto& [name, values] : want.arrays)
    table.compare("restructure", name, got.arrays.at(name), values, exact());
}

void compare_opacity_reset(Engines& engines, OpTable& table) {
  engines.device.reset_opacity(0.1f);
  engines.cpu.reset_opacity(0.1f);
  GaussianModel got, want;
  engines.device.store(got);
  engines.cpu.store(want);
  table.compare("reset_opacity", "opacity logits", got.opacity_logits, want.opacity_logits, exact());
}

void compare_lift(Engines& engines, const CompareScene& scene, OpTable& table) {
  if (scene.model.semantic_channels == 0) return;
  engines.device.lift_semantics(scene.request.raster);
  engines.cpu.lift_semantics(scene.request.raster);
  GaussianModel got, want;
  engines.device.store(got);
  engines.cpu.store(want);
  table.compare("lift", "semantics", got.semantics, want.semantics, with_large_flips(tight(CudaTolerance().lift)));
}

}  // namespace

void compare_engines(int device, const CompareScene& scene, OpTable& table) {
  Engines engines(device, scene);
  compare_rendering(engines, scene, table);
  compare_step(engines, scene, table);
  compare_restructuring(engines, table);
  compare_opacity_reset(engines, table);
  compare_lift(engines, scene, table);
}

}  // namespace aligngs::op_compare
