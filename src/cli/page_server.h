// The page's server as commands use it: everything registered, its address told, on a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "cli/command.h"
#include "cli/view_renders.h"
#include "serve/edit_service.h"
#include "serve/scene_service.h"
#include "serve/selection_service.h"
#include "serve/start_picture.h"
#include "serve/view_server.h"

namespace aligngs {

struct PageServerOptions {
  ViewServerOptions server;     ///< run, port, allowed hosts, web root; handlers are added
  std::filesystem::path scene;  ///< where the scene went; may be empty
  int threads = 0;
};

class PageServer {
 public:
  /// Opens the port and begins to serve. Errors as ViewServer's.
  explicit PageServer(PageServerOptions options);
  ~PageServer();  ///< ends the server
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  std::string url() const;
  /// The line to type on the computer in front of the user when this one is reached over ssh; empty otherwise.
  std::string ssh_line() const;
  uint16_t port() const { return server_->port(); }
  /// Tells the address, for people, on standard error.
  void announce() const;
  /// Serves until Ctrl-C or SIGTERM.
  void wait() const;
  /// Whether somebody pressed "stop" on the page.
  bool stop_was_asked() const { return stop_asked_; }

 private:
  std::mutex drawing_;  // held by whoever draws a picture or exports
  std::unique_ptr<SceneService> scenes_;
  std::unique_ptr<StartPicture> start_;  // before the edits, which tell it of theirs
  std::unique_ptr<EditService> edits_;
  std::unique_ptr<SelectionService> selections_;
  std::unique_ptr<ViewRenders> renders_;
  std::unique_ptr<ViewServer> server_;
  std::atomic<bool> stop_{false}, stop_asked_{false};
  std::thread thread_;
};

/// For `--view` of demo, run and train: nothing without it. The folder is made so that it can be served before the run
/// begins in it. `scene`: empty where run.json will say it.
std::unique_ptr<PageServer> serve_while_working(bool view, uint16_t port, const std::filesystem::path& run,
                                                const std::filesystem::path& scene, int threads);
/// Does the work of a command beside its page, then tells the address again and serves until Ctrl-C. A training that
/// was stopped from the page leaves the page too; the error (kInterrupted) follows at Ctrl-C. Without a server: the
/// work alone.
void work_beside_page(const std::unique_ptr<PageServer>& server, const std::function<void()>& work);

}  // namespace aligngs
