/// libFuzzer: texts that claim to be LAMMPS dumps.
///
/// Whatever the bytes are, they are refused with one line, or every frame is read (or refused) with finite numbers and
/// positions in its box.

#include "errors.h"
#include "frame.h"
#include "lammps_dump.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

void check_frame(const hardbody::Frame& frame) {
  require(!frame.bodies.empty(), "a frame has bodies");
  require(frame.box.allFinite() && frame.box.minCoeff() > 0, "a box has edges");
  for (const hardbody::FrameBody& body : frame.bodies) {
    require(body.position.allFinite() && body.unwrapped.allFinite(), "positions are finite");
    require((body.position.cwiseAbs() - 0.5000001 * frame.box).maxCoeff() <= 0, "positions are in the box");
    require(body.rotation.allFinite() && body.velocity.allFinite(), "rotations and velocities are finite");
    require(body.type < frame.types.size(), "a body's type is there");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t kMostFrames = 8;
  const auto one_line = [](std::string_view text) { return text.find('\n') == std::string_view::npos; };
  try {
    const hardbody::LammpsReader reader(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
    for (std::uint64_t k = 0; k < std::min(reader.frame_count(), kMostFrames); ++k) {
      try {
        check_frame(reader.read(k));
      } catch (const hardbody::InputError& error) {
        require(one_line(error.what()), "a refusal is one line");
      }
    }
  } catch (const hardbody::InputError& error) {
    require(one_line(error.what()), "a refusal is one line");
  }
  return 0;
}
