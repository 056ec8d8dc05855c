#include "saver.h"

#include "checkpoint.h"
#include "config_text.h"
#include "version.h"

#include <fmt/format.h>

#include <exception>
#include <string>

namespace hardbody {

Saver::Saver(const RunDirectory& directory, const Config& config, Progress& progress, Log& log)
    : directory_(directory), config_(config), progress_(progress), log_(log), last_(Clock::now()) {}

bool Saver::due() const {
  return std::chrono::duration<double>(Clock::now() - last_).count() >= config_.checkpoint_seconds();
}

void Saver::save(const ed::System& system, double time) {
  try {
    write(system, time);
  } catch (const std::exception& error) {
    const std::string text = fmt::format("no checkpoint at time {:g} of {}: {}", time, phase_, error.what());
    log_.line(text);
    progress_.say(text);
  }
  last_ = Clock::now();
}

void Saver::write(const ed::System& system, double time) const {
  Checkpoint checkpoint;
  checkpoint.program_version = version();
  checkpoint.config = resolved_text(config_);
  for (const std::string& feature : cpu_features()) {
    checkpoint.cpu_features += (checkpoint.cpu_features.empty() ? "" : " ") + feature;
  }
  checkpoint.phase = phase_;
  checkpoint.time = time;
  checkpoint.system = system;
  directory_.write(kCheckpointFile, encode_checkpoint(checkpoint));
}

}  // namespace hardbody
