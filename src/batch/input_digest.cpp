#include "batch/input_digest.h"

#include <algorithm>
#include <fstream>

#include "core/stop_signal.h"
#include "scene/sha256.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

/// Regular files of a room's inputs: of its source folder, then those that words of its options name. Sorted.
std::vector<fs::path> input_files(const Batch& batch, const RoomEntry& room) {
  std::vector<fs::path> files;
  std::error_code error;
  const fs::path source = batch.source_of(room);
  if (!room.synthetic() && fs::is_directory(source, error)) {
    for (fs::recursive_directory_iterator entry(source, fs::directory_options::skip_permission_denied, error), end;
         entry != end; entry.increment(error)) {
      std::error_code unknown;
      if (entry->is_regular_file(unknown)) files.push_back(entry->path());
    }
  }
  for (const std::string& word : room.options) {
    const fs::path file =
        batch.base() / word.substr(word.find('=') == std::string::npos || word[0] != '-' ? 0 : word.find('=') + 1);
    if (fs::is_regular_file(file, error)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// A length before each text, so that no two lists of texts give the same bytes.
void add(Sha256& sum, const std::string& text) {
  sum.update(std::to_string(text.size()) + ":");
  sum.update(text);
}

void add_head(Sha256& sum, const RoomEntry& room, size_t files) {
  add(sum, room.source);
  for (const std::string& word : room.options) add(sum, word);
  add(sum, std::to_string(files) + " files");
}

std::string name_in(const Batch& batch, const fs::path& file) { return file.lexically_relative(batch.base()).string(); }

void add_content(Sha256& sum, const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return add(sum, "unreadable");  // the run will name it
  std::string buffer(size_t(1) << 20, '\0');
  std::error_code error;
  add(sum, std::to_string(fs::file_size(file, error)));
  while (in.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || in.gcount() > 0) {
    sum.update(buffer.data(), static_cast<size_t>(in.gcount()));
  }
}

std::string quick_digest(const Batch& batch, const RoomEntry& room, const std::vector<fs::path>& files) {
  Sha256 sum;
  add_head(sum, room, files.size());
  for (const fs::path& file : files) {
    std::error_code error;
    add(sum, name_in(batch, file));
    add(sum, std::to_string(fs::file_size(file, error)));
    add(sum, std::to_string(fs::last_write_time(file, error).time_since_epoch().count()));
  }
  return sum.finish();
}

std::string content_digest(const Batch& batch, const RoomEntry& room, const std::vector<fs::path>& files) {
  Sha256 sum;
  add_head(sum, room, files.size());
  for (const fs::path& file : files) {
    add(sum, name_in(batch, file));
    add_content(sum, file);
    stop_if_requested();
  }
  return sum.finish();
}

}  // namespace

InputDigest digest_inputs(const Batch& batch, const RoomEntry& room) {
  const std::vector<fs::path> files = input_files(batch, room);
  return {content_digest(batch, room, files), quick_digest(batch, room, files)};
}

InputDigest digest_inputs(const Batch& batch, const RoomEntry& room, const InputDigest& known) {
  const std::vector<fs::path> files = input_files(batch, room);
  InputDigest now;
  now.quick = quick_digest(batch, room, files);
  now.content = now.quick == known.quick ? known.content : content_digest(batch, room, files);
  return now;
}

}  // namespace aligngs
