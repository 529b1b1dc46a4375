#include "priors/http_download.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "core/error.h"
#include "core/log.h"
#include "io/atomic_file.h"
#include "priors/testing/loopback_server.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string random_looking(size_t bytes) {
  std::string text(bytes, '\0');
  uint32_t state = 1;
  for (char& c : text) c = char((state = state * 1664525u + 1013904223u) >> 24);
  return text;
}

/// While one lives, no file of this process can grow, much as on a full disk.
class NoFileGrows {
 public:
  NoFileGrows() : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit none{0, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &none);
  }
  ~NoFileGrows() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

class HttpDownload : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_download()) GTEST_SKIP() << "built without libcurl";
    folder = fs::path(testing::TempDir()) /
             ("http_download_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    set_log_level(LogLevel::kSilent);
  }
  void TearDown() override { set_log_level(LogLevel::kInfo); }

  DownloadRequest request(const LoopbackServer& server) const {
    DownloadRequest r;
    r.url = server.url() + "/weights.bin";
    r.target = folder / "model" / "weights.bin";
    r.first_pause = 0.001;
    return r;
  }
  std::string part() const { return read_file(part_of(folder / "model" / "weights.bin")); }
  static ErrorKind kind_of(const DownloadRequest& r, std::string* text = nullptr) {
    try {
      download_to_part(r);
    } catch (const Error& error) {
      if (text) *text = error.what();
      return error.kind();
    }
    return ErrorKind{};
  }

  fs::path folder;
  const std::string body = random_looking(300'000);
};

TEST_F(HttpDownload, FetchesAFile) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  EXPECT_EQ(download_to_part(request(server)), body.size());
  EXPECT_EQ(part(), body);
}

TEST_F(HttpDownload, ReportsProgressWithTheTotal) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  DownloadRequest r = request(server);
  uint64_t last = 0, all = 0;
  r.progress = [&](uint64_t done, uint64_t total) {
    EXPECT_GE(done, last);
    last = done;
    all = total;
  };
  download_to_part(r);
  EXPECT_EQ(last, body.size());
  EXPECT_EQ(all, body.size());
}

TEST_F(HttpDownload, GoesOnWhereTheConnectionBroke) {
  LoopbackServer server([&](const std::string&, int before) {
    LoopbackAnswer answer{body};
    if (before < 3) answer.cut_after = 70'000;
    return answer;
  });
  download_to_part(request(server));
  EXPECT_EQ(part(), body);
  ASSERT_EQ(server.requests().size(), 4u);
  EXPECT_THAT(server.requests()[3], HasSubstr("Range: bytes=210000-"));
}

TEST_F(HttpDownload, GoesOnInAnotherProcess) {
  fs::create_directories(folder / "model");
  std::ofstream(folder / "model" / "weights.bin.part", std::ios::binary) << body.substr(0, 1000);
  std::ofstream(folder / "model" / "weights.bin.part.etag") << "\"1\"";
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  download_to_part(request(server));
  EXPECT_EQ(part(), body);
  EXPECT_THAT(server.requests()[0], HasSubstr("If-Range: \"1\""));
}

TEST_F(HttpDownload, ACompletePartIsNotFetchedAgain) {
  fs::create_directories(folder / "model");
  std::ofstream(folder / "model" / "weights.bin.part", std::ios::binary) << body;
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  EXPECT_EQ(download_to_part(request(server)), body.size());
  EXPECT_EQ(server.requests().size(), 1u);
}

TEST_F(HttpDownload, BeginsAgainWhenTheFileOnTheServerChanged) {
  const std::string newer = random_looking(200'000) + "new";
  LoopbackServer server([&](const std::string&, int before) {
    if (before == 0) return LoopbackAnswer{body, "\"1\"", 200, true, 50'000};
    return LoopbackAnswer{newer, "\"2\""};
  });
  download_to_part(request(server));
  EXPECT_EQ(part(), newer);
}

TEST_F(HttpDownload, BeginsAgainWhenTheServerKnowsNoRanges) {
  LoopbackServer server([&](const std::string&, int before) {
    return LoopbackAnswer{body, "\"1\"", 200, false, before == 0 ? size_t(50'000) : SIZE_MAX};
  });
  download_to_part(request(server));
  EXPECT_EQ(part(), body);
}

TEST_F(HttpDownload, APartLongerThanTheFileIsThrownAway) {
  fs::create_directories(folder / "model");
  std::ofstream(folder / "model" / "weights.bin.part", std::ios::binary) << body << "more";
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  download_to_part(request(server));
  EXPECT_EQ(part(), body);
}

TEST_F(HttpDownload, AServerThatAlwaysBreaksOffIsGivenUp) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body, "\"1\"", 200, false, 50'000}; });
  DownloadRequest r = request(server);
  r.attempts = 3;
  std::string text;
  EXPECT_EQ(kind_of(r, &text), ErrorKind::kFailed);
  EXPECT_THAT(text, HasSubstr("after 50000 of 300000 bytes"));
  EXPECT_THAT(text, HasSubstr("run the same command again"));
}

TEST_F(HttpDownload, AMissingFileIsNotAskedForTwice) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"", "\"1\"", 404}; });
  std::string text;
  EXPECT_EQ(kind_of(request(server), &text), ErrorKind::kFailed);
  EXPECT_THAT(text, HasSubstr("404"));
  EXPECT_EQ(server.requests().size(), 1u);
}

TEST_F(HttpDownload, AGatedFileSaysWhatToDo) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{"", "\"1\"", 401}; });
  std::string text;
  EXPECT_EQ(kind_of(request(server), &text), ErrorKind::kFailed);
  EXPECT_THAT(text, HasSubstr("HF_TOKEN"));
}

TEST_F(HttpDownload, ABusyServerIsAskedAgain) {
  LoopbackServer server([&](const std::string&, int before) {
    return LoopbackAnswer{body, "\"1\"", before < 2 ? 503 : 200};
  });
  download_to_part(request(server));
  EXPECT_EQ(part(), body);
}

TEST_F(HttpDownload, AFileOfAnotherSizeThanThePublishedOneIsRefused) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  DownloadRequest r = request(server);
  r.expected_bytes = body.size() + 1;
  EXPECT_EQ(kind_of(r), ErrorKind::kFailed);
}

TEST_F(HttpDownload, AFileOfAnotherSizeDoesNotStandInTheWayOfTheRightOne) {
  LoopbackServer wrong([&](const std::string&, int) { return LoopbackAnswer{body + "more"}; });
  DownloadRequest r = request(wrong);
  r.expected_bytes = body.size();
  kind_of(r);
  EXPECT_TRUE(fs::is_empty(folder / "model"));
  LoopbackServer right([&](const std::string&, int) { return LoopbackAnswer{body}; });
  r.url = right.url() + "/weights.bin";
  EXPECT_EQ(download_to_part(r), body.size());
}

TEST_F(HttpDownload, ADiskThatIsFullAtTheFirstByteLeavesNothing) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  const DownloadRequest r = request(server);
  const NoFileGrows limit;
  EXPECT_EQ(kind_of(r), ErrorKind::kResources);
  EXPECT_TRUE(fs::is_empty(folder / "model"));
}

TEST_F(HttpDownload, AFolderThatCannotBeMadeIsAResourceError) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  fs::create_directories(folder);
  std::ofstream(folder / "model") << "a file stands where the folder should be";
  std::string text;
  EXPECT_EQ(kind_of(request(server), &text), ErrorKind::kResources);
  EXPECT_THAT(text, HasSubstr("ALIGNGS_MODELS"));
}

TEST_F(HttpDownload, AFullDiskIsAResourceError) {
  LoopbackServer server([&](const std::string&, int) { return LoopbackAnswer{body}; });
  fs::create_directories(folder / "model");
  // Every write to this device fails with "no space left".
  fs::create_symlink("/dev/full", folder / "model" / "weights.bin.part");
  EXPECT_EQ(kind_of(request(server)), ErrorKind::kResources);
}

TEST_F(HttpDownload, NothingListensThere) {
  DownloadRequest r;
  r.url = "http://127.0.0.1:1/weights.bin";
  r.target = folder / "weights.bin";
  r.attempts = 2;
  r.first_pause = 0.001;
  EXPECT_EQ(kind_of(r), ErrorKind::kFailed);
}

}  // namespace
}  // namespace aligngs
