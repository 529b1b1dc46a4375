#include "serve/request_rules.h"

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "core/letter_case.h"

namespace aligngs {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The host without its port; empty when the brackets of an IPv6 address do not match.
std::string_view without_port(std::string_view host) {
  if (!host.empty() && host[0] == '[') {
    const size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    if (end + 1 < host.size() && host[end + 1] != ':') return {};
    return host.substr(0, end + 1);
  }
  return host.substr(0, host.find(':'));
}

/// Compares without telling by its time how many characters agree.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size() || b.empty()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

bool host_allowed(std::string_view host, const std::vector<std::string>& allowed) {
  const std::string name = lower_case(without_port(host));
  if (name == "localhost" || name == "127.0.0.1" || name == "[::1]") return true;
  return !name.empty() &&
         std::any_of(allowed.begin(), allowed.end(), [&](const std::string& a) { return lower_case(a) == name; });
}

std::optional<AbsoluteTarget> absolute_target(std::string_view target) {
  constexpr std::string_view kScheme = "http://";
  if (lower_case(target.substr(0, kScheme.size())) != kScheme) return {};
  target.remove_prefix(kScheme.size());
  const std::string_view host = target.substr(0, target.find_first_of("/?"));
  if (host.empty() || host.find('@') != std::string_view::npos) return {};
  std::string rest(target.substr(host.size()));
  if (rest.empty() || rest[0] == '?') rest.insert(0, "/");
  return AbsoluteTarget{std::string(host), std::move(rest)};
}

std::string port_of(std::string_view host) {
  const size_t colon = host.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? std::string_view() : host.substr(colon + 1);
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string_view::npos;
  return digits ? std::string(port) : "80";
}

std::optional<std::string> decode_request_path(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  if (path.empty() || path[0] != '/') return {};
  std::string out;
  for (size_t i = 0; i < path.size(); ++i) {
    int c = static_cast<unsigned char>(path[i]);
    if (c == '%') {
      if (i + 2 >= path.size()) return {};
      const int high = hex_digit(path[i + 1]), low = hex_digit(path[i + 2]);
      if (high < 0 || low < 0) return {};
      c = high * 16 + low;
      i += 2;
    }
    if (c < 0x20 || c == 0x7f || c == '\\') return {};
    out.push_back(static_cast<char>(c));
  }
  return out;
}

std::string_view query_value(std::string_view target, std::string_view name) {
  const size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view rest = target.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find('&'));
    rest = item.size() < rest.size() ? rest.substr(item.size() + 1) : std::string_view();
    const size_t equals = item.find('=');
    if (item.substr(0, equals) == name)
      return equals == std::string_view::npos ? std::string_view() : item.substr(equals + 1);
  }
  return {};
}

bool post_allowed(const PostHeaders& h, std::string_view token) {
  if (!h.origin.empty() && h.origin != "http://" + std::string(h.host)) return false;
  constexpr std::string_view kJson = "application/json";
  if (lower_case(h.content_type.substr(0, kJson.size())) != kJson) return false;
  if (h.content_type.size() > kJson.size() && h.content_type[kJson.size()] != ';') return false;
  return same_secret(h.token, token);
}

bool fetch_allowed(const FetchOrigin& origin, bool get, std::string_view path) {
  if (origin.site.empty() || origin.site == "same-origin" || origin.site == "none") return true;
  return get && path == "/" && origin.mode == "navigate" && origin.destination == "document";
}

bool accepts_gzip(std::string_view accept_encoding) {
  while (!accept_encoding.empty()) {
    std::string_view item = accept_encoding.substr(0, accept_encoding.find(','));
    accept_encoding.remove_prefix(std::min(accept_encoding.size(), item.size() + 1));
    while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
    const size_t semicolon = item.find(';');
    const std::string_view name = item.substr(0, semicolon);
    if (name != "gzip" && name != "*") continue;
    const std::string_view weight =
        semicolon == std::string_view::npos ? std::string_view() : item.substr(semicolon + 1);
    // "q=0" refuses it
    return weight.find_first_of("123456789") != std::string_view::npos || weight.find('q') == std::string_view::npos;
  }
  return false;
}

std::string random_token() {
  std::random_device source;
  std::string token;
  for (int i = 0; i < 4; ++i) {
    unsigned value = source();
    for (int k = 0; k < 8; ++k, value >>= 4) token.push_back("0123456789abcdef"[value & 15]);
  }
  return token;
}

std::string_view content_type_of(const std::filesystem::path& path) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kTypes = {
      {{".html", "text/html; charset=utf-8"},
       {".js", "text/javascript; charset=utf-8"},
       {".css", "text/css; charset=utf-8"},
       {".svg", "image/svg+xml"},
       {".png", "image/png"},
       {".jpg", "image/jpeg"},
       {".jpeg", "image/jpeg"},
       {".json", "application/json"},
       {".txt", "text/plain; charset=utf-8"},
       {".toml", "text/plain; charset=utf-8"},
       {".ndjson", "application/x-ndjson"}}};
  const std::string extension = path.extension().string();
  for (const auto& [ending, type] : kTypes) {
    if (extension == ending) return type;
  }
  return "application/octet-stream";
}

bool is_text_type(std::string_view content_type) {
  return content_type.substr(0, 5) == "text/" || content_type == "application/json" ||
         content_type == "application/x-ndjson" || content_type == "image/svg+xml";
}

}  // namespace aligngs
