// A small run with its page's server, and requests of its page.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/page_server.h"
#include "io/json_text.h"
#include "process.h"
#include "serve/testing/http_client.h"
#include "small_scene.h"

namespace aligngs::testing_support {

inline constexpr int kPatience = 60;  // seconds for an answer that opens a run

/// Each test has a copy of a run that is trained once for its suite.
class PageRun : public testing::Test {
 protected:
  using json = nlohmann::json;
  static std::filesystem::path root() {
    return std::filesystem::path(testing::TempDir()) /
           ("page_" + std::string(testing::UnitTest::GetInstance()->current_test_suite()->name()));
  }
  static std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

  static void SetUpTestSuite() {
    std::filesystem::remove_all(root());
    write_small_scene(root() / "scene");
    ASSERT_EQ(
        run_aligngs("train " + quoted(root() / "scene") + " -o " + quoted(root() / "trained") + " -n 40 -q", root())
            .status,
        0);
    ASSERT_EQ(run_aligngs("mesh " + quoted(root() / "trained") + " --set mesh.voxel=0.05 -q", root()).status, 0);
  }
  void SetUp() override {
    run_ = root() / testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(run_);
    std::filesystem::copy(root() / "trained", run_, std::filesystem::copy_options::recursive);
    PageServerOptions options;
    options.server.run = run_;
    server_ = std::make_unique<PageServer>(std::move(options));
    const std::string page = test_http::get(server_->port(), "/");
    const size_t at = page.find("aligngs_9000=") + 13;
    token_ = page.substr(at, page.find(';', at) - at);
  }
  void TearDown() override { server_.reset(); }

  std::string headers() const { return "Content-Type: application/json\r\nX-AlignGS-Token: " + token_ + "\r\n"; }
  std::string post(const std::string& path, const json& body) const {
    return test_http::post(server_->port(), path, headers(), json_line(body), kPatience);
  }
  json posted(const std::string& path, const json& body) const {
    const std::string answer = post(path, body);
    EXPECT_EQ(test_http::status(answer), 200) << answer;
    return parse_json(test_http::body(answer));
  }
  json list() const {
    return parse_json(test_http::body(test_http::get(server_->port(), "/api/edits", "localhost", kPatience)));
  }

  std::filesystem::path run_;
  std::unique_ptr<PageServer> server_;
  std::string token_;
};

}  // namespace aligngs::testing_support
