// Downloads over real sockets: parts, tags, compression, and clients that are slow, silent or many.
#include <chrono>
#include <vector>

#include "io/gzip.h"
#include "serve/testing/view_server.h"

namespace aligngs {
namespace {

using namespace std::chrono_literals;
using test_http::ask;
using test_http::body;
using test_http::Client;
using test_http::header;
using test_http::status;

class Download : public testing_support::ViewServerTest {
 protected:
  void configure(ViewServerOptions& options) override {
    options.limits.silence = 500ms;
    options.limits.request = 2s;
    options.limits.connections = 4;
  }
};

TEST_F(Download, IsResumedWhereItStopped) {
  write("run/scene.ply", "0123456789");
  const std::string whole = ask_for("/files/scene.ply");
  const std::string tag = header(whole, "ETag");
  EXPECT_EQ(header(whole, "Accept-Ranges"), "bytes");
  const std::string rest = ask_for("/files/scene.ply", "Range: bytes=4-\r\nIf-Range: " + tag + "\r\n");
  EXPECT_EQ(status(rest), 206);
  EXPECT_EQ(body(rest), "456789");
  EXPECT_EQ(header(rest, "Content-Range"), "bytes 4-9/10");
  EXPECT_EQ(status(ask_for("/files/scene.ply", "Range: bytes=10-\r\n")), 416);
}

TEST_F(Download, OfAFileThatWasReplacedBeginsAnew) {
  write("run/scene.ply", "0123456789");
  const std::string tag = header(ask_for("/files/scene.ply"), "ETag");
  std::filesystem::remove(base_ / "run" / "scene.ply");
  write("run/scene.ply", "another file");
  const std::string rest = ask_for("/files/scene.ply", "Range: bytes=4-\r\nIf-Range: " + tag + "\r\n");
  EXPECT_EQ(status(rest), 200);
  EXPECT_EQ(body(rest), "another file");
}

TEST_F(Download, OfWhatTheBrowserHasSendsNothing) {
  const std::string tag = header(ask_for("/files/scene.ply"), "ETag");
  const std::string again = ask_for("/files/scene.ply", "If-None-Match: " + tag + "\r\n");
  EXPECT_EQ(status(again), 304);
  EXPECT_EQ(body(again), "");
}

TEST_F(Download, HeadTellsTheLengthOfEveryRoute) {
  write("run/scene.ply", std::string(5000, 'x'));
  for (const char* target : {"/files/scene.ply", "/api/photo/view_000", "/api/state", "/api/double", "/app.js"}) {
    const std::string got = ask_for(target), head = ask(server_->port(), "HEAD", target, "");
    EXPECT_EQ(status(head), 200) << target;
    EXPECT_EQ(header(head, "Content-Length"), std::to_string(body(got).size())) << target;
    EXPECT_EQ(body(head), "") << target;
  }
  EXPECT_EQ(status(ask(server_->port(), "HEAD", "/api/events", "")), 200) << "and does not wait for events";
}

TEST_F(Download, TextIsCompressedForThoseWhoTakeIt) {
  const std::string text(20000, 'r');
  write("run/report.html", text);
  const std::string plain = ask_for("/files/report.html"),
                    packed = ask_for("/files/report.html", "Accept-Encoding: gzip\r\n");
  EXPECT_EQ(body(plain), text);
  EXPECT_EQ(header(packed, "Content-Encoding"), "gzip");
  EXPECT_LT(body(packed).size(), 1000u);
  EXPECT_EQ(gzip_expanded(body(packed), "report.html", 1 << 20), text);
  EXPECT_NE(header(packed, "ETag"), header(plain, "ETag"))
      << "a stream and a file are not resumed with each other's bytes";
  EXPECT_EQ(header(ask_for("/files/scene.ply", "Accept-Encoding: gzip\r\n"), "Content-Encoding"), "");
}

TEST_F(Download, MayBeSlowAsLongAsItsBytesFlow) {
  constexpr size_t kBytes = 2'000'000;
  write("run/scene.ply", std::string(kBytes, 'x'));
  const Client client(server_->port(), 16 * 1024);
  client.send("GET /files/scene.ply HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  size_t got = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (std::string piece = client.receive(100'000); !piece.empty(); piece = client.receive(100'000)) {
    got += piece.size();
    if (std::chrono::steady_clock::now() - begin < 2s) std::this_thread::sleep_for(50ms);
  }
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 1s) << "longer than the limit of silence";
  EXPECT_GT(got, kBytes) << "the head and every byte of the file";
}

TEST_F(Download, ByAClientThatTakesNothingEnds) {
  write("run/scene.ply", std::string(8'000'000, 'x'));
  const Client client(server_->port(), 16 * 1024);
  client.send("GET /files/scene.ply HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  std::this_thread::sleep_for(1500ms);
  size_t got = 0;
  for (std::string piece = client.receive(1'000'000); !piece.empty(); piece = client.receive(1'000'000))
    got += piece.size();
  EXPECT_LT(got, 8'000'000u);
}

TEST_F(Download, IdleConnectionsDoNotKeepAPageOut) {
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < 20; ++i) idle.push_back(std::make_unique<Client>(server_->port()));
  EXPECT_EQ(status(ask_for("/api/state")), 200);
  EXPECT_EQ(idle.front()->receive(1), "") << "the one that was silent longest has made room";
}

TEST_F(Download, ConnectionsAtWorkAreCapped) {
  std::vector<std::unique_ptr<Client>> listeners;
  for (int i = 0; i < 4; ++i) {
    listeners.push_back(std::make_unique<Client>(server_->port()));
    listeners.back()->send("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_NE(listeners.back()->receive(1), "");
  }
  EXPECT_EQ(status(ask_for("/api/state")), 503);
  listeners.clear();
  int last = 503;
  for (int i = 0; i < 100 && last == 503; ++i) {
    std::this_thread::sleep_for(50ms);
    last = status(ask_for("/api/state"));
  }
  EXPECT_EQ(last, 200) << "places of clients that left are free again";
}

}  // namespace
}  // namespace aligngs
