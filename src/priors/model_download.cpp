#include "priors/model_download.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/log.h"
#include "core/stop_signal.h"
#include "core/temporary_paths.h"
#include "io/file_system_error.h"
#include "priors/http_download.h"
#include "priors/model_identity.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t kProgressUnit = 1'000'000;

[[noreturn]] void wrong_file(const fs::path& path, const std::string& field, const std::string& message,
                             const std::string& remedy) {
  throw Error({ErrorKind::kWeights, message, path, field, remedy});
}

bool digest_agrees(const ModelFile& file, const std::string& sha256) {
  return sha256.compare(0, file.sha256.size(), file.sha256) == 0;
}

/// One process at a time fetches a model.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) {
    make_folders(folder);
    const fs::path path = folder / ".lock";
    descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw_resources(path, std::strerror(errno), "choose a folder that you may write to with ALIGNGS_MODELS");
    }
    if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    close(descriptor_);
    throw Error({ErrorKind::kFailed, "another aligngs is fetching this model", folder, "", "wait for it to end"});
  }
  ~FolderLock() { close(descriptor_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

void require_space(const fs::path& folder, const fs::path& part, uint64_t bytes) {
  std::error_code error;
  const uintmax_t there = fs::file_size(part, error);
  const uint64_t have = error ? 0 : uint64_t(there);
  const fs::space_info space = fs::space(folder, error);
  if (error || bytes <= have || space.available >= bytes - have) return;
  throw_resources(
      folder, fmt::format("{} are free and {} are needed", format_bytes(space.available), format_bytes(bytes - have)),
      "free space there, or choose another folder with ALIGNGS_MODELS");
}

fs::path importing(const fs::path& target) { return target.string() + ".importing"; }

std::string url_of(const ModelFile& file, const std::string& mirror) {
  if (mirror.empty()) return file.url;
  return mirror + (mirror.back() == '/' ? "" : "/") + file.name;
}

void download_file(const ModelStore& store, const PublishedModel& model, const ModelFile& file,
                   const ModelDownloadOptions& options) {
  const fs::path target = store.own_path(model, file);
  const fs::path part = part_of(target);
  std::error_code ignored;
  fs::remove(importing(target), ignored);  // of an import that was killed
  require_space(target.parent_path(), part, file.bytes);
  DownloadRequest request;
  request.url = url_of(file, options.mirror);
  request.target = target;
  request.expected_bytes = file.exact_size ? file.bytes : 0;
  request.attempts = options.attempts;
  request.first_pause = options.first_pause;
  if (request.url.rfind("https://huggingface.co/", 0) == 0) request.bearer_token = options.huggingface_token;
  const uintmax_t there = fs::file_size(part, ignored);
  const uint64_t start = ignored ? 0 : uint64_t(there);
  if (start > 0) log_info("{}: going on after {}", file.name, format_bytes(start));
  std::unique_ptr<Progress> bar;
  request.progress = [&](uint64_t done, uint64_t total) {
    if (!bar) {
      const uint64_t all = (total > 0 ? total : file.bytes) / kProgressUnit;
      bar = std::make_unique<Progress>(options.progress, "download " + file.name + " (MB)", std::max<uint64_t>(all, 1),
                                       start / kProgressUnit);
    }
    if (bar->due()) bar->update(done / kProgressUnit, format_bytes(done));
  };
  const uint64_t bytes = download_to_part(request);
  bar.reset();

  ModelStore::Record record;
  record.sha256 = sha256_of_file(part);
  std::string problem;
  if (!digest_agrees(file, record.sha256)) {
    problem = fmt::format("its SHA-256 is {}, the published one begins {}", record.sha256, file.sha256);
  } else {
    problem = identity_problem(part, file).message;
  }
  if (!problem.empty()) {
    fs::remove(part, ignored);
    fs::remove(part.string() + ".etag", ignored);
    wrong_file(target, "", request.url + " is not the published file: " + problem,
               "try again later, or another source with --from URL; what was downloaded has been "
               "removed");
  }
  stop_if_requested();
  const StopDeferral together;  // the file and its record
  fs::rename(part, target);
  fs::remove(part.string() + ".etag", ignored);
  record.path = fs::absolute(target).string();
  record.source = request.url;
  record.bytes = bytes;
  record.modified = modification_seconds(target);
  record.licence = model.licence.id;
  store.write_record(model, file, record);
  log_info("{}: {}, sha256 {}{}", target.string(), format_bytes(bytes), record.sha256,
           file.sha256.empty() ? " (recorded; the publisher gives none)" : " (as published)");
}

/// A file that is being copied: it takes its place, or is removed.
class ImportedFile {
 public:
  explicit ImportedFile(const fs::path& target) : target_(target), temporary_(importing(target)) {
    note_temporary_path(temporary_);  // gigabytes, which take longer to copy than a signal waits
  }
  ~ImportedFile() {
    std::error_code ignored;
    if (!placed_) fs::remove(temporary_, ignored);
    forget_temporary_path(temporary_);
  }
  ImportedFile(const ImportedFile&) = delete;
  ImportedFile& operator=(const ImportedFile&) = delete;

  void fill(const fs::path& source) const {
    std::error_code error;
    fs::remove(temporary_, error);
    fs::create_hard_link(source, temporary_, error);
    if (!error) return;
    require_space(target_.parent_path(), temporary_, fs::file_size(source));
    fs::copy_file(source, temporary_, fs::copy_options::overwrite_existing);
  }
  void place() {
    const auto lock = hold_temporary_paths();
    fs::rename(temporary_, target_);
    placed_ = true;
  }

 private:
  fs::path target_, temporary_;
  bool placed_ = false;
};

}  // namespace

void download_model(const ModelStore& store, const PublishedModel& model, const ModelDownloadOptions& options) {
  std::vector<const ModelFile*> missing;
  for (const ModelFile& file : model.files) {
    if (!store.find(model, file)) missing.push_back(&file);
  }
  if (missing.empty()) return;
  if (store.options().offline) {
    throw Error({ErrorKind::kWeights,
                 "the weights of \"" + model.name + "\" are not here and the network is forbidden",
                 {},
                 "",
                 how_to_get(store, model)});
  }
  const FolderLock lock(store.options().folder / model.name);
  for (const ModelFile* file : missing) download_file(store, model, *file, options);
}

fs::path import_model_file(const ModelStore& store, const PublishedModel& model, const fs::path& source) {
  if (!fs::is_regular_file(source)) throw_bad_input(source, "", "there is no such file", "check the path");
  const ModelFile* found = nullptr;
  std::string problems, remedy;
  for (const ModelFile& file : model.files) {
    const IdentityProblem problem = identity_problem(source, file);
    if (problem.message.empty()) {
      found = &file;
      break;
    }
    if (problems.find(problem.message) == std::string::npos)
      problems += (problems.empty() ? "" : "; ") + problem.message;
    remedy = problem.remedy;
  }
  if (!found) wrong_file(source, "", "these are not the weights of \"" + model.name + "\": " + problems, remedy);
  ModelStore::Record record;
  record.sha256 = sha256_of_file(source);
  if (!digest_agrees(*found, record.sha256)) {
    wrong_file(source, "sha256", fmt::format("it is {}, the published one begins {}", record.sha256, found->sha256),
               "the file is damaged or another one: download it again");
  }
  const fs::path target = store.own_path(model, *found);
  const FolderLock lock(target.parent_path());
  std::error_code error;
  ImportedFile copy(target);
  const bool elsewhere = !fs::equivalent(source, target, error);
  if (elsewhere) copy.fill(source);
  stop_if_requested();
  const StopDeferral together;  // the file and its record
  if (elsewhere) copy.place();
  record.path = fs::absolute(target).string();
  record.source = fs::absolute(source).string();
  record.bytes = fs::file_size(target);
  record.modified = modification_seconds(target);
  store.write_record(model, *found, record);
  return target;
}

std::vector<ModelFileState> verify_model(const ModelStore& store, const PublishedModel& model) {
  std::vector<ModelFileState> states;
  for (const ModelFile& file : model.files) {
    ModelFileState state;
    state.model = &model;
    state.file = &file;
    const auto located = store.find(model, file);
    if (!located) {
      state.problem = "missing";
      states.push_back(state);
      continue;
    }
    state.path = located->path;
    state.sha256 = sha256_of_file(located->path);
    const auto record = store.record(model, file);
    std::string expected = file.sha256;
    state.compared_with = "published";
    if (expected.empty() && record && record->path == fs::absolute(located->path).string()) {
      expected = record->sha256;
      state.compared_with = "recorded";
    } else if (expected.empty() && located->place == ModelPlace::kHuggingFace) {
      expected = store.digest(model, file, *located);
      state.compared_with = "Hugging Face";
    } else if (expected.empty()) {
      state.compared_with = "nothing";
      store.digest(model, file, *located);  // recorded from now on
    }
    if (state.sha256.compare(0, expected.size(), expected) != 0) {
      state.problem = "its SHA-256 is " + state.sha256 + ", expected " + expected;
    } else {
      state.problem = identity_problem(located->path, file).message;
    }
    state.good = state.problem.empty();
    states.push_back(state);
  }
  return states;
}

}  // namespace aligngs
