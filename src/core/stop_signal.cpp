#include "core/stop_signal.h"

#include <csignal>
#include <initializer_list>
#include <unistd.h>

namespace aligngs {
namespace {

volatile std::sig_atomic_t stop_flag = 0;  // the one thing a signal handler may write

void on_signal(int signal) {
  if (signal == SIGINT && stop_flag) _exit(130);
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
