#include "scene/scene_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "io/text_encoding.h"

namespace aligngs {
namespace {

using nlohmann::json;

/// The object in a file; null when there is no file.
json read_object(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return json();
  const std::string content = read_file(path, kMaxSceneFile);
  const std::string_view text = text_of_file(content, path);
  json value;
  try {
    value = json::parse(text);
  } catch (const json::parse_error&) {
    throw_bad_input(path, place_of_json_fault(text), "this is no valid JSON", "correct or remove the file");
  } catch (const json::exception&) {
    throw_bad_input(path, "", "a number in it is too large", "correct or remove the file");
  }
  if (!value.is_object()) throw_bad_input(path, "", "a JSON object expected", "correct or remove the file");
  return value;
}

std::string text_of(const json& object, const char* key, const std::filesystem::path& path) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return "";
  if (!found->is_string()) throw_bad_input(path, key, "a string expected", "put the value in double quotes");
  return found->get<std::string>();
}

std::optional<std::vector<std::string>> names_of(const json& object, const char* key,
                                                 const std::filesystem::path& path) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  const char* remedy = "write the names of the views as [\"0001\", \"0002\"]";
  if (!found->is_array()) throw_bad_input(path, key, "a list of names expected", remedy);
  std::vector<std::string> names;
  for (const json& name : *found) {
    if (!name.is_string()) throw_bad_input(path, key, "a list of names expected, but one is no string", remedy);
    names.push_back(name.get<std::string>());
  }
  return names;
}

std::optional<PriorJson> prior_of(const json& object, const char* key, const std::filesystem::path& path) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return std::nullopt;
  if (!found->is_object()) throw_bad_input(path, key, "an object expected", "correct or remove the file");
  PriorJson prior;
  prior.model = text_of(*found, "model", path);
  prior.weights = text_of(*found, "weights", path);
  const auto settings = found->find("settings");
  if (settings != found->end() && settings->is_object()) {
    for (const auto& [name, value] : settings->items()) {
      if (value.is_structured()) continue;  // other programs may nest what they like; it is only shown
      prior.settings[name] = value.is_string() ? value.get<std::string>() : json_line(value);
    }
  }
  return prior;
}

bool read_vector(const json& value, Vec3d& v) {
  bool good = value.is_array() && value.size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    good = value[i].is_number();
    if (good) v[i] = value[i].get<double>();
  }
  return good;
}

std::optional<Similarity> to_original_of(const json& object, const std::filesystem::path& path) {
  const auto found = object.find("to_original");
  if (found == object.end() || found->is_null()) return std::nullopt;
  Similarity back;
  const auto scale = found->is_object() ? found->find("scale") : found->end();
  bool good = found->is_object() && scale != found->end() && scale->is_number() && found->contains("translation");
  if (good) back.scale = scale->get<double>();
  good = good && std::isfinite(back.scale) && back.scale > 0 &&
         read_vector((*found)["translation"], back.translation) && std::isfinite(norm(back.translation));
  if (!good)
    throw_bad_input(path, "to_original", "a positive scale and a translation of three numbers expected",
                    "import the capture again");
  return back;
}

std::optional<UnitsEstimate> units_estimate_of(const json& object, const std::filesystem::path& path) {
  const auto found = object.find("units_estimate");
  if (found == object.end() || found->is_null()) return std::nullopt;
  UnitsEstimate estimate;
  const auto has = [&](const char* key, auto is) {
    return found->is_object() && found->contains(key) && is((*found)[key]);
  };
  bool good = has("model", [](const json& v) { return v.is_string(); }) &&
              has("spread", [](const json& v) { return v.is_number(); }) &&
              has("photos", [](const json& v) { return v.is_number_integer(); });
  if (good) estimate = {(*found)["model"], (*found)["spread"], (*found)["photos"]};
  good = good && std::isfinite(estimate.spread) && estimate.spread >= 0 && estimate.photos >= 0;
  if (!good) {
    throw_bad_input(path, "units_estimate", "a model, a spread of at least 0 and a number of photos expected",
                    "remove the entry: the units are then taken as given");
  }
  return estimate;
}

json json_of(const PriorJson& prior) {
  json out = {{"model", prior.model}};
  if (!prior.weights.empty()) out["weights"] = prior.weights;
  if (!prior.settings.empty()) out["settings"] = prior.settings;
  return out;
}

/// Text with invalid UTF-8 replaced: file names may hold any bytes.
void write_object(const std::filesystem::path& path, const json& value) {
  write_file_atomically(path, json_document(value));
}

}  // namespace

const char* name_of(SemanticKind kind) {
  switch (kind) {
    case SemanticKind::kScores:
      return "scores";
    case SemanticKind::kProbabilities:
      return "probabilities";
    case SemanticKind::kLogits:
      break;
  }
  return "logits";
}

const char* name_of(DepthScale scale) {
  switch (scale) {
    case DepthScale::kMetres:
      return "metres";
    case DepthScale::kOwn:
      return "own";
    case DepthScale::kPerView:
      return "per_view";
    case DepthScale::kScene:
      break;
  }
  return "scene";
}

DepthScale depth_scale_of(const PriorsJson& priors, bool refined) {
  if (priors.depth_scale) return *priors.depth_scale;
  if (assumes_depth_scale(priors, refined)) return DepthScale::kPerView;
  if (!priors.depth || refined) return DepthScale::kScene;
  const auto units = priors.depth->settings.find("units");
  if (units == priors.depth->settings.end()) return DepthScale::kScene;
  if (units->second == "arbitrary") return DepthScale::kOwn;
  return units->second == "metres" ? DepthScale::kMetres : DepthScale::kScene;
}

bool assumes_depth_scale(const PriorsJson& priors, bool refined) {
  if (priors.depth_scale || !priors.depth || refined) return false;
  const std::string& model = priors.depth->model;
  if (is_sensor_depth(model) || model == kStereoDepth) return false;
  const auto units = priors.depth->settings.find("units");
  return units == priors.depth->settings.end() || (units->second != "arbitrary" && units->second != "metres");
}

SceneJson read_scene_json(const std::filesystem::path& path) {
  SceneJson scene;
  const json object = read_object(path);
  if (object.is_null()) return scene;
  const std::string units = text_of(object, "units", path);
  if (!units.empty() && units != "metres" && units != "arbitrary") {
    throw_bad_input(path, "units", "'" + units + "' is unknown", "write \"metres\" or \"arbitrary\"");
  }
  scene.metric = units == "metres";
  scene.source = text_of(object, "source", path);
  scene.up_source = text_of(object, "up_source", path);
  scene.to_original = to_original_of(object, path);
  scene.units_estimate = units_estimate_of(object, path);
  scene.refined = object.contains("cameras_refined");
  const auto up = object.find("up");
  if (up == object.end() || up->is_null()) return scene;
  Vec3d v;
  if (!read_vector(*up, v) || !std::isfinite(norm(v)) || norm(v) < 1e-9) {
    throw_bad_input(path, "up", "a direction of three numbers, not all zero, or null expected",
                    "write \"up\": null when it is not known");
  }
  scene.up = normalized(v);
  return scene;
}

SplitJson read_split_json(const std::filesystem::path& path) {
  const json object = read_object(path);
  SplitJson split;
  if (object.is_null()) return split;
  split.train = names_of(object, "train", path);
  split.test = names_of(object, "test", path);
  if (!split.train && !split.test) {
    throw_bad_input(path, "", "neither a list 'train' nor a list 'test'",
                    "write {\"train\": [names], \"test\": [names]} or remove the file");
  }
  return split;
}

PriorsJson read_priors_json(const std::filesystem::path& path) {
  const json object = read_object(path);
  PriorsJson priors;
  if (object.is_null()) return priors;
  priors.depth = prior_of(object, "depth", path);
  priors.semantics = prior_of(object, "semantics", path);
  if (priors.depth) {
    const std::string scale = text_of(object["depth"], "scale", path);
    for (DepthScale known : {DepthScale::kScene, DepthScale::kMetres, DepthScale::kOwn, DepthScale::kPerView}) {
      if (scale == name_of(known)) priors.depth_scale = known;
    }
    if (!scale.empty() && !priors.depth_scale) {
      throw_bad_input(path, "depth.scale", "'" + scale + "' is unknown",
                      "write \"scene\", \"metres\", \"own\" or \"per_view\"");
    }
  }
  if (!priors.semantics) return priors;
  const std::string kind = text_of(object["semantics"], "kind", path);
  for (SemanticKind known : {SemanticKind::kLogits, SemanticKind::kScores, SemanticKind::kProbabilities}) {
    if (kind == name_of(known)) priors.kind = known;
  }
  if (!kind.empty() && !priors.kind) {
    throw_bad_input(path, "semantics.kind", "'" + kind + "' is unknown",
                    "write \"logits\", \"scores\" or \"probabilities\"");
  }
  return priors;
}

ExposureJson read_exposure_json(const std::filesystem::path& path) {
  const json object = read_object(path);
  ExposureJson exposure;
  if (object.is_null()) return exposure;
  const char* remedy = "write {\"log_gains\": {\"VIEW\": [red, green, blue]}} or remove the file";
  const auto gains = object.find("log_gains");
  if (gains == object.end() || !gains->is_object()) throw_bad_input(path, "log_gains", "an object expected", remedy);
  for (const auto& [name, value] : gains->items()) {
    Vec3f gain;
    bool good = value.is_array() && value.size() == 3;
    for (int k = 0; good && k < 3; ++k) {
      good = value[k].is_number() && std::abs(value[k].get<double>()) <= kMaxLogGain;
      if (good) gain[k] = value[k].get<float>();
    }
    if (!good) throw_bad_input(path, "log_gains." + name, "three numbers between -3 and 3 expected", remedy);
    exposure[name] = gain;
  }
  return exposure;
}

void write_scene_json(const std::filesystem::path& path, const SceneJson& scene) {
  json object = {{kWrittenBy, kThisProgram},
                 {"units", scene.metric ? "metres" : "arbitrary"},
                 {"up", nullptr},
                 {"source", scene.source}};
  if (scene.up) object["up"] = {scene.up->x, scene.up->y, scene.up->z};
  if (!scene.up_source.empty()) object["up_source"] = scene.up_source;
  if (scene.units_estimate) {
    const UnitsEstimate& estimate = *scene.units_estimate;
    object["units_estimate"] = {{"model", estimate.model}, {"spread", estimate.spread}, {"photos", estimate.photos}};
  }
  if (scene.to_original) {
    const Vec3d& t = scene.to_original->translation;
    object["to_original"] = {{"scale", scene.to_original->scale}, {"translation", {t.x, t.y, t.z}}};
  }
  write_object(path, object);
}

void write_split_json(const std::filesystem::path& path, const SplitJson& split) {
  json object = json::object();
  if (split.train) object["train"] = *split.train;
  if (split.test) object["test"] = *split.test;
  write_object(path, object);
}

void write_exposure_json(const std::filesystem::path& path, const ExposureJson& exposure) {
  json gains = json::object();
  for (const auto& [name, gain] : exposure) gains[name] = {gain.x, gain.y, gain.z};
  write_object(path, {{"log_gains", gains}});
}

void write_priors_json(const std::filesystem::path& path, const PriorsJson& priors) {
  json object = json::object();
  if (priors.depth) object["depth"] = json_of(*priors.depth);
  if (priors.depth && priors.depth_scale) object["depth"]["scale"] = name_of(*priors.depth_scale);
  if (priors.semantics) object["semantics"] = json_of(*priors.semantics);
  if (priors.semantics && priors.kind) object["semantics"]["kind"] = name_of(*priors.kind);
  write_object(path, object);
}

}  // namespace aligngs
