#include "cli/report/batch_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/report/run_scores.h"
#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

bool has_figures(const BatchFolder& folder, const RoomStatus& room) {
  return room.state == RoomState::kDone && std::filesystem::exists(folder.run(room.room.name) / "metrics.json");
}

}  // namespace

std::string batch_csv(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  std::string csv = "room,state,attempts,exit_status,message,remedy,retry";
  for (const ScoreColumn& c : score_columns()) csv += fmt::format(",{}", c.csv_name);
  csv += "\n";
  for (const RoomStatus& s : rooms) {
    const bool failed = s.state == RoomState::kFailed;
    csv += fmt::format("{},{},{},{},{},{},{}", csv_field(s.room.name), name_of(s.state), s.record.attempts,
                       failed ? std::to_string(s.record.exit_status) : "", failed ? csv_field(s.record.message) : "",
                       failed ? csv_field(s.record.remedy) : "",
                       failed ? csv_field(retry_command(folder, s.room.name)) : "");
    RunScores scores;
    scores.score.fill(std::nan(""));
    if (has_figures(folder, s)) scores = read_run_scores(folder.run(s.room.name));
    for (const double value : scores.score) csv += std::isfinite(value) ? fmt::format(",{}", value) : ",";
    csv += "\n";
  }
  return csv;
}

OrderedJson batch_json(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  OrderedJson list = OrderedJson::array();
  for (const RoomStatus& s : rooms) {
    OrderedJson room = {{"room", s.room.name},
                        {"state", name_of(s.state)},
                        {"run", folder.run(s.room.name).string()},
                        {"attempts", s.record.attempts}};
    if (!s.stage.empty()) room.update({{"stage", s.stage}, {"iterations", s.iterations}});
    if (!s.worker.empty()) room["worker"] = s.worker;
    if (s.state == RoomState::kFailed) {
      room.update({{"exit_status", s.record.exit_status},
                   {"message", s.record.message},
                   {"path", s.record.path},
                   {"field", s.record.field},
                   {"remedy", s.record.remedy},
                   {"log", folder.log(s.room.name).string()},
                   {"retry", retry_command(folder, s.room.name)}});
    }
    if (has_figures(folder, s)) {
      const RunScores scores = read_run_scores(folder.run(s.room.name));
      for (size_t c = 0; c < kScoreCount; ++c) {
        if (std::isfinite(scores.score[c])) room["figures"][score_columns()[c].csv_name] = scores.score[c];
      }
    }
    list.push_back(std::move(room));
  }
  return {{"folder", folder.path().string()}, {"rooms", list}};
}

void write_batch_json(const std::filesystem::path& file, const BatchFolder& folder,
                      const std::vector<RoomStatus>& rooms) {
  write_file_atomically(file, json_document(batch_json(folder, rooms)));
}

}  // namespace aligngs
