#pragma once

/// Work without the GIL.

#include "base/gil.h"

#include <nanobind/nanobind.h>

#include <chrono>

namespace hardbody::python {

namespace nb = nanobind;

/// Returns work(), called without the GIL. What it throws is thrown with the GIL.
template <class Work>
auto unlocked(const Work& work) {
  const GilReleased released;
  return work();
}

/// Throws what Python's signal handlers raise, KeyboardInterrupt after Ctrl-C. The caller holds the GIL.
inline void check_interrupts() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// Returns whether the answer of a callback is False, Python's or NumPy's; other answers have no meaning. The caller
/// holds the GIL.
inline bool ends_run(nb::handle answer) {
  if (answer.is(nb::handle(Py_False))) return true;
  const nb::object type = nb::module_::import_("numpy").attr("bool_");
  return PyObject_IsInstance(answer.ptr(), type.ptr()) == 1 && PyObject_IsTrue(answer.ptr()) == 0;
}

/// Clock that tells when a tenth of a second has passed, for looks at signals and reports of progress.
class Ticks {
 public:
  bool due() {
    const Clock::time_point now = Clock::now();
    if (now - last_ < kTick) return false;
    last_ = now;
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kTick{100};
  Clock::time_point last_ = Clock::now();
};

/// Function for long work without the GIL: throws what Python's signal handlers raise, about ten times a second.
class InterruptPoll {
 public:
  void operator()() {
    if (!ticks_.due()) return;
    const GilAcquired gil;
    check_interrupts();
  }

 private:
  Ticks ticks_;
};

}  // namespace hardbody::python
