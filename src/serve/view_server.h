// The local web server of `aligngs view`: one port, one thread, plain HTTP and Server-Sent Events.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aligngs {

/// Answers a POST with a JSON document; throws Error{kUsage, kBadInput} for a request that makes no sense (status 400).
using PostHandler = std::function<std::string(const std::string& body)>;

/// Answers a GET below its path; `name` is the rest of the path, decoded. Nothing: status 404.
struct GetAnswer {
  std::string type;  ///< content type
  std::string body;
};
using GetHandler = std::function<std::optional<GetAnswer>(const std::string& name)>;

struct ViewServerOptions {
  std::filesystem::path run;                ///< run folder or .ply file
  bool expect_run = false;                  ///< the folder exists and will become a run
  uint16_t port = 0;                        ///< 0: the first free one from 7860 on, otherwise exactly this
  std::vector<std::string> allowed_hosts;   ///< names accepted in the Host header besides this machine's
  std::filesystem::path web_root;           ///< serve the page from here (for its development); empty: embedded
  std::map<std::string, PostHandler> post;  ///< by path, e.g. "/api/edit"
  std::map<std::string, GetHandler> get;    ///< by path, e.g. "/api/edits", or by its beginning, e.g. "/api/render/"
};

/// GET /               the page, with the run's token in a SameSite=Strict cookie named aligngs_<port of the Host header>
///                     (cookies know no ports: two runs shown at a time must not overwrite each other's)
/// GET /api/state      ServedRun::state()
/// GET /api/events     Server-Sent Events: `events` (lines of events.ndjson as a JSON array, id: byte offset) and `state`
///                     (the version of the scene files) whenever they change
/// GET /api/photo/V    the photo of view V
/// GET /files/...      files of the run
/// GET, POST           the handlers of the options, one at a time on a thread of their own; a POST needs Origin absent or
///                     this host, a JSON body and X-AlignGS-Token
///
/// While a page listens to a run that is being trained, the trainer is asked for live snapshots (run_control.h).
///
/// Bound to 127.0.0.1. Headers up to 16 KiB, bodies up to 64 KiB, 15 s to send a request; a larger or slower one is
/// cut off. Every answer carries a content security policy; that of the run's own files allows no script, as a run may
/// come from anywhere. No cross-origin header is ever sent.
class ViewServer {
 public:
  /// Opens the port. Error{kBadInput} when the run is none, Error{kResources} when no port is free.
  explicit ViewServer(ViewServerOptions options);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  uint16_t port() const;
  const std::string& token() const;
  /// Serves until `stop` returns true (asked five times a second).
  void run(const std::function<bool()>& stop);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aligngs
