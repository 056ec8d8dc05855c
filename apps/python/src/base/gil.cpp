#include "base/gil.h"

#include <nanobind/nanobind.h>

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace hardbody::python {
namespace {

/// Longest wait, at the end of the interpreter, for callbacks of other threads.
constexpr std::chrono::seconds kLongestWait{1};

/// Number of scopes, of all threads, that ask for the GIL or may call Python.
std::atomic<int> all_scopes{0};
std::atomic<bool> is_ending{false};
/// Thread that ends the interpreter; set before is_ending.
std::thread::id ending_thread;

/// Whether this thread is within a scope without the GIL; else it has the GIL, or is none of Python's.
thread_local bool is_released = false;
/// Number of this thread's scopes among all_scopes.
thread_local int own_scopes = 0;

void leave() {
  --own_scopes;
  all_scopes.fetch_sub(1);
}

/// Counts a scope of a thread that is about to ask for the GIL. Does not return once the interpreter is ending; a
/// thread that has the GIL then gives it back.
void enter() {
  ++own_scopes;
  all_scopes.fetch_add(1);
  if (!is_ending.load() || std::this_thread::get_id() == ending_thread) return;
  if (!is_released && PyGILState_GetThisThreadState() != nullptr) PyEval_SaveThread();
  all_scopes.fetch_sub(own_scopes);
  for (;;) ::pause();
}

/// Lets other threads go to sleep, or return from callbacks, before the interpreter ends.
void wait_for_threads() {
  ending_thread = std::this_thread::get_id();
  is_ending.store(true);
  PyThreadState* const state = PyEval_SaveThread();
  const auto begin = std::chrono::steady_clock::now();
  while (all_scopes.load() > 0 && std::chrono::steady_clock::now() - begin < kLongestWait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  PyEval_RestoreThread(state);
}

}  // namespace

GilReleased::GilReleased() : state_(PyEval_SaveThread()), was_released_(is_released) {
  is_released = true;
}

GilReleased::~GilReleased() {
  enter();
  PyEval_RestoreThread(state_);
  leave();
  is_released = was_released_;
}

GilAcquired::GilAcquired() : was_released_(is_released) {
  enter();
  is_released = false;
  state_ = PyGILState_Ensure();
}

GilAcquired::~GilAcquired() {
  PyGILState_Release(state_);
  is_released = was_released_;
  leave();
}

void watch_end_of_interpreter() {
  namespace nb = nanobind;
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&wait_for_threads));
  // A forked process has one thread, whose scopes are not worth waiting for.
  pthread_atfork(nullptr, nullptr, [] { all_scopes.store(own_scopes); });
}

}  // namespace hardbody::python
