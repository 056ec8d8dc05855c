#pragma once

#include "base/errors.h"
#include "io/text_file.h"
#include "run/record.h"

#include <ed/simulation.h>
#include <ed/system.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody {

/// A state as bytes: those that were read, or what hands them over while they are written, so that a large run needs
/// no room for a second self.
class StoredState {
 public:
  using Make = std::function<void(const Sink&)>;

  StoredState() = default;
  StoredState(std::string bytes) : bytes_(std::move(bytes)) {}  // NOLINT(google-explicit-constructor): it is one
  /// `make` hands over the same bytes whenever it is called.
  explicit StoredState(Make make);

  std::uint64_t size() const { return make_ ? size_ : bytes_.size(); }
  void write(const Sink& sink) const;

  const std::string& bytes() const { return bytes_; }  ///< bytes of a state that was read
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
  Make make_;
  std::uint64_t size_ = 0;
};

/// State that a run needs, besides its config, to continue bit for bit.
struct RunState {
  bool finished = false;  ///< only the measured results are left to be written
  /// Equilibration without its system; while it runs, as of the last full unit of time.
  Equilibration equilibration;
  std::string monitor;    ///< ed::EquilibrationMonitor::save; not in production
  Production production;  ///< values at the beginning of production
  EventsMark events;
  TrajectoryMark trajectory;
  StoredState simulation;   ///< ed::Simulation::save
  StoredState observables;  ///< ed::Observables::save; of production
};

inline constexpr std::uint32_t kCheckpointFormat = 10;

/// checkpoint.bin: a state and what it belongs to.
///
/// Layout: "HARDBODY", a mark of the byte order, the format's version, the length of the payload; the
/// payload; the XXH3 checksum of everything before it. Versions 1 (one ellipsoid of revolution for all bodies) and 2
/// hold no RunState, versions 3 to 8 another one, which is left unread: they can be checked, not resumed.
struct Checkpoint {
  std::uint32_t format = kCheckpointFormat;  ///< format of the file that it was read from
  std::string program_version;
  std::string config;        ///< the run's resolved config.toml
  std::string cpu_features;  ///< features of the processor that made it, blank-separated
  std::string arithmetic;    ///< arithmetic of the program that made it
  std::string phase;         ///< "start", "equilibration" or "production"
  double time = 0;           ///< time since the phase began
  ed::System system;
  // In a "start"; later in RunState's equilibration.
  ed::Counters counters_of_start;
  std::vector<ed::FailedPair> failures_of_start;
  std::optional<RunState> run;  ///< nullopt in a "start", which continues from the system
  Upkeep upkeep;                ///< last, so that the checkpoints of two like runs differ in their last 48 bytes only
};

/// The file's bytes, piece by piece.
void encode_checkpoint(const Checkpoint& checkpoint, const Sink& sink);
std::string encode_checkpoint(const Checkpoint& checkpoint);

/// A payload with head and checksum: what decode_checkpoint takes for whole.
std::string seal_checkpoint(std::string_view payload, std::uint32_t format = kCheckpointFormat);

/// A checkpoint of another version of the program or of the format.
class OtherVersion : public InputError {
 public:
  using InputError::InputError;
};

/// Throws InputError, `name: why`, for anything but an undamaged checkpoint of a version that is known, in this byte
/// order; OtherVersion for one of a later format.
Checkpoint decode_checkpoint(std::string_view bytes, const std::string& name);

Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Whether it has a run of this program's version and format. Throws OtherVersion, naming what differs. To be asked
/// before the config is read, which may be another version's too.
void check_version(const Checkpoint& checkpoint, const std::string& name);

/// Whether the config is still that of the run. Throws InputError, naming the key that differs.
void check_same_config(const Checkpoint& checkpoint, const Config& config, const std::string& config_name);

/// Whether this program, of the same version, and this processor go on with the same bits. Throws InputError, naming
/// what differs.
void check_resumable(const Checkpoint& checkpoint, const std::string& name);

}  // namespace hardbody
