#include "cli/report/picture_cell.h"

#include <algorithm>

#include "cli/report/svg_chart.h"
#include "io/base64.h"
#include "io/image_file.h"
#include "io/resample.h"

namespace aligngs {

namespace {

constexpr int kPictureWidth = 320;   // pixels
constexpr int kPictureQuality = 85;  // JPEG

}  // namespace

std::string picture_cell(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return "<td></td>";
  Image<uint8_t> image = read_image(file);
  if (image.width > kPictureWidth) {
    const int height = std::max(1, image.height * kPictureWidth / image.width);
    image = to_bytes(resize_area(to_float(image), kPictureWidth, height));
  }
  const std::vector<uint8_t> jpeg = encode_jpeg(image, kPictureQuality);
  const std::string what = file.parent_path().filename().string() + " of " + file.stem().string();
  return "<td><img alt=\"" + escape_html(what) + "\" src=\"data:image/jpeg;base64," +
         base64_text({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}) + "\"></td>";
}

}  // namespace aligngs
