#include "core/stop_signal.h"

#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <initializer_list>
#include <string_view>
#include <thread>

#include "core/error.h"
#include "core/temporary_paths.h"

namespace aligngs {
namespace {

// timeout(1), shells and build tools deliver one Ctrl-C to the process and to its group. A second signal within this
// time is that echo. A later one is a second request of the user.
constexpr double kEchoSeconds = 0.5;
constexpr long kTickNanoseconds = 50'000'000;  // how soon the watcher sees the end of a deferral
constexpr int kStopped = static_cast<int>(ErrorKind::kInterrupted), kStoppedAtOnce = 130;

// Handlers of signals may touch lock-free atomics and nothing else.
std::atomic<bool> requested{false}, at_once{false};
std::atomic<double> first_signal_seconds{0};  // written before `requested`, and only by the first signal
std::atomic<int> deferrals{0};
thread_local int deferrals_here = 0;
sem_t woken;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<double>::is_always_lock_free);

double monotonic_seconds() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);  // safe in a signal handler
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Safe in a signal handler.
void say(std::string_view text) {
  [[maybe_unused]] const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
}

void on_signal(int signal) {
  const int saved = errno;
  const double now = monotonic_seconds();
  if (!requested.load()) {
    first_signal_seconds = now;
    // In `aligngs ... 2>&1 | tee log` Ctrl-C ends tee as well: what is said from here on must not end the process.
    ::signal(SIGPIPE, SIG_IGN);
    say(signal == SIGINT    ? "\nCtrl-C was heard: stopping (Ctrl-C again ends at once)\n"
        : signal == SIGTERM ? "\nSIGTERM was heard: stopping\n"
        : signal == SIGHUP  ? "\nSIGHUP was heard: stopping\n"
                            : "\nSIGUSR1 was heard: stopping\n");
    requested = true;
  } else if (signal == SIGINT && now - first_signal_seconds > kEchoSeconds) {
    at_once = true;
  }
  sem_post(&woken);
  errno = saved;
}

[[noreturn]] void end(int status) {
  remove_temporary_paths();
  say("stopped; existing output is intact\n");
  ::_exit(status);
}

/// Ends the process when it does not end itself.
void watch() {
  while (sem_wait(&woken) != 0) {
  }
  double since = monotonic_seconds();
  for (;;) {
    if (at_once) end(kStoppedAtOnce);
    if (deferrals > 0) since = monotonic_seconds();
    if (monotonic_seconds() - since > kGraceSeconds) end(kStopped);
    const timespec tick{0, kTickNanoseconds};
    nanosleep(&tick, nullptr);
  }
}

}  // namespace

void install_stop_handlers() {
  sem_init(&woken, 0, 0);
  std::thread(watch).detach();
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  // A write beyond the limit of file sizes (ulimit -f) is an error of that write, after which half a file is removed.
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

bool stop_requested() { return requested.load(std::memory_order_relaxed); }

void stop_if_requested() {
  if (!stop_requested() || deferrals_here > 0) return;
  throw Error({ErrorKind::kInterrupted,
               "stopped by a signal; existing output is intact",
               {},
               {},
               "run the same command again"});
}

StopDeferral::StopDeferral() {
  ++deferrals_here;
  ++deferrals;
}

StopDeferral::~StopDeferral() {
  --deferrals_here;
  --deferrals;
}

bool stop_deferred() { return deferrals_here > 0; }

void request_stop() { requested = true; }
void clear_stop_request() { requested = false; }

}  // namespace aligngs
