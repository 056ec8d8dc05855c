// Commands as guests of another process: consoles, signal handlers, programs of workers, configs without a file.

#include "base/console.h"
#include "base/errors.h"
#include "base/progress.h"
#include "base/signals.h"
#include "config/config.h"
#include "io/toml_document.h"
#include "sweep/file.h"
#include "sweep/workers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

using namespace hardbody;

/// Console that keeps what it is given.
class Kept : public Console {
 public:
  void print(std::string_view text) override { printed += text; }
  void say(std::string_view line) override { said.emplace_back(line); }
  void show(std::string_view text, double done) override {
    shown = text;
    fraction = done;
  }
  void clear() override { shown.clear(); }
  std::chrono::milliseconds interval() const override { return std::chrono::milliseconds(0); }

  std::string printed;
  std::vector<std::string> said;
  std::string shown;
  double fraction = -1;
};

TEST(ConsoleScope, IsOfOneThreadAndEnds) {
  Console* own = &console();
  Kept kept;
  {
    const ConsoleScope scope(kept);
    Progress progress;
    EXPECT_TRUE(progress.due());
    progress.show("half", 0.5);
    EXPECT_EQ(kept.shown, "half");
    EXPECT_EQ(kept.fraction, 0.5);
    progress.say("a message");
    console().print("a table\n");
    std::thread([&] { EXPECT_NE(&console(), &kept); }).join();
    Kept inner;
    {
      const ConsoleScope second(inner);
      console().print("inner");
    }
    EXPECT_EQ(inner.printed, "inner");
    EXPECT_EQ(&console(), &kept);
  }
  EXPECT_EQ(&console(), own);
  EXPECT_EQ(kept.printed, "a table\n");
  EXPECT_EQ(kept.said, std::vector<std::string>{"a message"});
  EXPECT_EQ(kept.shown, "") << "Progress clears what it has shown";
}

volatile std::sig_atomic_t g_received = 0;

void receive(int signal) {
  g_received = signal;
}

void (*handler_of(int signal))(int) {
  struct sigaction now = {};
  sigaction(signal, nullptr, &now);
  return now.sa_handler;
}

TEST(SignalScope, RestoresHandlersAndSendsTheSignalAgain) {
  std::signal(SIGINT, receive);
  std::signal(SIGPIPE, SIG_DFL);
  for (int round = 0; round < 2; ++round) {  // a second command is not stopped by the first one's signal
    g_received = 0;
    {
      const SignalScope outer;
      {
        const SignalScope inner;
        install_signal_handlers();
        EXPECT_EQ(pending_signal(), 0);
        (void)std::raise(SIGINT);
        (void)std::raise(SIGINT);  // ignored
        EXPECT_EQ(pending_signal(), SIGINT);
      }
      EXPECT_NE(handler_of(SIGINT), &receive) << "another scope is open";
      EXPECT_EQ(pending_signal(), SIGINT);
      EXPECT_EQ(int{g_received}, 0);
    }
    EXPECT_EQ(handler_of(SIGINT), &receive);
    EXPECT_EQ(handler_of(SIGPIPE), SIG_DFL);
    EXPECT_EQ(int{g_received}, SIGINT);
    EXPECT_EQ(pending_signal(), 0);
  }
  std::signal(SIGINT, SIG_DFL);
}

TEST(StopScope, RequestsAreOfOneThreadAndOneScope) {
  {
    const StopScope inner;
    request_stop();
    EXPECT_EQ(pending_signal(), kCallerStops);
  }
  EXPECT_EQ(pending_signal(), 0) << "what is around an inner part goes on";
  const StopScope outer;
  request_stop();
  EXPECT_EQ(pending_signal(), kCallerStops);
  {
    const StopScope inner;
    EXPECT_EQ(pending_signal(), 0);
  }
  EXPECT_EQ(pending_signal(), kCallerStops);
  EXPECT_STREQ(signal_name(kCallerStops), "its caller");
  EXPECT_FALSE(stopped_by_signal(exit_status_of(kCallerStops))) << "no signal";
  std::thread([] { EXPECT_EQ(pending_signal(), 0); }).join();
}

TEST(Workers, RunAnotherProgram) {
  Workers workers({"/bin/sh", "-c", "echo \"$0 $1\" >&2; exit 3"});
  workers.start(7, ".", {"run", "a b"});
  std::vector<WorkerEnd> ends;
  while (ends.empty()) ends = workers.ended(1000);
  EXPECT_EQ(ends[0].id, 7);
  EXPECT_EQ(ends[0].status, 3);
  EXPECT_EQ(ends[0].last_line, "run a b");
}

TEST(Workers, AreWaitedForWithoutTheirStderr) {
  Workers workers({"/bin/sh", "-c", "exec 2>&-; sleep 1; exit 3"});
  workers.start(7, ".", {});
  int calls = 0;
  std::vector<WorkerEnd> ends;
  for (; ends.empty(); ++calls) ends = workers.ended(1000);
  EXPECT_EQ(ends[0].status, 3);
  // A hundred: without a wait in each there would be hundreds of thousands.
  EXPECT_LT(calls, 2000);
}

TEST(Workers, EndWhereTheStatusIsLost) {
  std::signal(SIGCHLD, SIG_IGN);
  {
    Workers workers({"/bin/sh", "-c", "echo \"$0\" >&2"});
    workers.start(1, ".", {"a reason"});
    std::vector<WorkerEnd> ends;
    while (ends.empty()) ends = workers.ended(1000);
    EXPECT_EQ(ends[0].status, 0);
    EXPECT_EQ(ends[0].last_line, "a reason");
  }
  std::signal(SIGCHLD, SIG_DFL);
}

/// Returns the message of an InputError.
template <class Call>
std::string message_of(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Lines, AreNotNamedOfATextWithoutAFile) {
  const char* text = "[system]\nnumber = 0\npacking_fraction = 0.3\n[shape]\naspect_ratio = 2\n";
  const auto message = [&](Lines lines) {
    return message_of([&] { (void)read_config(read_toml(text, "config", {}, lines)); });
  };
  EXPECT_TRUE(message(Lines::named).starts_with("config:2: system.number is 0; accepted: "));
  EXPECT_TRUE(message(Lines::unnamed).starts_with("config: system.number is 0; accepted: "));
  const std::string missing =
      message_of([] { (void)read_config(read_toml("[shape]\naspect_ratio = 2\n", "config", {}, Lines::unnamed)); });
  EXPECT_TRUE(missing.starts_with("config: system.packing_fraction is missing")) << missing;
  const std::string grid = message_of([&] {
    (void)parse_sweep("[grid]\nsystem.number = []\n[shape]\naspect_ratio = 2\n", "config", "", {}, Lines::unnamed);
  });
  EXPECT_TRUE(grid.starts_with("config: ")) << grid;
  EXPECT_TRUE(grid.find("config:") == grid.rfind("config:")) << grid;
}

TEST(Overrides, MayBeLong) {
  std::string values = "[1.0";
  for (int k = 0; k < 200; ++k) values += ", 2.0";
  const TomlDocument document = read_toml("", "config", {"production.wave_numbers=" + values + "]"});
  ASSERT_EQ(document.entries.size(), 1u);
  EXPECT_EQ(document.entries[0].value.items.size(), 201u);
}

}  // namespace
