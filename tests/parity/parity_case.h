// One folder of reference data, and the book-keeping of what was compared with it.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/image.h"
#include "io/npy.h"
#include "nn/compute.h"
#include "nn/sliding_window.h"
#include "nn/tensor.h"
#include "nn/vit.h"
#include "nn/weights.h"

namespace aligngs::parity {

using Json = nlohmann::json;
using Shape = std::vector<int64_t>;

/// A way of computing, and how far its results may lie from the reference.
struct Mode {
  std::string name;
  nn::ComputeOptions options;
  double max_limit;    ///< of max|a - b| / max|b|
  double rms_limit;    ///< of rms(a - b) / rms(b)
  double label_limit;  ///< fraction of labels that may differ
};

/// Precisions in which every case of a network runs; the others in the first only. None: skip everything.
const std::vector<Mode>& modes();

class Case {
 public:
  Case(std::filesystem::path folder, const Mode& mode);

  const Json& config() const { return config_; }
  const Mode& mode() const { return mode_; }
  const std::filesystem::path& folder() const { return folder_; }
  bool has(const std::string& file) const { return std::filesystem::exists(folder_ / file); }

  FloatArray array(const std::string& name);  ///< name.npy, an input
  nn::Weights weights(const std::string& file) const { return nn::Weights::open(folder_ / file); }

  /// How far values of one output may lie from the reference, where the limits of the mode do not fit.
  struct Limits {
    double max, rms;
  };
  bool exact() const { return mode_.options.precision == nn::Precision::kFloat32; }

  /// Compares with name.npy where it is there. Labels: the fraction that differs counts; exact:
  /// none may differ.
  void compare(const std::string& name, const std::vector<float>& values, const Shape& shape);
  /// In float32 as above. In bfloat16 within `rounded`; none: only the shape counts, because rounding can move such an
  /// output anywhere.
  void compare(const std::string& name, const std::vector<float>& values, const Shape& shape,
               const std::optional<Limits>& rounded);
  void compare_labels(const std::string& name, const std::vector<float>& labels, const Shape& shape);
  void compare_exactly(const std::string& name, const std::vector<float>& values, const Shape& shape);
  /// How far values lie from name.npy (of `shape`), relative to it; nothing fails. For labels the
  /// fraction that differs is of use.
  struct Distance {
    double max = 0, rms = 0, different = 0;
  };
  Distance distance(const std::string& name, const std::vector<float>& values) const;
  /// A line below that of the case.
  void note(const std::string& text) { notes_.push_back(text); }
  /// The comparison itself; `limit` < 0: those of the mode.
  void judge(const std::string& name, const std::vector<float>& values, const std::vector<float>& reference,
             double limit = -1);
  void judge(const std::string& name, const std::vector<float>& values, const std::vector<float>& reference,
             const Limits& limits);
  void fail(const std::string& name, const std::string& why);

  /// Values of one image, or scene, of several: joined with those collected before under that name. compare_collected()
  /// compares them, with their number as the first axis.
  void collect(const std::string& name, const std::vector<float>& values, const Shape& one);
  void compare_collected();

  /// Every .npy file must have been read or compared; prints a line; true when all is well.
  bool finish();

 private:
  bool reference(const std::string& name, const Shape& shape, std::vector<float>& values);

  std::filesystem::path folder_;
  const Mode& mode_;
  Json config_;
  std::set<std::string> used_;
  std::vector<std::string> failures_, notes_;
  struct Collected {
    std::vector<float> values;
    Shape shape;
  };
  std::map<std::string, Collected> collected_;
  double worst_ = 0;
  std::string worst_name_ = "-";
};

/// Heads and the rule for the position embedding as the case has them.
nn::VitOptions vit_options(const Json& config);
/// The windows of a segmentation case; without sizes, or in mode "whole", the whole image.
nn::SlidingWindow sliding_window(const Json& config);

/// An image of 8 bits [height, width, channels].
Image<uint8_t> image_of(const FloatArray& array);
/// The same of a first image of [images, channels, height, width], and back.
Image<uint8_t> image_of_nchw(const FloatArray& array);
std::vector<float> nchw(const Image<uint8_t>& image);
/// Values of an NCHW array as maps, one per image, and back.
std::vector<nn::FeatureMap> maps_of(const FloatArray& array);
std::vector<float> nchw(const std::vector<nn::FeatureMap>& maps);
Shape nchw_shape(const std::vector<nn::FeatureMap>& maps);

template <class T>
T value_or(const Json& config, const char* key, T fallback) {
  return config.contains(key) ? config.at(key).get<T>() : fallback;
}

void run_vit(Case& test, nn::Compute& compute);
void run_vggt(Case& test, nn::Compute& compute);
void run_segmentation(Case& test, nn::Compute& compute);
void run_depth(Case& test, nn::Compute& compute);
void run_mask2former(Case& test, nn::Compute& compute);
void run_deformable_attention(Case& test, nn::Compute& compute);
void run_ops(Case& test, nn::Compute& compute);
void run_preprocess(Case& test, nn::Compute& compute);
void run_loader(Case& test, nn::Compute& compute);
void run_da3(Case& test, nn::Compute& compute);
void run_da3_metric(Case& test, nn::Compute& compute);
void run_da3_nested(Case& test, nn::Compute& compute);
void run_da3_camera(Case& test, nn::Compute& compute);
void run_da3_raypose(Case& test, nn::Compute& compute);
void run_da3_preprocess(Case& test, nn::Compute& compute);
void run_eomt(Case& test, nn::Compute& compute);
void run_lingbot(Case& test, nn::Compute& compute);

}  // namespace aligngs::parity
