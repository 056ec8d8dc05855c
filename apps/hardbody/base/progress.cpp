#include "base/progress.h"

#include <fmt/format.h>

#include <cstdio>

#include <unistd.h>

namespace hardbody {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{250};
constexpr std::chrono::seconds kPlainInterval{10};

}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1), begun_(Clock::now()), last_(begun_) {}

Progress::~Progress() {
  clear();
}

void Progress::begin() {
  begun_ = Clock::now();
}

bool Progress::due() const {
  const auto since = Clock::now() - last_;
  return terminal_ ? since >= kTerminalInterval : since >= kPlainInterval;
}

void Progress::show(const std::string& text) {
  last_ = Clock::now();
  if (terminal_) {
    (void)std::fputs(("\r\x1b[K" + text).c_str(), stderr);
    (void)std::fflush(stderr);
    shown_ = true;
  } else {
    say(text);
  }
}

void Progress::say(const std::string& text) {
  clear();
  // fmt::print is not used, because it throws when the reader of a pipe has gone.
  (void)std::fputs((text + '\n').c_str(), stderr);
}

void Progress::clear() {
  if (!shown_) return;
  (void)std::fputs("\r\x1b[K", stderr);
  (void)std::fflush(stderr);
  shown_ = false;
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begun_).count();
}

void announce(const std::string& text, Progress& progress, Log& log) {
  log.line(text);
  progress.say(text);
}

std::string eta(double seconds, double done, double total) {
  if (!(done > 0) || !(total > done)) return "";
  const double left = seconds * (total - done) / done;
  if (left < 100) return fmt::format("ETA {:.0f} s", left);
  if (left < 6000) return fmt::format("ETA {:.0f} min", left / 60);
  return fmt::format("ETA {:.1f} h", left / 3600);
}

}  // namespace hardbody
