// Weights brought into the store: downloaded, or imported from a file that the user has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.h"
#include "priors/model_store.h"

namespace aligngs {

struct ModelDownloadOptions {
  std::string mirror;        ///< a URL below which the files lie by their names; empty: the publisher
  std::string huggingface_token;  ///< for gated models; empty: none
  int attempts = 5;
  double first_pause = 1;    ///< seconds before the second attempt
  ProgressStyle progress;
};

/// Downloads the files of the model (not what it needs) that are not there, and checks each: its
/// size, its digest where one is published, that it opens as weights and holds the tensors it
/// should. Records digest and licence. Error{kWeights} when a file is not what it should be (it is
/// removed then) or the store is offline; kResources when the disk is too small; as
/// download_to_part() otherwise.
void download_model(const ModelStore& store, const PublishedModel& model,
                    const ModelDownloadOptions& options);

/// Checks `source` in the same way and copies it (a link where the file system can share the
/// bytes) to where find() looks. Which file of the model it is, its tensors tell.
std::filesystem::path import_model_file(const ModelStore& store, const PublishedModel& model,
                                        const std::filesystem::path& source);

struct ModelFileState {
  const PublishedModel* model = nullptr;
  const ModelFile* file = nullptr;
  std::filesystem::path path;   ///< empty: missing
  std::string sha256;           ///< computed now; empty when missing
  bool good = false;
  std::string problem;          ///< why it is not good
  std::string compared_with;    ///< "published", "recorded", "Hugging Face", "nothing"
};

/// Reads every file of the model again and compares its digest with the published one, else the one
/// recorded when it came; opens it and looks for its tensors.
std::vector<ModelFileState> verify_model(const ModelStore& store, const PublishedModel& model);

}  // namespace aligngs
