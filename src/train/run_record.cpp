#include "train/run_record.h"

#include <fmt/format.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_integer.h"
#include "io/json_text.h"
#include "io/output_place.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr int kRecordSchema = 1;
constexpr uint64_t kLargestRecord = 1 << 24;

nlohmann::json or_null(const std::string& text) {
  return text.empty() ? nlohmann::json(nullptr) : nlohmann::json(text);
}

std::string text_of(const nlohmann::json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
}

std::vector<std::string> texts_of(const nlohmann::json& json, const char* name) {
  std::vector<std::string> texts;
  const auto it = json.find(name);
  if (it == json.end() || !it->is_array()) return texts;
  for (const nlohmann::json& text : *it) {
    if (text.is_string()) texts.push_back(text.get<std::string>());
  }
  return texts;
}

double number_of(const nlohmann::json& json, const char* name) {
  const auto it = json.find(name);
  return it != json.end() && it->is_number() ? it->get<double>() : 0;
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec);
}

void write_run_record(const fs::path& path, const RunRecord& r) {
  nlohmann::json json = nlohmann::json::object();
  if (fs::exists(path)) {
    const nlohmann::json old = parse_json(read_file(path, kLargestRecord));
    if (old.is_object()) json = old;
  }
  json["schema"] = kRecordSchema;
  json["status"] = word_of(r.status);
  json["stage"] = word_of(r.stage);
  json["command"] = r.command;
  json["version"] = r.version;
  json["device"] = r.device;
  json["seed"] = r.seed;
  json["started"] = or_null(r.started);
  json["updated"] = or_null(r.updated);
  json["finished"] = or_null(r.finished);
  json["trained"] = or_null(r.trained);
  json["reason"] = or_null(r.reason);
  json["scene"] = r.scene;
  json["fingerprint"] = r.fingerprint;
  json["left_out"] = r.left_out;
  json["prior_depth"] = r.prior_depth;
  if (!r.cameras.empty()) json["cameras"] = r.cameras;
  json["warnings"] = r.warnings;
  json["train"] = {{"seconds", r.train.seconds},
                   {"iterations", r.train.iterations},
                   {"gaussians", r.train.gaussians},
                   {"iterations_per_second", r.train.iterations_per_second},
                   {"peak_memory_bytes", r.train.peak_memory_bytes},
                   {"device", r.device}};
  write_file_atomically(path, json_document(json));
}

bool is_run_record(const fs::path& path) {
  if (!fs::is_regular_file(path)) return false;
  const nlohmann::json json = parse_json(read_file(path, kLargestRecord));
  if (!json.is_object()) return false;
  const auto is_text = [&](const char* name) {
    const auto it = json.find(name);
    return it != json.end() && it->is_string();
  };
  const auto schema = json.find("schema");
  return schema != json.end() && schema->is_number_integer() && is_text("status") && is_text("version") &&
         is_text("fingerprint");
}

RunRecord read_run_record(const fs::path& path) {
  const nlohmann::json json = parse_json(read_file(path, kLargestRecord));
  if (!json.is_object())
    throw_bad_input(path, "", "this is no run record", "the file is damaged; start again with --overwrite");
  RunRecord r;
  r.status = choice_named<RunStatus>(text_of(json, "status")).value_or(RunStatus::kUnknown);
  r.stage = choice_named<RunStage>(text_of(json, "stage")).value_or(RunStage::kUnknown);
  r.command = text_of(json, "command");
  r.version = text_of(json, "version");
  r.device = text_of(json, "device");
  r.seed = integer_member<int64_t>(json, "seed");
  r.started = text_of(json, "started");
  r.updated = text_of(json, "updated");
  r.finished = text_of(json, "finished");
  r.trained = text_of(json, "trained");
  r.reason = text_of(json, "reason");
  r.scene = text_of(json, "scene");
  r.fingerprint = text_of(json, "fingerprint");
  r.left_out = texts_of(json, "left_out");
  r.prior_depth = text_of(json, "prior_depth");
  r.cameras = text_of(json, "cameras");
  r.warnings = texts_of(json, "warnings");
  if (const auto train = json.find("train"); train != json.end() && train->is_object()) {
    r.train.seconds = number_of(*train, "seconds");
    r.train.iterations = integer_member<int64_t>(*train, "iterations");
    r.train.gaussians = integer_member<uint64_t>(*train, "gaussians");
    r.train.iterations_per_second = number_of(*train, "iterations_per_second");
    r.train.peak_memory_bytes = integer_member<uint64_t>(*train, "peak_memory_bytes");
  }
  return r;
}

fs::path scene_of_run(const fs::path& run_folder, const RunRecord& record, const fs::path& override_folder) {
  if (!override_folder.empty()) return override_folder;
  const fs::path scene = record.scene;
  // relative_scene_path() counts from the folder itself, not from a link to it
  return scene.is_absolute() ? scene : (real_place(run_folder) / scene).lexically_normal();
}

std::string relative_scene_path(const fs::path& run_folder, const fs::path& scene) {
  std::error_code error;
  const fs::path relative = fs::relative(scene, run_folder, error);
  return error || relative.empty() ? fs::absolute(scene).string() : relative.string();
}

}  // namespace aligngs
