// One connection of the server: requests in, answers out, with limits of time and size.
#pragma once

#include <functional>
#include <optional>

#include "serve/http_answer.h"
#include "serve/http_types.h"
#include "serve/view_server.h"

namespace aligngs {

/// Reads requests from one client and writes the answers.
class HttpConnection {
 public:
  HttpConnection(net::ip::tcp::socket socket, const ServerLimits& limits);

  /// The next request, or nothing when the client is gone. `refuse` sees the request before its body is read; what it
  /// answers is sent instead, and the connection ends. So it does with requests that are too large (413, 431) or no
  /// HTTP (400).
  net::awaitable<std::optional<Request>> read(const std::function<std::optional<HttpAnswer>(const Request&)>& refuse);

  /// Sends an answer; without its body to HEAD. Returns whether the connection goes on.
  net::awaitable<bool> write(const Request& request, HttpAnswer answer);
  /// Sends bytes of an answer that has begun.
  net::awaitable<void> write(std::string_view bytes);

  /// The client has closed its side; an event stream has nothing else to notice it by.
  bool gone();
  void close();  ///< at once; reading and writing end
  /// Ends the answer and reads on for a moment: a client that still sends would otherwise lose what it was told.
  net::awaitable<void> end();

 private:
  net::awaitable<std::optional<Request>> answered(const Request& request, HttpAnswer answer);
  /// Reads a body in chunks. Bytes that cannot become a chunk are an error at once.
  net::awaitable<void> read_chunks(http::request_parser<http::string_body>& parser, beast::error_code& error);

  ServerLimits limits_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
};

}  // namespace aligngs
