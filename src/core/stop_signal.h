// Ctrl-C and SIGTERM as a question a long loop can ask.
#pragma once

namespace aligngs {

/// Installs handlers for SIGINT, SIGTERM and SIGUSR1. The first signal asks the program to stop at the
/// next safe point; a second SIGINT, half a second later or more, ends the process at once with status 130.
void install_stop_handlers();

/// True once a signal asked the program to stop.
bool stop_requested();

/// For tests, and for programs that stop from inside.
void request_stop();
void clear_stop_request();

}  // namespace aligngs
