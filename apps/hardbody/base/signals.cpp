#include "base/signals.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <mutex>
#include <utility>

#include <unistd.h>

namespace hardbody {
namespace {

/// First signal that has arrived; 0: none. Commands of all threads read it.
std::atomic<int> g_pending = 0;
static_assert(std::atomic<int>::is_always_lock_free);
/// Number of SignalScopes.
std::atomic<int> g_scopes = 0;

thread_local bool t_stop = false;

constexpr std::array kStopping = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
constexpr std::array kChanged = {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGPIPE, SIGXFSZ};

void on_signal(int signal) {
  int none = 0;
  if (g_pending.compare_exchange_strong(none, signal)) return;
  const bool again = signal != SIGINT || g_scopes > 0;
  if (again) return;
  std::signal(signal, SIG_DFL);
  (void)std::raise(signal);  // delivered when this handler returns
}

std::mutex g_scopes_mutex;
/// Handlers before the first SignalScope, in the order of kChanged.
std::array<struct sigaction, kChanged.size()> g_before;

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

SignalScope::SignalScope() {
  const std::lock_guard lock(g_scopes_mutex);
  if (g_scopes++ > 0) return;
  for (std::size_t k = 0; k < kChanged.size(); ++k) sigaction(kChanged[k], nullptr, &g_before[k]);
}

SignalScope::~SignalScope() {
  const std::lock_guard lock(g_scopes_mutex);
  if (--g_scopes > 0) return;
  for (std::size_t k = 0; k < kChanged.size(); ++k) sigaction(kChanged[k], &g_before[k], nullptr);
  const int signal = g_pending.exchange(0);
  if (signal != 0) (void)::kill(::getpid(), signal);
}

void request_stop() {
  t_stop = true;
}

StopScope::StopScope() : around_(std::exchange(t_stop, false)) {}

StopScope::~StopScope() {
  t_stop = around_;
}

int pending_signal() {
  return t_stop ? kCallerStops : g_pending.load();
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
    case kCallerStops:
      return "its caller";
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
