#include "priors/http_download.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <thread>

#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/stop_signal.h"
#include "core/version.h"

#if defined(ALIGNGS_WITH_CURL)
#include <curl/curl.h>
#endif

namespace aligngs {

namespace fs = std::filesystem;

fs::path part_of(const fs::path& target) { return target.string() + ".part"; }

#if !defined(ALIGNGS_WITH_CURL)

bool can_download() { return false; }

uint64_t download_to_part(const DownloadRequest& request) {
  throw Error({ErrorKind::kFailed, "this program was built without libcurl and cannot download", request.target, "",
               "fetch " + request.url +
                   " another way and `aligngs models import` it, or install "
                   "libcurl4-openssl-dev and build again"});
}

#else

bool can_download() { return true; }

namespace {

constexpr long kOk = 200, kPartial = 206, kUnauthorised = 401, kForbidden = 403, kNotFound = 404,
               kRangeNotSatisfiable = 416, kServerError = 500;

/// The file that grows, appended to or begun again as the server's answer demands.
class PartFile {
 public:
  explicit PartFile(fs::path path) : path_(std::move(path)) {
    std::error_code error;
    fs::create_directories(path_.parent_path(), error);
    descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw_resources(path_, std::strerror(errno), "choose a folder that you may write to with ALIGNGS_MODELS");
    }
  }
  ~PartFile() {
    close(descriptor_);
    std::error_code error;
    if (size() > 0) return;  // something to go on from
    fs::remove(path_, error);
    fs::remove(note(), error);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  uint64_t size() const {
    std::error_code error;
    const uintmax_t bytes = fs::file_size(path_, error);
    return error ? 0 : uint64_t(bytes);
  }
  /// The version of the file on the server. A part without it might be continued by another version.
  void write_note(const std::string& etag) {
    std::ofstream out(note(), std::ios::trunc);
    out << etag;
    out.close();
    if (!out) fail();
  }
  std::string read_note() const {
    std::string etag;
    std::ifstream in(note());
    std::getline(in, etag);
    return etag;
  }
  /// An empty part does not outlive this object.
  void clear() {
    if (ftruncate(descriptor_, 0) != 0) fail();
  }
  void append(const char* data, size_t bytes) {
    while (bytes > 0) {
      const ssize_t n = write(descriptor_, data, bytes);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) fail();
      data += n;
      bytes -= size_t(n);
    }
  }
  void flush() {
    if (fsync(descriptor_) != 0) fail();
  }

 private:
  fs::path note() const { return path_.string() + ".etag"; }
  [[noreturn]] void fail() const {
    throw_resources(path_, std::strerror(errno),
                    "free space there, or choose another folder with ALIGNGS_MODELS; run the same "
                    "command again to go on");
  }

  fs::path path_;
  int descriptor_ = -1;
};

std::string header_value(const std::string& line, const char* name) {
  const size_t length = std::strlen(name);
  if (line.size() <= length || strncasecmp(line.c_str(), name, length) != 0) return {};
  const size_t begin = line.find_first_not_of(" \t", length);
  const size_t end = line.find_last_not_of(" \t\r\n");
  return begin == std::string::npos || end < begin ? "" : line.substr(begin, end - begin + 1);
}

/// One connection.
struct Transfer {
  const DownloadRequest* request = nullptr;
  PartFile* part = nullptr;
  CURL* curl = nullptr;
  uint64_t offset = 0;       ///< bytes that were there before
  uint64_t received = 0;     ///< of the body
  uint64_t range_total = 0;  ///< of Content-Range
  std::string etag;
  bool begun = false;
  std::exception_ptr failure;

  long status() const {
    long code = 0;
    curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &code);
    return code;
  }
  uint64_t total() const {
    if (range_total > 0) return range_total;
    curl_off_t length = -1;
    curl_easy_getinfo(curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
    return length >= 0 ? (status() == kPartial ? offset : 0) + uint64_t(length) : 0;
  }
};

size_t on_header(char* data, size_t size, size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  const std::string line(data, size * count);
  if (line.rfind("HTTP/", 0) == 0) {  // a new answer, e.g. after a redirection
    transfer.etag.clear();
    transfer.range_total = 0;
  }
  const std::string etag = header_value(line, "etag:");
  if (!etag.empty()) transfer.etag = etag;
  const std::string range = header_value(line, "content-range:");
  const size_t slash = range.find('/');
  if (slash != std::string::npos) transfer.range_total = std::strtoull(range.c_str() + slash + 1, nullptr, 10);
  return size * count;
}

size_t on_body(char* data, size_t size, size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  const long status = transfer.status();
  if (status != kOk && status != kPartial) return size * count;  // the text of an error
  try {
    if (!transfer.begun) {
      transfer.begun = true;
      if (status == kOk && transfer.offset > 0) {  // the whole file: another version, or no ranges
        transfer.part->clear();
        transfer.offset = 0;
      }
      if (transfer.part->read_note() != transfer.etag) transfer.part->write_note(transfer.etag);
    }
    transfer.part->append(data, size * count);
  } catch (...) {
    transfer.failure = std::current_exception();
    return 0;
  }
  transfer.received += size * count;
  if (transfer.request->progress) transfer.request->progress(transfer.offset + transfer.received, transfer.total());
  return size * count;
}

int on_progress(void*, curl_off_t, curl_off_t, curl_off_t, curl_off_t) { return stop_requested() ? 1 : 0; }

struct CurlFree {
  void operator()(CURL* curl) const { curl_easy_cleanup(curl); }
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

void set_protocols(CURL* curl, const std::string& url) {
  // A redirection from https to http would give up what https is for.
  const bool secure = url.rfind("https:", 0) == 0;
#if LIBCURL_VERSION_NUM >= 0x075500
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS_STR, secure ? "https" : "http,https");
#else
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS, long(CURLPROTO_HTTP | CURLPROTO_HTTPS));
  curl_easy_setopt(curl, CURLOPT_REDIR_PROTOCOLS, long(secure ? CURLPROTO_HTTPS : CURLPROTO_HTTP | CURLPROTO_HTTPS));
#endif
}

/// Outcome of one connection.
struct Outcome {
  bool complete = false;
  bool worth_retrying = false;
  std::string reason;
};

Outcome outcome_of(CURLcode code, const Transfer& transfer, const char* detail) {
  const long status = transfer.status();
  const uint64_t have = transfer.offset + transfer.received;
  const uint64_t total = transfer.total();
  if (status == kRangeNotSatisfiable) {
    // Complete already, or longer than the file on the server.
    if (transfer.range_total > 0 && transfer.range_total == transfer.offset) return {true, false, ""};
    transfer.part->clear();
    return {false, true, "the server has a shorter file than the part on disk; beginning again"};
  }
  if (code == CURLE_OK && (status == kOk || status == kPartial)) {
    if (total == 0 || have == total) return {true, false, ""};
    return {false, true, fmt::format("the connection ended after {} of {} bytes", have, total)};
  }
  if (code == CURLE_OK && status > 0) {
    return {false, status >= kServerError, fmt::format("the server answered {}", status)};
  }
  const std::string text = *detail ? detail : curl_easy_strerror(code);
  if (total > have && have > 0) return {false, true, fmt::format("{} (after {} of {} bytes)", text, have, total)};
  return {false, true, text};
}

std::string remedy_for(long status) {
  const std::string go_on = "run the same command again: the download resumes";
  if (status == kUnauthorised || status == kForbidden) {
    return "fill in the publisher's form on the web page of the model, then set HF_TOKEN to a token with access";
  }
  if (status == kNotFound) {
    return "the file has moved: download it by hand for `aligngs models import`, or name a mirror with --from URL";
  }
  return go_on;
}

}  // namespace

uint64_t download_to_part(const DownloadRequest& request) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  const std::unique_ptr<CURL, CurlFree> curl(ready == CURLE_OK ? curl_easy_init() : nullptr);
  if (!curl) throw Error({ErrorKind::kFailed, "libcurl does not start", {}, "", ""});
  PartFile part(part_of(request.target));
  double pause = request.first_pause;
  uint64_t farthest = part.size();
  for (int attempt = 1;; ++attempt) {
    Transfer transfer;
    transfer.request = &request;
    transfer.part = &part;
    transfer.curl = curl.get();
    transfer.offset = part.size();
    char detail[CURL_ERROR_SIZE] = "";
    curl_easy_reset(curl.get());
    curl_easy_setopt(curl.get(), CURLOPT_URL, request.url.c_str());
    curl_easy_setopt(curl.get(), CURLOPT_USERAGENT, (std::string("aligngs/") + version()).c_str());
    curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION, 1L);
    curl_easy_setopt(curl.get(), CURLOPT_MAXREDIRS, 10L);
    set_protocols(curl.get(), request.url);
    curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(curl.get(), CURLOPT_CONNECTTIMEOUT, 30L);     // seconds
    curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_LIMIT, 1000L);  // bytes per second ...
    curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_TIME, 60L);     // ... for so long: given up
    curl_easy_setopt(curl.get(), CURLOPT_ERRORBUFFER, detail);
    curl_easy_setopt(curl.get(), CURLOPT_HEADERFUNCTION, on_header);
    curl_easy_setopt(curl.get(), CURLOPT_HEADERDATA, &transfer);
    curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, on_body);
    curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, &transfer);
    curl_easy_setopt(curl.get(), CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(curl.get(), CURLOPT_XFERINFOFUNCTION, on_progress);
    if (!request.bearer_token.empty()) {
      curl_easy_setopt(curl.get(), CURLOPT_HTTPAUTH, long(CURLAUTH_BEARER));
      curl_easy_setopt(curl.get(), CURLOPT_XOAUTH2_BEARER, request.bearer_token.c_str());
    }
    std::unique_ptr<curl_slist, CurlFree> headers;
    if (transfer.offset > 0) {
      curl_easy_setopt(curl.get(), CURLOPT_RANGE, fmt::format("{}-", transfer.offset).c_str());
      const std::string etag = part.read_note();
      if (!etag.empty() && etag.rfind("W/", 0) != 0) {  // weak tags cannot guard a range
        headers.reset(curl_slist_append(nullptr, ("If-Range: " + etag).c_str()));
        curl_easy_setopt(curl.get(), CURLOPT_HTTPHEADER, headers.get());
      }
    }
    const CURLcode code = curl_easy_perform(curl.get());
    if (transfer.failure) std::rethrow_exception(transfer.failure);
    const auto end_if_stopped = [&] {
      if (!stop_requested()) return;
      throw Error({ErrorKind::kInterrupted, "the download was stopped", part_of(request.target), "",
                   "run the same command again: the download resumes"});
    };
    end_if_stopped();
    const Outcome outcome = outcome_of(code, transfer, detail);
    if (outcome.complete) break;
    // Attempts count from the last one that got farther than all before it.
    if (part.size() > farthest) {
      attempt = 0;
      pause = request.first_pause;
    }
    farthest = std::max(farthest, part.size());
    if (!outcome.worth_retrying || attempt >= request.attempts) {
      throw Error({ErrorKind::kFailed, request.url + ": " + outcome.reason, part_of(request.target), "",
                   remedy_for(transfer.status())});
    }
    log_warning("{}; trying again in {:.0f} s", outcome.reason, pause);
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(pause);
    while (std::chrono::steady_clock::now() < end) {
      end_if_stopped();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));  // unnoticed by a waiting person
    }
    pause = std::min(2 * pause, 60.0);
  }
  part.flush();
  const uint64_t bytes = part.size();
  if (bytes == 0)
    throw Error({ErrorKind::kFailed, request.url + ": the server sent an empty file", part_of(request.target), "",
                 "try again later, or another mirror"});
  if (request.expected_bytes > 0 && bytes != request.expected_bytes) {
    part.clear();
    throw Error(
        {ErrorKind::kFailed,
         fmt::format("{}: the file has {} bytes, the published one {}", request.url, bytes, request.expected_bytes),
         part_of(request.target), "", "try again later, or another mirror; what was downloaded has been removed"});
  }
  return bytes;
}

#endif

}  // namespace aligngs
