#include "cli/summary.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "metrics/semantic_metrics.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

std::string value(const Json& object, const char* key, const char* format) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return "–";
  return fmt::format(fmt::runtime(format), object[key].get<double>());
}

std::string percent(const Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_number()) return "–";
  return fmt::format("{:.2f}", 100 * object[key].get<double>());
}

}  // namespace

std::string metrics_summary(const Json& metrics) {
  std::string text;
  const Json& nvs = metrics["nvs"];
  if (nvs.is_null()) {
    text += "novel views  left out\n";
  } else if (nvs.value("views", 0) == 0) {
    text += "novel views  no test views\n";
  } else {
    const bool lpips = nvs.contains("lpips") && nvs["lpips"].is_number();
    text += fmt::format("novel views  PSNR {} dB (after colour fit {}, after pose fit {}), SSIM {}, {}{} test views\n",
                        value(nvs, "psnr", "{:.2f}"), value(nvs["exposure_fitted"], "psnr", "{:.2f}"),
                        value(nvs.value("pose_refined", Json()), "psnr", "{:.2f}"), value(nvs, "ssim", "{:.3f}"),
                        lpips ? "LPIPS " + value(nvs, "lpips", "{:.3f}") +
                                    " (inputs in [0, 1]: " + value(nvs, "lpips_unit", "{:.3f}") + "), "
                              : "",
                        nvs.value("views", 0));
  }
  const Json& geometry = metrics["geometry"];
  if (geometry.is_null()) {
    text += "geometry     not measured: the scene has no true mesh\n";
  } else {
    text += fmt::format(
        "geometry     F {} at {} m (precision {}, recall {}), accuracy {} m, completeness {} m\n             [{}]\n",
        value(geometry, "fscore", "{:.3f}"), value(geometry, "threshold_m", "{:g}"),
        value(geometry, "precision", "{:.3f}"), value(geometry, "recall", "{:.3f}"),
        value(geometry, "accuracy", "{:.4f}"), value(geometry, "completeness", "{:.4f}"),
        geometry.value("protocol", std::string()));
    const Json surface = geometry.value("surface", Json());
    text += fmt::format(
        "surface      normals {} degrees off (median; walls, floor and ceiling {}), F {} at 2 cm, {} at 1 cm, pinholes "
        "{} %\n",
        value(surface, "normal_error_median_deg", "{:.1f}"),
        value(surface, "structure_normal_error_median_deg", "{:.1f}"), value(geometry, "fscore_2cm", "{:.3f}"),
        value(geometry, "fscore_1cm", "{:.3f}"), percent(surface, "pinholes"));
  }
  const Json& semantics = metrics["semantics"];
  if (semantics.is_null()) {
    text += "labels       not measured: no semantics or no true labels\n";
  } else {
    const auto line = [](const char* name, const Json& scores, const char* samples) {
      std::string words = fmt::format("{} mIoU {} over classes with at least {:g} % of the {}", name,
                                      value(scores, "miou", "{:.3f}"), 100 * kLeastClassShare, samples);
      if (scores.contains("present"))
        words += fmt::format(", {} over all classes present", value(scores["present"], "miou", "{:.3f}"));
      return words + fmt::format(", accuracy {}\n", value(scores, "accuracy", "{:.3f}"));
    };
    text += line("labels      ", semantics, "pixels");
    if (semantics.contains("teacher")) text += line("  teacher   ", semantics["teacher"], "pixels");
    if (semantics.contains("mesh")) text += line("  mesh      ", semantics["mesh"], "points");
  }
  const std::string priors =
      metrics.contains("priors") && metrics["priors"].is_string() ? metrics["priors"].get<std::string>() : "";
  if (priors.find("simulated") != std::string::npos) text += "priors       simulated (" + priors + ")\n";
  return text;
}

}  // namespace aligngs
