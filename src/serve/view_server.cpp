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
constexpr uint32_t kHeaderLimit = 16 * 1024, kBodyLimit = 1 << 20;  // bytes
constexpr auto kRequestTime = 15s, kFileTime = 120s, kPingTime = 10s;
constexpr auto kWatchTime = 500ms;  // between looks at the run folder
constexpr int kMaxListeners = 32;  // open event streams

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

using Request = http::request<http::string_body>;

template <class Response>
void harden(Response& response) {
  response.set(http::field::server, "aligngs");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Content-Security-Policy",
               "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
               "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self' blob:; "
               "frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
  response.set(http::field::cache_control, "no-store");
}

}  // namespace

struct ViewServer::State {
  ViewServerOptions options;
  ServedRun run;
  std::string token = random_token();
  net::io_context io{1};
  tcp::acceptor acceptor{io};
  int listeners = 0;

  explicit State(ViewServerOptions given) : options(std::move(given)), run(options.run) { listen(); }

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
    return answer(request, status, nlohmann::json{{"error", why}}.dump(), "application/json");
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
    if (path == "/") response.set(http::field::set_cookie, "aligngs=" + token + "; SameSite=Strict; Path=/");
    return response;
  }

  http::response<http::string_body> post(const Request& request, const std::string& path) const {
    PostHeaders headers;
    headers.host = view_of(request[http::field::host]);
    headers.origin = view_of(request[http::field::origin]);
    headers.token = view_of(request["X-AlignGS-Token"]);
    headers.content_type = view_of(request[http::field::content_type]);
    if (!post_allowed(headers, token)) return refuse(request, http::status::forbidden, "wrong origin, token or content type");
    const auto handler = options.post.find(path);
    if (handler == options.post.end()) return refuse(request, http::status::not_found, "not found");
    if (!nlohmann::json::accept(request.body())) return refuse(request, http::status::bad_request, "the body is not JSON");
    try {
      return answer(request, http::status::ok, handler->second(request.body()), "application/json");
    } catch (const Error& error) {
      const bool theirs = error.kind() == ErrorKind::kUsage || error.kind() == ErrorKind::kBadInput;
      return refuse(request, theirs ? http::status::bad_request : http::status::internal_server_error, error.what());
    }
  }

  /// The file that a GET asks for, if it asks for one.
  std::optional<std::filesystem::path> asked_file(const std::string& path) const {
    constexpr std::string_view kFiles = "/files/", kPhoto = "/api/photo/";
    if (path.compare(0, kFiles.size(), kFiles) == 0) return run.file(std::string_view(path).substr(kFiles.size()));
    if (path.compare(0, kPhoto.size(), kPhoto) == 0) return run.photo(std::string_view(path).substr(kPhoto.size()));
    return {};
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
      const std::string lines = run.events(offset);
      if (!lines.empty()) {
        std::string array = lines;
        array.pop_back();
        for (char& c : array) c = c == '\n' ? ',' : c == '\r' ? ' ' : c;
        message += "id: " + std::to_string(offset) + "\nevent: events\ndata: [" + array + "]\n\n";
      }
      const nlohmann::json state = nlohmann::json::parse(run.state());
      const std::string now_version = state.value("version", "") + "/" + (state["status"].is_string() ? state["status"].get<std::string>() : "");
      if (now_version != version) {
        version = now_version;
        message += "event: state\ndata: " + nlohmann::json(version).dump() + "\n\n";
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
          response = post(request, *path);
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
            harden(sent);
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
