#include "serve/view_server.h"

#include <chrono>

#include "core/error.h"
#include "serve/connection_slots.h"
#include "serve/event_stream.h"
#include "serve/gzip_cache.h"
#include "serve/handler_threads.h"
#include "serve/http_answer.h"
#include "serve/http_connection.h"
#include "serve/http_types.h"
#include "serve/page_answer.h"
#include "serve/request_admission.h"
#include "serve/request_body.h"
#include "serve/request_rules.h"
#include "serve/served_run.h"

namespace aligngs {

using tcp = net::ip::tcp;
using net::awaitable;
using net::use_awaitable;
using namespace std::chrono_literals;

namespace {

constexpr uint16_t kFirstPort = 7860, kPortsTried = 100;
constexpr auto kWatchTime = 500ms;      // between looks at the run folder
constexpr auto kSnapshotTime = 2000ms;  // between requests for live snapshots; the trainer may take longer
constexpr int kMaxListeners = 32;       // open event streams
constexpr uint64_t kLargestText = uint64_t(16) << 20;  // bytes of a text that is compressed; larger ones go as they are
constexpr uint64_t kSmallestText = 1024;               // bytes; less is sent in one packet anyway
constexpr size_t kCompressedTexts = size_t(16) << 20;  // bytes of streams that are kept

}  // namespace

struct ViewServer::State {
  ViewServerOptions options;
  ServedRun run;
  std::string token = random_token();
  std::string started = random_token();  // tells pages that this is another server than before
  int listeners = 0;
  std::chrono::steady_clock::time_point snapshot_asked{};
  GzipCache texts{kCompressedTexts};
  ConnectionSlots slots;
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  HandlerThreads threads;  // last: handlers end before the connections they answer

  explicit State(ViewServerOptions given)
      : options(std::move(given)),
        run(options.run, options.expect_run, options.scene),
        slots(options.limits.connections) {
    listen();
  }

  void listen() {
    const uint16_t first = options.port != 0 ? options.port : kFirstPort;
    const int tries = options.port != 0 ? 1 : kPortsTried;
    std::string reason;
    for (int i = 0; i < tries; ++i) {
      const tcp::endpoint end(net::ip::address_v4::loopback(), static_cast<uint16_t>(first + i));
      beast::error_code error;
      acceptor.open(end.protocol(), error);
      if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
      if (!error) acceptor.bind(end, error);
      if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
      if (!error) return;
      reason = error == net::error::address_in_use ? "is in use" : "cannot be opened: " + error.message();
      acceptor.close(error);
    }
    throw_resources({},
                    options.port != 0 ? "port " + std::to_string(options.port) + " " + reason
                                      : "no port is free: the last one " + reason,
                    "choose another one with " + options.port_option);
  }

  awaitable<HttpAnswer> post(const Request& request, const std::string& path) {
    if (const auto fault = json_fault(request.body())) co_return refusal(request, http::status::bad_request, *fault);
    std::optional<HttpAnswer> failed;
    if (const auto check = options.checks.find(path); check != options.checks.end()) {
      const auto look = [&look_at = check->second, &request] {
        look_at(request.body());
        return true;
      };
      co_await threads.handled<bool>(request, look, failed, HandlerLane::kPrompt);
      if (failed) co_return std::move(*failed);
    }
    const PostHandler& call = options.post.find(path)->second;
    const auto work = [&call, &request] { return call(request.body()); };
    const HandlerLane lane = options.prompt.contains(path) ? HandlerLane::kPrompt : HandlerLane::kInTurn;
    std::optional<std::string> body = co_await threads.handled<std::string>(request, work, failed, lane);
    if (failed) co_return std::move(*failed);
    co_return text_answer(request, http::status::ok, std::move(*body), "application/json");
  }

  /// The handler of a GET and the rest of its path.
  const GetHandler* get_handler(const std::string& path, std::string& name) const {
    for (const auto& [begin, handler] : options.get) {
      const bool folder = !begin.empty() && begin.back() == '/';
      if (folder ? path.compare(0, begin.size(), begin) != 0 : path != begin) continue;
      name = path.substr(begin.size());
      return &handler;
    }
    return nullptr;
  }

  awaitable<HttpAnswer> get_answer(const Request& request, const std::string& path, const GetHandler& handler,
                                   const std::string& name) {
    std::optional<HttpAnswer> failed;
    std::optional<std::optional<GetAnswer>> found;
    if (const auto snapshot = options.snapshots.find(path); snapshot != options.snapshots.end()) {
      const auto look = [&take = snapshot->second, &name] { return take(name); };
      found = co_await threads.handled<std::optional<GetAnswer>>(request, look, failed, HandlerLane::kPrompt);
      if (failed) co_return std::move(*failed);
    }
    if (!found || !*found) {
      const auto work = [&handler, &name] { return handler(name); };
      found = co_await threads.handled<std::optional<GetAnswer>>(request, work, failed);
      if (failed) co_return std::move(*failed);
    }
    if (!*found) co_return refusal(request, http::status::not_found, "not found");
    GetAnswer& given = **found;
    if (!given.bytes) co_return text_answer(request, http::status::ok, std::move(given.body), given.type);
    Download download{given.type, given.etag, false, AnswerPolicy::kPage, given.bytes, {}};
    co_return download_answer(request, std::move(download));
  }

  /// A text that the client takes compressed. Compressed at most once, on a thread of its own.
  awaitable<GzipCache::Stream> compressed(const std::string& name, const std::string& version,
                                          const std::string& text) {
    GzipCache::Stream stream = texts.find(name, version);
    if (!stream) {
      const auto work = [&] { return texts.add(name, version, text); };
      stream = co_await threads.beside_handlers<GzipCache::Stream>(work);
    }
    co_return stream;
  }

  awaitable<HttpAnswer> state(const Request& request) {
    std::string text = run.state();
    if (!accepts_gzip(view_of(request[http::field::accept_encoding]))) {
      co_return text_answer(request, http::status::ok, std::move(text), "application/json");
    }
    Download download{"application/json", etag_of(text), true, AnswerPolicy::kPage, {}, {}};
    download.prepared = co_await compressed("/api/state", download.etag, text);
    co_return download_answer(request, std::move(download));
  }

  /// The file that a GET asks for, if it asks for one.
  std::optional<ServedFile> asked_file(const std::string& path) {
    constexpr std::string_view kFiles = "/files/", kPhoto = "/api/photo/";
    if (path.starts_with(kFiles)) return run.file(std::string_view(path).substr(kFiles.size()));
    if (path.starts_with(kPhoto)) return run.photo(std::string_view(path).substr(kPhoto.size()));
    return {};
  }

  awaitable<HttpAnswer> file_answer(const Request& request, ServedFile file) {
    Download download{std::string(content_type_of(file.path())), file.etag(), false, AnswerPolicy::kFile, {}, {}};
    const bool shortens = is_text_type(download.type) && file.size() >= kSmallestText && file.size() <= kLargestText;
    // A range counts the bytes of the file, not those of a stream.
    if (shortens && request[http::field::range].empty() &&
        accepts_gzip(view_of(request[http::field::accept_encoding]))) {
      const std::string name = file.path().string();
      download.prepared = texts.find(name, file.etag());
      if (!download.prepared) {
        const auto text = file.content(kLargestText);
        if (text) download.prepared = co_await compressed(name, file.etag(), *text);
      }
      if (download.prepared) {
        download.gzip = true;
        download.etag.insert(download.etag.size() - 1, "-gzip");
      }
    }
    if (!download.prepared) download.file = std::move(file);
    co_return download_answer(request, std::move(download));
  }

  /// A training draws itself only while somebody looks on.
  void ask_for_snapshot() {
    const auto now = std::chrono::steady_clock::now();
    if (now - snapshot_asked < kSnapshotTime) return;
    snapshot_asked = now;
    run.ask_for_snapshot();
  }

  /// Sends new events and scene versions until the client goes away.
  awaitable<void> send_events(HttpConnection& connection, const Request& request) {
    const Counted listening(listeners);
    std::string_view from = view_of(request["Last-Event-ID"]);
    if (from.empty()) from = query_value(view_of(request.target()), "from");
    HttpAnswer head = text_answer(request, http::status::ok, "", "text/event-stream");
    head.head.erase(http::field::content_length);
    head.head.keep_alive(false);
    co_await connection.write(request, std::move(head));
    if (request.method() == http::verb::head) co_return;
    EventStream events(run, from, started);
    net::steady_timer timer(io);
    while (!connection.gone()) {
      ask_for_snapshot();
      const std::string message = events.next(std::chrono::steady_clock::now());
      co_await connection.write(message);
      if (events.has_more()) continue;
      timer.expires_after(kWatchTime);
      co_await timer.async_wait(use_awaitable);
    }
  }

  awaitable<HttpAnswer> answer(const Request& request) {
    const std::string path = *decode_request_path(view_of(request.target()));
    if (request.method() == http::verb::post) co_return co_await post(request, path);
    if (path == "/api/state") co_return co_await state(request);
    if (path == "/api/events") co_return refusal(request, http::status::service_unavailable, "too many pages are open");
    if (auto file = asked_file(path)) co_return co_await file_answer(request, std::move(*file));
    std::string name;
    if (const GetHandler* handler = get_handler(path, name)) {
      co_return co_await get_answer(request, path, *handler, name);
    }
    const std::vector<std::string> first = path == "/" ? run.first_requests() : std::vector<std::string>();
    co_return page_answer(request, path, {options.web_root, first, token});
  }

  awaitable<void> serve_connection(tcp::socket socket) {
    HttpConnection connection(std::move(socket), options.limits);
    try {
      auto slot = slots.take([&connection] { connection.close(); });
      if (!slot) {
        Request unread;
        unread.version(11);
        co_await connection.write(unread,
                                  refusal(unread, http::status::service_unavailable, "too many connections are open"));
        co_await connection.end();
        co_return;
      }
      for (;;) {
        slot->idle();
        const std::optional<Request> request =
            co_await connection.read([this](const Request& head) { return refusal_of(head, options, token); });
        if (!request || slot->closed()) break;
        slot->busy();
        const auto path = decode_request_path(view_of(request->target()));
        if (*path == "/api/events" && listeners < kMaxListeners) {
          co_await send_events(connection, *request);
          break;
        }
        HttpAnswer answered = co_await answer(*request);
        if (!co_await connection.write(*request, std::move(answered))) break;
      }
    } catch (const boost::system::system_error&) {
      // The client went away or took nothing for too long: its connection ends.
    }
  }

  awaitable<void> accept_connections() {
    for (;;) {
      beast::error_code error;
      tcp::socket socket = co_await acceptor.async_accept(net::redirect_error(use_awaitable, error));
      if (error) {
        if (error == net::error::operation_aborted) co_return;
        net::steady_timer pause(io, 100ms);  // out of file handles, for example
        co_await pause.async_wait(use_awaitable);
        continue;
      }
      net::co_spawn(io, serve_connection(std::move(socket)), net::detached);
    }
  }
};

ViewServer::ViewServer(ViewServerOptions options) : state_(std::make_unique<State>(std::move(options))) {}
ViewServer::~ViewServer() = default;

uint16_t ViewServer::port() const { return state_->acceptor.local_endpoint().port(); }
const std::string& ViewServer::token() const { return state_->token; }

void ViewServer::run(const std::function<bool()>& stop) {
  net::co_spawn(state_->io, state_->accept_connections(), net::detached);
  while (!stop()) state_->io.run_for(50ms);
}

}  // namespace aligngs
