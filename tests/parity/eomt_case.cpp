// EoMT, by the publisher's names and by Hugging Face's, as a semantic and as a panoptic network.
#include <nlohmann/json.hpp>

#include "io/atomic_file.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/eomt/panoptic.h"
#include "nn/segmentation.h"
#include "parity_case.h"

namespace aligngs::parity {
namespace {

constexpr Case::Limits kSemanticScores{6e-2, 4e-2};  // of a panoptic network, in bfloat16

std::vector<float> as_floats(const std::vector<int>& values) { return {values.begin(), values.end()}; }

/// Every `step`-th row from `first` on, channels first.
std::vector<float> some_rows(const nn::FeatureMap& map, int64_t first, int64_t step, Shape& shape) {
  std::vector<float> out;
  int64_t rows = 0;
  for (int64_t y = first; y < map.height; y += step) ++rows;
  for (int64_t c = 0; c < map.channels; ++c) {
    for (int64_t y = first; y < map.height; y += step) {
      for (int64_t x = 0; x < map.width; ++x) out.push_back(map.at(y, x)[c]);
    }
  }
  shape = {1, map.channels, rows, map.width};
  return out;
}

void compare_rows(Case& test, const std::string& name, const nn::FeatureMap& map,
                  const std::optional<Case::Limits>& rounded) {
  const Json& rows = test.config().at("rows");
  Shape shape;
  const std::vector<float> values = some_rows(map, rows.at(0), rows.at(1), shape);
  test.compare(name, values, shape, rounded);
}

void compare_prediction(Case& test, const nn::EomtPrediction& prediction, const nn::EomtInside& inside) {
  const auto rows = [&](const char* const name, const nn::Matrix& m) {
    test.compare(name, m.data, {1, m.rows, m.columns});
  };
  rows("out_tokens_before", inside.tokens_before);
  rows("out_tokens_last", inside.tokens_last);
  rows("out_mask_embed", inside.mask_embedding);
  rows("out_class_logits", prediction.classes);
  test.compare("out_upscaled", nchw({inside.upscaled}), nchw_shape({inside.upscaled}));
  test.compare("out_mask_logits", nchw({prediction.masks}), nchw_shape({prediction.masks}));
}

void compare_labels_of(Case& test, nn::Compute& compute, const nn::Eomt& network, const std::string& input,
                       const std::string& windows_key, const std::string& labels, const std::string& scores) {
  const Image<uint8_t> photo = image_of_nchw(test.array(input));
  const nn::EomtWindows windows = nn::eomt_windows(photo, network.window());
  Json found = Json::array();
  for (const int start : windows.starts) found.push_back({start, start + windows.side});
  if (found != test.config().at(windows_key)) test.fail(windows_key, "the windows lie elsewhere: " + found.dump());
  const nn::FeatureMap map = nn::eomt_scores(compute, network, photo, photo.height, photo.width);
  if (!scores.empty()) test.compare(scores, nchw({map}), nchw_shape({map}));
  test.compare_labels(labels, as_floats(nn::argmax_channels(map)), {1, photo.height, photo.width});
}

void run_semantic(Case& test, nn::Compute& compute, const nn::Eomt& network) {
  const Image<uint8_t> photo = image_of_nchw(test.array("in_image"));
  const nn::EomtWindows windows = nn::eomt_windows(photo, network.window());
  std::vector<float> crops;
  for (size_t i = 0; i < windows.starts.size(); ++i) {
    const std::vector<float> crop = nchw(windows.window(i));
    crops.insert(crops.end(), crop.begin(), crop.end());
  }
  test.compare_exactly("out_crops", crops, {int64_t(windows.starts.size()), 3, windows.side, windows.side});
  nn::EomtInside inside;
  const nn::EomtPrediction prediction =
      network(compute, windows.window(test.config().at("window").get<size_t>()), &inside);
  compare_prediction(test, prediction, inside);
  const nn::FeatureMap scores = nn::eomt_window_scores(network.exact(), prediction, windows.side);
  compare_rows(test, "out_window_scores", scores, Case::Limits{test.mode().max_limit, test.mode().rms_limit});
  compare_labels_of(test, compute, network, "in_image", "windows", "out_labels", "out_scores");
  if (test.has("in_image_tall.npy"))
    compare_labels_of(test, compute, network, "in_image_tall", "windows_tall", "out_labels_tall", "");
}

void compare_segments(Case& test, const nn::PanopticMap& map, size_t index) {
  const std::string n = std::to_string(index);
  const Shape shape = {1, map.height, map.width};
  test.compare_labels("out_segment_map_" + n, as_floats(map.segments), shape);
  test.compare_labels("out_class_map_" + n, as_floats(map.categories), shape);
  // Segments of a few pixels may come and go when the network is rounded.
  if (!test.exact()) {
    test.array("out_segment_scores_" + n);
    return;
  }
  std::vector<float> scores;
  Json found = Json::array();
  for (const nn::PanopticSegment& segment : map.list) {
    scores.push_back(segment.score);
    found.push_back({segment.id, segment.category});
  }
  Json expected = Json::array();
  for (const Json& segment : test.config().at("segments").at(index).at("segments"))
    expected.push_back({segment.at("id"), segment.at("class")});
  if (found != expected) test.fail("segments " + n, "found " + found.dump() + ", expected " + expected.dump());
  test.compare("out_segment_scores_" + n, scores, {int64_t(scores.size())});
}

void run_panoptic(Case& test, nn::Compute& compute, const nn::Eomt& network) {
  const Image<uint8_t> photo = image_of_nchw(test.array("in_image"));
  const nn::EomtPadded padded = nn::eomt_padded(photo, network.window());
  test.compare_exactly("out_padded", nchw(padded.image), {1, 3, padded.image.height, padded.image.width});
  nn::EomtInside inside;
  const nn::EomtPrediction prediction = network(compute, padded.image, &inside);
  compare_prediction(test, prediction, inside);
  const Json& thresholds = test.config().at("thresholds");
  for (size_t i = 0; i < thresholds.size(); ++i) {
    nn::PanopticOptions options;
    options.class_threshold = thresholds.at(i).at(0);
    options.overlap_threshold = thresholds.at(i).at(1);
    options.stuff = test.config().at("stuff_classes").get<std::vector<int>>();
    compare_segments(test, nn::panoptic_map(network.exact(), prediction, padded, photo.width, photo.height, options),
                     i);
  }
  compare_rows(test, "out_semantic_scores", nn::eomt_scores(compute, network, photo, photo.height, photo.width),
               kSemanticScores);
}

}  // namespace

void run_eomt(Case& test, nn::Compute& compute) {
  const Json& config = test.config();
  const auto task = config.at("task").get<std::string>();
  for (const char* const file : {"weights.safetensors", "hf_model.safetensors"}) {
    if (!test.has(file)) continue;
    nn::EomtOptions options;
    if (std::string(file) == "hf_model.safetensors" && test.has("hf_preprocessor_config.json")) {
      const Json pixels = Json::parse(read_file(test.folder() / "hf_preprocessor_config.json"));
      pixels.at("image_mean").get_to(options.mean);
      pixels.at("image_std").get_to(options.deviation);
    }
    if (std::string(file) == "hf_model.safetensors" && test.has("hf_config.json"))
      options.query_blocks = Json::parse(read_file(test.folder() / "hf_config.json")).at("num_blocks");
    options.heads = config.at("heads").get<int64_t>();
    const nn::Eomt network(compute, nn::eomt_weights(WeightFile::open(test.folder() / file)), options);
    if (task == "semantic") {
      run_semantic(test, compute, network);
    } else if (task == "panoptic") {
      run_panoptic(test, compute, network);
    } else {
      test.fail("task", "unknown task " + task);
    }
  }
}

}  // namespace aligngs::parity
