#include "core/stop_signal.h"

#include <csignal>
#include <ctime>
#include <initializer_list>
#include <unistd.h>

namespace aligngs {
namespace {

// timeout(1), shells and build tools deliver one Ctrl-C to the process and to its group: a second signal within this
// time is that echo, a later one is the user's impatience.
constexpr double kEchoSeconds = 0.5;

volatile std::sig_atomic_t stop_flag = 0;
volatile double first_signal_seconds = 0;  // written before stop_flag, and only by the first signal

double monotonic_seconds() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);  // safe in a signal handler
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void on_signal(int signal) {
  const double now = monotonic_seconds();
  if (!stop_flag) first_signal_seconds = now;
  else if (signal == SIGINT && now - first_signal_seconds > kEchoSeconds) _exit(130);
  stop_flag = 1;
}

}  // namespace

void install_stop_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
}

bool stop_requested() { return stop_flag != 0; }
void request_stop() { stop_flag = 1; }
void clear_stop_request() { stop_flag = 0; }

}  // namespace aligngs
