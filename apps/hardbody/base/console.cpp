#include "base/console.h"

#include <cstdio>
#include <string>
#include <utility>

#include <unistd.h>

namespace hardbody {
namespace {

/// stdout and stderr. fmt::print is not used, because it throws when the reader of a pipe has gone.
class StandardConsole : public Console {
 public:
  StandardConsole() : terminal_(::isatty(STDERR_FILENO) == 1) {}

  void print(std::string_view text) override {
    (void)std::fwrite(text.data(), 1, text.size(), stdout);
    (void)std::fflush(stdout);
  }

  void say(std::string_view line) override {
    clear();
    put(std::string(line) + '\n');
  }

  void show(std::string_view text, double /*done*/) override {
    if (!terminal_) {
      say(text);
      return;
    }
    put("\r\x1b[K" + std::string(text));
    shown_ = true;
  }

  void clear() override {
    if (std::exchange(shown_, false)) put("\r\x1b[K");
  }

  std::chrono::milliseconds interval() const override {
    return terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(10);
  }

 private:
  static void put(const std::string& text) {
    (void)std::fputs(text.c_str(), stderr);
    (void)std::fflush(stderr);
  }

  bool terminal_;
  bool shown_ = false;
};

/// Console of a ConsoleScope in this thread; nullptr: the process's own.
thread_local Console* t_console = nullptr;

}  // namespace

Console& console() {
  thread_local StandardConsole standard;
  return t_console != nullptr ? *t_console : standard;
}

ConsoleScope::ConsoleScope(Console& console) : before_(std::exchange(t_console, &console)) {}

ConsoleScope::~ConsoleScope() {
  t_console = before_;
}

}  // namespace hardbody
