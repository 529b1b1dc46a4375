#include "train/events.h"

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/memory_budget.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string kept_lines(const std::string& text, int64_t completed) {
  std::string kept;
  size_t begin = 0;
  for (size_t end = text.find('\n'); end != std::string::npos; begin = end + 1, end = text.find('\n', begin)) {
    const std::string line = text.substr(begin, end - begin);
    const Json json = parse_ordered_json(line);
    if (!json.is_object()) continue;
    const auto step = json.find("step");
    if (step != json.end() && step->is_number_integer() && step->get<int64_t>() > completed) continue;
    kept += line + "\n";
  }
  return kept;
}

Json losses_of(const LossTerms& losses) {
  Json json = {{"total", losses.total}};
  for (const LossRow& row : kLossCatalogue) json[std::string(row.name)] = losses[row.loss];
  return json;
}

}  // namespace

EventLog::EventLog(fs::path path, int64_t completed_iterations) : path_(std::move(path)) {
  if (fs::exists(path_)) {
    const std::string text = read_file(path_);
    const std::string kept = kept_lines(text, completed_iterations);
    if (kept != text) write_file_atomically(path_, kept);
  }
  file_.reset(std::fopen(path_.c_str(), "ab"));
  if (!file_) throw_resources(path_, std::string("the file cannot be opened: ") + std::strerror(errno));
}

void EventLog::line(const std::string& text) {
  // Flushed line by line: a viewer follows the file while the run goes on.
  if (std::fputs((text + "\n").c_str(), file_.get()) < 0 || std::fflush(file_.get()) != 0) {
    throw_resources(path_, std::string("the file cannot be written: ") + std::strerror(errno),
                    "free some disk space and use --resume");
  }
}

void EventLog::step(const Step& s) {
  Json json = {{"step", s.step},
               {"view", s.view},
               {"losses", losses_of(s.report->losses)},
               {"psnr", s.report->losses.psnr},
               {"gaussians", s.gaussians},
               {"visible", s.report->visible},
               {"coupling_scale", s.report->coupling_scale},
               {"seconds_per_step", s.seconds_per_step},
               {"memory_bytes", peak_memory_bytes()}};
  line(json_line(json));
}

void EventLog::restructured(int64_t step, const std::string& event, const RestructurePlan& plan) {
  line(json_line(Json{{"step", step},
                      {"event", event},
                      {"gaussians", plan.rows.size()},
                      {"cloned", plan.cloned},
                      {"split", plan.split},
                      {"pruned", plan.pruned}}));
}

void EventLog::message(int64_t step, const std::string& event, const std::string& message) {
  line(json_line(Json{{"step", step}, {"event", event}, {"message", message}}));
}

}  // namespace aligngs
