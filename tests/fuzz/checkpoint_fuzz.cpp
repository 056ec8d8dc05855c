/// libFuzzer: the bytes of checkpoints, simulations and observables, without the checksum that keeps accidents out.
///
/// Whatever they are, they are refused with one line, or read and written again as the same bytes.

#include "base/errors.h"
#include "run/checkpoint.h"

#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

std::vector<ed::Species> species() {
  return {ed::paper_species(geom::Ellipsoid({1, 1, 2})),
          ed::uniform_species(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5))};
}

/// Two bodies: of revolution, or any.
ed::System two_bodies(bool any) {
  ed::System system;
  system.box = 20;
  system.species = species();
  if (!any) system.species.pop_back();
  system.bodies.resize(2);
  system.bodies[1].position.x() = 5;
  system.bodies[1].species = any ? 1 : 0;
  system.bodies[1].velocity.x() = -1;
  return system;
}

/// Returns a state of either kind that can be read.
std::string state(bool any) {
  ed::Simulation simulation(two_bodies(any));
  simulation.run_until(0.5);
  return simulation.save();
}

/// Replaces some bytes: (2 bytes of place, 1 of value) each. Bytes at random would never get past the first texts.
std::string changed(std::string bytes, std::string_view changes) {
  for (; changes.size() >= 3; changes.remove_prefix(3)) {
    const auto place = static_cast<unsigned char>(changes[0]) * 256U + static_cast<unsigned char>(changes[1]);
    bytes[place % bytes.size()] = changes[2];
  }
  return bytes;
}

void check_simulation(std::string_view changes, bool any) {
  static const std::string good[] = {state(false), state(true)};
  const std::string bytes = changed(good[any ? 1 : 0], changes);
  std::vector<ed::Species> kinds = species();
  if (!any) kinds.pop_back();
  try {
    const ed::Simulation read = ed::Simulation::restore(bytes, kinds);
    require(read.save() == bytes, "what is read is written again");
  } catch (const std::invalid_argument& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

void check_checkpoint(std::string_view bytes) {
  try {
    const hardbody::Checkpoint read = hardbody::decode_checkpoint(hardbody::seal_checkpoint(bytes), "fuzz");
    require(!read.system.bodies.empty(), "a checkpoint has bodies");
  } catch (const hardbody::InputError&) {
  }
}

/// Returns the bytes between head and checksum of a checkpoint.
std::string payload() {
  constexpr std::size_t kHead = 24;
  constexpr std::size_t kTail = 8;
  hardbody::Checkpoint checkpoint;
  checkpoint.phase = "start";
  checkpoint.system = two_bodies(true);
  const std::string bytes = hardbody::encode_checkpoint(checkpoint);
  return bytes.substr(kHead, bytes.size() - kHead - kTail);
}

const ed::ObservablesOptions& observables_options() {
  static const ed::ObservablesOptions options{2, 1, 0.1};
  return options;
}

std::string observables() {
  ed::Simulation simulation(two_bodies(false));
  ed::Observables result(observables_options());
  while (result.next_time() <= 0.5) {
    simulation.run_until(result.next_time());
    result.measure(simulation);
  }
  return result.save();
}

void check_observables(std::string_view changes) {
  static const std::string good = observables();
  const std::string bytes = changed(good, changes);
  try {
    const ed::Observables read = ed::Observables::restore(bytes, observables_options());
    require(read.save() == bytes, "what is read is written again");
  } catch (const std::invalid_argument& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  static const std::string good = payload();
  switch (data[0] % 5) {
    case 0:
    case 1:
      check_simulation(rest, data[0] % 5 == 1);
      break;
    case 2:
      check_checkpoint(rest);
      break;
    case 3:
      check_checkpoint(changed(good, rest));
      break;
    default:
      check_observables(rest);
  }
  return 0;
}
