// events.ndjson: one JSON object per line, appended while a run goes on.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "engine/engine.h"
#include "gaussians/density_control.h"

namespace aligngs {

class EventLog {
 public:
  /// Opens for appending. First removes every line of a step beyond `completed_iterations`, and a line that a killed
  /// writer left incomplete. A resumed run writes those steps again. Error{kResources} when it cannot.
  EventLog(std::filesystem::path path, int64_t completed_iterations);

  /// {"step", "view", "losses": {...}, "psnr", "gaussians", "visible", "seconds_per_step", "memory_bytes"}
  struct Step {
    int64_t step = 0;
    std::string view;
    const StepReport* report = nullptr;
    size_t gaussians = 0;
    double seconds_per_step = 0;
  };
  void step(const Step& step);
  /// {"step", "event": name, "gaussians", "cloned", "split", "pruned"}
  void restructured(int64_t step, const std::string& event, const RestructurePlan& plan);
  /// {"step", "event": name, "message"}
  void message(int64_t step, const std::string& event, const std::string& message);

 private:
  void line(const std::string& text);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace aligngs
