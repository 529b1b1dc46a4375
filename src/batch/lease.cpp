#include "batch/lease.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <ctime>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "core/error.h"
#include "io/file_system_error.h"
#include "io/json_integer.h"
#include "io/json_text.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

constexpr double kNanosecond = 1e-9;         // seconds
constexpr uint64_t kLargestLease = 1 << 16;  // bytes; a lease has one line

fs::path file_of(const fs::path& leases, const std::string& room, int number) {
  return leases / (room + "." + std::to_string(number));
}

/// Numbers of the leases of a room, in no order.
std::vector<int> numbers_of(const fs::path& leases, const std::string& room) {
  std::vector<int> numbers;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(leases, error)) {
    const std::string name = entry.path().filename().string();
    if (name.size() <= room.size() + 1 || name.compare(0, room.size() + 1, room + ".") != 0) continue;
    int number = 0;
    const char* const begin = name.data() + room.size() + 1;
    const char* const end = name.data() + name.size();
    const auto [rest, failed] = std::from_chars(begin, end, number);
    // The room "a.1" has leases "a.1.N", which are none of the room "a".
    if (failed == std::errc() && rest == end && number > 0) numbers.push_back(number);
  }
  return numbers;
}

int highest(const std::vector<int>& numbers) {
  int most = 0;
  for (const int number : numbers) most = std::max(most, number);
  return most;
}

int64_t nanoseconds(const timespec& time) { return int64_t(time.tv_sec) * 1'000'000'000 + time.tv_nsec; }

int64_t touched_at(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? nanoseconds(status.st_mtim) : 0;
}

/// Now by the clock of the file system of `folder`; by this machine's where nothing may be written there.
int64_t file_system_now(const fs::path& folder) {
  const fs::path probe = folder / (".clock-" + host_name() + "-" + std::to_string(getpid()));
  const int descriptor = open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  struct stat status {};
  const bool known = descriptor >= 0 && futimens(descriptor, nullptr) == 0 && fstat(descriptor, &status) == 0;
  if (descriptor >= 0) {
    close(descriptor);
    unlink(probe.c_str());
  }
  if (known) return nanoseconds(status.st_mtim);
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return nanoseconds(now);
}

std::string first_line(const char* file) {
  std::string line;
  std::getline(std::ifstream(file), line);
  return line;
}

/// Names a set of process ids: those of one boot, in one container.
std::string process_space() {
  char link[64] = {};
  const ssize_t length = readlink("/proc/self/ns/pid", link, sizeof(link) - 1);
  return first_line("/proc/sys/kernel/random/boot_id") +
         (length > 0 ? std::string(link, static_cast<size_t>(length)) : "");
}

/// When a process began, in ticks since the boot: tells it from a later one with the same id. Empty when there is none,
/// or a zombie.
std::string beginning_of(int64_t pid) {
  const std::string line = first_line(("/proc/" + std::to_string(pid) + "/stat").c_str());
  const size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return "";
  std::istringstream fields(line.substr(name_end + 1));
  std::string field;
  constexpr int kState = 3, kBeginning = 22;  // proc(5), from 1; the name is the second
  for (int i = kState; i <= kBeginning && fields >> field; ++i) {
    if (i == kState && (field == "Z" || field == "X")) return "";
  }
  return field;
}

/// Whether the holder ran among the processes that are seen here, and is gone.
bool is_known_dead(const nlohmann::json& lease, int64_t pid) {
  const auto text = [&](const char* name) {
    return lease.value(name, nlohmann::json()).is_string() ? lease[name].get<std::string>() : "";
  };
  return pid > 0 && text("process_space") == process_space() && text("beginning") != beginning_of(pid);
}

}  // namespace

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 && name[0] != '\0' ? name : "unknown";
}

LeaseView look_at_lease(const fs::path& leases, const std::string& room, const LeaseTimes& times) {
  LeaseView view;
  view.number = highest(numbers_of(leases, room));
  if (view.number == 0) return view;
  const fs::path file = file_of(leases, room, view.number);
  view.touched = touched_at(file);
  if (view.touched == 0) return {};  // given back meanwhile
  view.age_seconds = static_cast<double>(file_system_now(leases) - view.touched) * kNanosecond;
  view.stale = view.age_seconds > times.stale_seconds;
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  if (text.str().size() > kLargestLease) return view;
  const nlohmann::json lease = parse_json(text.str());
  if (!lease.is_object()) return view;  // its holder has created it, and is about to write
  if (lease.contains("host") && lease["host"].is_string()) view.host = lease["host"].get<std::string>();
  view.pid = integer_member<int64_t>(lease, "pid");
  view.stale = view.stale || is_known_dead(lease, view.pid);
  return view;
}

/// The file of a held lease, and the thread that touches it.
class Lease::Held {
 public:
  Held(fs::path leases, std::string room, int number, double renew_seconds)
      : leases_(std::move(leases)),
        room_(std::move(room)),
        number_(number),
        keeper_([this, renew_seconds] { keep(renew_seconds); }) {}

  ~Held() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    woken_.notify_all();
    keeper_.join();
    std::error_code error;
    // Its own last: until then it is what counts.
    for (const int number : numbers_of(leases_, room_)) {
      if (number < number_) fs::remove(file_of(leases_, room_, number), error);
    }
    fs::remove(file_of(leases_, room_, number_), error);
  }

  /// The folder may have been read before somebody took and gave back lower numbers.
  bool counts() const { return highest(numbers_of(leases_, room_)) == number_; }
  bool lost() const { return lost_; }

 private:
  void keep(double renew_seconds) {
    const fs::path file = file_of(leases_, room_, number_);
    const auto pause = std::chrono::duration<double>(renew_seconds);
    std::unique_lock lock(mutex_);
    while (!woken_.wait_for(lock, pause, [this] { return ending_; })) {
      // A file system that is away for a moment has taken nothing from anybody.
      if (utimensat(AT_FDCWD, file.c_str(), nullptr, 0) != 0 && errno == ENOENT) lost_ = true;
      if (highest(numbers_of(leases_, room_)) > number_) lost_ = true;
    }
  }

  fs::path leases_;
  std::string room_;
  int number_;
  std::atomic<bool> lost_{false};
  bool ending_ = false;
  std::mutex mutex_;
  std::condition_variable woken_;
  std::thread keeper_;  // last: it uses all of the above
};

std::optional<Lease> Lease::take(const fs::path& leases, const std::string& room, const LeaseTimes& times) {
  const LeaseView old = look_at_lease(leases, room, times);
  if (old.held()) return std::nullopt;
  const int number = old.number + 1;
  const fs::path file = file_of(leases, room, number);
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    if (errno == EEXIST) return std::nullopt;
    throw_resources(file, std::string("cannot be created: ") + std::strerror(errno), remedy_for_write(errno));
  }
  const nlohmann::json lease = {{"host", host_name()},
                                {"pid", getpid()},
                                {"process_space", process_space()},
                                {"beginning", beginning_of(getpid())}};
  const std::string text = json_line(lease) + "\n";
  const bool written = ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int reason = errno;
  close(descriptor);
  // removes the file where it is not given to the caller
  auto held = std::make_unique<Held>(leases, room, number, times.renew_seconds);
  if (!written) throw_resources(file, std::string("cannot be written: ") + std::strerror(reason));
  if (!held->counts()) return std::nullopt;
  return Lease(std::move(held));
}

Lease::Lease(std::unique_ptr<Held> held) : held_(std::move(held)) {}
Lease::Lease(Lease&&) noexcept = default;
Lease::~Lease() = default;

bool Lease::lost() const { return held_->lost(); }

}  // namespace aligngs
