#pragma once

#include <ed/system.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace hardbody {

/// checkpoint.bin: a state and what it belongs to.
///
/// Layout: "HARDBODY", a mark of the byte order, the format's version, the length of the payload; the
/// payload; the XXH3 checksum of everything before it.
struct Checkpoint {
  std::string program_version;
  std::string config;        ///< the run's resolved config.toml
  std::string cpu_features;  ///< of the processor that made it, blank-separated
  std::string phase;         ///< "equilibration" or "production"
  double time = 0;           ///< since the phase began
  ed::System system;
};

std::string encode_checkpoint(const Checkpoint& checkpoint);

/// Throws InputError, `name: why`, for anything but an undamaged checkpoint of this version and byte order.
Checkpoint decode_checkpoint(std::string_view bytes, const std::string& name);

Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace hardbody
