#pragma once

namespace hardbody {

/// Installs handlers by which the first SIGINT, SIGTERM, SIGHUP (the terminal is gone) or SIGXCPU (the allowed
/// processor time is used up) only sets a flag, so that a run can save its state. A second SIGINT kills the process.
/// The others are sent more than once for one cause: SIGXCPU each second, SIGTERM by schedulers and dying parents. If
/// SIGHUP was ignored, as with nohup, it remains ignored. A closed pipe on stdout or stderr (SIGPIPE), or a file longer
/// than allowed (SIGXFSZ), does not end the run.
void install_signal_handlers();

/// Restores, when the last of these objects in the process ends, the handlers that were there before the first one: for
/// commands that a process calls beside other work. A signal that has stopped a command is then sent to this process
/// again, for the handler that it would have had. Until then a second SIGINT is ignored. Objects may be of several
/// threads; a signal stops the commands of all.
class SignalScope {
 public:
  SignalScope();
  ~SignalScope();
  SignalScope(const SignalScope&) = delete;
  SignalScope& operator=(const SignalScope&) = delete;
};

/// Makes pending_signal() return kCallerStops in this thread, until the innermost StopScope of the thread ends.
void request_stop();

/// Part of a thread's work that request_stop() stops. When it ends, a request to the part around it is what it was.
class StopScope {
 public:
  StopScope();
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

 private:
  bool around_;
};

/// Number in place of a signal's for commands that are stopped by their caller.
inline constexpr int kCallerStops = 100;

/// Returns the first of these signals, or 0 if none has arrived.
int pending_signal();

/// Returns the exit status that a shell expects of a program ended by a signal: 130 for SIGINT, 143 for SIGTERM, 129
/// for SIGHUP, 152 for SIGXCPU.
int exit_status_of(int signal);

/// Returns whether this is the exit status of a run that one of these signals has stopped.
bool stopped_by_signal(int exit_status);

/// Returns the name, "SIGINT", ...
const char* signal_name(int signal);

}  // namespace hardbody
