// A small run and a server for it, as the server's tests use them.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

#include "core/error.h"
#include "serve/testing/http_client.h"
#include "serve/view_server.h"

namespace aligngs::testing_support {

/// A small run and a server for it, on its own thread.
class ViewServerTest : public testing::Test {
 protected:
  void SetUp() override {
    base_ = std::filesystem::path(testing::TempDir()) /
            ("aligngs_view_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(base_);
    std::filesystem::create_directories(base_ / "run" / "renders" / "test" / "rgb");
    std::filesystem::create_directories(base_ / "run" / "scene" / "images");
    write("run/run.json", R"({"scene": "scene", "status": "running", "stage": "train"})");
    write("run/scene.ply", "ply");
    write("run/classes.json", R"({"schema": 1, "classes": [{"id": 0, "name": "wall", "color": [1, 2, 3]}]})");
    write("run/events.ndjson", "{\"step\":1}\n{\"step\":2}\n{\"st");
    write("run/renders/test/rgb/view_003.png", "picture");
    write("run/scene/scene.json", R"({"units": "metres", "up": [0, -1, 0]})");
    write("run/scene/images/view_000.png", "photo");
    write("secret.txt", "secret");
    std::filesystem::create_symlink(base_ / "secret.txt", base_ / "run" / "link.txt");
    ViewServerOptions options;
    options.run = base_ / "run";
    options.post["/api/echo"] = [](const std::string& body) { return body; };
    options.post["/api/slow"] = [this](const std::string&) {
      while (!release_) std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return std::string("{}");
    };
    options.post["/api/prompt"] = [](const std::string& body) { return body; };
    options.prompt.insert("/api/prompt");
    options.checks["/api/slow"] = [](const std::string& body) {
      if (body.find("bad") != std::string::npos) throw_usage("words that nobody can read");
    };
    options.get["/api/list"] = [](const std::string&) { return GetAnswer{"text/plain", "made", {}, {}}; };
    options.snapshots["/api/list"] = [this](const std::string&) -> std::optional<GetAnswer> {
      if (!has_snapshot_) return {};
      return GetAnswer{"text/plain", "kept", {}, {}};
    };
    options.post["/api/throw"] = [](const std::string&) -> std::string { throw std::runtime_error("a surprise"); };
    options.get["/api/double"] = [this](const std::string&) {
      ++calls_;
      return GetAnswer{"text/plain", "twice", {}, {}};
    };
    options.get["/api/below/"] = [this](const std::string& name) -> std::optional<GetAnswer> {
      ++calls_;
      if (name == "absent") return {};
      return GetAnswer{"text/plain", name, {}, {}};
    };
    options.post["/api/fail"] = [](const std::string&) -> std::string { throw_usage("no such object", "look"); };
    configure(options);
    options_ = options;
    start();
  }

  void TearDown() override {
    stop();
    std::filesystem::remove_all(base_);
  }

  /// Options of a test's own.
  virtual void configure(ViewServerOptions&) {}

  void start() {
    stop_ = false;
    server_ = std::make_unique<ViewServer>(options_);
    thread_ = std::thread([this] { server_->run([this] { return stop_.load(); }); });
  }
  void stop() {
    stop_ = true;
    thread_.join();
    server_.reset();
  }
  void restart() {
    stop();
    start();
  }

  void write(const std::string& name, const std::string& content) {
    std::ofstream(base_ / name, std::ios::binary) << content;
  }

  std::string raw(const std::string& bytes, const std::string& until = "") const {
    return test_http::raw(server_->port(), bytes, until);
  }
  std::string get(const std::string& target, const std::string& host = "localhost:9000") const {
    return test_http::get(server_->port(), target, host);
  }
  /// GET with headers of the test's own.
  std::string ask_for(const std::string& target, const std::string& headers = "") const {
    return test_http::ask(server_->port(), "GET", target, headers);
  }
  std::string post(const std::string& target, const std::string& headers, const std::string& body) const {
    return test_http::post(server_->port(), target, headers, body);
  }

  std::filesystem::path base_;
  ViewServerOptions options_;
  std::unique_ptr<ViewServer> server_;
  std::thread thread_;
  std::atomic<bool> stop_{false}, release_{false}, has_snapshot_{false};
  std::atomic<int> calls_{0};  // of the handlers of GET
};

}  // namespace aligngs::testing_support
