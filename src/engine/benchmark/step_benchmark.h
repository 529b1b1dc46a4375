// Times whole training steps on the benchmark's room and breaks them down by stage.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/benchmark/benchmark_room.h"
#include "engine/benchmark/machine_ceilings.h"
#include "engine/cpu/tile_statistics.h"
#include "engine/engine.h"

namespace aligngs {

struct StepBenchmarkOptions {
  BenchmarkRoom room;
  int threads = 0;           ///< 0: all hardware threads
  int warm_up = 4;           ///< steps before the first one that counts: buffers, what is prepared once per view
  int steps = 20;            ///< steps that count
  bool matrix_tiles = true;  ///< bfloat16 products where the processor has them; else float32 by vectors
  /// Makes the engine; empty: the CPU's, with `matrix_tiles`. Its steps must report stages (stage_names()).
  std::function<std::unique_ptr<Engine>(int threads)> make_engine;
  /// 1, 0.5 or 0.25 of the pixels take part in the semantic loss of a step, as preset default has it
  double pixel_share = 0.25;
  SemanticBlend blend = SemanticBlend::kProbabilities;  ///< kLogits: as preset paper has it
};

struct StepTiming {
  int threads = 0;
  double pixel_share = 1;                               ///< StepBenchmarkOptions
  SemanticBlend blend = SemanticBlend::kProbabilities;  ///< StepBenchmarkOptions
  double seconds = 0;                                   ///< median wall time of a step: every loss, optimiser included
  double best_seconds = 0;                              ///< of the fastest step, which other programs disturbed least
  /// Median over the steps of the processor time of all threads together, divided by their number. A step would take as
  /// long on a free machine with busy threads. Other programs change it much less than wall time.
  double cpu_seconds = 0;
  /// Median wall time by stage (StepReport::seconds), of the stages that most of the steps had.
  std::map<std::string, double> stages;
  std::map<std::string, double> best_stages;           ///< the fastest of each
  std::vector<std::map<std::string, double>> samples;  ///< stages of every step that counts
  double densify_seconds = 0;  ///< one call of density control (plan and restructuring), apart from the steps
  size_t densified = 0;        ///< Gaussians after that call
  double render_seconds = 0;   ///< colour, geometry and labels of one view
  cpu::TileStatistics tiles;   ///< of view 0
  size_t touched = 0;          ///< Gaussians that reached a pixel, mean over the steps
  /// of the process, without that of a device, so that it means this scene only when it is the first
  uint64_t peak_memory_bytes = 0;
};

StepTiming time_steps(const StepBenchmarkOptions& options);

/// The least work of a stage, whatever the implementation: its floor. "densify" comes beside the stages of a step; it
/// is bytes alone.
struct StageWork {
  double vector_flops = 0;  ///< float32 operations on active (Gaussian, pixel) pairs, rows or pixels
  double matrix_flops = 0;  ///< operations of the semantic tile products
  double bytes = 0;         ///< memory traffic with perfect caches
};
StageWork stage_work(const std::string& stage, const StepTiming& timing, const BenchmarkRoom& room);

/// The stages in the order in which a step runs them.
const std::vector<std::string>& stage_names();

}  // namespace aligngs
