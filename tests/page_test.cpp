// Requests of the page to a run: edits, undo, redo, exports, pictures, control; the same as the command line, and
// closed to everybody else.
#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/page_server.h"
#include "edit/edit_operation.h"
#include "io/atomic_file.h"
#include "io/gzip.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "serve/testing/http_client.h"
#include "support/page_run.h"
#include "support/process.h"
#include "support/small_scene.h"
#include "support/started_process.h"
#include "train/run_control.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::run_aligngs;

using PageRequests = testing_support::PageRun;
using testing_support::kPatience;

TEST_F(PageRequests, AnEditInThePageIsTheEditOfTheCommandLine) {
  const fs::path other = root() / "by_command";
  fs::remove_all(other);
  fs::copy(root() / "trained", other, fs::copy_options::recursive);
  posted("/api/edits/push", {{"edit", "delete bed"}});
  posted("/api/edits/push", {{"edit", "Recolour walls to #add8e6"}});
  ASSERT_EQ(run_aligngs("edit " + quoted(other) + " -q --select bed --delete --fill", root()).status, 0);
  ASSERT_EQ(run_aligngs("edit " + quoted(other) + " -q --select wall --recolor '#add8e6'", root()).status, 0);
  EXPECT_EQ(read_file(run_ / "edits.json"), read_file(other / "edits.json"));
  for (const EditOperation& edit : read_edits(run_ / "edits.json")) {
    EXPECT_TRUE(read_file(run_ / "edits" / edit.change) == read_file(other / "edits" / edit.change)) << edit.change;
  }
}

TEST_F(PageRequests, UndoAndRedoGoThroughTheStack) {
  EXPECT_TRUE(list()["edits"].empty());
  json answer = posted("/api/edits/push", {{"edit", "delete bed"}});
  EXPECT_GT(answer["report"]["selected_gaussians"], 0);
  const std::string edited = read_file(run_ / "edits.json");
  answer = posted("/api/edits/undo", json::object());
  EXPECT_EQ(answer["undone"], "delete bed, hole filled");
  EXPECT_TRUE(answer["edits"].empty());
  EXPECT_EQ(answer["redo"], json{"delete bed, hole filled"});
  EXPECT_FALSE(fs::exists(run_ / "edits"));
  answer = posted("/api/edits/redo", json::object());
  EXPECT_EQ(answer["edits"], json{"delete bed, hole filled"});
  EXPECT_TRUE(answer["redo"].empty());
  EXPECT_EQ(read_file(run_ / "edits.json"), edited);
  EXPECT_EQ(test_http::status(post("/api/edits/redo", json::object())), 400) << "nothing is left to do again";
}

TEST_F(PageRequests, AnEditIsSentAsWhatItChanges) {
  const auto got = [&](const std::string& path) {
    return test_http::body(test_http::get(server_->port(), path, "localhost", kPatience));
  };
  const std::string path = "/api/edits/scene/scene.labels.ply", whole = got("/api/scene/coarse/scene.labels.ply"),
                    before = got("/api/edits/mesh.ply");
  EXPECT_THAT(before, testing::StartsWith("ply"));
  posted("/api/edits/push", {{"edit", "delete bed"}});
  const std::string part = got(path);
  const std::string text = gzip_expanded(part, "part", 1 << 28);
  const json head = parse_json(text.substr(0, text.find('\n')));
  EXPECT_GT(head["added"], 0) << "the hole is filled";
  EXPECT_LT(part.size(), whole.size() / 2);
  EXPECT_FALSE(got("/api/edits/mesh.ply") == before);
  posted("/api/edits/undo", json::object());
  EXPECT_TRUE(got("/api/edits/mesh.ply") == before);
  EXPECT_EQ(test_http::status(test_http::get(server_->port(), "/api/edits/scene/nothing.ply", "localhost", kPatience)),
            404);
}

TEST_F(PageRequests, UndoCanBeTyped) {
  posted("/api/edits/push", {{"edit", "recolor wall dark green"}});
  posted("/api/edits/push", {{"edit", "highlight bed"}});
  const json answer = posted("/api/edits/push", {{"edit", "undo the first edit"}});
  EXPECT_EQ(answer["undone"], "recolor wall to #006400");
  EXPECT_EQ(answer["edits"], json{"highlight bed in #ffc800"});
}

TEST_F(PageRequests, WhatTheCommandLineDoesMeanwhileIsSeen) {
  posted("/api/edits/push", {{"edit", "delete bed"}});
  posted("/api/edits/undo", json::object());
  ASSERT_EQ(run_aligngs("edit " + quoted(run_) + " -q --select wall --highlight '#ff0000'", root()).status, 0);
  const json now = list();
  EXPECT_EQ(now["edits"], json{"highlight wall in #ff0000"});
  EXPECT_TRUE(now["redo"].empty()) << "what was undone belongs to another history";
}

TEST_F(PageRequests, PreviewDrawsAndWritesNothing) {
  const json report = posted("/api/edits/preview", {{"edit", "extract bed"}});
  EXPECT_GT(report["selected_gaussians"], 0);
  EXPECT_THAT(report["picture"].get<std::string>(), testing::StartsWith("data:image/png;base64,iVBOR"));
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
  EXPECT_FALSE(fs::exists(run_ / "edits"));
}

TEST_F(PageRequests, ExportsEveryFormat) {
  posted("/api/edits/push", {{"edit", "delete bed"}});
  const json formats = list()["formats"];
  EXPECT_EQ(formats.size(), 11u) << "plans are offered where the run has room.json";
  for (const auto& format : formats) {
    const json made = posted("/api/export", {{"format", format}});
    EXPECT_EQ(made["file"], "scene.edited." + format.get<std::string>());
    const std::string sent =
        test_http::body(test_http::get(server_->port(), "/files/" + made["file"].get<std::string>()));
    EXPECT_EQ(sent.size(), made["bytes"].get<size_t>()) << format;
  }
  EXPECT_TRUE(read_file(run_ / "scene.ply") == read_file(root() / "trained" / "scene.ply"));
}

TEST_F(PageRequests, DrawsAnyViewOnDemand) {
  const json cameras = parse_json(read_file(run_ / "cameras.json"));
  const std::string view = cameras[0]["img_name"];
  for (const char* kind : {"rgb", "depth", "normal", "label"}) {
    const std::string answer =
        test_http::get(server_->port(), "/api/render/" + view + "/" + kind + ".png", "localhost", kPatience);
    ASSERT_EQ(test_http::status(answer), 200) << answer.substr(0, 300);
    EXPECT_EQ(decode_image(test_http::body(answer), kind).width, 64);
  }
  for (const std::string& name : {view + "/other.png", view + "/rgb", std::string("nowhere/rgb.png"),
                                  std::string(".png"), std::string("/.png")}) {
    EXPECT_EQ(test_http::status(test_http::get(server_->port(), "/api/render/" + name, "localhost", kPatience)), 404)
        << name;
  }
}

TEST_F(PageRequests, ControlReachesATrainingAndNothingElse) {
  EXPECT_EQ(test_http::status(post("/api/control", {{"action", "stop"}})), 400) << "nobody would obey";
  EXPECT_FALSE(fs::exists(run_ / "control" / "stop"));
  const RunLock lock(run_);
  const RunControl control(run_);
  posted("/api/control", {{"action", "pause"}});
  EXPECT_TRUE(control.asked(RunControl::Flag::kPause));
  posted("/api/control", {{"action", "resume"}});
  EXPECT_FALSE(control.asked(RunControl::Flag::kPause));
  posted("/api/control", {{"action", "checkpoint"}});
  posted("/api/control", {{"action", "stop"}});
  EXPECT_TRUE(control.asked(RunControl::Flag::kCheckpoint));
  EXPECT_TRUE(control.asked(RunControl::Flag::kStop));
  EXPECT_EQ(test_http::status(post("/api/control", {{"action", "../../stop"}})), 400);
  EXPECT_EQ(test_http::status(post("/api/edits/push", {{"edit", "delete bed"}})), 400)
      << "a run in progress is not edited";
  EXPECT_EQ(test_http::status(test_http::get(server_->port(), "/api/render/x/rgb.png")), 400);
}

TEST_F(PageRequests, MistakesAreAnsweredInWordsAndChangeNothing) {
  const auto expect = [&](const std::string& path, const json& body, const char* words) {
    const std::string answer = post(path, body);
    EXPECT_EQ(test_http::status(answer), 400) << body;
    EXPECT_THAT(test_http::body(answer), HasSubstr(words)) << body;
  };
  expect("/api/edits/push", {{"edit", "delete bedd"}}, "bed");
  expect("/api/edits/push", {{"edit", "delete car"}}, "no object that is");
  expect("/api/edits/push", {{"edit", "explode bed"}}, "is no edit");
  expect("/api/edits/push", {{"edit", 7}}, "no text");
  expect("/api/edits/push", json::object(), "no text");
  expect("/api/edits/push", json::array({"delete bed"}), "no JSON object");
  expect("/api/edits/push", {{"edit", "delete bed"}, {"output", "/tmp/x"}}, "nobody knows");
  expect("/api/edits/push", {{"edit", "delete " + std::string(5000, 'x')}}, "too long");
  expect("/api/edits/preview", {{"edit", "delete everything"}}, "nothing would be left");
  expect("/api/edits/push", {{"edit", "replace bed with /etc/passwd.ply"}}, "the folder that the run is in");
  expect("/api/edits/preview", {{"edit", "replace bed with ../../run#bed"}}, "the folder that the run is in");
  expect("/api/edits/undo", json::object(), "no edit to undo");
  expect("/api/edits/undo", {{"all", "yes"}}, "nobody knows");
  expect("/api/export", {{"format", "gbl"}}, "glb");
  expect("/api/export", {{"format", "../../../tmp/x"}}, "no export format");
  expect("/api/export", {{"format", "glb"}, {"output", "/tmp/x"}}, "nobody knows");
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
  EXPECT_FALSE(fs::exists(run_ / "edits"));
}

/// Requests that another site's page, or a person without the token, could send to each of the endpoints that change something.
TEST_F(PageRequests, EveryEndpointIsClosedToOthers) {
  const std::string type = "Content-Type: application/json\r\n", token = "X-AlignGS-Token: " + token_ + "\r\n";
  const std::pair<const char*, const char*> endpoints[] = {{"/api/edits/push", R"({"edit":"delete bed"})"},
                                                           {"/api/edits/preview", R"({"edit":"delete bed"})"},
                                                           {"/api/edits/undo", "{}"},
                                                           {"/api/edits/redo", "{}"},
                                                           {"/api/export", R"({"format":"glb"})"},
                                                           {"/api/selections/save", R"({"name":"a"})"},
                                                           {"/api/selections/rename", R"({"name":"a","to":"b"})"},
                                                           {"/api/selections/remove", R"({"name":"a"})"},
                                                           {"/api/control", R"({"action":"stop"})"}};
  const RunLock lock(run_);  // so that a request that came through would leave a flag
  for (const auto& [path, body] : endpoints) {
    const uint16_t port = server_->port();
    EXPECT_EQ(test_http::status(test_http::post(port, path, type, body)), 403) << path << ": no token";
    EXPECT_EQ(test_http::status(
                  test_http::post(port, path, type + "X-AlignGS-Token: " + std::string(32, '0') + "\r\n", body)),
              403)
        << path;
    EXPECT_EQ(test_http::status(test_http::post(port, path, type + "Cookie: aligngs_9000=" + token_ + "\r\n", body)),
              403)
        << path << ": a browser sends the cookie by itself; it is no proof";
    EXPECT_EQ(test_http::status(test_http::post(port, path, type + token + "Origin: http://evil.example\r\n", body)),
              403)
        << path;
    EXPECT_EQ(test_http::status(test_http::post(port, path, type + token + "Origin: null\r\n", body)), 403) << path;
    EXPECT_EQ(test_http::status(test_http::post(port, path, token + "Content-Type: text/plain\r\n", body)), 403)
        << path << ": a form";
    EXPECT_EQ(test_http::status(test_http::raw(port, std::string("POST ") + path +
                                                         " HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n" +
                                                         type + token + "Content-Length: 2\r\n\r\n{}")),
              403)
        << path << ": rebound name";
    EXPECT_EQ(test_http::status(test_http::post(port, path, type + token + "Sec-Fetch-Site: cross-site\r\n", body)),
              403)
        << path << ": another site";
    EXPECT_EQ(test_http::status(test_http::get(port, path)), 404) << path << ": no GET changes anything";
    EXPECT_NE(test_http::status(test_http::post(port, path, type + token, std::string(100000, 'x'))), 200)
        << path << ": too large";
    EXPECT_EQ(test_http::status(test_http::post(port, path, type + token, "{")), 400) << path;
  }
  EXPECT_FALSE(fs::exists(run_ / "edits.json"));
  EXPECT_FALSE(fs::exists(run_ / "control" / "stop"));
}

TEST(PageOption, APortInUseNamesItsOptionAndBeginsNothing) {
  const fs::path folder = fs::path(testing::TempDir()) / "port_in_use";
  fs::remove_all(folder);
  testing_support::write_small_scene(folder / "scene");
  ViewServerOptions options;
  options.run = folder / "scene";
  options.expect_run = true;
  const ViewServer holder(options);
  const std::string port = std::to_string(holder.port());
  const auto in = [](const fs::path& path) { return "'" + path.string() + "'"; };
  const auto train = run_aligngs(
      "train " + in(folder / "scene") + " -o " + in(folder / "run") + " --view --view-port " + port, folder);
  EXPECT_EQ(train.status, 5);
  EXPECT_THAT(train.err, HasSubstr("port " + port + " is in use"));
  EXPECT_THAT(train.err, HasSubstr("choose another one with --view-port"));
  EXPECT_FALSE(fs::exists(folder / "run"));
}

TEST(PageOption, TrainWithViewServesWhileItTrainsAndAfterAStop) {
  const fs::path folder = fs::path(testing::TempDir()) / "page_option";
  fs::remove_all(folder);
  testing_support::write_small_scene(folder / "scene");
  const fs::path run = folder / "run";
  testing_support::StartedProcess training(
      {"train", (folder / "scene").string(), "-o", run.string(), "-n", "100000", "--view"}, folder);
  uint16_t port = 0;  // the first free one: a port of our choice may be another program's
  const std::string address = "http://127.0.0.1:";
  ASSERT_TRUE(testing_support::wait_until(
      [&] {
        const std::string told = training.err();
        const size_t begin = told.find(address), end = told.find('/', begin + address.size());
        if (begin == std::string::npos || end == std::string::npos) return false;
        port = static_cast<uint16_t>(std::stoi(told.substr(begin + address.size())));
        return true;
      },
      30))
      << training.err();
  json state;
  const auto state_is = [&](const std::function<bool()>& wanted) {
    return testing_support::wait_until(
        [&] {
          const std::string answer = test_http::get(port, "/api/state");
          if (test_http::status(answer) != 200) return false;
          state = parse_json(test_http::body(answer));
          if (wanted()) return true;
          test_http::raw(port, "GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n",
                         "event: state");  // somebody looks on
          return false;
        },
        30);
  };
  ASSERT_TRUE(state_is([&] { return state["splats"] == "live/scene.ply"; })) << state << training.err();
  EXPECT_EQ(state["active"], true);
  EXPECT_FALSE(state["cameras"].is_null());
  const std::string page = test_http::get(port, "/");
  const size_t at = page.find("aligngs_9000=") + 13;
  const std::string headers =
      "Content-Type: application/json\r\nX-AlignGS-Token: " + page.substr(at, page.find(';', at) - at) + "\r\n";
  EXPECT_EQ(test_http::status(test_http::post(port, "/api/control", headers, R"({"action":"stop"})")), 200);
  EXPECT_TRUE(state_is([&] { return state["active"] == false && state["status"] == "stopped"; }))
      << "the page can be used after a stop";
  EXPECT_THAT(state["not_editable"].get<std::string>(), HasSubstr("--resume"));
  training.send(SIGINT);
  EXPECT_EQ(training.wait(10), 75) << training.err();
  EXPECT_THAT(training.err(), HasSubstr("--resume"));
}

}  // namespace
}  // namespace aligngs
