#pragma once

/// Python's global interpreter lock (GIL), for threads that may outlive the interpreter.
///
/// A daemon thread may be within a call when the interpreter ends. Python (before 3.14) ends such a thread as soon as
/// it asks for the GIL, by unwinding its stack, which aborts the process where C++ frames are on it. These classes let
/// it sleep instead until the process is gone.

#include <Python.h>

namespace hardbody::python {

/// Scope without the GIL, which the thread has before and after it.
class GilReleased {
 public:
  GilReleased();
  ~GilReleased();
  GilReleased(const GilReleased&) = delete;
  GilReleased& operator=(const GilReleased&) = delete;

 private:
  PyThreadState* state_;
  bool was_released_;
};

/// Scope with the GIL, which the thread may have already: of every call of a Python function that may take long.
class GilAcquired {
 public:
  GilAcquired();
  ~GilAcquired();
  GilAcquired(const GilAcquired&) = delete;
  GilAcquired& operator=(const GilAcquired&) = delete;

 private:
  bool was_released_;
  PyGILState_STATE state_;
};

/// Prepares for the end of the interpreter, with Python's module atexit; to be called once, when the extension is
/// loaded.
void watch_end_of_interpreter();

}  // namespace hardbody::python
