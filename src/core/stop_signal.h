// How a command is stopped. There is one mechanism for all of them:
//
//   1. A signal (Ctrl-C, SIGTERM, SIGHUP, SIGUSR1) is answered on standard error at once, and asks the program to stop.
//   2. Stop points look at that request and throw Error{kInterrupted}, whose way out removes what is half-written.
//      Every command passes one: in the loops of ThreadPool, and before a file or folder takes its place
//      (io/atomic_file.h, io/folder_replacement.h). Networks pass one per tensor that they load (nn/weights.h).
//   3. Work that reaches no stop point within kGraceSeconds is ended from outside. Half-written files
//      (core/temporary_paths.h) are removed, and the process ends with status 75. A second Ctrl-C does the same at
//      once, with status 130.
//
// Work that stops itself at a better place, as training does, holds a StopDeferral.
#pragma once

namespace aligngs {

/// A command that was asked to stop has ended within 3. The system takes up to 1.4 of them to take back the memory of a
/// large network on a busy machine.
inline constexpr double kGraceSeconds = 1.5;

/// Installs the handlers, and starts the thread that ends what does not end itself. SIGHUP stays ignored where it is
/// (nohup).
void install_stop_handlers();

/// True once a signal asked the program to stop.
bool stop_requested();

/// A stop point: Error{kInterrupted} once a signal asked the program to stop, unless this thread defers it.
void stop_if_requested();

/// While one lives, stop points in its thread do nothing. Only a second Ctrl-C ends the process from outside. The work
/// looks at stop_requested() itself.
class StopDeferral {
 public:
  StopDeferral();
  ~StopDeferral();
  StopDeferral(const StopDeferral&) = delete;
  StopDeferral& operator=(const StopDeferral&) = delete;
};

/// Whether this thread holds a StopDeferral.
bool stop_deferred();

/// For tests, and for programs that stop from inside.
void request_stop();
void clear_stop_request();

}  // namespace aligngs
