#include "cli/report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace aligngs {
namespace {

/// Columns that at least one run has.
std::vector<size_t> used_columns(const std::vector<RunScores>& runs) {
  std::vector<size_t> columns;
  for (size_t c = 0; c < kScoreCount; ++c) {
    if (std::any_of(runs.begin(), runs.end(), [c](const RunScores& r) { return std::isfinite(r.score[c]); })) {
      columns.push_back(c);
    }
  }
  return columns;
}

/// Letters on screen: a continuation byte of UTF-8 takes no room.
size_t width_of(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string padded_left(const std::string& text, size_t width) {
  return std::string(width - std::min(width, width_of(text)), ' ') + text;
}

std::string comparison_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::set<std::string> views_of(const RunScores& run) {
  std::set<std::string> names;
  for (const TestViewMetrics& v : run.views) names.insert(v.name);
  return names;
}

}  // namespace

void name_apart(std::vector<RunScores>& runs) {
  std::map<std::string, int> count;
  for (const RunScores& r : runs) ++count[r.name];
  for (RunScores& r : runs) {
    if (count[r.name] > 1) r.name = r.folder.string();
  }
}

std::string comparison_csv(const std::vector<RunScores>& runs) {
  std::string out = "run";
  for (const ScoreColumn& c : score_columns()) out += std::string(",") + c.csv_name;
  out += "\n";
  for (const RunScores& r : runs) {
    out += comparison_field(r.name);
    for (const double v : r.score) out += std::isfinite(v) ? fmt::format(",{}", v) : std::string(",");
    out += "\n";
  }
  return out;
}

PairedDifference view_difference(const RunScores& base, const RunScores& run, double TestViewMetrics::*score) {
  if (run.other_room) return paired_difference({}, {});
  std::map<std::string, double> of_base;
  for (const TestViewMetrics& v : base.views) of_base[v.name] = v.*score;
  std::vector<double> a, b;
  for (const TestViewMetrics& v : run.views) {
    const auto found = of_base.find(v.name);
    if (found == of_base.end()) continue;
    a.push_back(found->second);
    b.push_back(v.*score);
  }
  return paired_difference(a, b);
}

std::string comparison_text(const std::vector<RunScores>& runs) {
  const std::vector<size_t> columns = used_columns(runs);
  size_t name_width = 3;
  for (const RunScores& r : runs) name_width = std::max(name_width, width_of(r.name));
  std::string out = "run" + std::string(name_width - 3, ' ');
  std::vector<size_t> widths;
  for (const size_t c : columns) {
    size_t width = width_of(score_columns()[c].name);
    for (const RunScores& r : runs) width = std::max(width, width_of(score_text(c, r.score[c])));
    widths.push_back(width);
    out += "  " + padded_left(score_columns()[c].name, width);
  }
  out += "\n";
  for (const RunScores& r : runs) {
    out += r.name + std::string(name_width - width_of(r.name), ' ');
    for (size_t k = 0; k < columns.size(); ++k) {
      out += "  " + padded_left(score_text(columns[k], r.score[columns[k]]), widths[k]);
    }
    out += "\n";
  }
  for (size_t i = 1; i < runs.size(); ++i) {
    if (runs[i].other_room) {
      out += fmt::format("{} against {}: different rooms, so that no view is compared\n", runs[i].name, runs[0].name);
      continue;
    }
    for (const ViewScoreColumn& c : view_score_columns()) {
      const PairedDifference d = view_difference(runs[0], runs[i], c.score);
      if (d.pairs == 0) continue;
      if (!d.has_interval()) {
        out +=
            fmt::format("{} against {}: {} {:+.{}f} over {} shared test view{} (no interval below {})\n", runs[i].name,
                        runs[0].name, c.name, d.mean, c.digits, d.pairs, d.pairs == 1 ? "" : "s", kFewestPairs);
        continue;
      }
      out += fmt::format("{} against {}: {} {:+.{}f}, 95 % interval {:+.{}f} to {:+.{}f} over {} shared test views{}\n",
                         runs[i].name, runs[0].name, c.name, d.mean, c.digits, d.low, c.digits, d.high, c.digits,
                         d.pairs, d.beyond_noise() ? "" : " (inside the noise)");
    }
  }
  return out;
}

std::vector<std::string> comparison_warnings(const std::vector<RunScores>& runs) {
  std::vector<std::string> out;
  for (size_t i = 1; i < runs.size(); ++i) {
    if (runs[i].other_room) {
      out.push_back(fmt::format("{} and {} show different rooms: views of one name are different photos", runs[0].name,
                                runs[i].name));
    } else if (views_of(runs[i]) != views_of(runs[0])) {
      out.push_back(fmt::format("{} and {} were measured on different test views", runs[0].name, runs[i].name));
    }
    if (!runs[i].protocol.empty() && !runs[0].protocol.empty() && runs[i].protocol != runs[0].protocol) {
      out.push_back(fmt::format("geometry of {} is by \"{}\", of {} by \"{}\"", runs[0].name, runs[0].protocol,
                                runs[i].name, runs[i].protocol));
    }
  }
  std::string simulated;
  for (const RunScores& r : runs) {
    if (r.priors.find("simulated") == std::string::npos) continue;
    simulated += (simulated.empty() ? "" : ", ") + r.name;
  }
  if (!simulated.empty()) out.push_back("priors are simulated in: " + simulated);
  return out;
}

}  // namespace aligngs
