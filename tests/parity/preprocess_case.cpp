#include <algorithm>
#include <array>

#include "nn/preprocess/normalised_image.h"
#include "nn/preprocess/opencv_resize.h"
#include "nn/preprocess/pillow_resize.h"
#include "nn/preprocess/vggt_images.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

/// Part of an axis as Python writes it, "start:stop:step"; what is left out counts as there.
std::vector<int64_t> slice_of(const std::string& text, int64_t length) {
  std::array<int64_t, 3> part = {0, length, 1};
  size_t at = 0;
  for (size_t i = 0; i < part.size() && at <= text.size(); ++i) {
    const size_t end = std::min(text.find(':', at), text.size());
    if (end > at) part[i] = std::stoll(text.substr(at, end - at));
    at = end + 1;
  }
  std::vector<int64_t> out;
  for (int64_t i = part[0]; i < std::min(part[1], length); i += part[2]) out.push_back(i);
  return out;
}

/// "0::16, columns 0::4": which rows and columns of the result are in the file.
struct Selection {
  std::string rows, columns;
  explicit Selection(const Json& entry) : rows(value_or<std::string>(entry, "rows", "")) {
    const std::string word = "columns ";
    const size_t at = rows.find(word);
    if (at == std::string::npos) return;
    columns = rows.substr(at + word.size());
    rows = rows.substr(0, rows.find(','));
  }
};

/// Interleaved images to selected rows and columns, channels first.
template <class T>
void append_selected(const T* data, int64_t height, int64_t width, const Selection& s, std::vector<float>& out,
                     Shape& shape) {
  const std::vector<int64_t> rows = slice_of(s.rows, height), columns = slice_of(s.columns, width);
  for (int64_t c = 0; c < 3; ++c) {
    for (const int64_t y : rows) {
      for (const int64_t x : columns) out.push_back(float(data[(y * width + x) * 3 + c]));
    }
  }
  shape = {3, int64_t(rows.size()), int64_t(columns.size())};
}

void compare_image(Case& test, const std::string& name, const Image<uint8_t>& image, const Json& entry) {
  std::vector<float> values;
  Shape shape;
  append_selected(image.data.data(), image.height, image.width, Selection(entry), values, shape);
  test.compare_exactly(name, values, shape);
  if (entry.contains("full_shape") && entry.at("full_shape") != Json({3, image.height, image.width}))
    test.fail(name, "the result has another size");
}

void run_entry(Case& test, const Json& entry) {
  const auto name = entry.at("name").get<std::string>();
  const std::string source = name.substr(name.rfind('_') + 1);  // 0, 1, tall, rgba, two
  const auto photo = [&](const std::string& which) {
    return image_of(test.array(which == "rgba" ? "rgba" : "rgb_" + which));
  };
  if (name.rfind("mmseg_norm_", 0) == 0) {
    const auto scale = entry.at("img_scale").get<std::vector<int>>();
    const nn::FeatureMap map = nn::normalised_image(nn::segmentation_image(
        image_of(test.array("mmseg_rgb_" + source)),
        {std::max(scale.at(0), scale.at(1)), std::min(scale.at(0), scale.at(1)), value_or(entry, "size_multiple", 0)}));
    std::vector<float> values;
    Shape shape;
    append_selected(map.data.data(), map.height, map.width, Selection(entry), values, shape);
    const FloatArray reference = test.array(name);
    constexpr double kNormalisedLimit = 1e-6;
    if (reference.shape != shape) test.fail(name, "the result has another size");
    test.judge(name, values, reference.data, kNormalisedLimit);
  } else if (name.rfind("vggt_square", 0) == 0) {
    const nn::VggtSquare square =
        nn::vggt_square_image(photo(source), std::stoi(name.substr(std::string("vggt_square").size())));
    compare_image(test, name, square.image, entry);
    test.compare_exactly(name + "_coords", {square.x1, square.y1, square.x2, square.y2, square.width, square.height},
                         {1, 6});
  } else if (name.rfind("vggt_pad_", 0) == 0) {
    compare_image(test, name, nn::vggt_image(photo(source), nn::VggtFit::kPad), entry);
  } else if (name == "vggt_crop_two") {
    std::vector<Image<uint8_t>> both;
    for (const char* const which : {"0", "1"}) both.push_back(nn::vggt_image(photo(which), nn::VggtFit::kCrop));
    nn::vggt_common_size(both);
    std::vector<float> values;
    Shape shape;
    for (const Image<uint8_t>& image : both)
      append_selected(image.data.data(), image.height, image.width, Selection(entry), values, shape);
    shape.insert(shape.begin(), 2);
    test.compare_exactly(name, values, shape);
  } else if (name.rfind("vggt_crop_", 0) == 0) {
    compare_image(test, name, nn::vggt_image(photo(source), nn::VggtFit::kCrop), entry);
  } else {
    test.fail(name, "unknown entry");
  }
}

}  // namespace

void run_preprocess(Case& test, nn::Compute&) {
  for (const Json& entry : test.config().at("entries")) run_entry(test, entry);
  // The plain resizes carry their size in the name of the file: pil_bicubic_20x31 (height x width).
  for (const auto& file : std::filesystem::directory_iterator(test.folder())) {
    const std::string name = file.path().stem().string();
    const bool pillow = name.rfind("pil_bicubic_", 0) == 0, opencv = name.rfind("cv2_linear_", 0) == 0;
    if (!pillow && !opencv) continue;
    const std::string size = name.substr(name.rfind('_') + 1);
    const int height = std::stoi(size), width = std::stoi(size.substr(size.find('x') + 1));
    const Image<uint8_t> input = image_of(test.array("resize_in"));
    const Image<uint8_t> out =
        pillow ? nn::pillow_resize_bicubic(input, width, height) : nn::opencv_resize_linear(input, width, height);
    test.compare_exactly(name, {out.data.begin(), out.data.end()}, {height, width, 3});
  }
}

}  // namespace aligngs::parity
