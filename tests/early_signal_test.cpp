// A signal at any moment of the start: while the system loads the program, and while options are set up or read.
#include <gmock/gmock.h>

#include <cmath>

#include "support/started_process.h"
#include "support/stop_fixture.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::kPatienceWithAStop;
using testing_support::kStatusOfAStop;
using testing_support::StartedProcess;
using testing_support::StopFixture;
using Words = std::vector<std::string>;

class EarlySignal : public StopFixture {
 protected:
  /// The command would take minutes. A signal comes after each of `kMoments` delays, whatever the program does then.
  /// Every moment has the same rule, so that a slow machine changes nothing.
  void expect_rule(const Words& command, int signal) {
    constexpr int kMoments = 26;
    constexpr double kFirst = 300,
                     kGrowth = 1.3;  // microseconds, up to a fifth of a second: loading takes 10 to 100 ms
    for (int moment = 0; moment < kMoments; ++moment) {
      StartedProcess process(command, root_ / "scratch");
      std::this_thread::sleep_for(std::chrono::microseconds(int(kFirst * std::pow(kGrowth, moment))));
      process.send(signal);
      const int status = process.wait(kPatienceWithAStop);
      // Before the program listens the system ends it, which shells report as 128 and the signal's number.
      ASSERT_THAT(status, AnyOf(128 + signal, kStatusOfAStop)) << moment << process.err();
      EXPECT_THAT(process.err(), status == kStatusOfAStop ? HasSubstr("was heard")
                                                          : testing::Matcher<std::string>(Not(HasSubstr("error"))));
      expect_no_output();
    }
  }
  void expect_no_output() const {
    EXPECT_TRUE(fs::is_empty(root_ / "work")) << fs::directory_iterator(root_ / "work")->path();
  }
};

TEST_F(EarlySignal, EndsACommandThatWritesAFolder) {
  const Words command = {"synth", path("work/out"), "--size", "1280x960", "--views", "200", "--test-views", "20"};
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) expect_rule(command, signal);
}

/// The program's own handlers take over once they are there: the system's status is for the first milliseconds alone.
TEST_F(EarlySignal, IsAnsweredAsSoonAsTheProgramListens) {
  StartedProcess process({"synth", path("work/out"), "--size", "1280x960", "--views", "200", "--test-views", "20"},
                         root_ / "scratch");
  while (!process.catches(SIGTERM)) std::this_thread::yield();
  process.send(SIGTERM);
  EXPECT_EQ(process.wait(kPatienceWithAStop), kStatusOfAStop) << process.err();
  EXPECT_THAT(process.err(), HasSubstr("SIGTERM was heard"));
  expect_no_output();
}

}  // namespace
}  // namespace aligngs
