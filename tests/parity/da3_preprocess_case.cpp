// Photographs as Depth Anything 3's program prepares them.
#include "nn/preprocess/da3_images.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

nn::Da3ImageOptions image_options_of(const Json& entry) {
  const auto method = entry.at("method").get<std::string>();
  const bool lower = method.rfind("lower_bound_", 0) == 0, cropped = method.size() > 5 && method.ends_with("_crop");
  if ((!lower && method.rfind("upper_bound_", 0) != 0) || (!cropped && !method.ends_with("_resize")))
    throw std::runtime_error("unknown method " + method);
  return {entry.at("res").get<int>(), lower, cropped};
}

void run_entry(Case& test, const Json& entry) {
  constexpr double kClose = 1e-6;
  const auto name = entry.at("name").get<std::string>();
  std::vector<Image<uint8_t>> images;
  std::vector<nn::ImagePlacement> placements;
  for (const Json& file : entry.at("images")) {
    const auto photo = file.get<std::string>();
    nn::ImagePlacement placement;
    const Image<uint8_t> pixels = image_of(test.array(photo.substr(0, photo.rfind('.'))));
    images.push_back(nn::da3_image(pixels, image_options_of(entry), &placement));
    placements.push_back(placement);
  }
  nn::da3_common_size(images, &placements);
  const int64_t step = value_or<int64_t>(entry, "row_step", 1), count = int64_t(images.size());
  const int height = images[0].height, width = images[0].width;
  if (entry.contains("out_hw") && entry.at("out_hw") != Json({height, width}))
    return test.fail(name, "the result has another size");
  std::vector<float> bytes, normal;
  for (const Image<uint8_t>& image : images) {
    const nn::FeatureMap input = nn::da3_input(image);
    for (int64_t y = 0; y < height; y += step)
      bytes.insert(bytes.end(), image.pixel(0, int(y)), image.pixel(0, int(y)) + 3 * width);
    for (int64_t c = 0; c < 3; ++c) {
      for (int64_t y = 0; y < height; y += step) {
        for (int64_t x = 0; x < width; ++x) normal.push_back(input.at(y, x)[c]);
      }
    }
  }
  const int64_t rows = (height + step - 1) / step;
  test.compare_exactly(name + "_u8", bytes, {count, rows, width, 3});
  const FloatArray reference = test.array(name + "_norm");
  if (reference.shape != Shape{count, 3, rows, width}) test.fail(name + "_norm", "the result has another size");
  test.judge(name + "_norm", normal, reference.data, kClose);
  if (!value_or(entry, "K", false)) return;
  FloatArray intrinsics = test.array(name + "_K_in");
  for (size_t i = 0; i < placements.size(); ++i) {
    float* const k = intrinsics.data.data() + 9 * i;
    for (size_t c = 0; c < 3; ++c) {
      k[c] = float(double(k[c]) * placements[i].scale_x);
      k[3 + c] = float(double(k[3 + c]) * placements[i].scale_y);
    }
    k[2] += float(placements[i].offset_x);
    k[5] += float(placements[i].offset_y);
  }
  test.judge(name + "_K_out", intrinsics.data, test.array(name + "_K_out").data, kClose);
}

}  // namespace

void run_da3_preprocess(Case& test, nn::Compute&) {
  for (const Json& entry : test.config().at("entries")) run_entry(test, entry);
}

}  // namespace aligngs::parity
