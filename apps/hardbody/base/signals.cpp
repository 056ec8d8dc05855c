#include "base/signals.h"

#include <algorithm>
#include <array>
#include <csignal>

namespace hardbody {
namespace {

volatile std::sig_atomic_t g_pending = 0;

constexpr std::array kStopping = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};

void on_signal(int signal) {
  if (g_pending != 0) {
    if (signal == SIGHUP || signal == SIGXCPU) return;
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
  // Interrupted writes are continued.
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  for (const int signal : kStopping) {
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
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

bool stopped_by_signal(int exit_status) {
  return std::any_of(kStopping.begin(), kStopping.end(),
                     [&](int signal) { return exit_status == exit_status_of(signal); });
}

const char* signal_name(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGHUP:
      return "SIGHUP";
    case SIGXCPU:
      return "SIGXCPU";
    default:
      return "SIGTERM";
  }
}

}  // namespace hardbody
