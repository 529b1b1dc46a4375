#include "cli/stages/pipeline.h"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/print_json.h"
#include "cli/report/html_report.h"
#include "cli/stages/eval_stage.h"
#include "cli/stages/render_stage.h"
#include "cli/stages/room_stage.h"
#include "cli/summary.h"
#include "core/error.h"
#include "core/log.h"
#include "core/shell_word.h"
#include "core/stop_signal.h"
#include "metrics/metrics_json.h"
#include "train/run_control.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

/// Writes the current stage to run.json, for viewers.
void enter_stage(const std::filesystem::path& run, RunStage stage) {
  RunRecord record = read_run_record(run / "run.json");
  record.stage = stage;
  record.updated = utc_now();
  write_run_record(run / "run.json", record);
}

/// For viewers and for the report.
void warn(const std::filesystem::path& run, const std::string& message) {
  log_warning("{}", message);
  RunRecord record = read_run_record(run / "run.json");
  std::erase(record.warnings, message);  // of an earlier time
  record.warnings.push_back(message);
  write_run_record(run / "run.json", record);
}

/// Between stages: everything so far is on disk, so stopping here loses nothing.
void stop_here_if_asked(const std::filesystem::path& run) {
  if (RunControl(run).take(RunControl::Flag::kStop)) request_stop();
  stop_if_requested();
}

/// The steps after training, each by itself.
class Products {
 public:
  /// `soft`: of what was trained just now, or null.
  Products(const RunPlan& plan, const TrainOptions& options, std::shared_ptr<const SoftLabels> soft,
           const TsdfDeviceFactory& make_tsdf_device)
      : plan_(plan),
        options_(options),
        make_tsdf_device_(make_tsdf_device),
        run_(load_run(options.run, load_options(options, std::move(soft)))) {}

  void render() {
    RenderStageOptions render;
    render.progress = options_.progress;
    render_views(run_, render);
    stop_here_if_asked(options_.run);
  }

  void mesh() {
    MeshStageOptions mesh;
    mesh.make_device = make_tsdf_device_;
    mesh.may_be_empty = true;
    mesh.keep_looks = plan_.has(RunStep::kRoom);
    if (mesh_run(run_, mesh).file.empty()) {
      warn(options_.run,
           "fusion found no surface, so that there is no mesh and geometry is not measured: train longer, or look at "
           "the renders");
    }
    stop_here_if_asked(options_.run);
  }

  void evaluate() {
    EvalStageOptions eval;
    eval.progress = options_.progress;
    metrics_ = evaluate_run(run_, eval);
  }

  void report() { write_report(options_.run); }

  /// room.json. A room that cannot be described is no reason to fail: everything else is there.
  void room() {
    try {
      room_run(run_);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kInterrupted) throw;
      warn(options_.run, std::string("there is no room.json: ") + error.what());
    }
  }

  const RunMetrics& metrics() const { return metrics_; }

 private:
  static LoadRunOptions load_options(const TrainOptions& options, std::shared_ptr<const SoftLabels> soft) {
    LoadRunOptions load{options.scene, options.threads, options.make_engine};
    load.soft = std::move(soft);
    return load;
  }

  const RunPlan& plan_;
  const TrainOptions& options_;
  const TsdfDeviceFactory& make_tsdf_device_;
  LoadedRun run_;
  RunMetrics metrics_;
};

struct Product {
  RunStep step;
  RunStage stage;  ///< of run.json, which the page shows
  void (Products::*make)();
};
constexpr Product kProducts[] = {{RunStep::kRender, RunStage::kRender, &Products::render},
                                 {RunStep::kMesh, RunStage::kMesh, &Products::mesh},
                                 {RunStep::kEvaluate, RunStage::kMeasure, &Products::evaluate},
                                 {RunStep::kReport, RunStage::kReport, &Products::report},
                                 {RunStep::kRoom, RunStage::kRoom, &Products::room}};

/// Returns what was measured.
RunMetrics make_products(const RunPlan& plan, const TrainOptions& options, std::shared_ptr<const SoftLabels> soft,
                         const TsdfDeviceFactory& make_tsdf_device) {
  const RunLock lock(options.run);
  enter_stage(options.run, kProducts[0].stage);  // opening a large run takes seconds
  Products products(plan, options, std::move(soft), make_tsdf_device);
  for (const Product& product : kProducts) {
    if (!plan.has(product.step)) continue;
    enter_stage(options.run, product.stage);
    (products.*product.make)();
  }
  RunRecord record = read_run_record(options.run / "run.json");
  record.stage = RunStage::kDone;
  record.updated = record.finished = utc_now();
  write_run_record(options.run / "run.json", record);
  return products.metrics();
}

}  // namespace

RunMetrics run_pipeline(const RunPlan& plan, const TrainOptions& options, const CommandContext& context,
                        const TsdfDeviceFactory& make_tsdf_device) {
  TrainResult trained = train_run(options);
  if (trained.already_finished) log_info("the training was finished already");
  RunMetrics metrics;
  try {
    metrics = make_products(plan, options, std::move(trained.soft), make_tsdf_device);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInterrupted) throw;
    throw Error({ErrorKind::kInterrupted,
                 "stopped; the training is finished",
                 {},
                 {},
                 "run again to make the rest: " + options.resume_command});
  }
  if (context.global.json) {
    print_json(metrics_json(metrics));
  } else {
    std::printf("training     %lld iterations in %s, %llu Gaussians\n", static_cast<long long>(trained.iterations),
                format_duration(trained.seconds).c_str(), static_cast<unsigned long long>(trained.gaussians));
    std::fputs(metrics_summary(metrics).c_str(), stdout);
    std::printf("look at      %s\n", (options.run / "report.html").string().c_str());
    std::printf("browser      aligngs view %s\n", quote_word(options.run.string()).c_str());
  }
  std::fflush(stdout);
  return metrics;
}

}  // namespace aligngs
