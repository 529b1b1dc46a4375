#include "cli/report/html_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "cli/report/overview.h"
#include "cli/report/picture_cell.h"
#include "cli/report/svg_chart.h"
#include "engine/loss_catalogue.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "metrics/metrics_json.h"
#include "train/run_record.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

const char* const kReportStyle = R"(
body{font:15px/1.45 system-ui,sans-serif;color:#1f2937;max-width:1180px;margin:24px auto;padding:0 16px}
h1{font-size:24px;margin:0 0 4px} h2{font-size:18px;margin:28px 0 8px;border-bottom:1px solid #e5e7eb}
table{border-collapse:collapse} td,th{padding:3px 10px;text-align:right;border-bottom:1px solid #f0f0f0} th{font-weight:600}
td:first-child,th:first-child{text-align:left}
.cards{display:flex;flex-wrap:wrap;gap:10px} .card{border:1px solid #e5e7eb;border-radius:8px;padding:8px 14px;min-width:110px}
.card b{display:block;font-size:20px} .note{background:#fef9c3;border-radius:6px;padding:6px 10px;margin:8px 0}
.views{overflow-x:auto} .views img{width:148px;display:block;image-rendering:auto} .views td{padding:2px;border:0}
pre{background:#f8fafc;padding:10px;overflow:auto;font-size:12.5px} svg{max-width:100%}
.chart-title{font:600 13px system-ui} .tick,.legend{font:11px system-ui} .tick{fill:#6b7280} .grid{stroke:#e5e7eb}
)";

/// A figure, formatted; "–" when it was not measured.
std::string number(double value, const char* format) {
  return std::isnan(value) ? "–" : fmt::format(fmt::runtime(format), value);
}

/// Nothing for a figure that was not measured.
std::string card(const std::string& name, double value, const char* format) {
  if (std::isnan(value)) return "";
  return fmt::format("<div class=\"card\"><b>{}</b>{}</div>", number(value, format), escape_html(name));
}

/// `training_psnr` (dB) is shown where no test view was measured.
std::string summary(const RunMetrics& metrics, double training_psnr) {
  const NovelViewMetrics views = metrics.novel_views.value_or(NovelViewMetrics());
  const auto mesh = [&](double MeshScores::*figure) {
    return metrics.geometry ? metrics.geometry->headline.scores.*figure : kUndefined;
  };
  const double fscore_2cm = metrics.geometry ? finer_fscore(metrics.geometry->headline.scores, 0.02) : kUndefined;
  const double normal_error = metrics.geometry ? metrics.geometry->surface.normal_error.median : kUndefined;
  const double gaussians = metrics.train.gaussians ? static_cast<double>(*metrics.train.gaussians) : kUndefined;
  const bool tested = !std::isnan(views.psnr);
  return "<div class=\"cards\">" + card("PSNR of test views (dB)", views.psnr, "{:.2f}") +
         card("PSNR of training views (dB)", tested ? kUndefined : training_psnr, "{:.2f}") +
         card("SSIM", views.ssim, "{:.3f}") + card("F-score at 5 cm", mesh(&MeshScores::fscore), "{:.3f}") +
         card("F-score at 2 cm", fscore_2cm, "{:.3f}") + card("normal error (degrees)", normal_error, "{:.1f}") +
         card("accuracy (m)", mesh(&MeshScores::accuracy), "{:.3f}") +
         card("completeness (m)", mesh(&MeshScores::completeness), "{:.3f}") +
         card(fmt::format("mIoU, classes with at least {:g} % of the pixels", 100 * kLeastClassShare),
              metrics.semantics ? metrics.semantics->miou : kUndefined, "{:.3f}") +
         card("mIoU, all classes present", metrics.semantics ? metrics.semantics->present_miou : kUndefined, "{:.3f}") +
         card("Gaussians", gaussians, "{:.0f}") + card("training (s)", metrics.train.seconds, "{:.1f}") + "</div>" +
         (tested ? "" : "<p>No photo was kept for testing: how well new views look was not measured.</p>");
}

/// The files of the run that other programs open, and the commands that show it and write more.
std::string products(const fs::path& run) {
  const std::pair<const char*, const char*> files[] = {{"scene.ply", "splats"},
                                                       {"mesh/mesh.ply", "mesh"},
                                                       {"scene.labels.ply", "splats with classes and objects"},
                                                       {"room.json", "measures of the room"},
                                                       {"metrics.json", "all figures"}};
  std::string links;
  for (const auto& [file, title] : files) {
    if (!fs::exists(run / file)) continue;
    links += fmt::format("{}<a href=\"{}\">{}</a>", links.empty() ? "" : ", ", file, title);
  }
  return "<p>" + (links.empty() ? "" : "Files: " + links + ". ") +
         "<code>aligngs view</code> shows the room in the browser, and <code>aligngs export</code> writes other "
         "formats.</p>";
}

std::string pictures(const fs::path& run) {
  const ShownRenders shown = shown_renders(run);
  const std::vector<std::string>& names = shown.views;
  if (names.empty()) return "<h2>Renders</h2><p>No renders: <code>aligngs render RUN</code> makes them.</p>";
  std::string html = shown.split == "test" ? "<h2>Renders of test views</h2>"
                                           : "<h2>Renders of training views</h2><p>Training has seen these photos.</p>";
  html += "<div class=\"views\"><table><tr><th>view</th>";
  for (const RenderKind& kind : kRenderKinds) {
    if (fs::exists(shown.folder(run) / kind.folder))
      html += fmt::format("<th style=\"text-align:left\">{}</th>", kind.title);
  }
  html += "</tr>";
  for (size_t i = 0; i < names.size() && i < size_t(kMaxViewsOnPage); ++i) {
    html += "<tr><td>" + escape_html(names[i]) + "</td>";
    for (const RenderKind& kind : kRenderKinds) {
      if (fs::exists(shown.folder(run) / kind.folder))
        html += picture_cell(shown.folder(run) / kind.folder / (names[i] + ".png"));
    }
    html += "</tr>";
  }
  return html + "</table></div>";
}

/// One series per numeric field of the events, with the iteration as x.
std::vector<ChartSeries> series_of(const std::vector<Json>& events, const std::vector<std::string>& fields) {
  std::vector<ChartSeries> series;
  for (const std::string& field : fields) {
    ChartSeries one{field, {}};
    for (const Json& event : events) {
      if (!event.contains("step") || !event["step"].is_number()) continue;
      const Json* value = event.contains(field) ? &event[field] : nullptr;
      if (!value && event.contains("losses") && event["losses"].is_object() && event["losses"].contains(field))
        value = &event["losses"][field];
      if (value && value->is_number()) one.points.emplace_back(event["step"].get<double>(), value->get<double>());
    }
    if (!one.points.empty()) series.push_back(std::move(one));
  }
  return series;
}

/// A running mean: one view's loss jumps, the trend is what is read.
ChartSeries smoothed(ChartSeries series) {
  constexpr double kKeep = 0.9;
  double mean = series.points.empty() ? 0 : series.points[0].second;
  for (auto& point : series.points) point.second = mean = kKeep * mean + (1 - kKeep) * point.second;
  return series;
}

bool acts(const ChartSeries& series) {
  return std::any_of(series.points.begin(), series.points.end(), [](const auto& point) { return point.second != 0; });
}

/// One chart per stage of the catalogue with a loss that acted in some step.
std::string loss_charts(const std::vector<Json>& events) {
  std::string html;
  for (const auto& [stage, title] : kLossStages) {
    std::vector<std::string> names;
    for (const Loss loss : losses_of(stage)) names.emplace_back(row_of(loss).name);
    std::vector<ChartSeries> series;
    for (ChartSeries& one : series_of(events, names)) {
      if (acts(one)) series.push_back(smoothed(std::move(one)));
    }
    if (!series.empty())
      html += svg_line_chart({fmt::format("losses on {} (unweighted, running mean)", title), "iteration", "", true},
                             series);
  }
  return html;
}

std::vector<Json> events_of(const fs::path& run) {
  const fs::path file = run / "events.ndjson";
  std::vector<Json> events;
  if (!fs::exists(file)) return events;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);) {
    Json event = parse_json(line);
    if (event.is_object()) events.push_back(std::move(event));
  }
  return events;
}

/// Running means of one field over the steps; no series without steps.
std::vector<ChartSeries> trend_of(const std::vector<Json>& events, const char* field) {
  std::vector<ChartSeries> series = series_of(events, {field});
  for (ChartSeries& one : series) one = smoothed(std::move(one));
  return series;
}

/// `quality`: the trend of the PSNR of training views.
std::string charts(const std::vector<Json>& events, const std::vector<ChartSeries>& quality) {
  if (events.empty()) return "";
  return "<h2>Training</h2>" +
         svg_line_chart({"total loss (weighted, running mean)", "iteration", "", true}, trend_of(events, "total")) +
         loss_charts(events) +
         svg_line_chart({"PSNR of training views (dB, running mean)", "iteration", "", false}, quality) +
         svg_line_chart({"Gaussians", "iteration", "", false}, series_of(events, {"gaussians"}));
}

std::string per_view_table(const std::vector<TestViewMetrics>& views) {
  if (views.empty()) return "";
  std::string html =
      "<h2>Test views</h2><table><tr><th>view</th><th>PSNR</th><th>after colour fit</th><th>after pose "
      "fit</th><th>SSIM</th><th>label accuracy</th></tr>";
  for (const TestViewMetrics& view : views) {
    html +=
        fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                    escape_html(view.name), number(view.psnr, "{:.2f}"), number(view.psnr_exposure_fitted, "{:.2f}"),
                    number(view.pose_refined ? view.pose_refined->psnr : kUndefined, "{:.2f}"),
                    number(view.ssim, "{:.3f}"), number(view.label_accuracy, "{:.3f}"));
  }
  return html + "</table>";
}

/// Smoothness and closedness of the mesh (metrics/surface_quality.h); nothing for files from before they were measured.
std::string surface_table(const SurfaceQuality& s) {
  if (std::isnan(s.normal_error.median) && std::isnan(s.pinholes)) return "";
  const auto row = [](const char* what, double everywhere, double structure, const char* format) {
    return fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>", what, number(everywhere, format),
                       number(structure, format));
  };
  return "<h2>Surface</h2><table><tr><th></th><th>everywhere</th><th>walls, floor, ceiling</th></tr>" +
         row("normal error, median (degrees)", s.normal_error.median, s.structure_normal_error.median, "{:.2f}") +
         row("normal error, mean (degrees)", s.normal_error.mean, s.structure_normal_error.mean, "{:.2f}") +
         row("roughness on planes, median (degrees)", s.roughness.median, kUndefined, "{:.2f}") +
         row("roughness on planes, mean (degrees)", s.roughness.mean, kUndefined, "{:.2f}") +
         row("pinholes (share of the seen surface)", s.pinholes, s.structure_pinholes, "{:.4f}") + "</table>";
}

std::string geometry_table(const std::optional<MeshEvaluation>& geometry) {
  if (!geometry) return "";
  std::string html =
      "<h2>Geometry</h2><table><tr><th>protocol</th><th>Acc (m)</th><th>Comp "
      "(m)</th><th>Prec</th><th>Recall</th><th>F</th><th>F at 2 cm</th><th>F at 1 cm</th></tr>";
  for (const MeshProtocolResult& v : geometry->variants) {
    const MeshScores& s = v.scores;
    html +=
        fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                    escape_html(protocol_text(v)), number(s.accuracy, "{:.4f}"), number(s.completeness, "{:.4f}"),
                    number(s.precision, "{:.3f}"), number(s.recall, "{:.3f}"), number(s.fscore, "{:.3f}"),
                    number(finer_fscore(s, 0.02), "{:.3f}"), number(finer_fscore(s, 0.01), "{:.3f}"));
  }
  return html + "</table>" + surface_table(geometry->surface);
}

std::string notes(const RunRecord& run, const std::string& priors) {
  std::string html;
  if (priors.find("simulated") != std::string::npos) {
    html += "<p class=\"note\">Priors of this scene are <b>simulated</b> (" + escape_html(priors) +
            "): these figures do not show how real networks would do.</p>";
  }
  if (!run.cameras.empty()) html += "<p class=\"note\">Cameras: " + escape_html(run.cameras) + ".</p>";
  for (const std::string& warning : run.warnings) html += "<p class=\"note\">" + escape_html(warning) + "</p>";
  return html;
}

}  // namespace

std::string html_report(const fs::path& run) {
  const fs::path record_file = run / "run.json", metrics_file = run / "metrics.json";
  const RunRecord record = fs::exists(record_file) ? read_run_record(record_file) : RunRecord();
  const RunMetrics metrics = fs::exists(metrics_file) ? read_metrics(metrics_file) : RunMetrics();
  const std::string title = "aligngs: " + fs::absolute(run).lexically_normal().filename().string();
  const std::string config = fs::exists(run / "config.toml") ? read_file(run / "config.toml") : "";
  std::string html =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>" +
      escape_html(title) + "</title><style>" + kReportStyle + "</style><h1>" + escape_html(title) + "</h1>";
  html += "<p><code>" + escape_html(record.command) + "</code></p>";
  const std::vector<Json> events = events_of(run);
  const std::vector<ChartSeries> quality = trend_of(events, "psnr");
  const double training_psnr = quality.empty() ? kUndefined : quality[0].points.back().second;
  html += notes(record, metrics.priors) + summary(metrics, training_psnr) + products(run);
  html += pictures(run) + geometry_table(metrics.geometry) + per_view_table(metrics.views) + charts(events, quality);
  html += "<h2>Settings</h2><details><summary>config.toml</summary><pre>" + escape_html(config) + "</pre></details>";
  return html + "</html>\n";
}

void write_report(const fs::path& run) {
  write_overview(run);
  write_file_atomically(run / "report.html", html_report(run));
}

}  // namespace aligngs
