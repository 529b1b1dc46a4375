#include "priors/photo_folder.h"

#include <algorithm>
#include <map>

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/exif_focal_length.h"
#include "io/file_system_error.h"
#include "io/image_file.h"
#include "io/jpeg_codec.h"
#include "io/png_codec.h"
#include "io/resample.h"
#include "io/text_encoding.h"
#include "scene/import/capture_text.h"
#include "scene/not_a_scene.h"
#include "scene/photo_lookup.h"
#include "scene/photo_mask.h"

namespace aligngs {

namespace fs = std::filesystem;

namespace {

/// Pictures that are not read.
const std::vector<std::string> kUnread = {".tif", ".tiff", ".dng", ".cr2", ".cr3",
                                          ".nef", ".arw",  ".jxl", ".bmp", ".gif"};

fs::path folder_with_photos(const fs::path& folder) {
  if (!list_files(folder, picture_extensions()).empty()) return folder;
  const fs::path inner = folder / "images";
  return fs::is_directory(inner) ? inner : folder;
}

/// The pictures of a folder, else those of its subfolders. `barred` gets the subfolders that may not be read.
std::vector<fs::path> pictures_of(const fs::path& folder, std::vector<LeftOut>& barred) {
  std::vector<fs::path> files = list_files(folder, picture_extensions());
  if (!files.empty()) return files;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && entry != end; entry.increment(error)) {
    if (is_hidden(entry->path()) || (entry->path().filename() == kMaskFolder && entry->is_directory(error))) {
      if (entry->is_directory(error)) entry.disable_recursion_pending();
    } else if (entry->is_regular_file(error) && has_picture_extension(entry->path())) {
      files.push_back(entry->path());
    } else if (std::error_code unknown; entry->is_directory(unknown) && !entry->is_symlink(unknown)) {
      const std::string name = entry->path().lexically_relative(folder).generic_string();
      use_or_leave_out(name, barred, [&] { require_readable_folder(entry->path(), {}); });
    }
  }
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.string(), b.string()); });
  return files;
}

Image<uint8_t> shrunk(const Image<uint8_t>& image, int max_side) {
  const double scale = double(max_side) / std::max(image.width, image.height);
  const auto side = [&](int pixels) { return std::max(1, int(pixels * scale + 0.5)); };
  return to_bytes(resize_area(image, side(image.width), side(image.height)));
}

Photo prepare(const Photo& photo, const fs::path& folder, int max_side) {
  Photo out = photo;
  const std::string bytes = read_file(photo.file);
  const bool common = is_common_picture(bytes, photo.file);
  const bool large = std::max(photo.width, photo.height) > max_side;
  Image<uint8_t> image = decode_image(bytes, photo.file);  // also of what is copied: damage shows here alone
  if (!large && common && read_image_info(photo.file).orientation == 1) {
    out.file = folder / (photo.name + (is_jpeg(bytes) ? ".jpg" : ".png"));
    write_file_atomically(out.file, bytes);
    return out;
  }
  if (large) image = shrunk(image, max_side);
  out.width = image.width;
  out.height = image.height;
  constexpr int kQuality = 95;  // artefacts stay below the noise of a camera
  if (is_png(bytes) || image.channels == 4) {
    out.file = folder / (photo.name + ".png");
    write_png(out.file, image);
    return out;
  }
  out.file = folder / (photo.name + ".jpg");
  const std::vector<uint8_t> small = encode_jpeg_bytes(image, kQuality);
  // Relative to the sides, the focal length of the shrunk picture is that of the stored one.
  const auto focal = exif_focal_35mm(exif_of_picture(bytes, photo.file), std::max(photo.width, photo.height));
  write_file_atomically(
      out.file, focal ? with_exif(small, exif_with_focal_35mm(*focal)) : std::string(small.begin(), small.end()));
  return out;
}

/// The place where find_mask() and COLMAP look for the mask of a prepared photo.
fs::path mask_place(const Photo& prepared, const fs::path& folder) {
  return folder.parent_path() / kMaskFolder / (prepared.file.lexically_relative(folder).string() + ".png");
}

void prepare_mask(const fs::path& mask, const Photo& photo, const Photo& prepared, const fs::path& folder) {
  write_png(mask_place(prepared, folder), mask.empty()
                                              ? Image<uint8_t>(prepared.width, prepared.height, 1, 255)
                                              : read_mask(mask, photo.file, true, prepared.width, prepared.height));
}

}  // namespace

bool has_photos(const fs::path& folder) {
  std::vector<LeftOut> barred;
  return fs::is_directory(folder) && !pictures_of(folder_with_photos(folder), barred).empty();
}

namespace {

PhotoList listed_photos(const fs::path& given, bool with_hidden) {
  require_readable_folder(given, "give the folder that holds the photos");
  PhotoList list;
  list.folder = folder_with_photos(given);
  require_readable_folder(list.folder, "give the folder that holds the photos");
  std::string unread;
  for (const fs::path& file : list_files(list.folder, kUnread)) unread += " " + as_utf8(file.filename().string());
  std::error_code error;
  for (fs::directory_iterator entry(list.folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!is_hidden(entry->path()) || !has_picture_extension(entry->path())) continue;
    list.left_out.push_back({as_utf8(entry->path().filename().string()), "a hidden file is no photo", "remove it"});
  }
  const size_t hidden = list.left_out.size();
  const std::vector<fs::path> files = pictures_of(list.folder, list.left_out);
  const bool barred = list.left_out.size() > hidden;
  std::map<std::string, fs::path> names;
  for (const fs::path& file : files) {
    const std::string name = view_name_of(file.lexically_relative(list.folder).generic_string());
    use_or_leave_out(file.filename().string(), list.left_out, [&] {
      const ImageInfo info = read_image_info(file);
      require_whole_picture(file);
      const auto [other, fresh] = names.emplace(name, file);
      if (!fresh) {
        throw_bad_input(file, "name", "another photo has the same name: " + other->second.filename().string(),
                        "rename or remove one of them");
      }
      list.photos.push_back({name, file, info.width, info.height});
    });
  }
  constexpr size_t kFewest = 2;  // one photo has no parallax
  if (list.photos.size() + (with_hidden ? hidden : 0) >= kFewest) {
    list.unread = unread;
    return list;
  }
  refuse_run_folder(given, given);
  if (!files.empty() || barred)
    require_enough(list.folder, list.photos.size(), list.left_out, kFewest, false, "photos");
  throw_bad_input(
      list.folder, "",
      list.photos.empty() ? "there is no photo here (JPEG, PNG, WebP or HEIC)" : "one photo is not enough",
      unread.empty() ? "give the folder that holds the photos of the room" : "convert these to JPEG first:" + unread);
}

}  // namespace

PhotoList list_photos(const fs::path& folder) { return listed_photos(folder, false); }

PhotoList list_named_photos(const fs::path& folder) { return listed_photos(folder, true); }

std::vector<Photo> prepare_photos(const std::vector<Photo>& photos, const fs::path& folder, int max_side,
                                  ThreadPool& pool, std::vector<LeftOut>& left_out) {
  make_folders(folder);
  std::vector<Photo> prepared(photos.size());
  std::vector<fs::path> masks;
  for (const Photo& photo : photos) masks.push_back(find_mask(photo.file));
  const bool any_mask = std::any_of(masks.begin(), masks.end(), [](const fs::path& mask) { return !mask.empty(); });
  std::vector<std::vector<LeftOut>> faults(photos.size());
  pool.parallel_for(photos.size(), 1, [&](size_t i, size_t, int) {
    const bool good = use_or_leave_out(photos[i].name, faults[i], [&] {
      prepared[i] = prepare(photos[i], folder, max_side);
      if (any_mask) prepare_mask(masks[i], photos[i], prepared[i], folder);
    });
    std::error_code ignored;
    if (!good) fs::remove(prepared[i].file, ignored);  // whoever finds cameras reads the folder
  });
  std::vector<Photo> good;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (faults[i].empty()) good.push_back(std::move(prepared[i]));
    left_out.insert(left_out.end(), faults[i].begin(), faults[i].end());
  }
  return good;
}

}  // namespace aligngs
