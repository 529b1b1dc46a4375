// A web server on 127.0.0.1 for tests of downloads: one file, with the faults that a test asks for.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace aligngs {

/// How one request is answered.
struct LoopbackAnswer {
  std::string body;
  std::string etag = "\"1\"";
  int status = 200;             ///< other than 200: no body
  bool ranges = true;           ///< honour Range and If-Range
  size_t cut_after = SIZE_MAX;  ///< bytes of this answer's body after which the connection closes
};

class LoopbackServer {
 public:
  /// `answer` is asked per request, with the path and the number of requests before it.
  explicit LoopbackServer(std::function<LoopbackAnswer(const std::string&, int)> answer) : answer_(std::move(answer)) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof(address);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), length) != 0 || listen(listener_, 8) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
      std::abort();
    }
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~LoopbackServer() {
    shutdown(listener_, SHUT_RDWR);
    close(listener_);
    thread_.join();
  }

  std::string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
  std::vector<std::string> requests() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return requests_;
  }

 private:
  void serve() {
    for (;;) {
      const int connection = accept(listener_, nullptr, nullptr);
      if (connection < 0) return;
      handle(connection);
      shutdown(connection, SHUT_WR);
      char rest[256];
      while (read(connection, rest, sizeof(rest)) > 0) {
      }
      close(connection);
    }
  }

  static std::string header(const std::string& request, const std::string& name) {
    const size_t at = request.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const size_t begin = at + name.size() + 4;
    return request.substr(begin, request.find("\r\n", begin) - begin);
  }

  static void send_all(int connection, const std::string& bytes) {
    size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t n = send(connection, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return;
      sent += size_t(n);
    }
  }

  void handle(int connection) {
    std::string request;
    char buffer[2048];
    while (request.find("\r\n\r\n") == std::string::npos) {
      const ssize_t n = read(connection, buffer, sizeof(buffer));
      if (n <= 0) return;
      request.append(buffer, size_t(n));
    }
    int before = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      before = int(requests_.size());
      requests_.push_back(request);
    }
    const size_t path = request.find(' ') + 1;
    const LoopbackAnswer answer = answer_(request.substr(path, request.find(' ', path) - path), before);
    std::string head, body;
    const std::string range = header(request, "Range"), condition = header(request, "If-Range");
    const std::string total = std::to_string(answer.body.size());
    if (answer.status != 200) {
      head = "HTTP/1.1 " + std::to_string(answer.status) + " Refused\r\nContent-Length: 0\r\n";
    } else if (answer.ranges && range.rfind("bytes=", 0) == 0 && (condition.empty() || condition == answer.etag)) {
      const size_t begin = std::strtoull(range.c_str() + 6, nullptr, 10);
      if (begin >= answer.body.size()) {
        head = "HTTP/1.1 416 Range\r\nContent-Range: bytes */" + total + "\r\nContent-Length: 0\r\n";
      } else {
        body = answer.body.substr(begin);
        head = "HTTP/1.1 206 Partial\r\nContent-Range: bytes " + std::to_string(begin) + "-" +
               std::to_string(answer.body.size() - 1) + "/" + total +
               "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
      }
    } else {
      body = answer.body;
      head = "HTTP/1.1 200 OK\r\nContent-Length: " + total + "\r\n";
    }
    send_all(connection, head + "ETag: " + answer.etag + "\r\nConnection: close\r\n\r\n" +
                             body.substr(0, std::min(body.size(), answer.cut_after)));
  }

  std::function<LoopbackAnswer(const std::string&, int)> answer_;
  int listener_ = -1;
  uint16_t port_ = 0;
  mutable std::mutex mutex_;
  std::vector<std::string> requests_;
  std::thread thread_;
};

}  // namespace aligngs
