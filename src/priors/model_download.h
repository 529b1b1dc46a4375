// Weights brought into the store: downloaded, or imported from a file that the user has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "priors/model_store.h"

namespace aligngs {

struct ModelDownloadOptions {
  std::string mirror;             ///< a URL below which the files lie by their names; empty: the publisher
  std::string huggingface_token;  ///< for gated models; empty: none
  int attempts = 5;
  double first_pause = 1;  ///< seconds before the second attempt
  ProgressStyle progress;
};

/// Downloads the missing files of the model (not of models that it needs), and checks each. Checked are its size, its
/// digest where one is published, that it opens as weights, and its tensors. Records digest and licence.
/// Error{kWeights} when a file fails a check (it is removed then) or the store is offline. kResources when the disk is
/// too small; as download_to_part() otherwise.
void download_model(const ModelStore& store, const PublishedModel& model, const ModelDownloadOptions& options);

/// Checks `source` in the same way and copies it (a link where the file system can share the bytes) to where find()
/// looks. Its tensors identify the file of the model.
std::filesystem::path import_model_file(const ModelStore& store, const PublishedModel& model,
                                        const std::filesystem::path& source);

struct ModelFileState {
  const PublishedModel* model = nullptr;
  const ModelFile* file = nullptr;
  std::filesystem::path path;  ///< empty: missing
  std::string sha256;          ///< computed now; empty when missing
  bool good = false;
  std::string problem;        ///< why it is not good
  std::string compared_with;  ///< "published", "recorded", "Hugging Face", "nothing"
};

/// Reads every file of the model again, opens it and looks for its tensors. Compares its digest with the published one,
/// else with the one recorded at the download.
std::vector<ModelFileState> verify_model(const ModelStore& store, const PublishedModel& model);

}  // namespace aligngs
