#include "observables/block_averages.h"
#include "observables/curves.h"
#include "observables/measured.h"

#include <ed/stored_frames.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ed {
namespace {

using Eigen::Vector3d;
using internal::Block;
using internal::BodyRange;
using internal::kNothing;
using internal::Measured;

constexpr double kLagsPerDecade = 20;
constexpr double kBlocks = 16;            ///< largest number of blocks
constexpr double kEquallyFar = 1e-6;      ///< relative to the distance of frames in time
constexpr double kDefaultShare = 0.25;    ///< default longest lag, as a share of the stretch
constexpr std::size_t kLogStretches = 4;  ///< a stretch of more frames than this share is taken, though times grow

std::string text_of(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

void check(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("analyze_frames: " + what);
  };
  require(!frames.empty(), "no frames; accepted: one at least");
  require(options.box > 0 && std::isfinite(options.box), "box; accepted: a positive number");
  require(options.length > 0 && options.length > 1e-6 * options.box,
          "length; accepted: a positive number above 1e-6 of the box");
  require(options.axial_length >= 0 && std::isfinite(options.axial_length),
          "axial_length; accepted: 0, or a positive finite number");
  const std::size_t n = frames[0].position.size();
  require(options.axis.size() == n, "axis; accepted: one of each body");
  require(!options.fit_from || (*options.fit_from >= 0 && std::isfinite(*options.fit_from)),
          "fit_from; accepted: a finite lag that is not negative");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const StoredFrame& f = frames[k];
    const auto all_or_none = [n](const auto& of, const auto& first) {
      return of.size() == first.size() && (of.empty() || of.size() == n);
    };
    require(f.position.size() == n && all_or_none(f.rotation, frames[0].rotation) &&
                all_or_none(f.velocity, frames[0].velocity),
            "frame " + std::to_string(k) + "; accepted: as many bodies as in the first one");
    require(std::isfinite(f.time) && (k == 0 || f.time > frames[k - 1].time),
            "time of frame " + std::to_string(k) + " is " + text_of(f.time) +
                (k > 0 ? ", that of the one before " + text_of(frames[k - 1].time) : "") +
                "; accepted: finite times that rise");
  }
}

/// Frames that are equally far apart in time.
struct Stretch {
  std::size_t first;
  std::size_t count;
};

/// End of the longest stretch from `first` on.
std::size_t end_of_stretch(const std::vector<StoredFrame>& frames, std::size_t first) {
  if (frames.size() < first + 3) return frames.size();
  const double begin = frames[first].time;
  const double step = frames[first + 1].time - begin;
  const auto fits = [&](std::size_t k) {
    return std::abs(frames[k].time - begin - static_cast<double>(k - first) * step) <= kEquallyFar * step;
  };
  std::size_t end = first + 2;
  while (end < frames.size() && fits(end)) ++end;
  return end;
}

/// The longest stretch, the first one of several.
Stretch longest_stretch(const std::vector<StoredFrame>& frames) {
  Stretch longest{0, end_of_stretch(frames, 0)};
  // Two stretches share one frame at most.
  std::size_t end = longest.count;
  while (end < frames.size()) {
    const std::size_t first = end - 1;
    end = end_of_stretch(frames, first);
    if (end - first > longest.count) longest = {first, end - first};
  }
  return longest;
}

/// Whether frames from the second on are ever further apart and no stretch is worth much: those at logarithmic times.
bool at_log_times(const std::vector<StoredFrame>& frames, const Stretch& longest) {
  if (frames.size() < 3 || longest.count > std::max<std::size_t>(2, frames.size() / kLogStretches)) return false;
  // The first interval, to the shortest time, may be longer than the next.
  for (std::size_t k = 3; k < frames.size(); ++k) {
    const double before = frames[k - 1].time - frames[k - 2].time;
    if (frames[k].time - frames[k - 1].time < before * (1 - kEquallyFar)) return false;
  }
  return true;
}

/// Numbers of frames, evenly on a logarithmic scale.
std::vector<std::size_t> lag_steps(std::size_t longest) {
  std::vector<std::size_t> steps = {1};
  for (int k = 1; steps.back() < longest; ++k) {
    const auto next = static_cast<std::size_t>(std::lround(std::pow(10.0, k / kLagsPerDecade)));
    if (next > steps.back()) steps.push_back(std::min(next, longest));
  }
  return steps;
}

Snapshot snapshot_of(const StoredFrame& stored, const StoredFramesOptions& options, bool rotations) {
  Snapshot s;
  const std::size_t n = stored.position.size();
  s.time = stored.time;
  s.position = stored.position;
  const bool turned = !stored.rotation.empty();
  for (std::size_t i = 0; i < n; ++i) {
    s.axis.emplace_back(turned ? Vector3d(stored.rotation[i].col(options.axis[i])) : Vector3d::UnitZ());
  }
  s.phi_lab.assign(n, Vector3d::Zero());
  s.phi_body = s.angular_velocity = s.phi_lab;
  s.velocity = stored.velocity.empty() ? s.phi_lab : stored.velocity;
  if (rotations) s.rotation = turned ? stored.rotation : std::vector<Eigen::Matrix3d>(n, Eigen::Matrix3d::Identity());
  return s;
}

/// Returns what frames do not tell.
internal::Gaps gaps_of(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options) {
  internal::Gaps gaps;
  gaps.collisions = gaps.rotations = MissingReason::not_told;
  if (frames[0].velocity.empty()) gaps.velocities = gaps.velocity_correlations = MissingReason::not_told;
  if (frames[0].rotation.empty()) gaps.orientations = gaps.turning = MissingReason::not_told;
  if (!options.length_known) gaps.overlap = MissingReason::not_told;
  if (!options.unwrapped) gaps.displacements = gaps.overlap = MissingReason::not_unwrapped;
  if (!options.same_bodies) {
    gaps.displacements = gaps.overlap = gaps.turning = gaps.velocity_correlations = MissingReason::not_followed;
  }
  return gaps;
}

/// Blocks of frames in the place of those that a run measures.
class Analysis {
 public:
  Analysis(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options)
      : options_(options),
        stretch_(longest_stretch(frames)),
        log_times_(at_log_times(frames, stretch_)),
        count_(log_times_ ? frames.size() : stretch_.count),
        step_(count_ > 1 ? frames[stretch_.first + 1].time - frames[stretch_.first].time : 1),
        measured_(plan(frames)) {
    measured_.gaps = gaps_of(frames, options);
    if (!measured_.any_oriented()) measured_.gaps.without_orientations();
    const auto three = [](const BodyRange& r) { return r.three_axes; };
    const bool rotations = std::any_of(measured_.ranges.begin(), measured_.ranges.end(), three);
    for (const StoredFrame& frame : frames) {
      poll();
      frames_.push_back(snapshot_of(frame, options, rotations));
      directors_.push_back(measured_.director(frames_.back()));
    }
  }

  StoredResults results();

 private:
  void poll() const {
    if (options_.poll) options_.poll();
  }
  Measured plan(const std::vector<StoredFrame>& frames);
  void plan_steps(Measured& plan);
  void plan_log_times(const std::vector<StoredFrame>& frames, Measured& plan);
  void plan_blocks(std::size_t origins, Measured& plan) const;
  double fit_from() const;
  void add_structure();
  void add_lags();
  /// The block that frame k of the stretch is an origin of.
  Block& block_of(std::size_t k) { return measured_.blocks[k / static_cast<std::size_t>(measured_.origins_per_block)]; }
  /// The block that the structure of frame k of all is in: as many frames each.
  Block& structure_block_of(std::size_t k) {
    if (frames_.size() == count_) return block_of(k);
    return measured_.blocks[k * measured_.blocks.size() / frames_.size()];
  }

  const StoredFramesOptions& options_;
  Stretch stretch_;
  bool log_times_;     ///< frame 0 is the only origin, and each other one has a lag of its own
  std::size_t count_;  ///< number of frames in the stretch; all at logarithmic times
  double step_;
  std::vector<std::size_t> steps_;
  Measured measured_;
  std::vector<Snapshot> frames_;                  ///< frames of the trajectory
  std::vector<Vector3d> directors_;               ///< directors of these
  std::vector<internal::Amplitudes> amplitudes_;  ///< amplitudes of those of the stretch, if wanted
};

Measured Analysis::plan(const std::vector<StoredFrame>& frames) {
  if (log_times_) stretch_ = {0, count_};
  ObservablesOptions wanted{};
  wanted.number = static_cast<int>(options_.axis.size());
  wanted.duration = log_times_ ? frames.back().time - frames.front().time : step_ * static_cast<double>(count_);
  wanted.groups = options_.groups;
  wanted.wave_numbers = options_.wave_numbers;
  wanted.collective = options_.collective;
  wanted.bonds = options_.bonds;
  Measured plan(wanted);
  plan.grid = {options_.box, options_.length};
  plan.length_known = options_.length_known;
  plan.axial_length = options_.axial_length;
  plan.lags.clear();
  if (log_times_) {
    plan_log_times(frames, plan);
  } else {
    plan_steps(plan);
  }
  return plan;
}

/// Plans lags of whole numbers of steps, and blocks as long as the longest lag.
void Analysis::plan_steps(Measured& plan) {
  const double last = static_cast<double>(count_) - 1;
  const double longest =
      options_.longest_lag > 0 ? options_.longest_lag / step_ * (1 + kEquallyFar) : kDefaultShare * last;
  const auto steps = static_cast<std::size_t>(std::clamp(std::floor(longest), 1.0, std::max(1.0, last)));
  steps_ = lag_steps(steps);
  for (const std::size_t step : steps_) plan.lags.push_back(static_cast<double>(step) * step_);
  const double blocks = std::clamp(std::floor(static_cast<double>(count_) / static_cast<double>(steps)), 2.0, kBlocks);
  plan.spacing = step_;
  plan.origins_per_block = static_cast<int>(std::max(1.0, std::ceil(static_cast<double>(count_) / blocks)));
  plan_blocks(count_, plan);
  for (Block& block : plan.blocks) {
    const auto before = static_cast<double>(&block - plan.blocks.data()) * plan.origins_per_block;
    block.begin.time = before * step_;
    block.end.time = block.begin.time + block.origins * step_;
  }
}

/// Plans the lags of all frames behind the first one, and one block: no errors, for one origin has none.
void Analysis::plan_log_times(const std::vector<StoredFrame>& frames, Measured& plan) {
  const double duration = plan.options.duration;
  const double longest = options_.longest_lag > 0 ? options_.longest_lag * (1 + kEquallyFar) : duration;
  for (std::size_t k = 1; k < count_; ++k) {
    const double lag = frames[k].time - frames[0].time;
    if (k > 1 && lag > longest) break;
    steps_.push_back(k);
    plan.lags.push_back(lag);
  }
  plan.spacing = duration / static_cast<double>(count_);
  plan.origins_per_block = static_cast<int>(count_);
  plan_blocks(count_, plan);
  plan.blocks[0].end.time = duration;
}

void Analysis::plan_blocks(std::size_t origins, Measured& plan) const {
  const auto per_block = static_cast<std::size_t>(plan.origins_per_block);
  plan.choose_hove_lags();
  plan.blocks.resize((origins + per_block - 1) / per_block);
  for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
    Block& block = plan.blocks[b];
    plan.make_room(block);
    block.origins = static_cast<int>(std::min(per_block, origins - b * per_block));
  }
}

void Analysis::add_structure() {
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    poll();
    Block& block = structure_block_of(k);
    measured_.add_structure(frames_[k], block);
    measured_.add_order(frames_[k], block);
  }
}

void Analysis::add_lags() {
  if (measured_.options.collective) {
    for (std::size_t k = 0; k < count_; ++k) {
      poll();
      amplitudes_.push_back(measured_.amplitudes_of(frames_[stretch_.first + k]));
    }
  }
  for (std::size_t n = 0; n < steps_.size(); ++n) {
    const std::size_t origins = log_times_ ? 1 : count_ - std::min(count_, steps_[n]);
    for (std::size_t k = 0; k < origins; ++k) {
      poll();
      const std::size_t first = stretch_.first + k;
      Block& block = block_of(k);
      measured_.add_lag(frames_[first], directors_[first], frames_[first + steps_[n]], n, block);
      if (measured_.options.collective) {
        measured_.add_collective_lag(amplitudes_[k], amplitudes_[k + steps_[n]], n, block);
      }
    }
  }
}

/// The lag that decays are fitted from: that of the options, or the end of ballistic motion; NaN if it is not known.
double Analysis::fit_from() const {
  if (options_.fit_from) return *options_.fit_from;
  if (measured_.gaps.displacements) return kNothing;
  const internal::BlockAverages averages(measured_);
  return internal::end_of_ballistic(
      averages.curve(internal::kAll, {}, [](const internal::LagSums& s) { return s.msd; }));
}

StoredResults Analysis::results() {
  add_structure();
  internal::Totals totals;
  totals.time = log_times_ ? measured_.options.duration : step_ * static_cast<double>(count_ - 1);
  if (measured_.options.wave_numbers.empty()) {
    const std::optional<double> q = internal::first_wave_number_of(measured_);
    if (q && std::isfinite(*q)) measured_.options.wave_numbers = wave_numbers_about(*q);
  }
  add_lags();
  StoredResults results;
  results.fit_from = fit_from();
  static_cast<Results&>(results) = internal::results_of(measured_, totals, results.fit_from);
  results.wave_numbers = measured_.options.wave_numbers;
  results.first_frame = stretch_.first;
  results.frames = count_;
  results.log_times = log_times_;
  return results;
}

}  // namespace

StoredResults analyze_frames(const std::vector<StoredFrame>& frames, const StoredFramesOptions& options) {
  check(frames, options);
  return Analysis(frames, options).results();
}

}  // namespace ed
