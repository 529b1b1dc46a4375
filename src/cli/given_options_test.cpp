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
    download->add_option("--folder", folder_)->group("Output folder");
    download->add_option("--count", count_);
    download->add_option("--steps", steps_);
    download->add_flag("--force");
  }
  /// The message about what was given; empty: none.
  std::string refusal(std::vector<std::string> arguments) {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
    try {
      program_.parse(arguments);
      require_given_values(program_);
    } catch (const CLI::ConversionError& error) {  // newer versions of CLI11 refuse some of them
      return error.what();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kUsage);
      return error.what();
    }
    return "";
  }
  CLI::App program_;
  std::string output_, folder_;
  uint64_t count_ = 0;
  int64_t steps_ = 0;
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

TEST_F(GivenOptions, ABeginningNamesItsOption) {
  EXPECT_EQ(find_unknown_option(program_, {"models", "download", "--outp"}).nearest, "--output");
  EXPECT_EQ(find_unknown_option(program_, {"models", "download", "--forc=1"}).nearest, "--force");
}

TEST_F(GivenOptions, AnOptionThatIsNotThereHasItsNeighbour) {
  const UnknownOption found = find_unknown_option(program_, {"models", "download", "--json", "--ouptut=x"});
  EXPECT_EQ(found.name, "--ouptut");
  EXPECT_EQ(found.nearest, "--output");
  EXPECT_EQ(find_unknown_option(program_, {"models", "download", "--force", "--", "--odd"}).name, "");
  EXPECT_EQ(find_unknown_option(program_, {"models", "--force"}).name, "--force") << "an option of the command below";
}

TEST_F(GivenOptions, AnOptionIsNoValue) {
  EXPECT_THAT(refusal({"models", "download", "-o", "--force"}),
              HasSubstr("--output needs a value: \"--force\" is an option"));
}

TEST_F(GivenOptions, AnUnknownOptionIsNoValueEither) {
  EXPECT_THAT(refusal({"models", "download", "--output=--odd"}), HasSubstr("--output needs a value"));
}

TEST_F(GivenOptions, AShortOptionIsNoValue) {
  EXPECT_THAT(refusal({"models", "download", "--words", "-o"}), HasSubstr("--words needs a value"));
}

TEST_F(GivenOptions, AFolderIsNotStandardOutput) {
  EXPECT_THAT(refusal({"models", "download", "--folder", "-"}), HasSubstr("\"-\" is no name of a folder"));
}

TEST_F(GivenOptions, AWholeNumberBelowZeroDoesNotWrapAround) {
  EXPECT_THAT(refusal({"models", "download", "--count", "-1"}), HasSubstr("--count: \"-1\" is no whole number"));
}

TEST_F(GivenOptions, AWholeNumberThatIsTooLargeDoesNotBecomeTheLargest) {
  EXPECT_THAT(refusal({"models", "download", "--steps", "99999999999999999999"}), HasSubstr("--steps: "));
}

TEST_F(GivenOptions, ANegativeWholeNumberPasses) { EXPECT_EQ(refusal({"models", "download", "--steps", "-3"}), ""); }

}  // namespace
}  // namespace aligngs
