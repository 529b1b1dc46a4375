#include "train/checkpoint_planes.h"

#include "train/checkpoint_tensors.h"

namespace aligngs {
namespace {

constexpr const char* kSizes = "planes.sizes";      // per view: width, height, planes
constexpr const char* kFrames = "planes.frames";    // per plane of a view: normal, distance
constexpr const char* kScales = "planes.scales";    // per view
constexpr const char* kNumbers = "planes.numbers";  // per pixel
constexpr const char* kWeights = "planes.weights";  // per pixel
constexpr size_t kSizeNumbers = 3, kFrameNumbers = 4;
constexpr int64_t kMostPlanes = 255;       // that a byte numbers
constexpr int64_t kLargestSide = 1 << 20;  // pixels: products of sizes stay in 64 bits

/// Takes a view's part of a tensor of all views.
template <class T>
class Reader {
 public:
  Reader(const TensorFile& file, const char* name, const char* dtype, const std::filesystem::path& path)
      : values_(raw_values<T>(file, name, dtype, path)), name_(name), path_(path) {}
  std::vector<T> take(size_t count) {
    if (count > values_.size() - used_) throw_bad_input(path_, name_, "the tensor is too short for the views");
    const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(used_);
    used_ += count;
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
  }

 private:
  std::vector<T> values_;
  const char* name_;
  const std::filesystem::path& path_;
  size_t used_ = 0;
};

Image<uint8_t> image_of(std::vector<uint8_t> pixels, int width, int height) {
  Image<uint8_t> out;
  out.width = width;
  out.height = height;
  out.channels = 1;
  out.data = std::move(pixels);
  return out;
}

}  // namespace

void put_planes(const PlaneTargets& targets, TensorFile& file) {
  if (targets.empty()) return;
  std::vector<int64_t> sizes;
  std::vector<double> frames;
  std::vector<float> scales;
  std::vector<uint8_t> numbers, weights;
  for (const ViewPlanes& view : targets.views) {
    sizes.insert(sizes.end(), {view.plane.width, view.plane.height, static_cast<int64_t>(view.planes.size())});
    for (const CameraPlane& plane : view.planes) {
      frames.insert(frames.end(), {plane.normal.x, plane.normal.y, plane.normal.z, plane.distance});
    }
    scales.push_back(view.depth_scale);
    numbers.insert(numbers.end(), view.plane.data.begin(), view.plane.data.end());
    weights.insert(weights.end(), view.weight.data.begin(), view.weight.data.end());
  }
  file.tensors[kSizes] = raw_tensor("I64", sizes.data(), sizes.size());
  file.tensors[kFrames] = raw_tensor("F64", frames.data(), frames.size());
  file.tensors[kScales] = raw_tensor("F32", scales.data(), scales.size());
  file.tensors[kNumbers] = raw_tensor("U8", numbers.data(), numbers.size());
  file.tensors[kWeights] = raw_tensor("U8", weights.data(), weights.size());
}

PlaneTargets take_planes(const TensorFile& file, const std::filesystem::path& path) {
  PlaneTargets out;
  if (file.tensors.count(kSizes) == 0) return out;
  const std::vector<int64_t> sizes = raw_values<int64_t>(file, kSizes, "I64", path);
  if (sizes.size() % kSizeNumbers != 0) throw_bad_input(path, kSizes, "the tensor has another size than views need");
  Reader<double> frames(file, kFrames, "F64", path);
  Reader<float> scales(file, kScales, "F32", path);
  Reader<uint8_t> numbers(file, kNumbers, "U8", path), weights(file, kWeights, "U8", path);
  for (size_t i = 0; i < sizes.size(); i += kSizeNumbers) {
    const int64_t width = sizes[i], height = sizes[i + 1], count = sizes[i + 2];
    if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide || count < 0 || count > kMostPlanes) {
      throw_bad_input(path, kSizes, "no view has such a size or so many planes");
    }
    ViewPlanes view;
    for (int64_t k = 0; k < count; ++k) {
      const std::vector<double> plane = frames.take(kFrameNumbers);
      view.planes.push_back({{plane[0], plane[1], plane[2]}, plane[3], PlaneKind::kNone, static_cast<uint8_t>(k + 1)});
    }
    view.depth_scale = scales.take(1)[0];
    const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    view.plane = image_of(numbers.take(pixels), static_cast<int>(width), static_cast<int>(height));
    view.weight = image_of(weights.take(pixels), static_cast<int>(width), static_cast<int>(height));
    for (const uint8_t number : view.plane.data) {
      if (number > count) throw_bad_input(path, kNumbers, "a pixel lies on a plane that is not there");
    }
    out.views.push_back(std::move(view));
  }
  return out;
}

}  // namespace aligngs
