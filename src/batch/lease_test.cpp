#include "batch/lease.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <fstream>
#include <latch>
#include <thread>
#include <vector>

#include "io/atomic_file.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

class LeaseTest : public testing::Test {
 protected:
  void SetUp() override {
    leases_ = fs::path(testing::TempDir()) / "leases" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(leases_);
    fs::create_directories(leases_);
  }
  /// A lease as a machine elsewhere would have left it, so many seconds ago.
  void write_foreign(const std::string& name, double seconds_ago) const {
    write_file_atomically(leases_ / name,
                          R"({"host": "far", "pid": 1, "process_space": "another boot", "beginning": "5"})");
    age(leases_ / name, seconds_ago);
  }
  static void age(const fs::path& file, double seconds_ago) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec -= static_cast<time_t>(seconds_ago);
    const timespec times[2] = {now, now};
    ASSERT_EQ(utimensat(AT_FDCWD, file.c_str(), times, 0), 0);
  }
  std::optional<Lease> take(const std::string& room) const { return Lease::take(leases_, room, times_); }
  LeaseView look(const std::string& room) const { return look_at_lease(leases_, room, times_); }

  fs::path leases_;
  LeaseTimes times_{.renew_seconds = 0.02, .stale_seconds = 60};
};

TEST_F(LeaseTest, OneHolderAtATimeAndNoneAfterwards) {
  {
    const auto lease = take("hall");
    ASSERT_TRUE(lease);
    EXPECT_FALSE(take("hall"));
    EXPECT_TRUE(take("kitchen"));
    EXPECT_TRUE(look("hall").held());
    EXPECT_EQ(look("hall").pid, getpid());
    EXPECT_EQ(look("hall").host, host_name());
  }
  EXPECT_EQ(look("hall").number, 0);
  EXPECT_TRUE(fs::is_empty(leases_));
}

TEST_F(LeaseTest, RoomsWhoseNamesBeginAlikeStayApart) {
  const auto lease = take("hall.1");
  ASSERT_TRUE(lease);
  EXPECT_EQ(look("hall").number, 0);
  EXPECT_TRUE(take("hall"));
}

TEST_F(LeaseTest, OfManyTakersOneWins) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> winners{0};
    std::latch begin(8), tried(8);
    std::vector<std::thread> takers;
    for (int i = 0; i < 8; ++i) {
      takers.emplace_back([&] {
        begin.arrive_and_wait();
        const auto lease = take("hall");
        if (lease) ++winners;
        tried.arrive_and_wait();  // nobody gives back before all have tried
      });
    }
    for (std::thread& taker : takers) taker.join();
    ASSERT_EQ(winners, 1) << round;
  }
}

TEST_F(LeaseTest, AHolderThatDiedOnThisMachineIsStaleAtOnce) {
  const pid_t child = fork();
  if (child == 0) {
    const auto lease = take("hall");
    _exit(lease ? 0 : 1);  // no destructor: the file stays, as after kill -9
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  EXPECT_TRUE(look("hall").stale);
  EXPECT_TRUE(take("hall"));
}

TEST_F(LeaseTest, AHolderElsewhereIsStaleByAgeAlone) {
  write_foreign("hall.1", 10);
  EXPECT_FALSE(take("hall"));
  write_foreign("hall.1", 100);
  const auto lease = take("hall");
  ASSERT_TRUE(lease);
  EXPECT_EQ(look("hall").number, 2);
}

TEST_F(LeaseTest, AFileWithoutContentIsHeldByWhoIsAboutToWriteIt) {
  std::ofstream(leases_ / "hall.1").close();
  EXPECT_TRUE(look("hall").held());
  age(leases_ / "hall.1", 100);
  EXPECT_FALSE(look("hall").held());
}

TEST_F(LeaseTest, AHeldLeaseIsTouchedAgainAndAgain) {
  const auto lease = take("hall");
  ASSERT_TRUE(lease);
  const int64_t first = look("hall").touched;
  for (int i = 0; i < 500 && look("hall").touched == first; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GT(look("hall").touched, first);
}

TEST_F(LeaseTest, AHolderLearnsThatItsLeaseWasTakenOver) {
  const auto lease = take("hall");
  ASSERT_TRUE(lease);
  EXPECT_FALSE(lease->lost());
  write_foreign("hall.2", 0);
  for (int i = 0; i < 500 && !lease->lost(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(lease->lost());
}

TEST_F(LeaseTest, GivingBackALostLeaseLeavesTheNewOne) {
  {
    const auto lease = take("hall");
    ASSERT_TRUE(lease);
    write_foreign("hall.2", 0);
  }
  EXPECT_EQ(look("hall").number, 2);
  EXPECT_FALSE(fs::exists(leases_ / "hall.1"));
}

}  // namespace
}  // namespace aligngs
