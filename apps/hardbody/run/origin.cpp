#include "run/origin.h"

#include "base/errors.h"
#include "config/keys.h"
#include "io/run_directory.h"
#include "run/checkpoint.h"
#include "start/agreement.h"

#include <fmt/format.h>

#include <filesystem>

namespace hardbody {

ed::System read_origin_state(const Config& config) {
  const std::filesystem::path file = std::filesystem::path(*config.start_from) / kCheckpointFile;
  const Checkpoint checkpoint = read_checkpoint(file);
  const auto refuse = [&](const std::string& why, const std::string& accepted) {
    return InputError(fmt::format("{}: {} {}; accepted: {}", kStartFromKey, file.string(), why, accepted));
  };
  if (!checkpoint.run || !checkpoint.run->finished) {
    throw refuse("is of a run that is not finished", "the directory of a finished run");
  }
  const Agreement same = compare(checkpoint.system, config);
  if (!same.number) {
    throw refuse(fmt::format("holds {} bodies, {} is {}", checkpoint.system.size(), kNumberKey, config.number),
                 "a run of as many");
  }
  if (!same.shape) throw refuse("holds bodies of another shape", "a run of the same bodies");
  if (!same.dynamics) throw refuse("holds bodies of other mass or inertia", "a run of the same bodies");
  const double phi = ed::packing_fraction(checkpoint.system);
  if (phi > config.packing_fraction * (1 + kStateRounding)) {
    throw refuse(fmt::format("has packing fraction {:g}, {} is {:g}", phi, kPackingKey, config.packing_fraction),
                 "a run that is not denser");
  }
  return checkpoint.system;
}

}  // namespace hardbody
