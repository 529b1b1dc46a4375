// The rows of all formats of `aligngs export`, compared with the lists of the manual and of the README.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/atomic_file.h"
#include "serve/export_file.h"

namespace aligngs {
namespace {

std::string source_text(const std::string& file) { return read_file(std::string(ALIGNGS_SOURCE_DIR) + "/" + file); }

TEST(ExportRows, TheManualHasTheRowsInTheirOrder) {
  std::string table = "| `-f` | content |\n|---|---|\n";
  for (const RunExportFormat& format : run_export_rows())
    table += std::string("| `") + format.name + "` | " + format.help + " |\n";
  EXPECT_NE(source_text("docs/editing.md").find(table + "\n"), std::string::npos) << "docs/editing.md should have:\n"
                                                                                  << table;
}

TEST(ExportRows, TheReadmeNamesEveryFormatOfARoom) {
  std::string line = "- Exports to ";
  std::set<std::string> titles;
  for (const ExportFormat& format : export_format_rows()) {
    if (titles.insert(format.title).second) line += std::string(format.title) + ", ";
  }
  line += "and one HTML page without a server.";
  EXPECT_NE(source_text("README.md").find("\n" + line + "\n"), std::string::npos) << "README.md should have:\n" << line;
}

TEST(ExportRows, EveryRowIsOfOneKind) {
  for (const RunExportFormat& format : run_export_rows()) {
    EXPECT_EQ(format.room != nullptr, format.kind == ExportKind::kRoom) << format.name;
    EXPECT_EQ(format.plan != nullptr, format.kind == ExportKind::kPlan) << format.name;
    EXPECT_EQ(&run_export_row(format.name), &format);
  }
  EXPECT_THROW(run_export_row("fbx"), Error);
}

TEST(ExportRows, ARunWithoutARoomOrLabelsLacksTheirFormats) {
  const auto lacks = [](const std::vector<std::string>& formats, const std::string& name) {
    return std::find(formats.begin(), formats.end(), name) == formats.end();
  };
  const std::vector<std::string> plain = formats_of_run(testing::TempDir() + "no_such_run", false);
  EXPECT_TRUE(lacks(plain, "plan.svg") && lacks(plain, "labels.ply"));
  EXPECT_FALSE(lacks(plain, "ply") || lacks(plain, "html"));
  EXPECT_FALSE(lacks(formats_of_run(testing::TempDir() + "no_such_run", true), "labels.ply"));
}

}  // namespace
}  // namespace aligngs
