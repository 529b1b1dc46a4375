// Damaged files of every format: whatever happens to a file, a parser either reads it or throws
// Error.
#include <gtest/gtest.h>

#include <functional>

#include "core/error.h"
#include "io/colmap_text.h"
#include "io/testing/valid_files.h"
#include "io/toml_file.h"

namespace aligngs {
namespace {

struct Format {
  std::string name;
  std::function<std::string()> valid;
  std::function<void(const std::string&)> parse;
  bool truncation_is_noticed = true;  ///< false for text whose beginning is a valid file too
};

void PrintTo(const Format& format, std::ostream* out) { *out << format.name; }

std::filesystem::path malformed_folder() { return std::filesystem::path(testing::TempDir()) / "malformed_test"; }

const valid_files::ColmapFiles& model() {
  static const valid_files::ColmapFiles files = valid_files::colmap(malformed_folder());
  return files;
}

std::vector<Format> formats() {
  namespace valid = valid_files;
  const std::string none(8, '\0');  // a COLMAP file of no entries
  return {
      {"npy", [] { return valid::npy(malformed_folder()); }, [](const std::string& b) { decode_npy(b, "x"); }},
      {"torch", [] { return valid::torch(malformed_folder()); },
       [](const std::string& b) { decode_torch_tensor(b, "x"); }},
      {"safetensors", [] { return valid::safetensors(malformed_folder()); },
       [](const std::string& b) { decode_safetensors(b, "x"); }},
      {"binary_ply", [] { return valid::binary_ply(malformed_folder()); },
       [](const std::string& b) { decode_ply(b, "x"); }},
      {"ascii_ply", [] { return valid::ascii_ply(); }, [](const std::string& b) { decode_ply(b, "x"); }, false},
      {"png", [] { return valid::text_of(encode_png(valid::picture(4))); },
       [](const std::string& b) { decode_image(b, "x"); }},
      {"gray_png", [] { return valid::gray_png16(malformed_folder()); },
       [](const std::string& b) { decode_gray_png(b, "x"); }},
      {"jpeg", [] { return valid::jpeg_with_exif(); }, [](const std::string& b) { decode_image(b, "x"); }},
      {"webp", [] { return valid::webp(); }, [](const std::string& b) { decode_image(b, "x"); }},
      {"heic", [] { return valid::heic(); }, [](const std::string& b) { decode_image(b, "x"); }},
      {"colmap_cameras", [] { return model().cameras; },
       [=](const std::string& b) { decode_colmap_binary(b, none, "", "x"); }},
      {"colmap_images", [] { return model().images; },
       [](const std::string& b) { decode_colmap_binary(model().cameras, b, "", "x"); }},
      // An empty points file counts as absent.
      {"colmap_points", [] { return model().points; },
       [=](const std::string& b) { decode_colmap_binary(none, none, b, "x"); }, false},
      {"colmap_text_cameras", [] { return valid::colmap_text().cameras; },
       [](const std::string& b) { parse_colmap_cameras_text(b, "x"); }, false},
      {"colmap_text_images", [] { return valid::colmap_text().images; },
       [](const std::string& b) { parse_colmap_images_text(b, "x"); }, false},
      {"colmap_text_points", [] { return valid::colmap_text().points; },
       [](const std::string& b) { parse_colmap_points_text(b, "x"); }, false},
      {"toml", [] { return valid::toml(); }, [](const std::string& b) { parse_toml(b, "x"); }, false},
  };
}

/// Whether the bytes were accepted; anything but Error fails the test.
bool accepts(const Format& format, const std::string& bytes, const std::string& what) {
  try {
    format.parse(bytes);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << what << ": " << error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << " throws " << error.what();
  }
  return false;
}

class Malformed : public testing::TestWithParam<Format> {};

TEST_P(Malformed, TheWholeFileIsAccepted) { EXPECT_TRUE(accepts(GetParam(), GetParam().valid(), "the whole file")); }

TEST_P(Malformed, TruncationAtEveryByteIsAnError) {
  const std::string valid = GetParam().valid();
  for (size_t keep = 0; keep < valid.size(); ++keep) {
    const std::string what = "truncation to " + std::to_string(keep) + " bytes";
    const bool accepted = accepts(GetParam(), valid.substr(0, keep), what);
    EXPECT_FALSE(accepted && GetParam().truncation_is_noticed) << what;
  }
}

TEST_P(Malformed, ChangingAnyByteIsAnErrorOrHarmless) {
  const std::string valid = GetParam().valid();
  for (size_t at = 0; at < valid.size(); ++at) {
    for (const int flip : {0x01, 0x20, 0x80, 0xff}) {
      std::string bytes = valid;
      bytes[at] = char(bytes[at] ^ flip);
      accepts(GetParam(), bytes, "byte " + std::to_string(at) + " ^ " + std::to_string(flip));
    }
  }
}

TEST_P(Malformed, RemovingAnyByteIsAnErrorOrHarmless) {
  const std::string valid = GetParam().valid();
  for (size_t at = 0; at < valid.size(); ++at) {
    std::string bytes = valid;
    accepts(GetParam(), bytes.erase(at, 1), "without byte " + std::to_string(at));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, Malformed, testing::ValuesIn(formats()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace aligngs
