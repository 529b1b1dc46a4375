// The rows of the export formats, and what is made from them.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/error.h"
#include "edit/export/scene_export.h"
#include "io/atomic_file.h"
#include "io/output_place.h"

namespace aligngs {
namespace {

TEST(ExportFormats, EveryOneHoldsSomethingUnderANameOfItsOwn) {
  std::set<std::string> names;
  for (const ExportFormat& format : export_format_rows()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    EXPECT_TRUE(format.splats || format.mesh) << format.name;
  }
}

TEST(ExportFormats, TexturesAndPartsAreOfFormatsThatHaveThem) {
  for (const ExportFormat& format : export_format_rows()) {
    EXPECT_TRUE(format.texture == ExportTexture::kNone || format.mesh) << format.name;
    EXPECT_TRUE(format.beside.empty() || format.texture != ExportTexture::kNone) << format.name;
    EXPECT_TRUE(!format.one_part || (format.splats && format.mesh)) << format.name;
    EXPECT_TRUE(!format.needs_labels || format.splats) << format.name;
  }
}

TEST(ExportFormats, AFileNameOfOneIsNotTakenByAnother) {
  for (const ExportFormat& format : export_format_rows()) {
    const std::string file = std::string("room.") + format.name;
    EXPECT_NO_THROW(require_extension(file, format.name)) << file;
    EXPECT_THROW(require_extension(file, "pdf"), Error) << file << ": its ending is missing in io/output_place.cpp";
  }
}

}  // namespace
}  // namespace aligngs
