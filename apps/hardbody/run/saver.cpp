#include "run/saver.h"

#include "base/version.h"
#include "config/text.h"

#include <fmt/format.h>

#include <exception>

namespace hardbody {

Saver::Saver(const RunDirectory& directory, const Config& config, Upkeep earlier, Progress& progress, Log& log)
    : directory_(directory), config_(config), upkeep_(earlier), progress_(progress), log_(log), last_(Clock::now()) {}

bool Saver::due() const {
  return std::chrono::duration<double>(Clock::now() - last_).count() >= config_.checkpoint_seconds();
}

Upkeep Saver::upkeep() const {
  Upkeep now = upkeep_;
  now.seconds += log_.seconds();
  return now;
}

void Saver::save(const std::function<Checkpoint()>& make) {
  try {
    write(make());
  } catch (const std::exception& error) {
    ++upkeep_.checkpoints_failed;
    announce(fmt::format("no checkpoint: {}", error.what()), progress_, log_);
  }
  last_ = Clock::now();
}

void Saver::write(Checkpoint checkpoint) {
  checkpoint.program_version = version();
  checkpoint.config = resolved_text(config_);
  checkpoint.cpu_features = cpu_feature_text();
  checkpoint.arithmetic = arithmetic();
  const double production_seconds = checkpoint.upkeep.production_seconds;
  checkpoint.upkeep = upkeep();
  checkpoint.upkeep.production_seconds = production_seconds;
  // Itself included: if it is not written nobody reads that it was.
  ++checkpoint.upkeep.checkpoints;
  directory_.write(kCheckpointFile, [&checkpoint](const Sink& sink) { encode_checkpoint(checkpoint, sink); });
  ++upkeep_.checkpoints;
}

}  // namespace hardbody
