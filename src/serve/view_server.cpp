#include "serve/view_server.h"

// Asio 1.74 does not find clang's coroutines by itself, and uses std::exchange without including <utility>.
#if defined(__clang__)
#define BOOST_ASIO_HAS_CO_AWAIT 1
#define BOOST_ASIO_HAS_STD_COROUTINE 1
#endif
#include <utility>

#include <boost/asio.hpp>
#include <boost/beast.hpp>

#include <chrono>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"
#include "serve/request_rules.h"
#include "serve/served_run.h"
#include "serve/web_page.h"

namespace aligngs {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using tcp = net::ip::tcp;
using net::awaitable;
using net::use_awaitable;
using namespace std::chrono_literals;

namespace {

constexpr uint16_t kFirstPort = 7860, kPortsTried = 100;
constexpr uint32_t kHeaderLimit = 16 * 1024, kBodyLimit = 64 * 1024;  // bytes
constexpr size_t kMaxWaiting = 16;  // handlers that wait for their turn
constexpr auto kRequestTime = 15s, kFileTime = 120s, kPingTime = 10s;
constexpr auto kWatchTime = 500ms;     // between looks at the run folder
constexpr auto kSnapshotTime = 2000ms;  // between requests for live snapshots; the trainer may take longer
constexpr int kMaxListeners = 32;  // open event streams

/// Failure of a handler, as an error for the page.
Error error_of(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return Error({ErrorKind::kResources, "out of memory", {}, {}, {}});
  } catch (const std::exception& error) {
    return Error({ErrorKind::kFailed, error.what(), {}, {}, {}});
  }
}

/// JSON that cannot hurt: no deeper than any request of the page.
bool acceptable_json(const std::string& body) {
  constexpr int kDeepest = 8;
  int depth = 0;
  for (const char c : body) {
    depth += (c == '{' || c == '[') - (c == '}' || c == ']');
    if (depth > kDeepest) return false;
  }
  return nlohmann::json::accept(body);
}

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

using Request = http::request<http::string_body>;

constexpr const char* kPagePolicy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self' blob:; "
    "object-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
/// A report with its pictures may be looked at; nothing in a run folder may run.
constexpr const char* kFilePolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

template <class Response>
void harden(Response& response, const char* policy = kPagePolicy) {
  response.set(http::field::server, "aligngs");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Content-Security-Policy", policy);
  response.set(http::field::cache_control, "no-store");
}

}  // namespace

struct ViewServer::State {
  ViewServerOptions options;
  ServedRun run;
  std::string token = random_token();
  int listeners = 0;
  size_t waiting = 0;
  std::chrono::steady_clock::time_point snapshot_asked{};
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  net::thread_pool workers{1};  // last: handlers end before the connections they answer

  explicit State(ViewServerOptions given) : options(std::move(given)), run(options.run, options.expect_run) { listen(); }
  ~State() {
    workers.stop();
    workers.join();
  }

  void listen() {
    const uint16_t first = options.port != 0 ? options.port : kFirstPort;
    const int tries = options.port != 0 ? 1 : kPortsTried;
    for (int i = 0; i < tries; ++i) {
      const tcp::endpoint end(net::ip::address_v4::loopback(), static_cast<uint16_t>(first + i));
      beast::error_code error;
      acceptor.open(end.protocol(), error);
      if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
      if (!error) acceptor.bind(end, error);
      if (!error) acceptor.listen(net::socket_base::max_listen_connections, error);
      if (!error) return;
      acceptor.close(error);
    }
    throw_resources({}, options.port != 0 ? "port " + std::to_string(options.port) + " is in use" : "no port is free",
                    "choose another one with --port");
  }

  /// The answer to everything but files and event streams.
  http::response<http::string_body> answer(const Request& request, http::status status, std::string body,
                                           std::string_view type) const {
    http::response<http::string_body> response{status, request.version()};
    harden(response);
    response.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response.keep_alive(request.keep_alive() && status == http::status::ok);
    response.body() = std::move(body);
    response.prepare_payload();
    if (request.method() == http::verb::head) {
      const auto size = response.body().size();
      response.body().clear();
      response.content_length(size);
    }
    return response;
  }

  http::response<http::string_body> refuse(const Request& request, http::status status, const char* why) const {
    return answer(request, status, json_line(nlohmann::json{{"error", why}}), "application/json");
  }

  http::response<http::string_body> page(const Request& request, const std::string& path) const {
    const std::string name = path == "/" ? "/index.html" : path;
    std::string body;
    bool compressed = false;
    if (!options.web_root.empty()) {
      std::error_code error;
      const auto root = std::filesystem::canonical(options.web_root, error);
      const auto file = error ? std::nullopt : file_below(root, name.substr(1));
      if (!file) return refuse(request, http::status::not_found, "not found");
      http::file_body::value_type content;
      beast::error_code failed;
      content.open(file->c_str(), beast::file_mode::scan, failed);
      if (failed) return refuse(request, http::status::not_found, "not found");
      body.resize(static_cast<size_t>(content.size()));
      body.resize(content.file().read(body.data(), body.size(), failed));
    } else {
      const auto content = embedded_page_file(name);
      if (content.empty()) return refuse(request, http::status::not_found, "not found");
      body.assign(reinterpret_cast<const char*>(content.data()), content.size());
      compressed = true;
    }
    auto response = answer(request, http::status::ok, std::move(body), content_type_of(name));
    if (compressed) response.set(http::field::content_encoding, "gzip");
    if (path == "/") {
      const std::string_view host = view_of(request[http::field::host]);
      response.set(http::field::set_cookie, "aligngs_" + std::string(port_of(host)) + "=" + token + "; SameSite=Strict; Path=/");
    }
    return response;
  }

  /// Runs a handler on the worker's thread, one at a time, while pages and events go on being served.
  template <class Result, class Handler>
  awaitable<Result> on_worker(const Handler& handler) {
    struct Turn {
      size_t& n;
      explicit Turn(size_t& count) : n(count) { ++n; }
      ~Turn() { --n; }
    } turn(waiting);
    co_return co_await net::co_spawn(
        workers.get_executor(), [&handler]() -> awaitable<Result> { co_return handler(); }, use_awaitable);
  }

  /// The error as JSON. Asking for nonsense is the page's fault, the rest is ours.
  http::response<http::string_body> refuse(const Request& request, const Error& error) const {
    const bool theirs = error.kind() == ErrorKind::kUsage || error.kind() == ErrorKind::kBadInput;
    const nlohmann::json body = {{"error", error.details().message}, {"remedy", error.details().remedy}, {"field", error.details().field}};
    return answer(request, theirs ? http::status::bad_request : http::status::internal_server_error, json_line(body), "application/json");
  }

  awaitable<http::response<http::string_body>> post(const Request& request, const std::string& path) {
    PostHeaders headers;
    headers.host = view_of(request[http::field::host]);
    headers.origin = view_of(request[http::field::origin]);
    headers.token = view_of(request["X-AlignGS-Token"]);
    headers.content_type = view_of(request[http::field::content_type]);
    if (!post_allowed(headers, token)) co_return refuse(request, http::status::forbidden, "wrong origin, token or content type");
    const auto handler = options.post.find(path);
    if (handler == options.post.end()) co_return refuse(request, http::status::not_found, "not found");
    if (!acceptable_json(request.body())) co_return refuse(request, http::status::bad_request, "the body is not JSON");
    if (waiting >= kMaxWaiting) co_return refuse(request, http::status::service_unavailable, "too many requests wait");
    const std::string& given = request.body();
    const PostHandler& call = handler->second;
    std::exception_ptr failure;
    std::string body;
    try {
      const auto work = [&call, &given] { return call(given); };
      body = co_await on_worker<std::string>(work);
    } catch (...) {
      failure = std::current_exception();
    }
    if (failure) co_return refuse(request, error_of(failure));
    co_return answer(request, http::status::ok, std::move(body), "application/json");
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

  awaitable<http::response<http::string_body>> get_answer(const Request& request, const GetHandler& handler, const std::string& name) {
    if (waiting >= kMaxWaiting) co_return refuse(request, http::status::service_unavailable, "too many requests wait");
    std::exception_ptr failure;
    std::optional<GetAnswer> found;
    try {
      const auto work = [&handler, &name] { return handler(name); };
      found = co_await on_worker<std::optional<GetAnswer>>(work);
    } catch (...) {
      failure = std::current_exception();
    }
    if (failure) co_return refuse(request, error_of(failure));
    if (!found) co_return refuse(request, http::status::not_found, "not found");
    const std::string type = found->type;
    co_return answer(request, http::status::ok, std::move(found->body), type);
  }

  /// The file that a GET asks for, if it asks for one.
  std::optional<std::filesystem::path> asked_file(const std::string& path) const {
    constexpr std::string_view kFiles = "/files/", kPhoto = "/api/photo/";
    if (path.compare(0, kFiles.size(), kFiles) == 0) return run.file(std::string_view(path).substr(kFiles.size()));
    if (path.compare(0, kPhoto.size(), kPhoto) == 0) return run.photo(std::string_view(path).substr(kPhoto.size()));
    return {};
  }

  /// A training draws itself only while somebody looks on.
  void ask_for_snapshot() {
    const auto now = std::chrono::steady_clock::now();
    if (now - snapshot_asked < kSnapshotTime) return;
    snapshot_asked = now;
    run.ask_for_snapshot();
  }

  /// Sends new events and scene versions until the client goes away.
  awaitable<void> stream_events(beast::tcp_stream& stream, const Request& request) {
    struct Count {
      int& n;
      explicit Count(int& count) : n(count) { ++n; }
      ~Count() { --n; }
    } count(listeners);
    std::string_view from = view_of(request["Last-Event-ID"]);
    if (from.empty()) from = query_value(view_of(request.target()), "from");
    uint64_t offset = 0;
    for (size_t i = 0; i < from.size() && i < 15 && from[i] >= '0' && from[i] <= '9'; ++i) {
      offset = offset * 10 + static_cast<uint64_t>(from[i] - '0');
    }
    http::response<http::empty_body> head{http::status::ok, request.version()};
    harden(head);
    head.set(http::field::content_type, "text/event-stream");
    head.keep_alive(false);
    http::response_serializer<http::empty_body> serializer(head);
    stream.expires_after(kRequestTime);
    co_await http::async_write_header(stream, serializer, use_awaitable);
    net::steady_timer timer(stream.get_executor());
    std::string version = "none";
    auto last_sent = std::chrono::steady_clock::now();
    std::string message = "retry: 1000\n\n";
    for (;;) {
      ask_for_snapshot();
      const std::string lines = run.events(offset);
      if (!lines.empty()) {
        std::string array = lines;
        array.pop_back();
        for (char& c : array) c = c == '\n' ? ',' : c == '\r' ? ' ' : c;
        message += "id: " + std::to_string(offset) + "\nevent: events\ndata: [" + array + "]\n\n";
      }
      const std::string now_version = run.signature();
      if (now_version != version) {
        version = now_version;
        message += "event: state\ndata: " + json_line(nlohmann::json(version)) + "\n\n";
      }
      const auto now = std::chrono::steady_clock::now();
      if (message.empty() && now - last_sent > kPingTime) message = ": ping\n\n";
      if (!message.empty()) {
        stream.expires_after(kRequestTime);
        co_await net::async_write(stream, net::buffer(message), use_awaitable);
        message.clear();
        last_sent = now;
        if (!lines.empty()) continue;  // a long history comes in parts
      }
      timer.expires_after(kWatchTime);
      co_await timer.async_wait(use_awaitable);
    }
  }

  awaitable<void> serve_connection(tcp::socket socket) {
    beast::tcp_stream stream(std::move(socket));
    beast::error_code ignored;
    stream.socket().set_option(tcp::no_delay(true), ignored);
    beast::flat_buffer buffer;
    try {
      for (;;) {
        http::request_parser<http::string_body> parser;
        parser.header_limit(kHeaderLimit);
        parser.body_limit(kBodyLimit);
        stream.expires_after(kRequestTime);
        co_await http::async_read(stream, buffer, parser, use_awaitable);
        const Request request = parser.release();
        const bool get = request.method() == http::verb::get || request.method() == http::verb::head;
        const auto path = decode_request_path(view_of(request.target()));
        std::optional<http::response<http::string_body>> response;
        if (!host_allowed(view_of(request[http::field::host]), options.allowed_hosts)) {
          response = refuse(request, http::status::forbidden, "this host name is not served; see --allow-host");
        } else if (!path) {
          response = refuse(request, http::status::bad_request, "bad path");
        } else if (request.method() == http::verb::post) {
          response = co_await post(request, *path);
        } else if (!get) {
          response = refuse(request, http::status::method_not_allowed, "only GET, HEAD and POST are served");
        } else if (*path == "/api/state") {
          response = answer(request, http::status::ok, run.state(), "application/json");
        } else if (*path == "/api/events") {
          if (listeners < kMaxListeners) {
            co_await stream_events(stream, request);
            break;
          }
          response = refuse(request, http::status::service_unavailable, "too many pages are open");
        } else if (const auto file = asked_file(*path)) {
          http::response<http::file_body> sent{http::status::ok, request.version()};
          beast::error_code failed;
          sent.body().open(file->c_str(), beast::file_mode::scan, failed);
          if (!failed && get && request.method() == http::verb::get) {
            harden(sent, kFilePolicy);
            const std::string_view type = content_type_of(*file);
            sent.set(http::field::content_type, beast::string_view(type.data(), type.size()));
            sent.keep_alive(request.keep_alive());
            sent.prepare_payload();
            stream.expires_after(kFileTime);
            co_await http::async_write(stream, sent, use_awaitable);
            if (!request.keep_alive()) break;
            continue;
          }
          response = failed ? refuse(request, http::status::not_found, "not found")
                            : answer(request, http::status::ok, "", content_type_of(*file));
        } else if (std::string name; const GetHandler* handler = get_handler(*path, name)) {
          response = co_await get_answer(request, *handler, name);
        } else {
          response = page(request, *path);
        }
        stream.expires_after(kRequestTime);
        co_await http::async_write(stream, *response, use_awaitable);
        if (!response->keep_alive()) break;
      }
    } catch (const boost::system::system_error&) {
      // The client went away, or sent too much, too slowly, or something that is not HTTP: its connection ends.
    }
    stream.socket().shutdown(tcp::socket::shutdown_both, ignored);
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
  while (!stop()) state_->io.run_for(200ms);
}

}  // namespace aligngs
