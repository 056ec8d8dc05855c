#pragma once

#include <cstddef>
#include <functional>

namespace hardbody::python {

/// Largest number of threads of one call.
inline constexpr int kMostThreads = 1024;

/// Work on the range [begin, end).
using Work = std::function<void(std::size_t begin, std::size_t end)>;

/// Does the work on ranges that make up [0, count), at most `chunk` long and shorter if that takes long, on `threads`
/// threads, the caller's among them. The caller holds the GIL, which is released meanwhile: the work must not touch
/// Python.
///
/// An exception ends the call, that of the first range if several throw. Python's signals are looked after about twenty
/// times a second; one that raises, such as Ctrl-C, ends the call when the ranges in work are done.
void parallel(std::size_t count, std::size_t chunk, int threads, const Work& work);

/// Overload for work with a state of its own: `make` is called once in each thread.
void parallel(std::size_t count, std::size_t chunk, int threads, const std::function<Work()>& make);

}  // namespace hardbody::python
