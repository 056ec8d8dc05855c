#pragma once

namespace hardbody {

/// From now on the first SIGINT or SIGTERM only sets a mark, so that a run can save what it has; the second
/// one kills. A closed pipe on stdout or stderr (SIGPIPE), or a file longer than allowed (SIGXFSZ), does not end the
/// run.
void install_signal_handlers();

/// SIGINT or SIGTERM if one has come, else 0.
int pending_signal();

/// What the shell expects of a program that a signal ended: 130 for SIGINT, 143 for SIGTERM.
int exit_status_of(int signal);

/// "SIGINT", "SIGTERM"
const char* signal_name(int signal);

}  // namespace hardbody
