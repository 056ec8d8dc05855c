#include "trajectory_reader.h"

#include "gsd_frames.h"
#include "lammps_dump.h"
#include "stored_bytes.h"

#include <algorithm>
#include <string>
#include <utility>

namespace hardbody {

std::optional<std::uint64_t> last_frame(const TrajectoryReader& reader) {
  std::uint64_t k = reader.frame_count();
  while (k > 0 && !reader.has_positions(k - 1)) --k;
  return k > 0 ? std::optional(k - 1) : std::nullopt;
}

std::unique_ptr<TrajectoryReader> open_frames(const std::filesystem::path& path) {
  std::unique_ptr<StoredBytes> bytes = open_stored_bytes(path);
  const std::string begin = bytes->read(0, std::min<std::uint64_t>(bytes->size(), 4));
  if (begin == "\xDF\x65\xDF\x65") return std::make_unique<GsdReader>(std::move(bytes), path.string());
  return std::make_unique<LammpsReader>(std::move(bytes), path.string());
}

}  // namespace hardbody
