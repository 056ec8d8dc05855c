#pragma once

#include <ed/archive.h>

namespace ed::internal {

using archive::bytes_of;
using archive::check_format;
using archive::expect;
using archive::Is;
using archive::Reader;
using archive::Writer;

}  // namespace ed::internal
