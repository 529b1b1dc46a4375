// The local web server of `aligngs view`: one port, one thread, plain HTTP and Server-Sent Events.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace aligngs {

/// Answers a POST with a JSON document; throws Error{kUsage, kBadInput} for a request that makes no sense (status 400).
using PostHandler = std::function<std::string(const std::string& body)>;

/// Answers a GET below its path; `name` is the rest of the path, decoded. Nothing: status 404.
struct GetAnswer {
  std::string type;  ///< content type
  std::string body;
  std::shared_ptr<const std::string> bytes;  ///< instead of `body`: bytes that are kept and sent to many
  std::string etag;                          ///< of `bytes`, with its quotes: the download can be resumed
};
using GetHandler = std::function<std::optional<GetAnswer>(const std::string& name)>;

/// Limits of time count silence: a slow download goes on for as long as its bytes flow.
struct ServerLimits {
  std::chrono::milliseconds request{15000};  ///< for the head of a request, and between two parts of its body
  std::chrono::milliseconds silence{60000};  ///< during an answer: the client takes no byte
  size_t connections = 64;                   ///< at a time; a browser holds six
};

struct ViewServerOptions {
  std::filesystem::path run;                ///< run folder or .ply file
  std::filesystem::path scene;              ///< new place of the run's scene; empty: as run.json says
  bool expect_run = false;                  ///< the folder exists and will become a run
  uint16_t port = 0;                        ///< 0: the first free one from 7860 on, otherwise exactly this
  std::string port_option = "--port";       ///< of the command that serves, for the remedy of an error
  std::vector<std::string> allowed_hosts;   ///< names accepted in the Host header besides this machine's
  std::filesystem::path web_root;           ///< serve the page from here (for its development); empty: embedded
  std::map<std::string, PostHandler> post;  ///< by path, e.g. "/api/edit"
  std::map<std::string, GetHandler> get;    ///< by path, e.g. "/api/edits", or by its beginning, e.g. "/api/render/"
  std::set<std::string> prompt;             ///< paths of `post` that do not wait for other handlers
  /// By path: looks at a body before the turn of its handler, and throws what is answered then.
  std::map<std::string, std::function<void(const std::string& body)>> checks;
  std::map<std::string, GetHandler> snapshots;  ///< by path, asked before `get`; nothing: `get` has its turn
  ServerLimits limits;
};

/// GET /               the page, with the run's token in a SameSite=Strict cookie named aligngs_<port of the Host
/// header>
///                     (cookies know no ports: two runs shown at a time must not overwrite each other's)
/// GET /api/state      ServedRun::state()
/// GET /api/events     Server-Sent Events (event_stream.h)
/// GET /api/photo/V    the photo of view V
/// GET /files/...      files of the run
/// GET, POST           the handlers of the options, one at a time on a thread of their own; a POST needs Origin absent
/// or
///                     this host, a JSON body and X-AlignGS-Token. Handlers that are `prompt`, `checks` and `snapshots` run
///                     on a second thread, one at a time: they share no data with the other handlers, or lock it
///
/// Downloads have an ETag and take Range, If-Range, If-Match and If-None-Match. Text is compressed once and kept. HEAD
/// tells the length.
///
/// While a page listens to a run that is being trained, the trainer is asked for live snapshots (run_control.h).
///
/// Bound to 127.0.0.1. Requests of other sites (Host, Sec-Fetch-Site) are refused before their body is read. Headers
/// are at most 16 KiB (status 431), bodies 64 KiB (413), and what is no HTTP is answered with 400. When all connections
/// are taken, the one that is idle longest makes room. Every answer carries a content security policy; that of the
/// run's own files allows no script, as a run may come from anywhere. No cross-origin header is ever sent.
class ViewServer {
 public:
  /// Opens the port. Error{kBadInput} when the run is none, Error{kResources} when no port is free.
  explicit ViewServer(ViewServerOptions options);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  uint16_t port() const;
  const std::string& token() const;
  /// Serves until `stop` returns true (called twenty times a second).
  void run(const std::function<bool()>& stop);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aligngs
