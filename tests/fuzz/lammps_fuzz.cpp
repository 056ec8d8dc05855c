/// libFuzzer: texts that claim to be LAMMPS dumps (frames.h).

#include "frames.h"
#include "trajectory/lammps/dump.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace {

/// Columns of these names stand somewhere in a dump that knows the quantity.
void check_columns(const hardbody::Frame& frame, std::string_view text) {
  const auto has = [&](std::string_view name) { return text.find(name) != std::string_view::npos; };
  fuzz::require(!frame.velocities || (has("vx") && has("vy") && has("vz")), "velocities are columns");
  fuzz::require(!frame.orientations || (has("quatw") && has("quatk")), "orientations are columns");
  fuzz::require(!frame.angular_velocities || has("omegax") || has("angmomx"), "turning is columns");
  fuzz::require(!frame.images || has("xu") || has("xsu") || has("ix"), "images are columns");
  fuzz::require(!frame.ids || has("id"), "ids are a column");
  for (const hardbody::FrameType& type : frame.types) {
    fuzz::require(!type.shape || has("shapex") || has("radius") || has("diameter"), "shapes are columns");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::read_all([&] { return hardbody::LammpsReader(hardbody::stored_bytes_in_memory(text), "fuzz"); },
                 [&](const hardbody::Frame& frame, std::uint64_t /*k*/) { check_columns(frame, text); });
  return 0;
}
