/// libFuzzer: files that claim to be GSD trajectories (frames.h).

#include "frames.h"
#include "trajectory/gsd/frames.h"

#include <ed/system.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include <unistd.h>

namespace {

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

/// The file as another program would have it.
std::string without_doubles(std::string bytes) {
  bytes[bytes.find("log/hardbody/time")] = 'X';
  return bytes;
}

/// The file with some bytes replaced: (2 bytes of place, 1 of value) each. Bytes at random would never get past the
/// header.
std::string changed_file(const std::string& good, std::string_view changes) {
  std::string bytes = good;
  for (; changes.size() >= 3; changes.remove_prefix(3)) {
    const auto place = static_cast<unsigned char>(changes[0]) * 256U + static_cast<unsigned char>(changes[1]);
    bytes[place % bytes.size()] = changes[2];
  }
  return bytes;
}

/// Quantities that move are known of a later frame only if some later frame has them; a state in doubles has all.
void check_known(const hardbody::Frame& frame, std::uint64_t k, const hardbody::GsdFile& file) {
  if (k == 0 || frame.exact) return;
  const auto stored = [&](const char* name) { return file.stored_later(name); };
  fuzz::require(!frame.orientations || stored("particles/orientation"), "later orientations are stored");
  fuzz::require(!frame.velocities || stored("particles/velocity"), "later velocities are stored");
  fuzz::require(!frame.angular_velocities || stored("particles/angmom"), "later angular momenta are stored");
  fuzz::require(!frame.images || stored("particles/image"), "later images are stored");
}

void read_all(const std::string& bytes) {
  fuzz::read_all([&] { return hardbody::GsdReader(hardbody::stored_bytes_in_memory(bytes), "fuzz"); },
                 [&](const hardbody::Frame& frame, std::uint64_t k) {
                   check_known(frame, k, hardbody::GsdFile(hardbody::stored_bytes_in_memory(bytes), "fuzz"));
                 });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  static const std::string good = good_file();
  static const std::string other = without_doubles(good);
  read_all(data[0] % 4 == 0 ? std::string(rest) : changed_file(data[0] % 4 == 2 ? other : good, rest));
  return 0;
}
