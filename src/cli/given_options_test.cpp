#include "cli/given_options.h"

#include <gmock/gmock.h>
#include <CLI/App.hpp>
#include <algorithm>

#include "core/error.h"

namespace aligngs {
namespace {

using testing::HasSubstr;

/// A program with a command and a command in that, as `models download`.
class GivenOptions : public testing::Test {
 protected:
  GivenOptions() : program_("", "program") {
    program_.fallthrough();
    program_.add_flag("--json");
    CLI::App* models = program_.add_subcommand("models", "");
    CLI::App* download = models->add_subcommand("download", "");
    download->add_option("-o,--output", output_);
    download->add_option("--error", error_)->check(CLI::Range(0.01, 10.0));
    download->add_option("--words", words_);
    download->add_flag("--force");
  }
  /// The message about what was given; empty: none.
  std::string refusal(std::vector<std::string> arguments) {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
    program_.parse(arguments);
    try {
      require_given_values(program_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return error.what();
    }
    return "";
  }
  CLI::App program_;
  std::string output_;
  std::vector<std::string> words_;
  double error_ = 0;
};

TEST_F(GivenOptions, ValuesAndFlagsPass) {
  EXPECT_EQ(refusal({"models", "download", "--output", "a", "--error", "1e-1", "--force", "--words", "nan"}), "");
}

TEST_F(GivenOptions, AnEmptyValueIsNamed) {
  EXPECT_THAT(refusal({"models", "download", "-o", ""}), HasSubstr("--output has an empty value"));
}

TEST_F(GivenOptions, ANumberThatIsNoneIsNamed) {
  EXPECT_THAT(refusal({"models", "download", "--error", "nan"}), HasSubstr("--error: \"nan\""));
}

TEST_F(GivenOptions, AnOptionThatIsNotThereHasItsNeighbour) {
  const UnknownOption found = find_unknown_option(program_, {"models", "download", "--json", "--ouptut=x"});
  EXPECT_EQ(found.name, "--ouptut");
  EXPECT_EQ(found.nearest, "--output");
  EXPECT_EQ(find_unknown_option(program_, {"models", "download", "--force", "--", "--odd"}).name, "");
  EXPECT_EQ(find_unknown_option(program_, {"models", "--force"}).name, "--force") << "an option of the command below";
}

}  // namespace
}  // namespace aligngs
