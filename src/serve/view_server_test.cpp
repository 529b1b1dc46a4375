// The server as a browser sees it, and as an attacker does. Plain sockets, so that every byte is ours.
#include "serve/view_server.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"
#include "serve/testing/view_server.h"
#include "train/run_control.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using test_http::body;
using test_http::status;
using testing_support::ViewServerTest;

TEST_F(ViewServerTest, SendsThePageWithItsTokenAndAPolicy) {
  const std::string answer = get("/");
  EXPECT_EQ(status(answer), 200);
  EXPECT_NE(answer.find("aligngs_9000=" + server_->token() + "; SameSite=Strict"), std::string::npos);
  EXPECT_NE(answer.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_NE(answer.find("frame-ancestors 'none'"), std::string::npos);
  EXPECT_NE(answer.find("X-Content-Type-Options: nosniff"), std::string::npos);
  EXPECT_EQ(answer.find("Access-Control-"), std::string::npos);
}

TEST_F(ViewServerTest, EveryAnswerCarriesAPolicy) {
  const std::string json = "Content-Type: application/json\r\n",
                    token = "X-AlignGS-Token: " + server_->token() + "\r\n";
  const std::pair<int, std::string> answers[] = {
      {200, get("/")},
      {200, get("/app.js")},
      {200, get("/api/state")},
      {200, get("/files/scene.ply")},
      {200, get("/api/photo/view_000")},
      {200, get("/api/double")},
      {404, get("/absent")},
      {404, get("/files/absent")},
      {400, get("/%zz")},
      {403, get("/", "evil.example")},
      {405, raw("DELETE / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")},
      {403, post("/api/echo", json, "{}")},
      {200, post("/api/echo", json + token, "{}")},
      {400, post("/api/fail", json + token, "{}")},
      {500, post("/api/throw", json + token, "{}")},
      {200, raw("HEAD / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")},
      {200, raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state")}};
  for (const auto& [expected, answer] : answers) {
    EXPECT_EQ(status(answer), expected) << answer.substr(0, 200);
    EXPECT_NE(answer.find("Content-Security-Policy: default-src "), std::string::npos) << answer.substr(0, 200);
    EXPECT_NE(answer.find("X-Content-Type-Options: nosniff"), std::string::npos) << answer.substr(0, 200);
  }
}

TEST_F(ViewServerTest, NothingInARunFolderMayRun) {
  write("run/report.html", "<script src=evil.js></script>");
  const std::string answer = get("/files/report.html");
  EXPECT_NE(answer.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_EQ(answer.find("script-src"), std::string::npos);
}

TEST_F(ViewServerTest, CookiesOfTwoServersDoNotMeet) {
  EXPECT_NE(get("/", "localhost:9000").find("aligngs_9000="), std::string::npos);
  EXPECT_NE(get("/", "127.0.0.1:7861").find("aligngs_7861="), std::string::npos);
  EXPECT_NE(get("/", "[::1]").find("aligngs_80="), std::string::npos);
  EXPECT_EQ(get("/", "localhost:1; Domain=x").find("Domain=x"), std::string::npos)
      << "nothing else of the header goes into the cookie";
}

TEST_F(ViewServerTest, HandlersOfGetHaveTheRestOfThePath) {
  EXPECT_EQ(body(get("/api/double")), "twice");
  EXPECT_EQ(body(get("/api/below/a%20b/c.png?x=1")), "a b/c.png");
  EXPECT_EQ(status(get("/api/below/absent")), 404);
  EXPECT_EQ(status(get("/api/doubles")), 404);
  EXPECT_EQ(status(get("/api/echo")), 404) << "what changes something is no GET";
}

TEST_F(ViewServerTest, ASlowHandlerDoesNotStopTheOthersAndTheirNumberIsLimited) {
  const std::string headers = "Content-Type: application/json\r\nX-AlignGS-Token: " + server_->token() + "\r\n";
  std::vector<std::thread> waiting;
  std::atomic<int> done{0}, refused{0};
  for (int i = 0; i < 20; ++i) {
    waiting.emplace_back([&] {
      const int s = status(post("/api/slow", headers, "{}"));
      (s == 200 ? done : s == 503 ? refused : done) += s == 200 || s == 503;
    });
  }
  for (int i = 0; i < 500 && refused < 4; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(status(get("/api/state")), 200) << "the page is served meanwhile";
  release_ = true;
  for (std::thread& one : waiting) one.join();
  EXPECT_EQ(done, 16);
  EXPECT_EQ(refused, 4);
}

TEST_F(ViewServerTest, WhatIsPromptDoesNotWaitForASlowHandler) {
  const std::string headers = "Content-Type: application/json\r\nX-AlignGS-Token: " + server_->token() + "\r\n";
  EXPECT_EQ(body(get("/api/list")), "made") << "without a snapshot the handler answers";
  has_snapshot_ = true;
  std::atomic<bool> ended{false};
  std::thread slow([&] {
    EXPECT_EQ(status(post("/api/slow", headers, "{}")), 200);
    ended = true;
  });
  EXPECT_EQ(status(post("/api/prompt", headers, "{}")), 200);
  EXPECT_EQ(status(post("/api/slow", headers, "{\"edit\": \"bad\"}")), 400) << "the check refuses it";
  EXPECT_EQ(body(get("/api/list")), "kept");
  EXPECT_FALSE(ended);
  release_ = true;
  slow.join();
}

TEST_F(ViewServerTest, ATrainingIsAskedForSnapshotsOnlyWhileSomebodyLooksOn) {
  const RunLock lock(base_ / "run");
  const fs::path flag = RunControl(base_ / "run").file(RunControl::Flag::kSnapshot);
  EXPECT_EQ(status(get("/api/state")), 200);
  EXPECT_FALSE(fs::exists(flag));
  raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state");
  EXPECT_TRUE(fs::exists(flag));
}

TEST_F(ViewServerTest, ARunInProgressShowsItsSnapshotAndItsStages) {
  fs::create_directories(base_ / "run" / "live");
  write("run/live/scene.ply", "live");
  EXPECT_EQ(parse_json(body(get("/api/state")))["splats"], "scene.ply") << "left behind by a killed training";
  const RunLock lock(base_ / "run");
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["splats"], "live/scene.ply");
  EXPECT_EQ(state["active"], true);
  EXPECT_EQ(state["editable"], false);
  EXPECT_EQ(state["stages"][0]["name"], "train");
  EXPECT_EQ(state["stages"][0]["state"], "now");
  EXPECT_EQ(state["stages"][2]["state"], "waiting");
}

TEST_F(ViewServerTest, AnEditedRunTellsTheVersionOfItsEdits) {
  const auto before = parse_json(body(get("/api/state")));
  EXPECT_EQ(before["edited"], false);
  EXPECT_TRUE(before["edits"].is_null());
  write("run/edits.json", R"({"schema": 2, "edits": [{"operation": "delete", "select": "bed"}]})");
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["edited"], true);
  EXPECT_TRUE(state["edits"].is_string());
  EXPECT_EQ(state["splats"], "scene.ply") << "the page has them already, and asks for what the edits did";
  EXPECT_EQ(state["version"], before["version"]);
  write("run/edits.json", R"({"schema": 2, "edits": []})");
  EXPECT_EQ(parse_json(body(get("/api/state")))["edited"], false);
}

TEST_F(ViewServerTest, DescribesTheRun) {
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["status"], "running");
  EXPECT_EQ(state["splats"], "scene.ply");
  EXPECT_TRUE(state["mesh"].is_null());
  EXPECT_EQ(state["up"][1], -1);
  EXPECT_EQ(state["units"], "metres");
  EXPECT_EQ(state["classes"][0]["name"], "wall");
  EXPECT_EQ(state["views"]["view_003"]["kinds"][0], "rgb");
}

TEST_F(ViewServerTest, SendsFilesAndPhotos) {
  EXPECT_EQ(body(get("/files/scene.ply?v=1")), "ply");
  EXPECT_EQ(body(get("/files/renders/test/rgb/view_003.png")), "picture");
  EXPECT_EQ(body(get("/api/photo/view_000")), "photo");
  EXPECT_EQ(status(get("/files/absent.ply")), 404);
}

TEST_F(ViewServerTest, StreamsCompleteEventsAndResumesWhereAPageLeftOff) {
  const std::string all = raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state");
  EXPECT_NE(all.find("text/event-stream"), std::string::npos);
  EXPECT_NE(all.find("id: 22\nevent: events\ndata: [{\"step\":1},{\"step\":2}]\n\n"), std::string::npos);
  const std::string rest =
      raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\nLast-Event-ID: 11\r\n\r\n", "event: state");
  EXPECT_NE(rest.find("data: [{\"step\":2}]"), std::string::npos);
}

TEST_F(ViewServerTest, ATornEventLineLosesThatLineAlone) {
  write("run/events.ndjson", "{\"step\":1}\n{\"st{\"step\":2}\n{\"step\":3}\n");
  const std::string all = raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state");
  EXPECT_NE(all.find("data: [{\"step\":1},{\"step\":3}]"), std::string::npos);
}

TEST_F(ViewServerTest, APageLearnsThatItsServerWasStartedAnew) {
  const auto name_of = [&](uint16_t port) {
    const std::string answer =
        test_http::raw(port, "GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state");
    const size_t at = answer.find("event: server\ndata: ");
    return at == std::string::npos ? std::string() : answer.substr(at + 20, 34);
  };
  const std::string first = name_of(server_->port());
  EXPECT_EQ(first.size(), 34u);
  EXPECT_EQ(name_of(server_->port()), first);
  restart();
  EXPECT_NE(name_of(server_->port()), first);
}

TEST_F(ViewServerTest, TellsPagesOfNewEvents) {
  std::thread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    std::ofstream(base_ / "run" / "events.ndjson", std::ios::app) << "ep\":3}\n";
  });
  const std::string answer = raw("GET /api/events?from=22 HTTP/1.1\r\nHost: localhost\r\n\r\n", "\"step\":3");
  later.join();
  EXPECT_NE(answer.find("data: [{\"step\":3}]"), std::string::npos);
}

TEST_F(ViewServerTest, AnotherSitesNameInTheHostHeaderIsRefused) {
  EXPECT_EQ(status(get("/api/state", "evil.example")), 403);
  EXPECT_EQ(status(get("/", "127.0.0.1.evil.example:7860")), 403);
  EXPECT_EQ(status(raw("GET / HTTP/1.1\r\nConnection: close\r\n\r\n")), 400);
}

TEST_F(ViewServerTest, NoPathLeavesTheRunFolder) {
  for (const char* target :
       {"/files/../secret.txt", "/files/%2e%2e/secret.txt", "/files/..%2fsecret.txt", "/files//etc/passwd",
        "/files/link.txt", "/files/renders/../../secret.txt", "/api/photo/..%2f..%2f..%2fsecret", "/../secret.txt"}) {
    const std::string answer = get(target);
    EXPECT_EQ(status(answer), 404) << target;
    EXPECT_EQ(answer.find("secret\n"), std::string::npos) << target;
  }
  for (const char* target : {"/files/scene.ply%00.txt", "/files/..%5csecret.txt", "/files/%zz"})
    EXPECT_EQ(status(get(target)), 400) << target;
}

TEST_F(ViewServerTest, AFifoInTheRunStopsNothing) {
  for (const char* name : {"run/report.html", "run/room.json"}) ASSERT_EQ(mkfifo((base_ / name).c_str(), 0600), 0);
  for (const char* name : {"run/events.ndjson", "run/classes.json", "run/scene.ply"}) {
    fs::remove(base_ / name);
    ASSERT_EQ(mkfifo((base_ / name).c_str(), 0600), 0);
  }
  EXPECT_EQ(status(get("/files/report.html")), 404);
  EXPECT_EQ(status(raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state")), 200);
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_TRUE(state["splats"].is_null());
  EXPECT_TRUE(state["room"].is_null());
  EXPECT_EQ(state["report"], false);
}

TEST_F(ViewServerTest, NoRouteFollowsALinkOutOfTheRun) {
  write("classes.json", R"({"classes": [{"id": 0, "name": "secret", "color": [1, 2, 3]}]})");
  write("events.ndjson", "{\"secret\":1}\n");
  fs::create_directories(base_ / "outside" / "rgb");
  write("outside/rgb/secret_view.png", "secret");
  for (const char* name : {"classes.json", "events.ndjson"}) {
    fs::remove(base_ / "run" / name);
    fs::create_symlink(base_ / name, base_ / "run" / name);
  }
  fs::create_directory_symlink(base_ / "outside", base_ / "run" / "renders" / "train");
  for (const std::string& answer :
       {get("/api/state"), get("/files/classes.json"), get("/files/renders/train/rgb/secret_view.png"),
        raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state")}) {
    EXPECT_EQ(body(answer).find("secret"), std::string::npos) << answer;
  }
}

TEST_F(ViewServerTest, FilesThatAreNestedTooDeeplyAreNamed) {
  write("run/cameras.json", std::string(100000, '['));
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_TRUE(state["cameras"].is_null());
  EXPECT_EQ(state["problems"][0], "cameras.json is nested deeper than 32 levels");
}

/// Files of a run take their place whole, so that one that is no JSON is damaged.
TEST_F(ViewServerTest, DamagedFilesAreNamedAndTheirPartsAreAbsent) {
  for (const char* name : {"room.json", "metrics.json", "selections.json", "edits.json", "cameras.json"}) {
    write(std::string("run/") + name, "{\"a\": [1,");
    const auto state = parse_json(body(get("/api/state")));
    EXPECT_EQ(state["problems"], nlohmann::json::array({std::string(name) + " is no JSON"})) << name;
    EXPECT_TRUE(state["room"].is_null()) << name;
    fs::remove(base_ / "run" / name);
  }
  write("run/room.json", "[1, 2]");
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["problems"][0], "room.json is no JSON object");
  EXPECT_TRUE(state["room"].is_null());
}

TEST_F(ViewServerTest, ARunThatCannotBeOpenedIsNotOfferedForEdits) {
  EXPECT_EQ(parse_json(body(get("/api/state")))["editable"], true);
  write("run/edits.json", "[");
  EXPECT_EQ(parse_json(body(get("/api/state")))["not_editable"], "edits.json is no JSON");
  fs::remove(base_ / "run" / "edits.json");
  fs::rename(base_ / "run" / "scene", base_ / "elsewhere");
  auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["editable"], false);
  EXPECT_THAT(state["not_editable"].get<std::string>(), testing::HasSubstr("--scene DIR"));
  fs::remove(base_ / "run" / "run.json");
  state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["status"], "unknown") << "nothing is starting here";
  EXPECT_THAT(state["not_editable"].get<std::string>(), testing::HasSubstr("run.json"));
}

TEST_F(ViewServerTest, AMovedSceneGivesItsPhotosAndUnits) {
  fs::rename(base_ / "run" / "scene", base_ / "elsewhere");
  EXPECT_EQ(status(get("/api/photo/view_000")), 404);
  stop();
  options_.scene = base_ / "elsewhere";
  start();
  EXPECT_EQ(status(get("/api/photo/view_000")), 200);
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["units"], "metres");
  EXPECT_EQ(state["editable"], true);
}

TEST_F(ViewServerTest, ARunWithoutCheckpointsIsEditedButNotDrawn) {
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["editable"], true);
  EXPECT_EQ(state["drawable"], false);
  fs::create_directories(base_ / "run" / "checkpoints");
  EXPECT_EQ(parse_json(body(get("/api/state")))["drawable"], true);
}

TEST_F(ViewServerTest, ARunThatWasNotTrainedSaysSo) {
  fs::remove(base_ / "run" / "scene.ply");
  const auto state = parse_json(body(get("/api/state")));
  EXPECT_EQ(state["editable"], false);
  EXPECT_NE(state["not_editable"].get<std::string>().find("nothing has been trained"), std::string::npos);
}

TEST_F(ViewServerTest, RequestsOfOtherSitesAreRefusedBeforeAnyWork) {
  const std::string site = "Sec-Fetch-Site: cross-site\r\n";
  for (const char* target : {"/api/state", "/files/scene.ply", "/api/double", "/api/below/x", "/api/events",
                             "/api/photo/view_000", "/app.js"}) {
    EXPECT_EQ(status(test_http::ask(server_->port(), "GET", target, site + "Sec-Fetch-Mode: no-cors\r\n")), 403)
        << target;
  }
  EXPECT_EQ(calls_, 0) << "no handler ran";
  const std::string token = "X-AlignGS-Token: " + server_->token() + "\r\nContent-Type: application/json\r\n";
  EXPECT_EQ(
      status(test_http::raw(server_->port(), "POST /api/echo HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n" +
                                                 token + site + "\r\n")),
      403)
      << "the body is not waited for";
  EXPECT_EQ(status(test_http::ask(server_->port(), "GET", "/api/double", "Sec-Fetch-Site: same-origin\r\n")), 200);
  EXPECT_EQ(calls_, 1);
}

TEST_F(ViewServerTest, PostsNeedTheTokenTheOriginAndJson) {
  const std::string token = "X-AlignGS-Token: " + server_->token() + "\r\n",
                    json = "Content-Type: application/json\r\n";
  EXPECT_EQ(body(post("/api/echo", token + json + "Origin: http://localhost:9000\r\n", "{\"a\":1}")), "{\"a\":1}");
  EXPECT_EQ(status(post("/api/echo", json, "{}")), 403);
  EXPECT_EQ(status(post("/api/echo", json + "X-AlignGS-Token: 0123\r\n", "{}")), 403);
  EXPECT_EQ(status(post("/api/echo", token + json + "Origin: http://evil.example\r\n", "{}")), 403);
  EXPECT_EQ(status(post("/api/echo", token + "Content-Type: text/plain\r\n", "{}")), 403);
  EXPECT_EQ(status(post("/api/echo", token + json, "{")), 400);
  const std::string deep = post("/api/echo", token + json, std::string(30000, '['));
  EXPECT_EQ(status(deep), 400);
  EXPECT_NE(body(deep).find("nested deeper than 8 levels"), std::string::npos);
  EXPECT_EQ(status(post("/api/fail", token + json, "{}")), 400);
  EXPECT_EQ(status(post("/api/state", token + json, "{}")), 404);
}

TEST_F(ViewServerTest, OtherMethodsAreRefused) {
  EXPECT_EQ(status(raw("DELETE /files/scene.ply HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")), 405);
  EXPECT_TRUE(fs::exists(base_ / "run" / "scene.ply"));
}

TEST_F(ViewServerTest, OversizedRequestsAndNoiseAreAnswered) {
  EXPECT_EQ(status(raw("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(40000, 'x') + "\r\n\r\n")), 431);
  const std::string token = "X-AlignGS-Token: " + server_->token() + "\r\nContent-Type: application/json\r\n";
  EXPECT_EQ(status(post("/api/echo", token, "\"" + std::string(70000, 'x') + "\"")), 413);
  const std::string noise = raw("\x16\x03\x01 this is not HTTP\r\n\r\n");
  EXPECT_EQ(status(noise), 400);
  EXPECT_NE(noise.find("Content-Security-Policy: default-src "), std::string::npos);
  EXPECT_EQ(status(get("/api/state")), 200) << "and it still serves";
}

TEST_F(ViewServerTest, ManyPagesAtOnceAreServedAndThenRefused) {
  std::vector<std::thread> pages;
  std::atomic<int> served{0};
  for (int i = 0; i < 32; ++i) {
    pages.emplace_back(
        [&] { served += status(raw("GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n", "event: state")) == 200; });
  }
  for (std::thread& page : pages) page.join();
  EXPECT_EQ(served, 32);
  EXPECT_EQ(status(get("/api/state")), 200);
}

TEST_F(ViewServerTest, ATakenPortIsAResourceErrorAndTheDefaultMovesOn) {
  ViewServerOptions options;
  options.run = base_ / "run";
  options.port = server_->port();
  try {
    ViewServer second(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kResources);
  }
  options.port = 0;
  EXPECT_NE(ViewServer(options).port(), server_->port());
}

TEST(ServedRunInput, WhatIsNoRunIsRefused) {
  ViewServerOptions options;
  options.run = fs::path(testing::TempDir()) / "aligngs_no_such_run";
  try {
    ViewServer server(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput);
  }
}

}  // namespace
}  // namespace aligngs
