// One training step on the CPU, every intermediate kept: the inputs of each operation on the device, and what it has to
// give back.
#pragma once

#include "engine/benchmark/benchmark_room.h"
#include "engine/cpu/semantic_visit.h"
#include "engine/cuda/testing/view.h"

namespace aligngs::op_compare {

/// The benchmark's room with every loss on, and rates of the usual size.
struct CompareScene {
  BenchmarkRoom room;
  GaussianModel model;
  TrainingView training;
  StepRequest request;
};
CompareScene make_compare_scene(const BenchmarkRoom& room);

/// Float32 on the CPU, semantic products too. Not to be copied: `view` holds memory of the device.
struct CpuStep {
  /// `scene` outlives the step.
  CpuStep(cuda::DeviceContext& context, const CompareScene& scene);

  const CompareScene& scene;
  /// Projection, lists, maps and record, and their copies on the device, whose spans are for reading alone.
  mutable cuda::TestView view;

  LossTerms map_terms;  ///< of the maps
  MapGradients<float> gradients;
  std::vector<float> residual;

  size_t channels = 0, padded = 0;
  SemanticView cache;
  cpu::ClassCounts counts;
  cpu::AlignedArray<float> features;       ///< [visible][padded] softmax of the rows in view
  cpu::AlignedArray<float> row_gradients;  ///< [visible][padded] dL/dfeatures where written
  std::vector<uint8_t> written;            ///< [visible]
  std::vector<float> logit_gradients;      ///< [visible][padded] dL/dlogits, zero where not written
  double soft = 0, hard = 0;

  cpu::SlotGradients slots;     ///< of the maps and of the coupling
  float coupling_scale = 0.5f;  ///< factor of the coupling, any
  cpu::ParameterGradientTotals totals;
  cpu::ParameterGradients parameters;  ///< without the shape terms
  LossTerms shape_terms;
  cpu::ParameterGradients with_shape;  ///< with them
  DensityStatistics statistics;

  bool semantics() const { return channels > 0; }
  cpu::ParameterGradientInputs parameter_gradient_inputs(const StepRequest& request) const;

 private:
  void run_losses();
  void run_backward();
  void run_reduction();
};

}  // namespace aligngs::op_compare
