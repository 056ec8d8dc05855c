#pragma once

#include "base/errors.h"
#include "io/text_file.h"
#include "run/record.h"

#include <ed/simulation.h>
#include <ed/system.h>

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody {

/// State of a simulation as bytes: either bytes that were read, or a function that produces them piece by piece when
/// the file is written, so that a large run needs no memory for a copy of its state.
class StoredState {
 public:
  using Make = std::function<void(const Sink&)>;

  StoredState() = default;
  StoredState(std::string bytes) : bytes_(std::move(bytes)) {}  // NOLINT(google-explicit-constructor): it is one
  /// Stores a function that passes the same bytes to the sink whenever it is called.
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
  bool finished = false;  ///< true at the end of a run: only its results may remain to be written
  /// Equilibration without its system; while it runs, as of the last full unit of time.
  Equilibration equilibration;
  std::string monitor;      ///< bytes of ed::EquilibrationMonitor::save; empty in production
  Production production;    ///< plan of production and its progress; results are not stored
  FilesMark files;          ///< lengths of the files that grow with production
  StoredState simulation;   ///< bytes of ed::Simulation::save
  StoredState observables;  ///< bytes of ed::Observables::save; empty before production
};

inline constexpr std::uint32_t kCheckpointFormat = 11;

/// checkpoint.bin: a state and what it belongs to.
///
/// Layout: "HARDBODY", a mark of the byte order, the format's version, the length of the payload; the
/// payload; the XXH3 checksum of everything before it. Versions 1 (one ellipsoid of revolution for all bodies) and 2
/// contain no RunState, versions 3 to 10 another one, which is not read: these can be checked, but not resumed.
struct Checkpoint {
  std::uint32_t format = kCheckpointFormat;  ///< format of the file that it was read from
  std::string program_version;
  std::string config;        ///< the run's resolved config.toml
  std::string cpu_features;  ///< features of the processor that made it, blank-separated
  std::string arithmetic;    ///< arithmetic of the program that made it
  std::string phase;         ///< "start", "equilibration" or "production"
  double time = 0;           ///< time since the phase began
  ed::System system;
  // Only in a "start"; later they are in RunState::equilibration.
  ed::Counters counters_of_start;
  std::vector<ed::FailedPair> failures_of_start;
  double packing_of_file = 0;
  std::optional<RunState> run;  ///< nullopt in a "start", which continues from the system
  Upkeep upkeep;                ///< stored last: the checkpoints of two equal runs differ in their last 48 bytes only
};

/// Passes the file's bytes to the sink, piece by piece.
void encode_checkpoint(const Checkpoint& checkpoint, const Sink& sink);
std::string encode_checkpoint(const Checkpoint& checkpoint);

/// Returns a payload with head and checksum, as decode_checkpoint accepts it.
std::string seal_checkpoint(std::string_view payload, std::uint32_t format = kCheckpointFormat);

/// Error for a checkpoint of another version of the program or of the format.
class OtherVersion : public InputError {
 public:
  using InputError::InputError;
};

/// Decodes an undamaged checkpoint of a known version in this byte order. Throws InputError, `name: why`, for anything
/// else; OtherVersion for a later format.
Checkpoint decode_checkpoint(std::string_view bytes, const std::string& name);

Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Returns restore(). A std::invalid_argument becomes an InputError that calls the checkpoint `name` damaged.
template <class F>
auto restored(const std::string& name, const F& restore) {
  try {
    return restore();
  } catch (const std::invalid_argument& error) {
    throw InputError(
        fmt::format("{}: holds an impossible state ({}); accepted: an undamaged checkpoint", name, error.what()));
  }
}

/// Returns the simulation of a checkpoint, whose bytes are released. Throws InputError if they do not fit its system.
ed::Simulation restored_simulation(const Config& config, Checkpoint& checkpoint, const std::string& name);

/// Checks that a run of this program's version and format can continue from it. Throws OtherVersion, naming the
/// difference. Must be called before the config is read, which may also be that of another version.
void check_version(const Checkpoint& checkpoint, const std::string& name);

/// Checks that the config is still that of the run. Throws InputError, naming the key that differs.
void check_same_config(const Checkpoint& checkpoint, const Config& config, const std::string& config_name);

/// Checks that this build of the program on this processor continues with the same bits. Throws InputError, naming the
/// difference.
void check_resumable(const Checkpoint& checkpoint, const std::string& name);

}  // namespace hardbody
