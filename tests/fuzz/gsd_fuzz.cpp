/// libFuzzer: files that claim to be GSD trajectories.
///
/// Whatever the bytes are, they are refused with one line, or every frame is read (or refused) with finite numbers.

#include "errors.h"
#include "frame.h"
#include "gsd_frames.h"

#include <ed/system.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include <unistd.h>

namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

ed::System two_bodies() {
  ed::System system;
  system.box = 20;
  system.species = {ed::paper_species(geom::Ellipsoid({1, 1, 2})),
                    ed::uniform_species(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5))};
  system.bodies.resize(2);
  system.bodies[1].position.x() = 5;
  system.bodies[1].species = 1;
  system.bodies[1].velocity.x() = -1;
  return system;
}

/// A file of two frames.
std::string good_file() {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("hardbody_gsd_fuzz_" + std::to_string(::getpid()));
  hardbody::GsdWriter writer(path, 3);
  writer.append(hardbody::frame_of(two_bodies(), {1, 1}));
  writer.append(hardbody::frame_of(two_bodies(), {1, 1}));
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return bytes;
}

/// The file with some bytes replaced: (2 bytes of place, 1 of value) each. Bytes at random would never get past the
/// header.
std::string changed_file(std::string_view changes) {
  static const std::string good = good_file();
  std::string bytes = good;
  for (; changes.size() >= 3; changes.remove_prefix(3)) {
    const auto place = static_cast<unsigned char>(changes[0]) * 256U + static_cast<unsigned char>(changes[1]);
    bytes[place % bytes.size()] = changes[2];
  }
  return bytes;
}

void check_frame(const hardbody::Frame& frame) {
  require(!frame.bodies.empty(), "a frame has bodies");
  for (const hardbody::FrameBody& body : frame.bodies) {
    require(body.position.allFinite() && body.unwrapped.allFinite(), "positions are finite");
    require(body.rotation.allFinite() && body.velocity.allFinite(), "rotations and velocities are finite");
    require(body.type < frame.types.size(), "a body's type is there");
  }
  if (frame.exact) require(frame.exact->bodies.size() == frame.bodies.size(), "the state is of all bodies");
}

void read_all(std::string bytes) {
  constexpr std::uint64_t kMostFrames = 8;  // enough of those that repeat the first one
  const auto one_line = [](std::string_view text) { return text.find('\n') == std::string_view::npos; };
  try {
    const hardbody::GsdReader reader(hardbody::gsd_bytes_in_memory(std::move(bytes)), "fuzz");
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
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  read_all(data[0] % 4 == 0 ? std::string(rest) : changed_file(rest));
  return 0;
}
