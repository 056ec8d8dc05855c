#include "run/checkpoint.h"

#include "base/errors.h"
#include "base/version.h"
#include "config/keys.h"
#include "io/text_file.h"

#include <ed/archive_observables.h>
#include <ed/archive_simulation.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace hardbody {

using ed::archive::Is;
using ed::archive::Reader;
using ed::archive::Writer;

// ---- Members, found by the archive through their types -------------------------------------------------------------

template <class Archive, Is<Upkeep> T>
void fields(Archive& archive, T& upkeep) {
  archive(upkeep.seconds, upkeep.production_seconds, upkeep.checkpoints, upkeep.checkpoints_failed, upkeep.resumed);
}

template <class Archive, Is<Equilibration> T>
void fields(Archive& archive, T& e) {
  archive(e.kinetic_at_start, e.time, e.envelope, e.relaxation, e.counters_of_start, e.counters_of_tuning,
          e.failures_of_start, e.counters, e.failures, e.packing_of_file);
}

template <class Archive, Is<Production> T>
void fields(Archive& archive, T& p) {
  archive(p.kinetic_at_start, p.time, p.planned, p.longest_lag, p.next_look, p.precise, p.wave_numbers);
}

template <class Archive, Is<EventsMark> T>
void fields(Archive& archive, T& mark) {
  archive(mark.rows, mark.bytes);
}

inline void fields(Writer& archive, const StoredState& state) {
  archive(state.size());
  state.write([&archive](std::string_view piece) { archive.raw(piece); });
}
inline void fields(Reader& archive, StoredState& state) {
  archive(state.bytes());
}

template <class Archive, Is<TrajectoryMark> T>
void fields(Archive& archive, T& mark) {
  archive(mark.frames, mark.last_time, mark.bytes);
}

template <class Archive, Is<RunState> T>
void fields(Archive& archive, T& run) {
  archive(run.finished, run.equilibration, run.monitor, run.production, run.files.events, run.files.trajectory,
          run.simulation, run.observables);
}

namespace {

constexpr std::string_view kMagic = "HARDBODY";
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kFormat = kCheckpointFormat;
/// First of the formats, up to kFormat - 1, whose runs only an older program can resume.
constexpr std::uint32_t kOtherRun = 3;
/// Format of one ellipsoid of revolution; like format 2 it lacks what a run needs to resume.
constexpr std::uint32_t kOneEllipsoid = 1;
constexpr std::size_t kHead = 8 + 4 + 4 + 8;  ///< magic, byte order, format, length of the payload
constexpr std::size_t kTail = 8;              ///< checksum
constexpr std::size_t kLongest = std::size_t{1} << 35;

/// One species, without its kind, and bodies without their species.
ed::System take_one_ellipsoid(Reader& reader) {
  ed::System system;
  reader(system.box);
  ed::Species& species = system.species.emplace_back();
  species.shape = geom::Ellipsoid(reader.value<Eigen::Vector3d>());
  reader(species.mass, species.inertia, species.spins);
  for (auto number = reader.value<std::uint64_t>(); number > 0; --number) {
    ed::Body& body = system.bodies.emplace_back();
    reader(body.position, body.rotation, body.velocity, body.angular_velocity);
  }
  return system;
}

Checkpoint take_checkpoint(std::uint32_t format, std::string_view payload) {
  Reader reader(payload);
  Checkpoint checkpoint;
  checkpoint.format = format;
  reader(checkpoint.program_version, checkpoint.config, checkpoint.cpu_features);
  if (format >= kOtherRun) reader(checkpoint.arithmetic);
  reader(checkpoint.phase, checkpoint.time);
  if (format == kOneEllipsoid) {
    checkpoint.system = take_one_ellipsoid(reader);
  } else {
    reader(checkpoint.system);
  }
  if (format == kFormat) {
    reader(checkpoint.counters_of_start, checkpoint.failures_of_start, checkpoint.packing_of_file, checkpoint.run,
           checkpoint.upkeep);
  }
  if (format >= kOtherRun && format < kFormat) (void)reader.raw(reader.left());
  reader.finish();
  const ed::System& system = checkpoint.system;
  ed::archive::expect(reader, system.box > 0 && std::isfinite(system.box), "the box");
  ed::archive::expect(reader, !system.bodies.empty(), "no bodies");
  ed::check_species(system);
  return checkpoint;
}

struct Payload {
  std::uint32_t format;
  std::string_view bytes;
};

/// The payload of a file whose head and checksum are right.
Payload checked_payload(std::string_view bytes, const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    return InputError(fmt::format("{}: {}; accepted: an undamaged checkpoint", name, why));
  };
  if (!bytes.starts_with(kMagic)) throw refuse("is not a hardbody checkpoint");
  const std::string cut = fmt::format("is cut off after {} bytes", bytes.size());
  if (bytes.size() < kHead + kTail) throw refuse(cut);
  Reader head(bytes.substr(kMagic.size(), kHead - kMagic.size()));
  if (head.value<std::uint32_t>() != kByteOrder) throw refuse("was written with another byte order, or is damaged");
  const auto format = head.value<std::uint32_t>();
  const auto length = head.value<std::uint64_t>();
  if (format < kOneEllipsoid || format > kFormat) {
    throw OtherVersion(fmt::format(
        "{}: has format version {}, this program reads versions {} to {}; accepted: the program that wrote it, or a "
        "new run of its config.toml",
        name, format, kOneEllipsoid, kFormat));
  }
  if (length > bytes.size() - kHead - kTail) throw refuse(cut);
  if (length < bytes.size() - kHead - kTail) throw refuse("is longer than it says, so it is damaged");
  Reader tail(bytes.substr(kHead + length));
  if (tail.value<std::uint64_t>() != XXH3_64bits(bytes.data(), kHead + length)) {
    throw refuse("is damaged: its checksum does not fit");
  }
  return {format, bytes.substr(kHead, length)};
}

std::string or_none(const std::string& features) {
  return features.empty() ? "none" : features;
}

std::string different(const std::string& name, const char* what, const std::string& made, const std::string& here) {
  return fmt::format(
      "{}: was made {} {}, here {}, which would change bits; accepted: the same, or a new run of its config.toml", name,
      what, made, here);
}

void put_payload(const Checkpoint& checkpoint, const Sink& sink) {
  Writer payload(sink);
  payload(checkpoint.program_version, checkpoint.config, checkpoint.cpu_features, checkpoint.arithmetic,
          checkpoint.phase, checkpoint.time, checkpoint.system, checkpoint.counters_of_start,
          checkpoint.failures_of_start, checkpoint.packing_of_file, checkpoint.run, checkpoint.upkeep);
  payload.flush();
}

/// Returns the number of bytes that `make` hands over.
std::uint64_t count_bytes(const std::function<void(const Sink&)>& make) {
  std::uint64_t count = 0;
  make([&count](std::string_view piece) { count += piece.size(); });
  return count;
}

struct FreeHash {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

/// The payload with head and checksum.
void seal(std::uint32_t format, std::uint64_t length, const std::function<void(const Sink&)>& payload,
          const Sink& sink) {
  const std::unique_ptr<XXH3_state_t, FreeHash> hash(XXH3_createState());
  if (!hash || XXH3_64bits_reset(hash.get()) != XXH_OK)
    throw std::runtime_error("checkpoint: no room for its checksum");
  const auto hashed = [&](std::string_view piece) {
    if (XXH3_64bits_update(hash.get(), piece.data(), piece.size()) != XXH_OK) {
      throw std::runtime_error("checkpoint: its checksum cannot be made");
    }
    sink(piece);
  };
  hashed(std::string(kMagic) + ed::archive::bytes_of(kByteOrder) + ed::archive::bytes_of(format) +
         ed::archive::bytes_of(length));
  payload(hashed);
  sink(ed::archive::bytes_of(std::uint64_t{XXH3_64bits_digest(hash.get())}));
}

}  // namespace

StoredState::StoredState(Make make) : make_(std::move(make)), size_(count_bytes(make_)) {}

void StoredState::write(const Sink& sink) const {
  if (make_) {
    make_(sink);
  } else {
    sink(bytes_);
  }
}

std::string seal_checkpoint(std::string_view payload, std::uint32_t format) {
  std::string bytes;
  seal(
      format, payload.size(), [payload](const Sink& sink) { sink(payload); },
      [&bytes](std::string_view piece) { bytes += piece; });
  return bytes;
}

void encode_checkpoint(const Checkpoint& checkpoint, const Sink& sink) {
  const auto payload = [&checkpoint](const Sink& to) { put_payload(checkpoint, to); };
  seal(kFormat, count_bytes(payload), payload, sink);
}

std::string encode_checkpoint(const Checkpoint& checkpoint) {
  std::string bytes;
  encode_checkpoint(checkpoint, [&bytes](std::string_view piece) { bytes += piece; });
  return bytes;
}

Checkpoint decode_checkpoint(std::string_view bytes, const std::string& name) {
  const Payload payload = checked_payload(bytes, name);
  return restored(name, [&] { return take_checkpoint(payload.format, payload.bytes); });
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  return decode_checkpoint(read_file(path, kLongest), path.string());
}

ed::Simulation restored_simulation(const Config& config, Checkpoint& checkpoint, const std::string& name) {
  return restored(name, [&] {
    ed::Simulation simulation = ed::Simulation::restore(checkpoint.run->simulation.bytes(), checkpoint.system.species,
                                                        config.simulation_options());
    checkpoint.run->simulation = {};
    if (ed::archive::bytes_of(simulation.system()) == ed::archive::bytes_of(checkpoint.system)) return simulation;
    throw std::invalid_argument("state: two that should be the same differ");
  });
}

void check_same_config(const Checkpoint& checkpoint, const Config& config, const std::string& config_name) {
  const Config there = parse_config(checkpoint.config, config_name + " (of the checkpoint)");
  const std::optional<Difference> found = difference(config, there);
  if (!found) return;
  throw InputError(fmt::format("{}: {} is {}, the checkpoint was made with {}; accepted: the config of the run",
                               config_name, found->key, found->here, found->there));
}

void check_version(const Checkpoint& checkpoint, const std::string& name) {
  if (checkpoint.format >= kOtherRun && checkpoint.format < kFormat) {
    throw OtherVersion(
        fmt::format("{}: was made by hardbody {} in format {}, from which only that program goes on, here {} in format "
                    "{}; accepted: that program, or a new run of its config.toml",
                    name, checkpoint.program_version, checkpoint.format, version(), kFormat));
  }
  if (checkpoint.format < kOtherRun || (checkpoint.phase != "start" && !checkpoint.run)) {
    throw OtherVersion(fmt::format(
        "{}: is of an older format that holds no running state; accepted: a new run of its config.toml", name));
  }
  if (checkpoint.program_version != version()) {
    throw OtherVersion(different(name, "by hardbody", checkpoint.program_version, version()));
  }
}

void check_resumable(const Checkpoint& checkpoint, const std::string& name) {
  if (checkpoint.arithmetic != arithmetic()) {
    throw InputError(different(name, "by a program with", checkpoint.arithmetic, arithmetic()));
  }
  if (checkpoint.cpu_features != cpu_feature_text()) {
    throw InputError(
        different(name, "on a processor with", or_none(checkpoint.cpu_features), or_none(cpu_feature_text())));
  }
}

}  // namespace hardbody
