#include "cli/view_renders.h"

#include <algorithm>

#include "cli/pictures.h"
#include "core/error.h"
#include "core/free_memory.h"
#include "io/image_file.h"
#include "scene/triangle_mesh.h"
#include "serve/plain_run.h"
#include "train/run_control.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

std::string newest_checkpoint(const fs::path& run) {
  std::string newest;
  std::error_code error;
  for (fs::directory_iterator i(run / "checkpoints", error), end; !error && i != end; i.increment(error)) {
    newest = std::max(newest, i->path().filename().string());
  }
  return newest;
}

/// Numbers of semantic columns become those of their classes.
void name_columns(const std::vector<uint16_t>& classes, Image<uint16_t>& label) {
  if (classes.empty()) return;
  for (uint16_t& l : label.data) l = l == kNoLabel ? l : classes[l];
}

std::optional<Image<uint8_t>> drawn(const LoadedRun& run, const Camera& camera, const std::string& kind) {
  RenderOptions options = run.render_options();
  options.geometry = kind == "depth" || kind == "normal";
  options.labels = options.labels && kind == "label";
  if (kind != "rgb" && !options.geometry && !options.labels) return {};
  Rendering rendering = run.engine->render(camera, options);
  if (kind == "rgb") return to_bytes(rendering.color);
  if (kind == "normal") return normal_picture(rendering.normal);
  if (kind == "depth") {
    const DepthRange range = depth_range(rendering.depth_median);
    return depth_picture(rendering.depth_median, range.low, range.high);
  }
  name_columns(run.classes, rendering.label);
  return label_picture(rendering.label, run.scene().labels);
}

}  // namespace

std::optional<GetAnswer> ViewRenders::picture(const std::string& name) {
  const size_t slash = name.rfind('/');
  constexpr std::string_view kEnding = ".png";
  if (slash == std::string::npos || name.size() < slash + 1 + kEnding.size() ||
      name.compare(name.size() - kEnding.size(), kEnding.size(), kEnding) != 0) {
    return {};
  }
  const std::string view = name.substr(0, slash),
                    kind = name.substr(slash + 1, name.size() - slash - 1 - kEnding.size());
  if (RunControl(folder_).active()) {
    run_.reset();
    throw_usage("the run is still being made", "the pictures come when it has ended");
  }
  const std::lock_guard turn(drawing_);
  const std::string checkpoint = newest_checkpoint(folder_);
  if (!run_ || checkpoint != opened_) {
    run_.reset();
    require_plain_run(folder_);
    run_.emplace(load_run(folder_, options_));
    run_->forget_model();
    give_back_free_memory();
    opened_ = checkpoint;
  }
  const std::vector<View>& views = run_->scene().views;
  const auto found = std::find_if(views.begin(), views.end(), [&](const View& v) { return v.name == view; });
  if (found == views.end()) return {};
  const Camera camera = run_->working_camera(static_cast<int>(found - views.begin()));
  const auto image = drawn(*run_, camera, kind);
  if (!image) return {};
  const std::vector<uint8_t> png = encode_png(*image);
  return GetAnswer{"image/png", std::string(reinterpret_cast<const char*>(png.data()), png.size()), {}, {}};
}

void ViewRenders::serve(ViewServerOptions& options) {
  options.get["/api/render/"] = [this](const std::string& name) { return picture(name); };
}

}  // namespace aligngs
