#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/report/comparison.h"
#include "cli/report/overview.h"
#include "cli/report/picture_cell.h"
#include "cli/report/svg_chart.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

const char* const kComparisonStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;color:#1f2937;margin:24px;max-width:none}
h1{font-size:24px} h2{font-size:18px;margin:28px 0 8px}
table{border-collapse:collapse} td,th{padding:3px 10px;text-align:right;border-bottom:1px solid #eee}
td:first-child,th:first-child{text-align:left}
.best{font-weight:700} .note{background:#fef9c3;border-radius:6px;padding:6px 10px;margin:8px 0}
.views{overflow-x:auto} .views td,.views th{padding:2px;border:0;text-align:left;font-weight:400;font-size:13px}
.views img{width:300px;display:block}
)";

/// Whether a larger figure is the better one; 0: neither is.
int better_sign(size_t column) {
  switch (static_cast<Score>(column)) {
    case Score::kLpips:
    case Score::kAccuracy:
    case Score::kCompleteness:
    case Score::kSeconds:
      return -1;
    case Score::kGaussians:
      return 0;
    default:
      return 1;
  }
}

std::string table(const std::vector<RunScores>& runs) {
  std::string html = "<table><tr><th>run</th>";
  for (const ScoreColumn& c : score_columns()) html += fmt::format("<th>{}</th>", c.name);
  for (const ViewScoreColumn& c : view_score_columns())
    html += fmt::format("<th>{}: difference from the first, 95 % interval</th>", c.name);
  html += "</tr>";
  for (size_t i = 0; i < runs.size(); ++i) {
    html += "<tr><td>" + escape_html(runs[i].name) + "</td>";
    for (size_t c = 0; c < kScoreCount; ++c) {
      const double value = runs[i].score[c] * better_sign(c);
      bool best = std::isfinite(value) && better_sign(c) != 0;
      for (const RunScores& other : runs) best = best && !(other.score[c] * better_sign(c) > value);
      html += fmt::format("<td{}>{}</td>", best ? " class=\"best\"" : "", score_text(c, runs[i].score[c]));
    }
    for (const ViewScoreColumn& c : view_score_columns()) {
      const PairedDifference d = i == 0 ? PairedDifference{} : view_difference(runs[0], runs[i], c.score);
      html += i > 0 && runs[i].other_room ? "<td>different rooms</td>"
              : i == 0 || d.pairs == 0    ? "<td></td>"
              : !d.has_interval()
                  ? fmt::format("<td>{:+.{}f}, no interval below {} views</td>", d.mean, c.digits, kFewestPairs)
                  : fmt::format("<td>{:+.{}f} [{:+.{}f}, {:+.{}f}]{}</td>", d.mean, c.digits, d.low, c.digits, d.high,
                                c.digits, d.beyond_noise() ? "" : " inside the noise");
    }
    html += "</tr>";
  }
  return html + "</table>";
}

fs::path render_of(const RunScores& run, const char* kind, const std::string& view) {
  return run.folder / "renders" / "test" / kind / (view + ".png");
}

std::string pictures(const std::vector<RunScores>& runs, const char* kind) {
  std::string rows;
  int shown = 0;
  for (const std::string& view : rendered_views(runs[0].folder, "test")) {
    if (shown++ >= kMaxViewsOnPage) break;
    std::string row = "<tr><td>" + escape_html(view) + "</td>" + picture_cell(render_of(runs[0], "gt", view));
    bool any = false;
    for (const RunScores& run : runs) {
      const fs::path file = render_of(run, kind, view);
      any = any || fs::exists(file);
      row += picture_cell(file);
    }
    if (any) rows += row + "</tr>";
  }
  if (rows.empty()) return "";
  std::string html = fmt::format("<h2>{}</h2><div class=\"views\"><table><tr><th></th><th>photo</th>", kind);
  for (const RunScores& run : runs) html += "<th>" + escape_html(run.name) + "</th>";
  return html + "</tr>" + rows + "</table></div>";
}

}  // namespace

std::string comparison_page(const std::vector<RunScores>& runs) {
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">"
      "<title>aligngs: comparison</title><style>" +
      std::string(kComparisonStyle) + "</style><h1>Runs side by side</h1>";
  for (const std::string& warning : comparison_warnings(runs))
    html += "<p class=\"note\">" + escape_html(warning) + "</p>";
  html += table(runs);
  for (const char* kind : {"rgb", "depth", "normal", "label"}) html += pictures(runs, kind);
  return html + "</html>\n";
}

}  // namespace aligngs
