#include "cli/stages/quality_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "metrics/metrics_json.h"

namespace aligngs {
namespace {

/// Why a part of the metrics is empty, as the end of a message; nothing where it was measured.
std::string unmeasured_part(const RunMetrics& metrics, const std::string& figure) {
  const std::string part = figure.substr(0, figure.find('.'));
  const bool no_views = !metrics.novel_views || metrics.novel_views->views == 0;
  if (part == "nvs" && no_views) return ": no test view was measured";
  if (part == "geometry" && !metrics.geometry) return ": the run has no mesh, or the scene no true mesh";
  if (part == "semantics" && !metrics.semantics) return ": no labels of test views were measured";
  return "";
}

}  // namespace

std::vector<LeastValue> least_values(const std::vector<std::string>& conditions) {
  const std::vector<std::pair<std::string, std::string>> short_names = {
      {"psnr", "nvs.psnr"}, {"ssim", "nvs.ssim"}, {"fscore", "geometry.fscore"}, {"miou", "semantics.miou"}};
  std::vector<LeastValue> values;
  for (const std::string& condition : conditions) {
    const size_t equals = condition.find('=');
    char* end = nullptr;
    const double wanted = equals == std::string::npos ? 0 : std::strtod(condition.c_str() + equals + 1, &end);
    if (equals == std::string::npos || end == condition.c_str() + equals + 1 || *end != '\0' || !std::isfinite(wanted))
      throw_usage("--fail-under needs name=number, got \"" + condition + "\"", "for example --fail-under psnr=24");
    std::string figure = condition.substr(0, equals);
    const auto is_short = [&](const auto& name) { return name.first == figure; };
    const auto known = std::find_if(short_names.begin(), short_names.end(), is_short);
    if (known != short_names.end()) figure = known->second;
    constexpr std::array<std::string_view, 4> kParts = {"nvs", "geometry", "semantics", "train"};
    if (std::find(kParts.begin(), kParts.end(), figure.substr(0, figure.find('.'))) == kParts.end()) {
      throw_usage("--fail-under: there is no figure \"" + figure + "\"",
                  "names are psnr, ssim, fscore, miou, and those of metrics.json, as geometry.recall");
    }
    values.push_back({figure, wanted});
  }
  return values;
}

void require_at_least(const RunMetrics& metrics, const std::vector<LeastValue>& values) {
  if (values.empty()) return;
  const std::map<std::string, double> figures = named_figures(metrics);
  for (const auto& [figure, least] : values) {
    const auto found = figures.find(figure);
    if (found == figures.end()) {
      throw_usage("--fail-under: this run has no number \"" + figure + "\"" + unmeasured_part(metrics, figure),
                  "names are those of metrics.json, e.g. nvs.psnr, geometry.fscore");
    }
    if (found->second < least) {
      throw Error({ErrorKind::kBelow,
                   fmt::format("{} is {:.4g}, below the required {:.4g}", figure, found->second, least),
                   {},
                   {},
                   {}});
    }
  }
}

}  // namespace aligngs
