// Places of weights on this machine: Hugging Face's cache, our own folder, torch's cache.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "priors/model_registry.h"

namespace aligngs {

struct ModelStoreOptions {
  std::filesystem::path folder;                    ///< ours: <folder>/<model>/<file>
  std::vector<std::filesystem::path> huggingface;  ///< folders with models--<owner>--<name>
  std::vector<std::filesystem::path> torch;        ///< folders with files as torch.hub names them
  bool offline = false;                            ///< never touch the network

  /// Ours: $ALIGNGS_MODELS, else $XDG_CACHE_HOME/aligngs/models, else ~/.cache/aligngs/models.
  /// Hugging Face's: $HF_HUB_CACHE, else $HF_HOME/hub, else ~/.cache/huggingface/hub; torch's:
  /// $TORCH_HOME/hub/checkpoints, else ~/.cache/torch/hub/checkpoints. offline also when
  /// ALIGNGS_OFFLINE or HF_HUB_OFFLINE is set to anything but "" or "0".
  static ModelStoreOptions from_environment(bool offline);
};

enum class ModelPlace { kOurs, kHuggingFace, kTorch };
const char* name_of(ModelPlace place);

struct LocatedModelFile {
  std::filesystem::path path;
  ModelPlace place = ModelPlace::kOurs;
};

class ModelStore {
 public:
  explicit ModelStore(ModelStoreOptions options) : options_(std::move(options)) {}

  const ModelStoreOptions& options() const { return options_; }
  /// Place to which download and import write a file.
  std::filesystem::path own_path(const PublishedModel& model, const ModelFile& file) const;
  /// Looks at the disk only; the first place that has the file wins. Hugging Face's cache, which
  /// the user's other programs read as well, then ours, then torch's.
  std::optional<LocatedModelFile> find(const PublishedModel& model, const ModelFile& file) const;
  /// Every path that find() looks at, in its order ("*" for any revision).
  std::vector<std::filesystem::path> places(const PublishedModel& model, const ModelFile& file) const;
  /// Whether all files of the model and of what it needs are there.
  bool installed(const PublishedModel& model) const;
  /// The files of the model itself. Error{kWeights} when a file of it, or of a model that it needs,
  /// is missing. The error names the download command, the size and the searched places. Error{kWeights} also where a
  /// file holds another published model (other_model_in), whose licence may be another one.
  std::vector<std::filesystem::path> require(const PublishedModel& model) const;

  /// SHA-256 of a file that find() returned: the recorded one while its size and time stay, or the
  /// name of Hugging Face's blob. Otherwise computed (and recorded) now.
  std::string digest(const PublishedModel& model, const ModelFile& file, const LocatedModelFile& located) const;

  /// The record beside a file: `<file>.json` in our folder, also for files that lie elsewhere.
  struct Record {
    std::string path, sha256, source;
    uint64_t bytes = 0;
    int64_t modified = 0;  ///< of the file, seconds
    std::string licence;   ///< accepted when it was downloaded; empty otherwise
  };
  std::optional<Record> record(const PublishedModel& model, const ModelFile& file) const;
  void write_record(const PublishedModel& model, const ModelFile& file, const Record& record) const;

 private:
  ModelStoreOptions options_;
};

/// SHA-256 of a whole file, 64 hexadecimal digits. Error{kBadInput} when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// Seconds since the epoch at which the file was changed last.
int64_t modification_seconds(const std::filesystem::path& path);

/// The text of the error of require(), for callers that can go on without the model.
std::string how_to_get(const ModelStore& store, const PublishedModel& model);

}  // namespace aligngs
