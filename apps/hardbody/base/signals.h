#pragma once

namespace hardbody {

/// From now on the first SIGINT, SIGTERM, SIGHUP (the terminal is gone) or SIGXCPU (the processor time allowed is used
/// up) only sets a mark, so that a run can save what it has; a SIGINT or SIGTERM after it kills. The other two come
/// more than once for one cause, SIGXCPU each second. Where SIGHUP was ignored, as nohup does, it still is. A closed
/// pipe on stdout or stderr (SIGPIPE), or a file longer than allowed (SIGXFSZ), does not end the run.
void install_signal_handlers();

/// The first of these signals, if one has come, else 0.
int pending_signal();

/// What the shell expects of a program that a signal ended: 130 for SIGINT, 143 for SIGTERM, 129 for SIGHUP, 152 for
/// SIGXCPU.
int exit_status_of(int signal);

/// Whether that is the exit status of a run that one of these signals has stopped.
bool stopped_by_signal(int exit_status);

/// "SIGINT", ...
const char* signal_name(int signal);

}  // namespace hardbody
