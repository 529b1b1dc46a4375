// SOG version 2: facts from PlayCanvas' public format description. A zip of lossless WebP images, one pixel a Gaussian,
// and meta.json with the codebooks.
#include <webp/encode.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/version.h"
#include "edit/export/codebook.h"
#include "edit/export/scene_export.h"
#include "io/atomic_file.h"
#include "io/json_text.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kPaletteEntries = 1024;  ///< of the higher harmonics; more cost time and little is gained in a room
constexpr int kPaletteRounds = 6;
constexpr size_t kPaletteColumns = 64;  ///< entries per row of the centroid image
constexpr int kLargestWebp = 16383;     ///< pixels per side, a limit of WebP

/// An RGBA image with one pixel per Gaussian.
struct PixelSheet {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;
  PixelSheet(size_t w, size_t h) : width(static_cast<int>(w)), height(static_cast<int>(h)), rgba(4 * w * h, 255) {}
  uint8_t* at(size_t i) { return &rgba[4 * i]; }
};

PixelSheet sheet_for(size_t count) {
  const size_t width = (static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(count)))) + 3) / 4 * 4;
  return {std::max<size_t>(4, width),
          std::max<size_t>(4, ((count + width - 1) / std::max<size_t>(1, width) + 3) / 4 * 4)};
}

std::string encode(const PixelSheet& sheet, const std::filesystem::path& path) {
  if (sheet.width > kLargestWebp || sheet.height > kLargestWebp) {
    throw Error({ErrorKind::kFailed, "too many Gaussians for the images of SOG", path, {}, "export as PLY"});
  }
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigInit(&config) || !WebPPictureInit(&picture))
    throw Error({ErrorKind::kFailed, "libwebp does not start", path, {}, {}});
  config.lossless = 1;
  config.exact = 1;  // colours under transparent pixels are data here
  config.method = 3;
  picture.use_argb = 1;
  picture.width = sheet.width;
  picture.height = sheet.height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool good =
      WebPPictureImportRGBA(&picture, sheet.rgba.data(), 4 * sheet.width) && WebPEncode(&config, &picture);
  std::string bytes(good ? reinterpret_cast<const char*>(writer.mem) : "", good ? writer.size : 0);
  WebPPictureFree(&picture);
  WebPMemoryWriterClear(&writer);
  if (!good) throw_resources(path, "an image could not be compressed", "free memory, or export as PLY");
  return bytes;
}

using Files = std::vector<std::pair<std::string, std::string>>;

/// 16 bits per axis of sign(x) ln(1 + |x|), low and high bytes in two images.
Json add_means(const GaussianModel& model, const std::filesystem::path& path, Files& files) {
  const auto compressed = [](float x) { return std::copysign(std::log1p(std::fabs(x)), x); };
  float low[3], high[3];
  for (size_t a = 0; a < 3; ++a) low[a] = high[a] = compressed(model.positions[a]);
  for (size_t i = 0; i < model.positions.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], compressed(model.positions[i]));
    high[i % 3] = std::max(high[i % 3], compressed(model.positions[i]));
  }
  PixelSheet lower = sheet_for(model.size()), upper = lower;
  for (size_t i = 0; i < model.size(); ++i) {
    for (size_t a = 0; a < 3; ++a) {
      const float range = high[a] - low[a];
      const float t = range > 0 ? (compressed(model.positions[3 * i + a]) - low[a]) / range : 0;
      const long q = std::clamp(std::lround(t * 65535), 0L, 65535L);
      lower.at(i)[a] = static_cast<uint8_t>(q & 255);
      upper.at(i)[a] = static_cast<uint8_t>(q >> 8);
    }
  }
  files.emplace_back("means_l.webp", encode(lower, path));
  files.emplace_back("means_u.webp", encode(upper, path));
  return {{"mins", {low[0], low[1], low[2]}},
          {"maxs", {high[0], high[1], high[2]}},
          {"files", {"means_l.webp", "means_u.webp"}}};
}

Json add_scales(const GaussianModel& model, const std::filesystem::path& path, Files& files) {
  const std::vector<float> codebook = scalar_codebook(model.log_scales);
  PixelSheet sheet = sheet_for(model.size());
  for (size_t i = 0; i < model.log_scales.size(); ++i)
    sheet.at(i / 3)[i % 3] = nearest_level(codebook, model.log_scales[i]);
  files.emplace_back("scales.webp", encode(sheet, path));
  return {{"codebook", codebook}, {"files", {"scales.webp"}}};
}

/// Smallest three of (w, x, y, z); alpha is 252 plus the one left out.
Json add_rotations(const GaussianModel& model, const std::filesystem::path& path, Files& files) {
  PixelSheet sheet = sheet_for(model.size());
  for (size_t i = 0; i < model.size(); ++i) {
    const float* r = &model.rotations[4 * i];
    const Quaternionf q = normalized(Quaternionf{r[0], r[1], r[2], r[3]});
    const float v[4] = {q.w, q.x, q.y, q.z};
    size_t largest = 0;
    for (size_t k = 1; k < 4; ++k) {
      if (std::fabs(v[k]) > std::fabs(v[largest])) largest = k;
    }
    const float sign = v[largest] < 0 ? -1.f : 1.f;
    size_t slot = 0;
    for (size_t k = 0; k < 4; ++k) {
      if (k == largest) continue;
      sheet.at(i)[slot++] =
          static_cast<uint8_t>(std::clamp(std::lround((sign * v[k] * 1.41421356f * 0.5f + 0.5f) * 255), 0L, 255L));
    }
    sheet.at(i)[3] = static_cast<uint8_t>(252 + largest);
  }
  files.emplace_back("quats.webp", encode(sheet, path));
  return {{"files", {"quats.webp"}}};
}

Json add_colors(const GaussianModel& model, const std::filesystem::path& path, Files& files) {
  std::vector<float> dc;
  for (size_t i = 0; i < model.size(); ++i)
    dc.insert(dc.end(), &model.sh[3 * kShCoefficients * i], &model.sh[3 * kShCoefficients * i] + 3);
  const std::vector<float> codebook = scalar_codebook(dc);
  PixelSheet sheet = sheet_for(model.size());
  for (size_t i = 0; i < dc.size(); ++i) sheet.at(i / 3)[i % 3] = nearest_level(codebook, dc[i]);
  for (size_t i = 0; i < model.size(); ++i)
    sheet.at(i)[3] = static_cast<uint8_t>(std::lround(255 * opacity_of(model, i)));
  files.emplace_back("sh0.webp", encode(sheet, path));
  return {{"codebook", codebook}, {"files", {"sh0.webp"}}};
}

/// Higher harmonics: each Gaussian names an entry of a palette; the palette's values have a codebook.
Json add_harmonics(const GaussianModel& model, const std::filesystem::path& path, ThreadPool& pool, Files& files) {
  const size_t coefficients = static_cast<size_t>(sh_coefficient_count(model.sh_degree)) - 1, width = 3 * coefficients;
  std::vector<float> rows;
  for (size_t i = 0; i < model.size(); ++i) {
    const float* sh = &model.sh[3 * (kShCoefficients * i + 1)];
    rows.insert(rows.end(), sh, sh + width);
  }
  const Palette palette = make_palette(rows, width, kPaletteEntries, kPaletteRounds, pool);
  const std::vector<float> codebook = scalar_codebook(palette.entries);
  PixelSheet centroids(kPaletteColumns * coefficients, (palette.count() + kPaletteColumns - 1) / kPaletteColumns);
  for (size_t k = 0; k < palette.count(); ++k) {
    for (size_t j = 0; j < coefficients; ++j) {
      uint8_t* pixel = centroids.at(k * coefficients + j);
      for (size_t c = 0; c < 3; ++c) pixel[c] = nearest_level(codebook, palette.entries[k * width + 3 * j + c]);
    }
  }
  PixelSheet labels = sheet_for(model.size());
  for (size_t i = 0; i < model.size(); ++i) {
    labels.at(i)[0] = static_cast<uint8_t>(palette.index[i] & 255);
    labels.at(i)[1] = static_cast<uint8_t>(palette.index[i] >> 8);
    labels.at(i)[2] = 0;
  }
  files.emplace_back("shN_centroids.webp", encode(centroids, path));
  files.emplace_back("shN_labels.webp", encode(labels, path));
  return {{"count", palette.count()},
          {"bands", model.sh_degree},
          {"codebook", codebook},
          {"files", {"shN_centroids.webp", "shN_labels.webp"}}};
}

}  // namespace

ExportReport write_sog(const std::filesystem::path& path, const GaussianModel& model, ThreadPool& pool) {
  if (model.size() == 0)
    throw Error({ErrorKind::kUsage, "there is no Gaussian to write", path, {}, "undo the edit that removed all"});
  Files files;
  Json meta = {{"version", 2},
               {"asset", {{"generator", std::string("aligngs ") + version()}}},
               {"count", model.size()},
               {"antialias", false}};
  meta["means"] = add_means(model, path, files);
  meta["scales"] = add_scales(model, path, files);
  meta["quats"] = add_rotations(model, path, files);
  meta["sh0"] = add_colors(model, path, files);
  if (model.sh_degree > 0) meta["shN"] = add_harmonics(model, path, pool, files);
  const std::string text = json_line(meta);
  std::vector<std::pair<std::string, std::string_view>> entries = {{"meta.json", text}};
  for (const auto& [name, bytes] : files) entries.emplace_back(name, bytes);
  write_file_atomically(path, make_stored_zip(entries));
  return {.files = {path}, .gaussians = model.size()};
}

}  // namespace aligngs
