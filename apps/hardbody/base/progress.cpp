#include "base/progress.h"

#include "base/console.h"

#include <fmt/format.h>

namespace hardbody {

Progress::Progress() : begun_(Clock::now()), last_(begun_) {}

Progress::~Progress() {
  clear();
}

void Progress::begin() {
  begun_ = Clock::now();
}

bool Progress::due() const {
  return Clock::now() - last_ >= console().interval();
}

void Progress::show(const std::string& text, double done) {
  last_ = Clock::now();
  console().show(text, done);
}

void Progress::say(const std::string& text) {
  console().say(text);
}

void Progress::clear() {
  console().clear();
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
