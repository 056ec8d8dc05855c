// Saved states of simulations: "HBSIMULATION", the format's number, what has to be the same where the state is
// restored, the options, the groups, the species, the observables, the bytes of ed::Simulation::save; the XXH3 checksum
// of everything before it.

#include "simulation/simulation.h"

#include <base/version.h>
#include <io/text_file.h>

#include <ed/archive_observables.h>
#include <ed/archive_simulation.h>
#include <geom/batch.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace hardbody::python {
namespace {

using ed::archive::Reader;
using ed::archive::Writer;

constexpr std::string_view kMagic = "HBSIMULATION";
constexpr std::uint32_t kFormat = 2;
constexpr std::size_t kTail = 8;

/// Checksum of bytes that come in pieces.
class Checksum {
 public:
  Checksum() : state_(XXH3_createState()) {
    if (!state_ || XXH3_64bits_reset(state_.get()) != XXH_OK) throw std::bad_alloc();
  }
  void add(std::string_view piece) { static_cast<void>(XXH3_64bits_update(state_.get(), piece.data(), piece.size())); }
  std::uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_;
};

template <class Archive, class Options>
void put_or_get(Archive& archive, Options& options) {
  archive(options.envelope, options.neighbours);
  fields(archive, options.contact);
  archive(options.batches, options.prepare_from, options.least_progress);
}

void check_options(Reader& reader, const ed::SimulationOptions& options) {
  using ed::archive::expect;
  const ed::ContactOptions& contact = options.contact;
  expect(reader, options.neighbours <= ed::Neighbours::cells, "the kind of neighbours");
  expect(reader, contact.finder <= ed::Finder::bracketing, "the finder");
  expect(reader, contact.distance <= ed::DistanceMethod::newton5, "the method of distances");
  expect(reader, contact.root <= ed::ContactRoot::one_dimensional, "the method of roots");
  expect(reader, options.envelope >= 0 && std::isfinite(options.envelope), "the thickness of envelopes");
  expect(reader, options.prepare_from >= 0, "the number of bodies from which on memory is prefetched");
  expect(reader, options.least_progress > 0 && std::isfinite(options.least_progress), "the criterion of a stall");
  expect(reader, !options.batches || *options.batches <= geom::InstructionSet::avx512, "the instruction set");
}

/// Throws std::invalid_argument unless a stored text is `here`: without that bits differ.
void check_same(Reader& reader, const char* what, const std::string& here) {
  const auto there = reader.value<std::string>();
  if (there == here) return;
  throw std::invalid_argument(std::string("state: was saved ") + what + " \"" + there + "\", here \"" + here +
                              "\", which would change bits; accepted: the same");
}

void put_species(Writer& writer, const std::vector<ed::Species>& list) {
  writer(std::uint64_t{list.size()});
  for (const ed::Species& species : list) {
    const auto* custom = std::get_if<ed::CustomShape>(&species.shape);
    writer(custom != nullptr);
    if (custom != nullptr) {
      writer(custom->name());
    } else {
      writer(species.shape);
    }
    writer(species.mass, species.inertia, species.spins);
  }
}

std::vector<ed::Species> get_species(Reader& reader, const std::vector<ed::CustomShape>& shapes) {
  std::vector<ed::Species> list;
  std::size_t used = 0;
  for (auto left = reader.value<std::uint64_t>(); left > 0; --left) {
    ed::Species& species = list.emplace_back();
    if (reader.value<bool>()) {
      const auto name = reader.value<std::string>();
      if (used == shapes.size()) {
        throw std::invalid_argument(
            "state: needs the shape \"" + name +
            "\", which is code; accepted: shapes=[...], your own in the order of their species");
      }
      species.shape = shapes[used++];
    } else {
      reader(species.shape);
    }
    reader(species.mass, species.inertia, species.spins);
  }
  if (used < shapes.size()) {
    throw std::invalid_argument("shapes has " + std::to_string(shapes.size()) + " shapes; accepted: " +
                                std::to_string(used) + ", as many of your own as the state has");
  }
  return list;
}

[[noreturn]] void refuse_bytes(const char* what) {
  throw std::invalid_argument(std::string("state: ") + what + "; accepted: what Simulation.save has made");
}

/// Returns the bytes between head and checksum. Throws std::invalid_argument if they are damaged.
std::string_view checked_bytes(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) refuse_bytes("is not that of a simulation");
  if (bytes.size() < kMagic.size() + kTail) refuse_bytes("is cut off");
  const std::string_view content = bytes.substr(0, bytes.size() - kTail);
  if (Reader(bytes.substr(content.size())).value<std::uint64_t>() != XXH3_64bits(content.data(), content.size())) {
    refuse_bytes("is damaged, its checksum does not fit");
  }
  return content.substr(kMagic.size());
}

}  // namespace

void PythonSimulation::save(const std::function<void(std::string_view)>& sink) const {
  const ed::Simulation& simulation = whole();
  Checksum checksum;
  const auto summed = [&](std::string_view piece) {
    checksum.add(piece);
    sink(piece);
  };
  Writer writer(summed);
  writer.raw(kMagic);
  writer(kFormat, std::string(version()), arithmetic(), cpu_feature_text());
  put_or_get(writer, options_);
  writer(groups_, seen_);
  put_species(writer, simulation.system().species);
  writer(std::uint64_t{measurements_.size()});
  for (const auto& m : measurements_) writer(m->options, m->options.time_unit, m->observables.save());
  writer.flush();
  simulation.save(summed);
  sink(ed::archive::bytes_of(checksum.value()));
}

PythonSimulation PythonSimulation::restore(std::string_view bytes, const std::vector<ed::CustomShape>& shapes) {
  try {
    return restore_checked(bytes, shapes);
  } catch (const std::invalid_argument& error) {
    const std::string message = one_line(error.what());
    throw std::invalid_argument(message.starts_with("state: ") || message.starts_with("shapes ") ? message
                                                                                                 : "state: " + message);
  }
}

PythonSimulation PythonSimulation::restore_checked(std::string_view bytes, const std::vector<ed::CustomShape>& shapes) {
  Reader reader(checked_bytes(bytes));
  ed::archive::check_format(reader, kFormat);
  check_same(reader, "by hardbody", version());
  check_same(reader, "by a build with", arithmetic());
  check_same(reader, "on a processor with", cpu_feature_text());
  ed::SimulationOptions options;
  put_or_get(reader, options);
  check_options(reader, options);
  const auto groups = reader.value<std::vector<int>>();
  const auto seen = reader.value<ed::Counters>();
  const std::vector<ed::Species> species = get_species(reader, shapes);
  std::vector<std::shared_ptr<Measurement>> measurements;
  for (auto left = reader.value<std::uint64_t>(); left > 0; --left) {
    ed::ObservablesOptions how{};
    reader(how, how.time_unit);
    const auto state = reader.value<std::string>();
    ed::Observables observables = ed::Observables::restore(state, how);
    measurements.push_back(std::make_shared<Measurement>(Measurement{std::move(how), std::move(observables)}));
  }
  const std::int64_t bodies = std::accumulate(groups.begin(), groups.end(), std::int64_t{0});
  ed::Simulation simulation = ed::Simulation::restore(reader.raw(reader.left()), species, options);
  const bool filled = std::ranges::all_of(groups, [](int number) { return number > 0; });
  ed::archive::expect(reader, filled && bodies == simulation.system().size(), "the groups of bodies");
  for (const auto& m : measurements) {
    ed::archive::expect(reader, m->options.number == bodies, "the number of bodies that are measured");
  }
  PythonSimulation made(std::move(simulation), options, groups);
  made.seen_ = seen;
  made.measurements_ = std::move(measurements);
  return made;
}

}  // namespace hardbody::python
