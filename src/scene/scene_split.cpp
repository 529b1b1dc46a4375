#include "scene/scene_split.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "core/error.h"
#include "scene/map_names.h"
#include "scene/photo_lookup.h"
#include "scene/scene_check.h"
#include "scene/scene_json.h"
#include "scene/view_names.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// Resolves the names of split.json: view names, short names or file names.
class ViewNames {
 public:
  /// `left_out`: names that mean views which cannot be used; they resolve to nothing.
  ViewNames(const std::vector<View>& views, const fs::path& images, const std::vector<LeftOut>& left_out) {
    for (const LeftOut& view : left_out) {
      left_out_.insert({view.name, view_name_of(view.name)});
      reasons_ += "; left out: " + view.name.substr(0, 100) + " (" + view.reason + ")";
    }
    const int count = static_cast<int>(views.size());
    std::map<std::string, int> uses;
    std::vector<std::string> files;
    for (const View& view : views) {
      files.push_back(view.image.lexically_relative(images).generic_string());
      ++uses[short_name(files.back())];
    }
    for (int i = 0; i < count; ++i) index_.emplace(views[i].name, i);
    for (int i = 0; i < count; ++i) {  // emplace: a view name is never displaced by another view's file name
      index_.emplace(files[i], i);
      if (uses[short_name(files[i])] == 1) index_.emplace(short_name(files[i]), i);
    }
  }

  std::vector<int> resolve(const std::vector<std::string>& names, const char* list, const fs::path& path) const {
    std::set<int> found;
    std::string unknown;
    int unknown_count = 0;
    for (const std::string& name : names) {
      const auto entry = index_.find(name);
      if (entry != index_.end()) {
        found.insert(entry->second);
      } else if (left_out_.count(name) || left_out_.count(view_name_of(name))) {
        continue;
      } else if (++unknown_count <= 20) {  // enough to see the pattern
        unknown += (unknown.empty() ? "" : ", ") + name.substr(0, 100);
      }
    }
    if (unknown_count > 0) {
      throw_bad_input(path, list,
                      std::to_string(unknown_count) + " names are no registered images: " + unknown +
                          (unknown_count > 20 ? ", ..." : "") + reasons_,
                      "remove them from the list, or register the images");
    }
    return {found.begin(), found.end()};
  }

 private:
  std::map<std::string, int> index_;
  std::set<std::string> left_out_;
  std::string reasons_;  ///< of what is left out: one of the unknown names may have meant it
};

}  // namespace

void read_split(const std::filesystem::path& path, const SceneOptions& options, Scene& scene) {
  const int count = static_cast<int>(scene.views.size());
  const SplitJson split = read_split_json(path);
  if (!split.train && !split.test) {
    for (int i = 0; i < count; ++i) {
      const bool test = options.default_test_every > 0 && count > 1 && i % options.default_test_every == 0;
      (test ? scene.test : scene.train).push_back(i);
    }
  } else {
    const ViewNames names(scene.views, scene.folder / "images", scene.left_out);
    if (split.test) scene.test = names.resolve(*split.test, "test", path);
    if (split.train) {
      scene.train = names.resolve(*split.train, "train", path);
    } else {  // only the test views are named, as in the published layout: the others are for training
      for (int i = 0; i < count; ++i) {
        if (!std::binary_search(scene.test.begin(), scene.test.end(), i)) scene.train.push_back(i);
      }
    }
    std::vector<int> both;
    std::set_intersection(scene.train.begin(), scene.train.end(), scene.test.begin(), scene.test.end(),
                          std::back_inserter(both));
    if (!both.empty()) {
      throw_bad_input(path, "train, test", "'" + scene.views[both[0]].name + "' is in both lists",
                      "leave each view in one of the lists");
    }
  }
  if (split.train) {  // what no list names is not missed
    std::set<std::string> named(split.train->begin(), split.train->end());
    if (split.test) named.insert(split.test->begin(), split.test->end());
    std::erase_if(scene.left_out, [&](const LeftOut& view) {
      return !named.count(view.name) && !named.count(view_name_of(view.name));
    });
  }
  require_enough_training_views(scene);
  if (scene.train.empty()) {
    throw_bad_input(path, "train", "no training view is left", "name at least one training view");
  }
}

}  // namespace aligngs
