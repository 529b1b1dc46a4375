#include "parity_case.h"

#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "io/array_shape.h"
#include "io/atomic_file.h"

namespace aligngs::parity {

Case::Case(std::filesystem::path folder, const Mode& mode) : folder_(std::move(folder)), mode_(mode) {
  try {
    config_ = Json::parse(read_file(folder_ / "case.json"));
  } catch (const Json::exception& error) {
    throw_bad_input(folder_ / "case.json", "", error.what());
  }
}

FloatArray Case::array(const std::string& name) {
  used_.insert(name);
  return read_npy(folder_ / (name + ".npy"));
}

bool Case::reference(const std::string& name, const Shape& shape, std::vector<float>& values) {
  if (!has(name + ".npy")) return false;
  used_.insert(name);
  FloatArray array = read_npy(folder_ / (name + ".npy"));
  if (array.shape != shape) {
    fail(name, "shape " + shape_text(shape) + ", the reference has " + shape_text(array.shape));
    return false;
  }
  values = std::move(array.data);
  return true;
}

void Case::fail(const std::string& name, const std::string& why) { failures_.push_back(name + ": " + why); }

namespace {

Case::Distance distance_of(const std::vector<float>& values, const std::vector<float>& reference) {
  double most = 0, largest = 0, squares = 0, total = 0;
  size_t different = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double error = std::abs(double(values[i]) - double(reference[i]));
    if (!(error <= most)) most = std::isnan(error) ? 1e300 : error;
    largest = std::max(largest, std::abs(double(reference[i])));
    squares += error * error;
    total += double(reference[i]) * double(reference[i]);
    different += values[i] != reference[i];
  }
  return {most > 0 ? most / largest : 0, squares > 0 ? std::sqrt(squares / total) : 0,
          values.empty() ? 0 : double(different) / double(values.size())};
}

}  // namespace

Case::Distance Case::distance(const std::string& name, const std::vector<float>& values) const {
  const FloatArray array = read_npy(folder_ / (name + ".npy"));
  if (array.data.size() != values.size()) return {1e300, 1e300, 1};
  return distance_of(values, array.data);
}

void Case::judge(const std::string& name, const std::vector<float>& values, const std::vector<float>& reference,
                 double limit) {
  const Limits mode{mode_.max_limit, mode_.rms_limit};
  judge(name, values, reference, limit >= 0 ? Limits{limit, limit} : mode);
}

void Case::judge(const std::string& name, const std::vector<float>& values, const std::vector<float>& reference,
                 const Limits& limits) {
  if (values.size() != reference.size()) return fail(name, "another number of values");
  const auto [max_error, rms_error, different] = distance_of(values, reference);
  if (max_error >= worst_) {
    worst_ = max_error;
    worst_name_ = name;
  }
  if (!(max_error <= limits.max) || !(rms_error <= limits.rms)) {
    char text[160];
    std::snprintf(text, sizeof text, "max %.2e (limit %.0e), rms %.2e (limit %.0e)", max_error, limits.max, rms_error,
                  limits.rms);
    fail(name, text);
  }
}

void Case::compare(const std::string& name, const std::vector<float>& values, const Shape& shape) {
  std::vector<float> expected;
  if (reference(name, shape, expected)) judge(name, values, expected);
}

void Case::compare(const std::string& name, const std::vector<float>& values, const Shape& shape,
                   const std::optional<Limits>& rounded) {
  if (exact()) return compare(name, values, shape);
  std::vector<float> expected;
  if (reference(name, shape, expected) && rounded) judge(name, values, expected, *rounded);
}

void Case::compare_exactly(const std::string& name, const std::vector<float>& values, const Shape& shape) {
  std::vector<float> expected;
  if (reference(name, shape, expected)) judge(name, values, expected, 0);
}

void Case::compare_labels(const std::string& name, const std::vector<float>& labels, const Shape& shape) {
  std::vector<float> expected;
  if (!reference(name, shape, expected)) return;
  size_t different = 0;
  for (size_t i = 0; i < labels.size(); ++i) different += labels[i] != expected[i];
  const double fraction = double(different) / double(labels.size());
  if (fraction > mode_.label_limit)
    fail(name, std::to_string(different) + " of " + std::to_string(labels.size()) + " labels differ");
}

void Case::collect(const std::string& name, const std::vector<float>& values, const Shape& one) {
  Collected& all = collected_[name];
  if (all.shape.empty()) {
    all.shape = one;
    all.shape.insert(all.shape.begin(), 0);
  }
  ++all.shape[0];
  all.values.insert(all.values.end(), values.begin(), values.end());
}

void Case::compare_collected() {
  for (const auto& [name, all] : collected_) compare(name, all.values, all.shape);
  collected_.clear();
}

bool Case::finish() {
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() == ".npy" && used_.count(name) == 0) fail(name, "not compared");
  }
  std::printf("%-4s %-16s %-18s worst %.1e (%s)\n", failures_.empty() ? "ok" : "FAIL",
              folder_.filename().string().c_str(), mode_.name.c_str(), worst_, worst_name_.c_str());
  for (const std::string& text : notes_) std::printf("       %s\n", text.c_str());
  for (const std::string& failure : failures_) std::printf("       %s\n", failure.c_str());
  return failures_.empty();
}

nn::VitOptions vit_options(const Json& config) {
  nn::VitOptions options;
  options.heads = config.at("heads").get<int64_t>();
  options.position_offset = value_or(config, "offset", 0.1);
  const bool scaled = options.position_offset != 0;
  options.position = value_or(config, "aa", false)
                         ? (scaled ? nn::PositionRule::kAntialiasedScaleOffset : nn::PositionRule::kAntialiased)
                         : (scaled ? nn::PositionRule::kScaleOffset : nn::PositionRule::kPlain);
  return options;
}

nn::SlidingWindow sliding_window(const Json& config) {
  if (!config.contains("crop") || value_or<std::string>(config, "mode", "slide") != "slide") return {};
  const Json &crop = config.at("crop"), &stride = config.at("stride");
  return {crop.at(0), crop.at(1), stride.at(0), stride.at(1)};
}

Image<uint8_t> image_of(const FloatArray& a) {
  Image<uint8_t> image(int(a.shape.at(1)), int(a.shape.at(0)), int(a.shape.at(2)));
  for (size_t i = 0; i < a.data.size(); ++i) image.data[i] = uint8_t(a.data[i]);
  return image;
}

Image<uint8_t> image_of_nchw(const FloatArray& a) {
  const int channels = int(a.shape.at(1));
  Image<uint8_t> image(int(a.shape.at(3)), int(a.shape.at(2)), channels);
  for (size_t c = 0; c < size_t(channels); ++c) {
    for (size_t p = 0; p < image.pixels(); ++p)
      image.data[p * size_t(channels) + c] = uint8_t(a.data[c * image.pixels() + p]);
  }
  return image;
}

std::vector<float> nchw(const Image<uint8_t>& image) {
  std::vector<float> out;
  for (size_t c = 0; c < size_t(image.channels); ++c) {
    for (size_t p = 0; p < image.pixels(); ++p) out.push_back(float(image.data[p * size_t(image.channels) + c]));
  }
  return out;
}

std::vector<nn::FeatureMap> maps_of(const FloatArray& array) {
  const auto& s = array.shape;
  const int64_t images = s.at(0), channels = s.at(1), height = s.at(2), width = s.at(3);
  std::vector<nn::FeatureMap> maps;
  for (int64_t n = 0; n < images; ++n) {
    nn::FeatureMap map(height, width, channels);
    for (int64_t c = 0; c < channels; ++c) {
      for (int64_t p = 0; p < height * width; ++p) {
        map.data[size_t(p * channels + c)] = array.data[size_t((n * channels + c) * height * width + p)];
      }
    }
    maps.push_back(std::move(map));
  }
  return maps;
}

std::vector<float> nchw(const std::vector<nn::FeatureMap>& maps) {
  std::vector<float> out;
  for (const nn::FeatureMap& map : maps) {
    for (int64_t c = 0; c < map.channels; ++c) {
      for (int64_t p = 0; p < map.places(); ++p) out.push_back(map.data[size_t(p * map.channels + c)]);
    }
  }
  return out;
}

Shape nchw_shape(const std::vector<nn::FeatureMap>& maps) {
  const nn::FeatureMap& m = maps.at(0);
  return {int64_t(maps.size()), m.channels, m.height, m.width};
}

}  // namespace aligngs::parity
