#include "priors/model_store.h"

#include <fmt/format.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/stop_signal.h"
#include "io/atomic_file.h"
#include "io/file_system_error.h"
#include "io/json_text.h"
#include "priors/model_identity.h"
#include "scene/sha256.h"

namespace aligngs {

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Empty when the variable is not set or empty.
fs::path folder_variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? fs::path(value) : fs::path();
}

bool is_set(const char* name) {
  const char* value = std::getenv(name);
  return value && *value && std::string(value) != "0";
}

fs::path cache_folder() {
  const fs::path cache = folder_variable("XDG_CACHE_HOME");
  if (!cache.empty()) return cache;
  fs::path home = folder_variable("HOME");
  if (home.empty()) {  // as a shell does where the variable is unset
    const passwd* user = getpwuid(getuid());
    home = user && user->pw_dir ? user->pw_dir : "";
  }
  static std::once_flag told;
  if (!home.is_absolute()) {
    std::call_once(told, [] {
      log_warning(
          "HOME is not set, and the system knows no home folder of this user: weights are looked for in .cache/ of the "
          "current folder; ALIGNGS_MODELS names another one");
    });
  }
  return home.is_absolute() ? home / ".cache" : fs::path(".cache");
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && fs::file_size(path, error) > 0 && !error;
}

/// "models--facebook--VGGT-1B"
std::string huggingface_folder(const std::string& repository) {
  std::string folder = "models--" + repository;
  const size_t slash = folder.find('/');
  if (slash != std::string::npos) folder.replace(slash, 1, "--");
  return folder;
}

/// Snapshots of a repository in the cache: the one that "main" points to, then the others by name.
std::vector<fs::path> snapshots(const fs::path& repository) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator at(repository / "snapshots", error), end; !error && at != end; at.increment(error)) {
    found.push_back(at->path());
  }
  std::sort(found.begin(), found.end());
  std::string main;
  std::ifstream(repository / "refs" / "main") >> main;
  std::stable_partition(found.begin(), found.end(), [&](const fs::path& p) { return p.filename() == main; });
  return found;
}

std::vector<std::string> huggingface_names(const ModelFile& file) {
  std::vector<std::string> names = {file.name};
  names.insert(names.end(), file.also.begin(), file.also.end());
  return names;
}

bool is_hex_digest(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

ModelStoreOptions ModelStoreOptions::from_environment(bool offline) {
  const auto first_of = [](fs::path a, fs::path b) { return a.empty() ? b : a; };
  const auto below = [](const fs::path& a, const char* b) { return a.empty() ? a : a / b; };
  ModelStoreOptions options;
  options.folder = first_of(folder_variable("ALIGNGS_MODELS"), cache_folder() / "aligngs" / "models");
  options.huggingface = {first_of(folder_variable("HF_HUB_CACHE"), first_of(below(folder_variable("HF_HOME"), "hub"),
                                                                            cache_folder() / "huggingface" / "hub"))};
  options.torch = {first_of(below(folder_variable("TORCH_HOME"), "hub/checkpoints"),
                            cache_folder() / "torch" / "hub" / "checkpoints")};
  options.offline = offline || is_set("ALIGNGS_OFFLINE") || is_set("HF_HUB_OFFLINE");
  return options;
}

const char* name_of(ModelPlace place) {
  switch (place) {
    case ModelPlace::kHuggingFace:
      return "Hugging Face cache";
    case ModelPlace::kTorch:
      return "torch cache";
    case ModelPlace::kOurs:
      break;
  }
  return "aligngs";
}

fs::path ModelStore::own_path(const PublishedModel& model, const ModelFile& file) const {
  return options_.folder / model.name / file.name;
}

std::optional<LocatedModelFile> ModelStore::find(const PublishedModel& model, const ModelFile& file) const {
  if (!file.huggingface.empty()) {
    for (const fs::path& cache : options_.huggingface) {
      for (const fs::path& snapshot : snapshots(cache / huggingface_folder(file.huggingface))) {
        for (const std::string& name : huggingface_names(file)) {
          if (is_file(snapshot / name)) return LocatedModelFile{snapshot / name, ModelPlace::kHuggingFace};
        }
      }
    }
  }
  const fs::path own = own_path(model, file);
  if (is_file(own)) return LocatedModelFile{own, ModelPlace::kOurs};
  // Names on Hugging Face ("model.pt") say nothing outside of their repository.
  if (file.url.find("huggingface.co") == std::string::npos) {
    for (const fs::path& cache : options_.torch) {
      if (is_file(cache / file.name)) return LocatedModelFile{cache / file.name, ModelPlace::kTorch};
    }
  }
  return std::nullopt;
}

std::vector<fs::path> ModelStore::places(const PublishedModel& model, const ModelFile& file) const {
  std::vector<fs::path> paths;
  if (!file.huggingface.empty()) {
    for (const fs::path& cache : options_.huggingface) {
      const fs::path snapshot = cache / huggingface_folder(file.huggingface) / "snapshots" / "*";
      for (const std::string& name : huggingface_names(file)) paths.push_back(snapshot / name);
    }
  }
  paths.push_back(own_path(model, file));
  if (file.url.find("huggingface.co") == std::string::npos) {
    for (const fs::path& cache : options_.torch) paths.push_back(cache / file.name);
  }
  return paths;
}

bool ModelStore::installed(const PublishedModel& model) const {
  for (const PublishedModel* part : with_needs(model)) {
    for (const ModelFile& file : part->files) {
      if (!find(*part, file)) return false;
    }
  }
  return true;
}

std::vector<fs::path> ModelStore::require(const PublishedModel& model) const {
  if (!installed(model)) {
    throw Error({ErrorKind::kWeights,
                 "the weights of \"" + model.name + "\" are not on this machine",
                 {},
                 "",
                 how_to_get(*this, model)});
  }
  std::vector<fs::path> paths;
  for (const ModelFile& file : model.files) {
    paths.push_back(find(model, file)->path);
    const std::string other = other_model_in(paths.back(), file);
    if (other.empty()) continue;
    const ModelLicence& licence = published_model(other).licence;
    throw Error({ErrorKind::kWeights, "this file holds \"" + other + "\", not \"" + model.name + "\"", paths.back(),
                 file.probe,
                 "remove it here, and use it under its own name and licence (" + licence.id +
                     "): aligngs models import " + other + " FILE"});
  }
  return paths;
}

std::string how_to_get(const ModelStore& store, const PublishedModel& model) {
  uint64_t bytes = 0;
  std::string looked, licences;
  for (const PublishedModel* part : with_needs(model)) {
    for (const ModelFile& file : part->files) {
      if (store.find(*part, file)) continue;
      bytes += file.bytes;
      for (const fs::path& path : store.places(*part, file)) looked += "\n    " + path.string();
      const std::string licence = part->licence.id + (part->licence.note.empty() ? "" : ", " + part->licence.note);
      if (licences.find(licence) == std::string::npos) licences += (licences.empty() ? "" : "; ") + licence;
    }
  }
  return fmt::format(
      "aligngs models download {}   ({}, licence {}){}\n"
      "  or put a file you have in place: aligngs models import {} FILE\n"
      "  looked for it at:{}",
      model.name, format_bytes(bytes), licences,
      store.options().offline ? "; you are offline (--offline, ALIGNGS_OFFLINE or HF_HUB_OFFLINE)" : "", model.name,
      looked);
}

std::string sha256_of_file(const fs::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw_bad_input(path, "", cannot_open(errno), "check the path and its permissions");
  Sha256 sha;
  std::vector<char> buffer(size_t(1) << 20);
  while (file.read(buffer.data(), std::streamsize(buffer.size())), file.gcount() > 0) {
    sha.update(buffer.data(), size_t(file.gcount()));
    stop_if_requested();
  }
  if (file.bad()) throw_bad_input(path, "", "reading failed", "check the disk");
  return sha.finish();
}

int64_t modification_seconds(const fs::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? int64_t(status.st_mtime) : 0;
}

std::string ModelStore::digest(const PublishedModel& model, const ModelFile& file,
                               const LocatedModelFile& located) const {
  std::error_code error;
  if (located.place == ModelPlace::kHuggingFace) {
    const std::string blob = fs::read_symlink(located.path, error).filename().string();
    if (!error && is_hex_digest(blob)) return blob;
  }
  const uint64_t bytes = fs::file_size(located.path, error);
  const std::optional<Record> known = record(model, file);
  if (known && known->path == fs::absolute(located.path).string() && known->bytes == bytes &&
      known->modified == modification_seconds(located.path) && is_hex_digest(known->sha256)) {
    return known->sha256;
  }
  log_info("{}: computing the digest ({})", located.path.string(), format_bytes(bytes));
  Record fresh;
  fresh.path = fs::absolute(located.path).string();
  fresh.sha256 = sha256_of_file(located.path);
  fresh.source = name_of(located.place);
  fresh.bytes = bytes;
  fresh.modified = modification_seconds(located.path);
  try {
    write_record(model, file, fresh);
  } catch (const Error& failure) {
    // Only the next start pays for it: the digest is computed again.
    log_debug("the digest was not recorded: {}", failure.what());
  }
  return fresh.sha256;
}

std::optional<ModelStore::Record> ModelStore::record(const PublishedModel& model, const ModelFile& file) const {
  const fs::path path = own_path(model, file).string() + ".json";
  if (!is_file(path)) return std::nullopt;
  const Json json = parse_json(read_file(path, uint64_t(1) << 16));
  if (!json.is_object()) return std::nullopt;
  const auto text = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  const auto number = [&](const char* key) {
    return json.contains(key) && json[key].is_number_unsigned() ? json[key].get<uint64_t>() : 0;
  };
  Record out;
  out.path = text("path");
  out.sha256 = text("sha256");
  out.source = text("source");
  out.licence = text("licence_accepted");
  out.bytes = number("bytes");
  out.modified = int64_t(number("modified"));
  return out;
}

void ModelStore::write_record(const PublishedModel& model, const ModelFile& file, const Record& record) const {
  const Json json = {{"path", record.path},   {"sha256", record.sha256},     {"source", record.source},
                     {"bytes", record.bytes}, {"modified", record.modified}, {"licence_accepted", record.licence}};
  write_file_atomically(own_path(model, file).string() + ".json", json_document(json));
}

}  // namespace aligngs
