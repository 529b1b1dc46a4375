#include "cli/stages/render_stage.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "cli/pictures.h"
#include "cli/stages/pictured_views.h"
#include "io/image_file.h"
#include "scene/triangle_mesh.h"
#include "scene/view_data.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

Image<uint16_t> depth_values(const ImageF& depth) {
  Image<uint16_t> out(depth.width, depth.height, 1, 0);
  for (size_t i = 0; i < depth.data.size(); ++i) {
    const float thousandths = depth.data[i] * 1000;
    if (thousandths >= 0.5f && thousandths < 65535) out.data[i] = static_cast<uint16_t>(std::lround(thousandths));
  }
  return out;
}

Image<uint8_t> label_ids(const Image<uint16_t>& labels) {
  Image<uint8_t> out(labels.width, labels.height, 1, 255);
  for (size_t i = 0; i < labels.data.size(); ++i) {
    if (labels.data[i] < 255) out.data[i] = static_cast<uint8_t>(labels.data[i]);
  }
  return out;
}

void render_one(LoadedRun& run, int index, const fs::path& folder) {
  const View& view = run.scene().views[index];
  const std::string file = view.name + ".png";
  const ViewData data = load_view(run.scene(), index, run.load_options());
  Rendering rendering = run.engine->render(data.camera, run.render_options());
  run.expose_as(index, rendering.color);
  // Making and compressing the pictures takes longer than rendering them.
  std::vector<std::function<void()>> pictures = {
      [&] { write_png(folder / "rgb" / file, to_bytes(rendering.color)); },
      [&] { write_png(folder / "gt" / file, to_bytes(data.color)); },
      [&] { write_png(folder / "error" / file, error_picture(rendering.color, data.color)); },
      [&] {
        const DepthRange range = depth_range(rendering.depth_median);
        write_png(folder / "depth" / file, depth_picture(rendering.depth_median, range.low, range.high));
      },
      [&] { write_png16(folder / "depth16" / file, depth_values(rendering.depth_median)); },
      [&] { write_png(folder / "normal" / file, normal_picture(rendering.normal)); }};
  if (run.has_labels()) {
    pictures.push_back([&] { write_png(folder / "label" / file, label_picture(rendering.label, run.scene().labels)); });
    if (run.scene().labels.size() < 255) {
      pictures.push_back([&] { write_png(folder / "label_id" / file, label_ids(rendering.label)); });
    }
  }
  run.pool->parallel_for(pictures.size(), 1, [&](size_t i, size_t, int) { pictures[i](); });
}

}  // namespace

size_t render_views(LoadedRun& run, const RenderStageOptions& options) {
  const Scene& scene = run.scene();
  std::vector<PicturedViews> parts;
  if (options.split == RenderedSplit::kPictured) parts.push_back(pictured_views(scene));
  if (options.split == RenderedSplit::kTest || options.split == RenderedSplit::kAll)
    parts.push_back({"test", scene.test});
  if (options.split == RenderedSplit::kTrain || options.split == RenderedSplit::kAll)
    parts.push_back({"train", scene.train});
  size_t total = 0, done = 0;
  for (const PicturedViews& part : parts) total += part.views.size();
  Progress progress(options.progress, "render", total);
  for (const PicturedViews& part : parts) {
    for (const int index : part.views) {
      render_one(run, index, run.folder() / "renders" / part.split);
      progress.update(++done);
    }
  }
  return total;
}

}  // namespace aligngs
