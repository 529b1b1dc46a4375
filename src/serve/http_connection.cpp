#include "serve/http_connection.h"

#include <sys/socket.h>

#include <algorithm>
#include <string>

#include "serve/request_rules.h"

namespace aligngs {

using net::awaitable;
using net::use_awaitable;
using namespace std::chrono_literals;

namespace {

constexpr uint32_t kHeaderLimit = 16 * 1024, kBodyLimit = 64 * 1024;  // bytes
constexpr size_t kPiece = 128 * 1024;                                 // bytes read from a file at a time
// The kernel wakes a writer when a third of its buffer is free: with more, a slow client would look like a silent one.
constexpr int kSendBuffer = 128 * 1024;         // bytes
constexpr size_t kMostDiscarded = 1024 * 1024;  // bytes read after the last answer
constexpr auto kDiscardTime = 2s;

constexpr size_t kChunkPiece = 16 * 1024;  // bytes of a chunked body that are read at a time

/// Whether bytes that the parser leaves may become the head of a chunk: an end of line, hexadecimal digits, and what
/// follows them. The parser itself waits for the end of the line, which may never come.
bool may_begin_chunk(std::string_view bytes) {
  if (bytes.size() > kHeaderLimit) return false;
  if (bytes.starts_with("\r\n")) bytes.remove_prefix(2);
  if (bytes.empty() || bytes == "\r") return true;
  const size_t digits = std::min(bytes.find_first_not_of("0123456789abcdefABCDEF"), bytes.size());
  constexpr size_t kMostDigits = 16;  // of a 64-bit number
  if (digits == 0 || digits > kMostDigits) return false;
  const size_t next = bytes.find_first_not_of(" \t", digits);
  return next == std::string_view::npos || bytes[next] == ';' || bytes[next] == '\r';
}

constexpr std::string_view kGoOn = "HTTP/1.1 100 Continue\r\n\r\n";

/// The client sends its body when it has been told to (RFC 9110, section 10.1.1).
bool waits_to_be_asked(const Request& request) {
  return request.version() >= 11 && beast::iequals(request[http::field::expect], "100-continue");
}

/// A target in absolute form says itself which host is meant, and the Host header then counts no more. Headers that
/// break another rule stay as they are, so that they are refused.
void use_origin_form(Request& request) {
  const auto absolute = absolute_target(view_of(request.target()));
  if (!absolute || request.count(http::field::host) != 1) return;
  request.target(absolute->target);
  request.set(http::field::host, absolute->host);
}

/// The answer to what could not be read as a request; nothing for a client that went away.
std::optional<HttpAnswer> answer_to(const beast::error_code& error, const Request& request) {
  if (error == http::error::header_limit) {
    return refusal(request, http::status::request_header_fields_too_large, "the headers are larger than 16 KiB");
  }
  if (error == http::error::body_limit)
    return refusal(request, http::status::payload_too_large, "the body is larger than 64 KiB");
  if (error == http::error::end_of_stream || error == http::error::partial_message) return {};
  if (error.category() == make_error_code(http::error::bad_method).category()) {
    return refusal(request, http::status::bad_request, "this is no HTTP request");
  }
  return {};
}

}  // namespace

HttpConnection::HttpConnection(net::ip::tcp::socket socket, const ServerLimits& limits)
    : limits_(limits), stream_(std::move(socket)) {
  beast::error_code ignored;
  stream_.socket().set_option(net::ip::tcp::no_delay(true), ignored);
  stream_.socket().set_option(net::socket_base::send_buffer_size(kSendBuffer), ignored);
}

awaitable<std::optional<Request>> HttpConnection::answered(const Request& request, HttpAnswer answer) {
  answer.head.keep_alive(false);
  co_await write(request, std::move(answer));
  co_await end();
  co_return std::nullopt;
}

awaitable<std::optional<Request>> HttpConnection::read(
    const std::function<std::optional<HttpAnswer>(const Request&)>& refuse) {
  http::request_parser<http::string_body> parser;
  parser.header_limit(kHeaderLimit);
  parser.body_limit(kBodyLimit);
  beast::error_code error;
  stream_.expires_after(limits_.request);
  co_await http::async_read_header(stream_, buffer_, parser, net::redirect_error(use_awaitable, error));
  if (!error) {
    use_origin_form(parser.get());
    if (auto refused = refuse(parser.get())) co_return co_await answered(parser.get(), std::move(*refused));
    if (!parser.is_done() && waits_to_be_asked(parser.get())) co_await write(kGoOn);
  }
  if (!error && parser.chunked()) co_await read_chunks(parser, error);
  while (!error && !parser.is_done()) {
    stream_.expires_after(limits_.request);
    co_await http::async_read_some(stream_, buffer_, parser, net::redirect_error(use_awaitable, error));
  }
  if (!error) co_return parser.release();
  Request unread;
  unread.method(http::verb::get);
  unread.version(11);
  if (auto told = answer_to(error, unread)) co_return co_await answered(unread, std::move(*told));
  co_return std::nullopt;
}

awaitable<void> HttpConnection::read_chunks(http::request_parser<http::string_body>& parser, beast::error_code& error) {
  while (!error && !parser.is_done()) {
    const size_t taken = buffer_.size() > 0 ? parser.put(buffer_.data(), error) : 0;
    buffer_.consume(taken);
    if (error == http::error::need_more) error = {};
    if (error || parser.is_done() || taken > 0) continue;
    const net::const_buffer rest = buffer_.data();
    if (!may_begin_chunk({static_cast<const char*>(rest.data()), rest.size()})) {
      error = http::error::bad_chunk;
      continue;
    }
    stream_.expires_after(limits_.request);
    const size_t got =
        co_await stream_.async_read_some(buffer_.prepare(kChunkPiece), net::redirect_error(use_awaitable, error));
    buffer_.commit(got);
  }
}

awaitable<void> HttpConnection::write(std::string_view bytes) {
  while (!bytes.empty()) {
    stream_.expires_after(limits_.silence);
    bytes.remove_prefix(co_await stream_.async_write_some(net::buffer(bytes.data(), bytes.size()), use_awaitable));
  }
}

awaitable<bool> HttpConnection::write(const Request& request, HttpAnswer answer) {
  http::response_serializer<http::empty_body> serializer(answer.head);
  stream_.expires_after(limits_.silence);
  co_await http::async_write_header(stream_, serializer, use_awaitable);
  const bool goes_on = answer.head.keep_alive();
  if (request.method() == http::verb::head) co_return goes_on;
  if (!answer.file) {
    const std::string_view body = answer.prepared ? *answer.prepared : answer.text;
    co_await write(body.substr(answer.bytes.first, answer.bytes.count));
    co_return goes_on;
  }
  std::string piece(std::min<uint64_t>(kPiece, answer.bytes.count), '\0');
  for (uint64_t sent = 0; sent < answer.bytes.count;) {
    const size_t wanted = std::min<uint64_t>(piece.size(), answer.bytes.count - sent);
    const size_t got = answer.file->read(answer.bytes.first + sent, {piece.data(), wanted});
    if (got == 0) co_return false;  // the file became shorter than its Content-Length: the connection tells it
    co_await write({piece.data(), got});
    sent += got;
  }
  co_return goes_on;
}

bool HttpConnection::gone() {
  char byte;
  return ::recv(stream_.socket().native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void HttpConnection::close() { stream_.close(); }

awaitable<void> HttpConnection::end() {
  beast::error_code error;
  stream_.socket().shutdown(net::ip::tcp::socket::shutdown_send, error);
  char discarded[4096];
  stream_.expires_after(kDiscardTime);
  for (size_t read = 0; !error && read < kMostDiscarded;) {
    read += co_await stream_.async_read_some(net::buffer(discarded), net::redirect_error(use_awaitable, error));
  }
}

}  // namespace aligngs
