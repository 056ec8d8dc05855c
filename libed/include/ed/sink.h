#pragma once

/// @file
/// Receiver of bytes piece by piece, for writers of states and files.

#include <ed/export.h>  // refuses Eigen with row-major matrices, as every header of the library does

#include <functional>
#include <string_view>

namespace ed::archive {

/// Receives bytes piece by piece.
using Sink = std::function<void(std::string_view)>;

}  // namespace ed::archive
