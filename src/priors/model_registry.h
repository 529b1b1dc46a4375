// The published weights that aligngs can read: what they are for, where they come from, on what
// terms.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aligngs {

struct ModelLicence {
  std::string id;             ///< SPDX where there is one
  std::string url;            ///< the text
  std::string note;           ///< what it means for a user, one sentence; may be empty
  bool gated = false;         ///< the publisher wants a form filled in first
  bool commercial = true;     ///< whether commercial use is allowed
  std::string question = {};  ///< what is not clear about the terms, one sentence; shown before a download

  bool is_for_anyone() const { return commercial && question.empty(); }
};

struct ModelFile {
  std::string name;  ///< in the folder of the model
  std::string url;
  std::string huggingface;        ///< repository "owner/name" whose cache may hold it; may be empty
  std::vector<std::string> also;  ///< other names of a file there with the same tensors
  uint64_t bytes = 0;
  bool exact_size = false;       ///< false: `bytes` is rounded
  std::string sha256;            ///< published digest or its first digits; empty: none is published
  std::string probe;             ///< a tensor that tells such a file from others
  std::string other_probe = {};  ///< the same in another layout of names; may be empty
  /// Last dimension of the probe in the published file, where models of several widths share it; 0: they do not.
  int64_t probe_columns = 0;
};

struct PublishedModel {
  std::string name;     ///< as the command line has it, e.g. "vggt-1b"
  std::string purpose;  ///< one line
  ModelLicence licence;
  std::vector<ModelFile> files;
  std::vector<std::string> needs;  ///< names of models without which it is of no use (backbones)
};

/// All of them, in the order in which they are listed.
const std::vector<PublishedModel>& published_models();

/// Error{kUsage} with the nearest name when there is none of this name.
const PublishedModel& published_model(const std::string& name);

/// The model and what it needs, backbones first.
std::vector<const PublishedModel*> with_needs(const PublishedModel& model);

/// Sum over the files.
uint64_t download_bytes(const PublishedModel& model);

}  // namespace aligngs
