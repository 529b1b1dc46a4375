// A client of plain sockets for tests, so that every byte is ours.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace aligngs::test_http {

/// Sends bytes to 127.0.0.1 and reads until the server closes, `until` has arrived, or `seconds` have passed.
inline std::string raw(uint16_t port, const std::string& bytes, const std::string& until = "", int seconds = 5) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  timeval limit{seconds, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(fd);
    return "no connection";
  }
  for (size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = send(fd, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) break;
    sent += static_cast<size_t>(n);
  }
  std::string answer;
  char buffer[4096];
  while (until.empty() || answer.find(until) == std::string::npos) {
    const ssize_t n = recv(fd, buffer, sizeof buffer, 0);
    if (n <= 0) break;
    answer.append(buffer, static_cast<size_t>(n));
  }
  close(fd);
  return answer;
}

inline std::string get(uint16_t port, const std::string& target, const std::string& host = "localhost:9000",
                       int seconds = 5) {
  return raw(port, "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n", "", seconds);
}

/// GET or another method with more headers, each ending with \r\n.
inline std::string ask(uint16_t port, const std::string& method, const std::string& target, const std::string& headers,
                       int seconds = 5) {
  return raw(port,
             method + " " + target + " HTTP/1.1\r\nHost: localhost:9000\r\nConnection: close\r\n" + headers + "\r\n",
             "", seconds);
}

inline std::string post(uint16_t port, const std::string& target, const std::string& headers, const std::string& body,
                        int seconds = 5) {
  return raw(port,
             "POST " + target + " HTTP/1.1\r\nHost: localhost:9000\r\nConnection: close\r\nContent-Length: " +
                 std::to_string(body.size()) + "\r\n" + headers + "\r\n" + body,
             "", seconds);
}

inline int status(const std::string& answer) {
  return answer.compare(0, 9, "HTTP/1.1 ") == 0 ? std::stoi(answer.substr(9, 3)) : 0;
}
/// Value of a header of an answer; empty when it has none.
inline std::string header(const std::string& answer, const std::string& name) {
  const size_t end = answer.find("\r\n\r\n"), at = answer.find("\r\n" + name + ": ");
  if (at == std::string::npos || at > end) return "";
  const size_t begin = at + 4 + name.size();
  return answer.substr(begin, answer.find("\r\n", begin) - begin);
}
inline std::string body(const std::string& answer) {
  const size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? std::string() : answer.substr(end + 4);
}

/// A connection that stays open: for what happens between requests, and for clients that read slowly.
class Client {
 public:
  explicit Client(uint16_t port, int receive_buffer = 0) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval limit{5, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  bool connected() const { return connected_; }
  void send(const std::string& bytes) const { ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  /// At most `most` bytes; empty when the server has closed the connection, or after five seconds.
  std::string receive(size_t most) const {
    std::string bytes(most, '\0');
    const ssize_t n = recv(socket_, bytes.data(), most, 0);
    bytes.resize(n > 0 ? static_cast<size_t>(n) : 0);
    return bytes;
  }

 private:
  int socket_;
  bool connected_ = false;
};

}  // namespace aligngs::test_http
