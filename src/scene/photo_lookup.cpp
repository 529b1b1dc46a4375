#include "scene/photo_lookup.h"

#include <algorithm>
#include <set>

#include "core/error.h"
#include "core/letter_case.h"
#include "io/file_system_error.h"
#include "io/text_encoding.h"
#include "io/unicode_letters.h"
#include "scene/photo_mask.h"
#include "scene/photo_places.h"
#include "scene/view_names.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_readable(const fs::path& folder) {
  try {
    require_readable_folder(folder, {});
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Whether the extension is that of a picture, also of kinds that are not read.
bool is_named_like_picture(const fs::path& file) {
  static const std::set<std::string> kKnown = {".jpg",  ".jpeg", ".png", ".tif",  ".tiff", ".heic", ".heif",
                                               ".webp", ".bmp",  ".ppm", ".avif", ".gif",  ".exr",  ".dng",
                                               ".cr2",  ".nef",  ".arw", ".jp2",  ".jpe",  ".jfif"};
  return kKnown.count(lower_case(file.extension().string())) > 0;
}

/// A name without such an extension; other dots belong to the name.
std::string stem_of(const fs::path& file) {
  return is_named_like_picture(file) ? file.stem().string() : file.filename().string();
}

std::string listed(const std::vector<fs::path>& files) {
  std::string text;
  for (size_t i = 0; i < files.size() && i < 3; ++i) text += (i ? ", " : "") + as_utf8(files[i].string());
  return text + (files.size() > 3 ? ", ..." : "");
}

constexpr const char* kSeveral = "several photos could be meant: ";

PhotoLookup::Answer answer_of(std::vector<fs::path> found) {
  std::sort(found.begin(), found.end());
  if (found.size() == 1) return {found.front(), ""};
  if (found.empty()) return {};
  return {{}, kSeveral + listed(found)};
}

/// The name in both encodings, as written first.
std::vector<std::string> spellings(const std::string& name) {
  std::vector<std::string> all = {name};
  for (const std::string& other : {is_utf8(name) ? latin1_of_utf8(name) : utf8_of_latin1(name)}) {
    if (!other.empty() && other != name) all.push_back(other);
  }
  return all;
}

}  // namespace

bool is_hidden(const fs::path& file) { return file.filename().string().rfind('.', 0) == 0; }

std::string slashed_name(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  while (name.rfind("./", 0) == 0) name.erase(0, 2);
  return name;
}

std::string view_name_of(const std::string& image_name) {
  const fs::path path(slashed_name(image_name));
  return as_utf8((path.parent_path() / path.stem()).generic_string());
}

PhotoLookup::PhotoLookup(fs::path photos, fs::path beside, std::vector<fs::path> subfolders)
    : photos_(std::move(photos)) {
  if (!photos_.empty()) places_.push_back({photos_});
  if (!beside.empty()) places_.push_back({std::move(beside)});
  if (!subfolders.empty()) places_.push_back(std::move(subfolders));
}

PhotoLookup::Answer PhotoLookup::find(const std::string& given) const {
  const std::string name = slashed_name(given);
  if (name.empty()) return {{}, "the name of the photo is empty"};
  const auto decided = [](const Answer& answer) { return !answer.file.empty() || !answer.problem.empty(); };
  for (const auto rule : {&PhotoLookup::exact, &PhotoLookup::by_other_extension}) {
    for (const std::string& spelling : spellings(name)) {
      for (const Folders& place : places_) {
        Answer answer = (this->*rule)(place, spelling);
        if (decided(answer)) return answer;
      }
    }
  }
  for (const Folders& place : places_) {
    Answer answer = by_other_spelling(place, name);
    if (decided(answer)) return answer;
  }
  for (const bool any_spelling : {false, true}) {
    Answer answer = by_ending(name, any_spelling);
    if (decided(answer)) return answer;
  }
  const std::string decoded = percent_decoded(name);  // after all rules for the name as it is written
  if (!decoded.empty()) return find(decoded);
  require_readable_places(name);
  const std::string unread = of_unread_kind(name);
  return {{}, unread.empty() ? kMissing : unread + " is of a kind that is not read: convert it to PNG or JPEG"};
}

void PhotoLookup::require_readable_places(const std::string& name) const {
  candidates();
  if (!barred_.empty()) require_readable_folder(barred_, {});
  if (leads_elsewhere(name)) return;  // folders of another machine tell nothing
  for (const Folders& folders : places_) {
    for (const fs::path& folder : folders) {
      const fs::path around = (folder / name).parent_path();
      std::error_code error;
      const bool there = fs::is_directory(around, error);
      if (error == std::errc::permission_denied) throw error_of(fs::filesystem_error("list", around, error));
      if (there) require_readable_folder(around, {});
    }
  }
}

std::string PhotoLookup::of_unread_kind(const std::string& name) const {
  for (const Folders& folders : places_) {
    for (const fs::path& folder : folders) {
      const fs::path wanted = folder / name;
      const std::string stem = stem_of(wanted);
      for (const Entry& entry : entries(wanted.parent_path())) {
        const fs::path& file = entry.path;
        if (is_named_like_picture(file) && !has_picture_extension(file) && file.stem().string() == stem)
          return as_utf8(file.filename().string());
      }
    }
  }
  return {};
}

bool PhotoLookup::is_ambiguous(const Answer& answer) { return answer.problem.rfind(kSeveral, 0) == 0; }

PhotoLookup::Answer PhotoLookup::exact(const Folders& folders, const std::string& name) const {
  std::vector<fs::path> found;
  for (const fs::path& folder : folders) {
    if (is_file(folder / name)) found.push_back(folder / name);
  }
  return answer_of(std::move(found));
}

PhotoLookup::Answer PhotoLookup::by_other_extension(const Folders& folders, const std::string& name) const {
  std::vector<fs::path> same, others;  // of the same extension in another case, of others
  for (const fs::path& folder : folders) {
    const fs::path wanted = folder / name;
    const std::string stem = stem_of(wanted), extension = lower_case(wanted.extension().string());
    for (const Entry& entry : entries(wanted.parent_path())) {
      const fs::path& file = entry.path;
      if (!has_picture_extension(file) || file.stem().string() != stem || !is_file(file)) continue;
      (lower_case(file.extension().string()) == extension ? same : others).push_back(file);
    }
  }
  return answer_of(same.empty() ? others : same);
}

PhotoLookup::Answer PhotoLookup::by_other_spelling(const Folders& folders, const std::string& name) const {
  std::vector<std::string> wanted;
  for (const fs::path& part : fs::path(name).lexically_normal()) wanted.push_back(common_spelling(part.string()));
  if (wanted.empty() || fs::path(name).is_absolute()) return {};
  wanted.back() = common_spelling(stem_of(fs::path(name).filename()));
  Folders level = folders;  // all folders that the parts of the name so far may mean
  for (size_t i = 0; i < wanted.size(); ++i) {
    const bool last = i + 1 == wanted.size();
    Folders next;
    for (const fs::path& folder : level) {
      for (const Entry& entry : entries(folder)) {
        if ((last ? entry.stem : entry.name) != wanted[i]) continue;
        if (last ? has_picture_extension(entry.path) && is_file(entry.path) : fs::is_directory(entry.path))
          next.push_back(entry.path);
      }
    }
    level = std::move(next);
  }
  return answer_of(std::move(level));
}

const std::vector<PhotoLookup::Entry>& PhotoLookup::entries(const fs::path& folder) const {
  const auto [found, fresh] = entries_.try_emplace(folder);
  if (!fresh) return found->second;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    if (is_hidden(path)) continue;
    found->second.push_back({path, common_spelling(path.filename().string()), common_spelling(path.stem().string())});
  }
  return found->second;
}

PhotoLookup::Answer PhotoLookup::by_ending(const std::string& name, bool any_spelling) const {
  std::vector<std::string> wanted;
  for (const fs::path& part : fs::path(as_utf8(name)).relative_path()) wanted.push_back(part.string());
  if (wanted.empty()) return {};
  wanted.back() = stem_of(wanted.back());
  if (any_spelling) std::transform(wanted.begin(), wanted.end(), wanted.begin(), common_spelling);
  std::vector<fs::path> found;
  size_t longest = 0;
  for (const Candidate& candidate : candidates()) {
    const std::vector<std::string>& parts = any_spelling ? candidate.spellings : candidate.parts;
    const size_t common = std::min(wanted.size(), parts.size());
    if (common < longest ||
        !std::equal(wanted.rbegin(), wanted.rbegin() + static_cast<ptrdiff_t>(common), parts.rbegin()))
      continue;
    if (common > longest) found.clear();
    longest = common;
    found.push_back(candidate.file);
  }
  return answer_of(found);
}

const std::vector<PhotoLookup::Candidate>& PhotoLookup::candidates() const {
  if (listed_ || photos_.empty()) return candidates_;
  listed_ = true;
  std::error_code error;
  if (fs::is_directory(photos_, error) && !is_readable(photos_)) barred_ = photos_;
  error.clear();
  fs::recursive_directory_iterator entry(photos_, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    if (is_hidden(file) || (file.filename() == kMaskFolder && entry->is_directory(error))) {
      if (entry->is_directory(error)) entry.disable_recursion_pending();
      continue;
    }
    std::error_code unknown;  // of a link to itself, which is no reason to stop
    if (barred_.empty() && entry->is_directory(unknown) && !is_readable(file)) barred_ = file;
    if (!has_picture_extension(file) || !is_file(file)) continue;
    Candidate candidate{file, {}, {}};
    for (const fs::path& part : file.lexically_relative(photos_)) candidate.parts.push_back(as_utf8(part.string()));
    candidate.parts.back() = as_utf8(file.stem().string());
    for (const std::string& part : candidate.parts) candidate.spellings.push_back(common_spelling(part));
    candidates_.push_back(std::move(candidate));
  }
  return candidates_;
}

PhotoLookup photos_of_data_set(const fs::path& folder) {
  const fs::path images = images_folder(folder);
  if (!images.empty()) return PhotoLookup(images, folder);
  std::vector<fs::path> subfolders;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_directory(error) && !is_hidden(entry->path()) && entry->path().filename() != kMaskFolder &&
        !fits_other_cameras(entry->path()))
      subfolders.push_back(entry->path());
  }
  return PhotoLookup({}, folder, std::move(subfolders));
}

}  // namespace aligngs
