#include "cli/report/overview.h"

#include <algorithm>

#include "cli/report/picture_title.h"
#include "io/image_file.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr int kRows = 3;      // views shown
constexpr int kGap = 4;       // pixels between pictures
constexpr int kQuality = 90;  // JPEG

void paste(const Image<uint8_t>& from, Image<uint8_t>& to, int x0, int y0) {
  for (int y = 0; y < from.height && y0 + y < to.height; ++y) {
    for (int x = 0; x < from.width && x0 + x < to.width; ++x) {
      for (int c = 0; c < 3; ++c) to.at(x0 + x, y0 + y, c) = from.at(x, y, c);
    }
  }
}

}  // namespace

std::vector<std::string> rendered_views(const fs::path& run, const std::string& split) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(run / "renders" / split / "rgb", error)) {
    if (entry.path().extension() == ".png") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

ShownRenders shown_renders(const fs::path& run) {
  for (const char* split : {"test", "train"}) {
    ShownRenders shown{split, rendered_views(run, split)};
    if (!shown.views.empty()) return shown;
  }
  return {"test", {}};
}

void write_overview(const fs::path& run) {
  const ShownRenders shown = shown_renders(run);
  const std::vector<std::string>& names = shown.views;
  if (names.empty()) return;
  std::vector<RenderKind> kinds;
  for (const RenderKind& kind : kRenderKinds) {
    if (kind.in_overview && fs::exists(shown.folder(run) / kind.folder)) kinds.push_back(kind);
  }
  const int rows = std::min<int>(kRows, static_cast<int>(names.size()));
  Image<uint8_t> canvas;
  for (int r = 0; r < rows; ++r) {
    // Spread over the views: the first few are often neighbours.
    const std::string& name = names[size_t(r) * (names.size() - 1) / std::max(1, rows - 1)];
    for (size_t k = 0; k < kinds.size(); ++k) {
      const fs::path file = shown.folder(run) / kinds[k].folder / (name + ".png");
      if (!fs::exists(file)) continue;
      const Image<uint8_t> picture = read_image(file);
      if (canvas.empty()) {
        canvas = Image<uint8_t>(static_cast<int>(kinds.size()) * (picture.width + kGap) - kGap,
                                kTitleHeight + rows * (picture.height + kGap) - kGap, 3, 255);
      }
      const int x = static_cast<int>(k) * (picture.width + kGap);
      if (r == 0) draw_title(canvas, x, 0, kinds[k].title);
      paste(picture, canvas, x, kTitleHeight + r * (picture.height + kGap));
    }
  }
  if (!canvas.empty()) write_jpeg(run / "overview.jpg", canvas, kQuality);
}

}  // namespace aligngs
