#include "serve/run_products.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "scene/label_set.h"
#include "serve/run_descriptions.h"
#include "serve/served_file.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool has_file(const fs::path& root, const std::string& name) { return ServedFile::open(root, name).has_value(); }

bool has_folder(const fs::path& root, const fs::path& name) {
  std::error_code error;
  const fs::path found = fs::canonical(root / name, error);
  if (error || !fs::is_directory(found, error)) return false;
  const fs::path inside = found.lexically_relative(root);
  return !inside.empty() && *inside.begin() != "..";
}

Json rendered_views(const fs::path& root) {
  Json views = Json::object();
  std::error_code error;
  for (const char* split : {"test", "train"}) {
    for (const char* kind : {"gt", "rgb", "depth", "normal", "label", "error"}) {
      if (!has_folder(root, fs::path("renders") / split / kind)) continue;
      for (fs::directory_iterator i(root / "renders" / split / kind, error), end; !error && i != end;
           i.increment(error)) {
        if (i->path().extension() != ".png") continue;
        Json& view = views[i->path().stem().string()];
        view["split"] = split;
        view["kinds"].push_back(kind);
      }
      error.clear();
    }
  }
  return views;
}

Json scene_classes(const fs::path& scene) {
  LabelSet labels = ade20k_labels();
  try {
    if (has_file(scene, "labels.csv")) labels = read_label_csv(scene / "labels.csv");
  } catch (const Error&) {
    return nullptr;
  }
  Json classes = Json::array();
  for (int i = 0; i < labels.size(); ++i) {
    const LabelClass& c = labels.classes[static_cast<size_t>(i)];
    classes.push_back({{"id", i}, {"name", c.name}, {"synonyms", c.synonyms}, {"color", c.color}});
  }
  return classes;
}

Json run_stages(const fs::path& root, const Json& run, bool active) {
  struct Stage {
    const char *name, *product;
  };
  constexpr Stage kStages[] = {{"train", "scene.ply"},
                               {"render", "renders"},
                               {"mesh", "mesh/mesh.ply"},
                               {"measure", "metrics.json"},
                               {"report", "report.html"}};
  const Json named = json_field(run, "stage");
  const std::string current = !active ? "" : named.is_string() ? named.get<std::string>() : "train";
  Json stages = Json::array();
  bool later = false;  // than the one in progress: products there are of an earlier time
  for (const Stage& stage : kStages) {
    const bool now = current == stage.name;
    const bool done = !now && !later && fs::exists(root / stage.product);
    later |= now;
    stages.push_back({{"name", stage.name}, {"state", now ? "now" : done ? "done" : "waiting"}});
  }
  return stages;
}

}  // namespace aligngs
