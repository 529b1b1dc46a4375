// Requests that keep to the rules of HTTP in unusual ways, or break them, over real sockets (RFC 9110, RFC 9112).
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "serve/testing/view_server.h"

namespace aligngs {
namespace {

using namespace std::chrono_literals;
using test_http::ask;
using test_http::body;
using test_http::Client;
using test_http::header;
using test_http::status;

class HttpRules : public testing_support::ViewServerTest {
 protected:
  void configure(ViewServerOptions& options) override {
    options.limits.request = 1s;
    options.limits.connections = 8;  // streams of events that ended count for half a second
  }
  std::string post_head(const std::string& headers) const {
    return "POST /api/echo HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nX-AlignGS-Token: " + server_->token() +
           "\r\n" + headers;
  }
  static int answers(const std::string& text) {
    int count = 0;
    for (size_t at = text.find("HTTP/1.1 "); at != std::string::npos; at = text.find("HTTP/1.1 ", at + 1)) ++count;
    return count;
  }
};

TEST_F(HttpRules, AHeaderThatDecidesWhoMayAskComesOnce) {
  const std::string get = "GET /api/state HTTP/1.1\r\nConnection: close\r\nHost: localhost\r\n";
  EXPECT_EQ(status(raw(get + "Host: evil.example\r\n\r\n")), 400);
  EXPECT_EQ(status(raw(get + "Sec-Fetch-Site: same-origin\r\nSec-Fetch-Site: cross-site\r\n\r\n")), 400);
  const std::string type = "Content-Type: application/json\r\n", end = "Content-Length: 2\r\n\r\n{}";
  EXPECT_EQ(status(raw(post_head(type + end))), 200);
  EXPECT_EQ(status(raw(post_head(type + "Content-Type: text/plain\r\n" + end))), 400);
  EXPECT_EQ(status(raw(post_head(type + "X-AlignGS-Token: 0\r\n" + end))), 400);
  EXPECT_EQ(status(raw(post_head(type + "Origin: http://localhost\r\nOrigin: http://evil.example\r\n" + end))), 400);
}

TEST_F(HttpRules, ALengthHasOneMeaning) {
  const std::string type = "Content-Type: application/json\r\n", body = "\r\n{}";
  EXPECT_EQ(status(raw(post_head(type + "Content-Length: 2\r\nContent-Length: 3\r\n" + body))), 400);
  EXPECT_EQ(status(raw(post_head(type + "Content-Length: -1\r\n" + body))), 400);
  EXPECT_EQ(status(raw(post_head(type + "Content-Length: 99999999999999999999999\r\n" + body))), 400);
  EXPECT_EQ(status(raw(post_head(type + "Content-Length: 9223372036854775808\r\n" + body))), 413);
  const std::string chunked = type + "Transfer-Encoding: chunked\r\n", chunk = "\r\n2\r\n{}\r\n0\r\n\r\n";
  EXPECT_EQ(status(raw(post_head(chunked + chunk))), 200);
  EXPECT_EQ(status(raw(post_head(chunked + "Content-Length: 2\r\n" + chunk))), 400);
  EXPECT_EQ(status(raw(post_head(chunked + "\r\nffffffffffffffffff\r\n{}"))), 400);
  EXPECT_EQ(status(raw(post_head(chunked + "\r\n20000\r\n" + std::string(0x20000, ' ')))), 413);
}

TEST_F(HttpRules, AChunkThatIsNoneIsRefusedAtOnce) {
  const std::string head = post_head("Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n");
  for (const char* chunks : {"{}", "zz\r\n{}\r\n", "-1\r\n", "2 {}", "2\r\n{}\r\nx", "11111111111111111"}) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(status(raw(head + chunks)), 400) << chunks;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 900ms) << chunks << ": not after the limit of time";
  }
  const Client parts(server_->port());
  parts.send(head);
  for (const char* part : {"1", "\r", "\n{", "\r\n1;a=b\r\n}", "\r\n0\r\n", "\r\n"}) {
    parts.send(part);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_EQ(status(parts.receive(10000)), 200) << "chunks in pieces are whole";
}

TEST_F(HttpRules, APostNeedsItsContentTypeInAnyCase) {
  EXPECT_EQ(status(raw(post_head("Content-Length: 2\r\n\r\n{}"))), 403);
  EXPECT_EQ(status(raw(post_head("Content-Type: Application/JSON; charset=utf-8\r\nContent-Length: 2\r\n\r\n{}"))),
            200);
}

TEST_F(HttpRules, AClientThatWaitsToBeAskedIsAskedForItsBody) {
  const Client client(server_->port());
  client.send(post_head("Content-Type: application/json\r\nExpect: 100-continue\r\nContent-Length: 2\r\n\r\n"));
  EXPECT_EQ(client.receive(1000), "HTTP/1.1 100 Continue\r\n\r\n");
  client.send("{}");
  EXPECT_EQ(status(client.receive(10000)), 200);
  const Client refused(server_->port());
  refused.send(post_head("Expect: 100-continue\r\nContent-Length: 2\r\n\r\n"));
  EXPECT_EQ(status(refused.receive(10000)), 403) << "and is not asked for what is refused anyway";
}

TEST_F(HttpRules, RequestsOfOneConnectionAreAnsweredInTurn) {
  const std::string one = "GET /api/double HTTP/1.1\r\nHost: localhost\r\n", last = one + "Connection: close\r\n\r\n";
  EXPECT_EQ(answers(raw(one + "\r\n" + one + "\r\n" + last)), 3);
  EXPECT_EQ(answers(raw(one + "Content-Length: 5\r\n\r\nhello" + last)), 2) << "the body of a GET is no request";
  EXPECT_EQ(answers(raw("GET /%zz HTTP/1.1\r\nHost: localhost\r\n\r\n" + last)), 1) << "none after a refusal";
}

TEST_F(HttpRules, ATargetInAbsoluteFormIsServed) {
  const std::string rest = " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  EXPECT_EQ(body(raw("GET http://127.0.0.1:" + std::to_string(server_->port()) + "/api/double?x=1" + rest)), "twice");
  EXPECT_EQ(body(raw("GET HTTP://LocalHost/files/renders/test/rgb/view_003.png" + rest)), "picture");
  for (const char* page : {"GET http://localhost", "GET http://localhost?v=1", "HEAD http://[::1]:80/"})
    EXPECT_EQ(status(raw(page + rest)), 200) << page;
  for (const char* below : {"GET http://localhost/../secret.txt", "GET http://localhost/files/%2e%2e/secret.txt"})
    EXPECT_EQ(status(raw(below + rest)), 404) << below;
}

TEST_F(HttpRules, TheHostOfATargetInAbsoluteFormCounts) {
  const auto asked = [&](const std::string& target, const std::string& headers) {
    return status(raw("GET " + target + " HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n"));
  };
  EXPECT_EQ(asked("http://evil.example/api/state", "Host: localhost\r\n"), 403);
  EXPECT_EQ(asked("http://localhost.evil.example:80/", "Host: localhost\r\n"), 403);
  EXPECT_EQ(asked("http://localhost/api/state", "Host: evil.example\r\n"), 200) << "the header is ignored then";
  EXPECT_EQ(asked("http://localhost/api/state", ""), 400) << "but it has to be there";
  EXPECT_EQ(asked("http://localhost/api/state", "Host: localhost\r\nHost: localhost\r\n"), 400);
  EXPECT_EQ(asked("http://localhost/api/state", "Host: localhost\r\nSec-Fetch-Site: cross-site\r\n"), 403);
  const std::string post =
      "POST http://localhost:9000/api/echo HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
      "Content-Type: application/json\r\nContent-Length: 2\r\nX-AlignGS-Token: " +
      server_->token() + "\r\nOrigin: http://";
  EXPECT_EQ(status(raw(post + "localhost:9000\r\n\r\n{}")), 200);
  EXPECT_EQ(status(raw(post + "evil.example\r\n\r\n{}")), 403);
}

TEST_F(HttpRules, OtherFormsOfATargetAreRefused) {
  const std::string rest = " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  for (const char* line :
       {"GET https://localhost/api/state", "GET http:///api/state", "GET http://user@localhost/", "GET localhost/",
        "GET *", "OPTIONS *", "CONNECT localhost:80", "GET /files/scene.ply%00", "GET /files/%2"})
    EXPECT_EQ(status(raw(line + rest)), 400) << line;
  for (const char* line : {"GET //localhost/api/state", "GET /files/%252e%252e/secret.txt",
                           "GET /files/%c0%ae%c0%ae/secret.txt", "GET /files/.", "GET /api/photo/%ff"})
    EXPECT_EQ(status(raw(line + rest)), 404) << line;
  EXPECT_EQ(status(raw("GET /" + std::string(20000, 'a') + rest)), 431);
  EXPECT_EQ(status(raw("GET /api/state HTTP/2.0\r\nHost: localhost\r\n\r\n")), 400);
  EXPECT_EQ(status(raw("GET /api/state HTTP/1.1\r\nHost : localhost\r\n\r\n")), 400);
}

TEST_F(HttpRules, RangesThatAreUnusual) {
  write("run/scene.ply", "0123456789");
  const auto range = [&](const std::string& value, const std::string& more = "") {
    return ask_for("/files/scene.ply", "Range: " + value + "\r\n" + more);
  };
  EXPECT_EQ(body(range("bytes=-3")), "789");
  EXPECT_EQ(header(range("bytes=-99"), "Content-Range"), "bytes 0-9/10") << "the last 99 bytes of ten";
  EXPECT_EQ(status(range("bytes=-0")), 416);
  EXPECT_EQ(body(range("bytes=8-99")), "89");
  for (const char* whole :
       {"bytes=0-1,4-5", "bytes=5-2", "lines=0-1", "bytes=-", "bytes=a-b", "bytes=0-18446744073709551616"})
    EXPECT_EQ(body(range(whole)), "0123456789") << whole;
  EXPECT_EQ(body(range("bytes=0-1", "If-Range: \"other\"\r\n")), "0123456789");
  const std::string head = ask(server_->port(), "HEAD", "/files/scene.ply", "Range: bytes=2-4\r\n");
  EXPECT_EQ(status(head), 206);
  EXPECT_EQ(header(head, "Content-Length"), "3");
  EXPECT_EQ(body(head), "");
}

TEST_F(HttpRules, AFileThatHasChangedIsNotSentToAClientThatWantsTheOldOne) {
  const std::string tag = header(ask_for("/files/scene.ply", ""), "ETag");
  EXPECT_EQ(status(ask_for("/files/scene.ply", "If-Match: " + tag + "\r\nRange: bytes=1-\r\n")), 206);
  EXPECT_EQ(status(ask_for("/files/scene.ply", "If-Match: *\r\n")), 200);
  EXPECT_EQ(status(ask_for("/files/scene.ply", "If-Match: \"old\"\r\nRange: bytes=1-\r\n")), 412);
}

TEST_F(HttpRules, AnEventStreamGoesOnFromAnyPlace) {
  for (const char* from : {"", "Last-Event-ID: 11\r\n", "Last-Event-ID: -1\r\n",
                           "Last-Event-ID: 99999999999999999999999\r\n", "Last-Event-ID: \xff\r\n"}) {
    const std::string told =
        raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n" + std::string(from) + "\r\n", "event: state");
    EXPECT_EQ(status(told), 200) << from;
    EXPECT_NE(told.find("{\"step\":2}"), std::string::npos) << from << told;
    EXPECT_EQ(told.find("{\"step\":1}") != std::string::npos,
              from[0] == '\0' || std::string(from).find("11") == std::string::npos)
        << from;
  }
}

TEST_F(HttpRules, AHeadThatTricklesEnds) {
  const Client client(server_->port());
  client.send("GET / HTTP/1.1\r\nHost: localhost\r\n");
  const auto begin = std::chrono::steady_clock::now();
  std::atomic<bool> ended{false};
  std::thread drip([&] {
    while (!ended && std::chrono::steady_clock::now() - begin < 4s) {
      client.send("X: y\r\n");
      std::this_thread::sleep_for(100ms);
    }
  });
  EXPECT_EQ(client.receive(1), "");
  ended = true;
  drip.join();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 4s) << "each header is in time, all of them are not";
}

TEST_F(HttpRules, BodiesThatTrickleDoNotKeepAPageOut) {
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < 16; ++i) {
    slow.push_back(std::make_unique<Client>(server_->port()));
    slow.back()->send(post_head("Content-Type: application/json\r\nContent-Length: 60000\r\n\r\n{"));
  }
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(status(ask_for("/api/state", "")), 200);
}

}  // namespace
}  // namespace aligngs
