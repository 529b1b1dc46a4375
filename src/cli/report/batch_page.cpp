#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/report/batch_results.h"
#include "cli/report/overview.h"
#include "cli/report/picture_cell.h"
#include "cli/report/run_scores.h"
#include "cli/report/svg_chart.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

const char* const kBatchStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;color:#1f2937;margin:24px;max-width:none}
h1{font-size:24px} h2{font-size:18px;margin:28px 0 8px}
table{border-collapse:collapse} td,th{padding:3px 10px;text-align:right;border-bottom:1px solid #eee}
td:first-child,th:first-child{text-align:left}
.failed{background:#fee2e2;border-radius:6px;padding:8px 12px;margin:8px 0} .failed p{margin:2px 0}
code{background:#f3f4f6;border-radius:4px;padding:1px 5px;user-select:all}
.views td,.views th{padding:2px;border:0;text-align:left;font-weight:400;font-size:13px}
.views img{width:260px;display:block}
)";

/// The columns that a page has room for; the CSV has all.
constexpr Score kShown[] = {Score::kPsnr,    Score::kSsim, Score::kAccuracy, Score::kCompleteness, Score::kFscore,
                            Score::kNormals, Score::kMiou, Score::kSeconds,  Score::kGaussians};

std::string link_to(const std::string& room, const char* file) { return fmt::format("rooms/{}/{}", room, file); }

std::string failures(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  std::string html;
  for (const RoomStatus& s : rooms) {
    if (s.state != RoomState::kFailed) continue;
    const RoomRecord& r = s.record;
    html += fmt::format("<div class=\"failed\"><p><b>{}</b>: status {}: {}</p>", escape_html(s.room.name),
                        r.exit_status, escape_html(r.message));
    if (!r.path.empty()) html += fmt::format("<p>file: {} {}</p>", escape_html(r.path), escape_html(r.field));
    if (!r.remedy.empty()) html += fmt::format("<p>remedy: {}</p>", escape_html(r.remedy));
    html += fmt::format("<p>again: <code>{}</code></p><p><a href=\"logs/{}.txt\">log</a></p></div>",
                        escape_html(retry_command(folder, s.room.name)), escape_html(s.room.name));
  }
  return html.empty() ? "" : "<h2>Failed</h2>" + html;
}

std::string figures(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  std::string html = "<h2>Rooms</h2><table><tr><th>room</th><th>state</th>";
  for (const Score s : kShown) html += fmt::format("<th>{}</th>", score_columns()[static_cast<size_t>(s)].name);
  html += "</tr>";
  for (const RoomStatus& s : rooms) {
    const fs::path run = folder.run(s.room.name);
    const bool done = s.state == RoomState::kDone && fs::exists(run / "metrics.json");
    const std::string name = escape_html(s.room.name);
    html += "<tr><td>" +
            (fs::exists(run / "report.html") ? fmt::format("<a href=\"{}\">{}</a>", link_to(name, "report.html"), name)
                                             : name) +
            "</td>";
    html += fmt::format("<td>{}</td>", name_of(s.state));
    if (done) {
      const RunScores scores = read_run_scores(run);
      for (const Score c : kShown) html += fmt::format("<td>{}</td>", score_text(static_cast<size_t>(c), scores[c]));
    } else {
      for ([[maybe_unused]] const Score c : kShown) html += "<td></td>";
    }
    html += "</tr>";
  }
  return html + "</table>";
}

/// A view of each room.
std::string pictures(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  std::string rows;
  for (const RoomStatus& s : rooms) {
    const fs::path run = folder.run(s.room.name);
    if (s.state != RoomState::kDone) continue;
    const ShownRenders shown = shown_renders(run);
    if (shown.views.empty()) continue;
    rows += fmt::format("<tr><td>{}</td>", escape_html(s.room.name));
    for (const RenderKind& kind : kRenderKinds) {
      if (kind.in_overview) rows += picture_cell(shown.folder(run) / kind.folder / (shown.views.front() + ".png"));
    }
    rows += "</tr>";
  }
  if (rows.empty()) return "";
  std::string html = "<h2>A view of each room</h2><div class=\"views\"><table><tr><th></th>";
  for (const RenderKind& kind : kRenderKinds) {
    if (kind.in_overview) html += fmt::format("<th>{}</th>", kind.title);
  }
  return html + "</tr>" + rows + "</table></div>";
}

}  // namespace

std::string batch_page(const BatchFolder& folder, const std::vector<RoomStatus>& rooms) {
  const auto done =
      std::count_if(rooms.begin(), rooms.end(), [](const RoomStatus& s) { return s.state == RoomState::kDone; });
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">"
      "<title>aligngs: rooms</title><style>" +
      std::string(kBatchStyle) + "</style>";
  html += fmt::format("<h1>{} of {} rooms are done</h1>", done, rooms.size());
  return html + failures(folder, rooms) + figures(folder, rooms) + pictures(folder, rooms) + "</html>\n";
}

}  // namespace aligngs
