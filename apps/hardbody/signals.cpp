#include "signals.h"

#include <csignal>

namespace hardbody {
namespace {

volatile std::sig_atomic_t g_pending = 0;

void on_signal(int signal) {
  if (g_pending != 0) {
    std::signal(signal, SIG_DFL);
    (void)std::raise(signal);  // delivered when this handler returns
    return;
  }
  g_pending = signal;
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  // Writing files goes on where it was.
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  // A file beyond the limit is an error of its write, like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
}

int pending_signal() {
  return g_pending;
}

int exit_status_of(int signal) {
  return 128 + signal;
}

const char* signal_name(int signal) {
  return signal == SIGINT ? "SIGINT" : "SIGTERM";
}

}  // namespace hardbody
