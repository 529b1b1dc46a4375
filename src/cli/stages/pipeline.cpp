#include "cli/stages/pipeline.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/print_json.h"
#include "cli/report/html_report.h"
#include "cli/stages/eval_stage.h"
#include "cli/stages/render_stage.h"
#include "cli/stages/room_stage.h"
#include "cli/summary.h"
#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "train/run_control.h"
#include "train/run_record.h"

namespace aligngs {
namespace {

/// Writes the current stage to run.json, for viewers.
void enter_stage(const std::filesystem::path& run, const char* stage) {
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

/// room.json where the run has labels. A room that cannot be described is no reason to fail: everything else is there.
void describe(OpenRun& run, const TrainOptions& options) {
  if (!run.has_labels()) return;
  try {
    room_run(run, options.scene);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kInterrupted) throw;
    warn(options.run, std::string("there is no room.json: ") + error.what());
  }
}

/// The stages after training; returns metrics.json.
nlohmann::json make_products(const TrainOptions& options, const TsdfDeviceFactory& make_tsdf_device) {
  const RunLock lock(options.run);
  enter_stage(options.run, "render");
  OpenRun run = open_run(options.run, {options.scene, options.threads, options.make_engine});

  RenderStageOptions render;
  render.progress = options.progress;
  render.test = true;
  render_views(run, render);
  stop_here_if_asked(options.run);
  enter_stage(options.run, "mesh");
  MeshStageOptions mesh;
  mesh.make_device = make_tsdf_device;
  mesh.may_be_empty = true;
  if (mesh_run(run, mesh).file.empty()) {
    warn(options.run,
         "fusion found no surface, so that there is no mesh and geometry is not measured: train longer, or look at the "
         "renders");
  }
  stop_here_if_asked(options.run);
  enter_stage(options.run, "measure");
  EvalStageOptions eval;
  eval.progress = options.progress;
  const nlohmann::json metrics = evaluate_run(run, eval);
  enter_stage(options.run, "report");
  write_report(options.run);

  enter_stage(options.run, "room");
  describe(run, options);

  RunRecord record = read_run_record(options.run / "run.json");
  record.stage = "done";
  record.updated = record.finished = utc_now();
  write_run_record(options.run / "run.json", record);
  return metrics;
}

}  // namespace

nlohmann::json run_pipeline(const TrainOptions& options, const CommandContext& context,
                            const TsdfDeviceFactory& make_tsdf_device) {
  const TrainResult trained = train_run(options);
  if (trained.already_finished) log_info("the training was finished already");
  nlohmann::json metrics;
  try {
    metrics = make_products(options, make_tsdf_device);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kInterrupted) throw;
    throw Error({ErrorKind::kInterrupted,
                 "stopped; the training is finished",
                 {},
                 {},
                 "run again to make the rest: " + options.resume_command});
  }
  if (context.global.json) {
    print_json(metrics);
  } else {
    std::printf("training     %lld iterations in %s, %llu Gaussians\n", static_cast<long long>(trained.iterations),
                format_duration(trained.seconds).c_str(), static_cast<unsigned long long>(trained.gaussians));
    std::fputs(metrics_summary(metrics).c_str(), stdout);
    std::printf("look at      %s\n", (options.run / "report.html").string().c_str());
  }
  std::fflush(stdout);
  return metrics;
}

}  // namespace aligngs
