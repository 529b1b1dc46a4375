// Sizes and names: the publishers' README files. No publisher gives digests, except in file names
// (torchvision: the first digits of the SHA-256) and in Hugging Face's cache.
#include "priors/model_registry.h"

#include <algorithm>

#include "core/edit_distance.h"
#include "core/error.h"

namespace aligngs {
namespace {

constexpr uint64_t kMegabyte = 1'000'000;

ModelLicence apache() {
  return {"Apache-2.0", "https://github.com/facebookresearch/dinov2/blob/main/LICENSE", "", false};
}

std::string dinov2_url(char letter, const std::string& file) {
  return std::string("https://dl.fbaipublicfiles.com/dinov2/dinov2_vit") + letter + "14/" + file;
}

struct Dinov2Size {
  char letter;
  const char* title;
  const char* word;             ///< in names on Hugging Face
  uint64_t backbone_megabytes;  ///< float32
  uint64_t channels;
  uint64_t dpt_megabytes;  ///< the file holds the optimiser's state as well: three times the head
};
constexpr Dinov2Size kDinov2Sizes[] = {{'s', "ViT-S/14", "small", 88, 384, 168},
                                       {'b', "ViT-B/14", "base", 346, 768, 291},
                                       {'l', "ViT-L/14", "large", 1217, 1024, 411},
                                       {'g', "ViT-g/14", "giant", 4546, 1536, 741}};

PublishedModel backbone(const Dinov2Size& size) {
  const std::string file = std::string("dinov2_vit") + size.letter + "14_pretrain.pth";
  PublishedModel model;
  model.name = std::string("dinov2-") + size.letter;
  model.purpose = std::string("image features (") + size.title + "): backbone of the heads below";
  model.licence = apache();
  model.files = {{file,
                  dinov2_url(size.letter, file),
                  "",
                  {},
                  size.backbone_megabytes * kMegabyte,
                  false,
                  "",
                  "blocks.0.attn.qkv.weight",
                  "",
                  static_cast<int64_t>(size.channels)}};
  return model;
}

/// A head beside its backbone. `kind`: as in the publisher's file names.
PublishedModel head(const Dinov2Size& size, const std::string& name, const std::string& kind,
                    const std::string& purpose, uint64_t bytes, const std::string& probe) {
  const std::string file = std::string("dinov2_vit") + size.letter + "14_" + kind + "_head.pth";
  PublishedModel model;
  model.name = name + "-" + size.letter;
  model.purpose = purpose + " (" + size.title + ")";
  model.licence = apache();
  model.files = {{file, dinov2_url(size.letter, file), "", {}, bytes, false, "", probe}};
  model.needs = {std::string("dinov2-") + size.letter};
  return model;
}

PublishedModel vggt() {
  PublishedModel model;
  model.name = "vggt-1b";
  model.purpose = "cameras, depth and points from photos alone (VGGT-1B)";
  model.licence = {"CC-BY-NC-4.0", "https://huggingface.co/facebook/VGGT-1B", "non-commercial use only", false, false};
  model.files = {{"model.safetensors",
                  "https://huggingface.co/facebook/VGGT-1B/resolve/main/model.safetensors",
                  "facebook/VGGT-1B",
                  {"model.pt"},
                  5026 * kMegabyte,
                  false,
                  "",
                  "aggregator.camera_token"}};
  return model;
}

PublishedModel commercial_vggt() {
  PublishedModel model;
  model.name = "vggt-1b-commercial";
  model.purpose = "the same network, trained for commercial use";
  model.licence = {"VGGT License v1", "https://huggingface.co/facebook/VGGT-1B-Commercial",
                   "commercial use allowed under an acceptable-use policy, no military use", true};
  model.files = {{"vggt_1B_commercial.pt",
                  "https://huggingface.co/facebook/VGGT-1B-Commercial/resolve/main/vggt_1B_commercial.pt",
                  "facebook/VGGT-1B-Commercial",
                  {"model.safetensors", "model.pt"},
                  5026 * kMegabyte,
                  false,
                  "",
                  "aggregator.camera_token"}};
  return model;
}

/// Stage 1 of LingBot-Map: tensors of VGGT without its heads for points and tracks.
PublishedModel lingbot_map() {
  PublishedModel model;
  model.name = "lingbot-map";
  model.purpose = "cameras and depth from photos alone (LingBot-Map stage 1, the network of VGGT)";
  model.licence = {"Apache-2.0",
                   "https://huggingface.co/robbyant/lingbot-map",
                   "as declared by the publisher",
                   false,
                   true,
                   "whether these weights started from VGGT-1B, which is non-commercial, is not known: the publisher "
                   "has not answered"};
  model.files = {{"lingbot-map-stage1.pt",
                  "https://huggingface.co/robbyant/lingbot-map/resolve/main/lingbot-map-stage1.pt",
                  "robbyant/lingbot-map",
                  {},
                  4632 * kMegabyte,
                  false,
                  "",
                  "aggregator.camera_token"}};
  return model;
}

PublishedModel mask2former() {
  PublishedModel model;
  model.name = "ade20k-m2f";
  model.purpose = "150 classes of ADE20K, the method's teacher (ViT-g + Mask2Former)";
  model.licence = apache();
  const std::string file = "dinov2_vitg14_ade20k_m2f.pth";
  model.files = {{file, dinov2_url('g', file), "", {}, 6900 * kMegabyte, false, "", "decode_head.query_feat.weight"}};
  return model;
}

PublishedModel lpips() {
  PublishedModel model;
  model.name = "lpips-vgg";
  model.purpose = "the image metric LPIPS v0.1 on VGG16 (nvs.lpips of metrics.json)";
  model.licence = {"BSD-3-Clause (VGG16), BSD-2-Clause (LPIPS)",
                   "https://github.com/richzhang/PerceptualSimilarity/blob/master/LICENSE", "", false};
  model.files = {{"vgg16-397923af.pth",
                  "https://download.pytorch.org/models/vgg16-397923af.pth",
                  "",
                  {},
                  553433881,
                  true,
                  "397923af",
                  "features.0.weight"},
                 {"vgg.pth",
                  "https://raw.githubusercontent.com/richzhang/PerceptualSimilarity/master/lpips/"
                  "weights/v0.1/vgg.pth",
                  "",
                  {},
                  7289,
                  false,
                  "",
                  "lin0.model.1.weight"}};
  return model;
}

enum class Da3Terms { kFree, kNonCommercial };

/// A tensor that tells a file of Depth Anything 3 from others. `columns`: as of ModelFile.
struct Da3Probe {
  std::string tensor;
  int64_t columns = 0;
};

/// Depth Anything 3. `repository`: on Hugging Face.
PublishedModel da3(const std::string& name, const std::string& repository, Da3Terms terms, const std::string& purpose,
                   uint64_t bytes, bool exact, const Da3Probe& probe) {
  const std::string page = "https://huggingface.co/depth-anything/" + repository;
  PublishedModel model;
  model.name = name;
  model.purpose = purpose;
  model.licence = {"Apache-2.0", page, "", false};
  if (terms == Da3Terms::kNonCommercial)
    model.licence = {"CC-BY-NC-4.0", page, "non-commercial use only", false, false};
  model.files = {{"model.safetensors",
                  page + "/resolve/main/model.safetensors",
                  "depth-anything/" + repository,
                  {},
                  bytes,
                  exact,
                  "",
                  probe.tensor,
                  "",
                  probe.columns}};
  return model;
}

/// Sizes of small and base follow from their tensors; those of the metric and the large network are published.
void add_da3(std::vector<PublishedModel>& models) {
  const std::string cameras = "cameras and depth from photos alone (Depth Anything 3, ";
  // The camera branch takes local and global tokens together: twice the channels of the trunk.
  const auto any = [](int64_t channels) { return Da3Probe{"model.cam_dec.fc_t.weight", 2 * channels}; };
  const Da3Probe sky = {"model.head.scratch.sky_output_conv2.0.weight"};
  models.push_back(da3("da3-small", "DA3-SMALL", Da3Terms::kFree, cameras + "Small)", 137248940, false, any(384)));
  models.push_back(da3("da3-base", "DA3-BASE", Da3Terms::kFree, cameras + "Base)", 541518028, false, any(768)));
  models.push_back(
      da3("da3-large", "DA3-LARGE-1.1", Da3Terms::kNonCommercial, cameras + "Large)", 1643843860, true, any(1024)));
  models.push_back(da3("da3-giant", "DA3-GIANT-1.1", Da3Terms::kNonCommercial, cameras + "Giant)", 4600 * kMegabyte,
                       false, any(1536)));
  models.push_back(da3("da3metric-large", "DA3METRIC-LARGE", Da3Terms::kFree,
                       "metric depth and sky of one photo (Depth Anything 3)", 1336734448, true, sky));
}

PublishedModel eomt(const std::string& name, const std::string& repository, const std::string& purpose,
                    uint64_t bytes) {
  const std::string page = "https://huggingface.co/tue-mps/" + repository;
  PublishedModel model;
  model.name = name;
  model.purpose = purpose;
  model.licence = {"MIT", page, "the licence of the code; look at the page for that of the weights", false};
  model.files = {{"pytorch_model.bin",
                  page + "/resolve/main/pytorch_model.bin",
                  "tue-mps/" + repository,
                  {"model.safetensors"},
                  bytes,
                  false,
                  "",
                  "network.q.weight",
                  "query.weight"}};
  return model;
}

PublishedModel lingbot() {
  const std::string repository = "LibreYOLO/LibreLingBotVisions-sem", file = "LibreLingBotVisions-sem.pt";
  PublishedModel model;
  model.name = "lingbot-s";
  model.purpose = "150 classes, a light choice (LingBot-Vision-S with a linear head)";
  model.licence = {"Apache-2.0", "https://huggingface.co/" + repository, "", false};
  model.files = {{file,
                  "https://huggingface.co/" + repository + "/resolve/main/" + file,
                  repository,
                  {},
                  87 * kMegabyte,
                  false,
                  "",
                  "backbone.rope_embed.periods"}};
  return model;
}

std::vector<PublishedModel> make_models() {
  constexpr uint64_t kClasses = 150, kFloatBytes = 4, kHeadOverhead = 4000;
  std::vector<PublishedModel> models = {vggt(), commercial_vggt(), lingbot_map()};
  add_da3(models);
  models.push_back(mask2former());
  models.push_back(eomt("eomt-l", "ade20k_semantic_eomt_large_512", "150 classes of ADE20K (EoMT-L, windows of 512)",
                        1264 * kMegabyte));
  models.push_back(eomt("eomt-l-panoptic", "ade20k_panoptic_eomt_large_640",
                        "150 classes of ADE20K, things one by one (EoMT-L, windows of 640)", 1267 * kMegabyte));
  models.push_back(lingbot());
  for (const Dinov2Size& size : kDinov2Sizes) {
    models.push_back(head(size, "ade20k-linear", "ade20k_linear", "150 classes, the light choice",
                          (kClasses + 4) * size.channels * kFloatBytes + kHeadOverhead, "decode_head.conv_seg.weight"));
  }
  for (const Dinov2Size& size : kDinov2Sizes) {
    models.push_back(head(size, "ade20k-ms", "ade20k_ms", "150 classes from four layers",
                          4 * (kClasses + 4) * size.channels * kFloatBytes + kHeadOverhead,
                          "decode_head.conv_seg.weight"));
  }
  for (const Dinov2Size& size : kDinov2Sizes) {
    models.push_back(head(size, "nyu-dpt", "nyu_dpt", "metric depth of one photo, DPT head",
                          size.dpt_megabytes * kMegabyte, "decode_head.project.conv.weight"));
    // The same weights, backbone included, as transformers stores them.
    models.back().files[0].huggingface = std::string("facebook/dpt-dinov2-") + size.word + "-nyu";
    models.back().files[0].also = {"model.safetensors", "pytorch_model.bin"};
    models.back().files[0].other_probe = "neck.convs.0.weight";
  }
  for (const Dinov2Size& size : kDinov2Sizes) {
    constexpr uint64_t kBins = 256, kLayers = 4;
    models.push_back(head(size, "nyu-linear4", "nyu_linear4", "metric depth of one photo, linear head",
                          kBins * 2 * size.channels * kLayers * kFloatBytes + kHeadOverhead,
                          "decode_head.conv_depth.weight"));
  }
  for (const Dinov2Size& size : kDinov2Sizes) models.push_back(backbone(size));
  models.push_back(lpips());
  return models;
}

}  // namespace

const std::vector<PublishedModel>& published_models() {
  static const std::vector<PublishedModel> models = make_models();
  return models;
}

const PublishedModel& published_model(const std::string& name) {
  const std::vector<PublishedModel>& models = published_models();
  const PublishedModel* nearest = &models.front();
  for (const PublishedModel& model : models) {
    if (model.name == name) return model;
    if (edit_distance(name, model.name) < edit_distance(name, nearest->name)) nearest = &model;
  }
  throw_usage("there is no model \"" + name + "\"",
              "`aligngs models list` shows the names; the nearest is " + nearest->name);
}

std::vector<const PublishedModel*> with_needs(const PublishedModel& model) {
  std::vector<const PublishedModel*> all;
  for (const std::string& name : model.needs) {
    for (const PublishedModel* need : with_needs(published_model(name))) {
      if (std::find(all.begin(), all.end(), need) == all.end()) all.push_back(need);
    }
  }
  all.push_back(&model);
  return all;
}

uint64_t download_bytes(const PublishedModel& model) {
  uint64_t bytes = 0;
  for (const ModelFile& file : model.files) bytes += file.bytes;
  return bytes;
}

}  // namespace aligngs
