#include "base/archive.h"
#include "observables/frame_sums.h"
#include "observables/order/stationarity.h"
#include "observables/structure.h"

#include <ed/analysis.h>
#include <ed/archive_observables.h>
#include <ed/equilibration.h>
#include <ed/system.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

namespace ed {
namespace {

using internal::BodyRange;
using internal::StructureGrid;
using internal::WaveVectors;

/// Raised by every change of what save() writes.
constexpr std::uint32_t kEquilibrationFormat = 4;

constexpr double kDecayed = 0.05;
constexpr std::size_t kLeastSamples = 4;  ///< least number of samples of a relaxation, one a time_unit
constexpr int kInARow = 2;
constexpr double kZDrift = 0.01;  ///< relative
constexpr double kSDrift = 0.05;
constexpr double kErrors = 3;  ///< standard errors that are no drift
constexpr int kVectorsPerShell = 100;
/// Wave numbers, in inverse lengths, about those at which a first peak is looked for.
constexpr double kFrom = 1;
constexpr double kTo = 8;

/// True if the estimates differ by more than fluctuations and by more than `allowed`, or are NaN.
bool drifts(const Estimate& before, const Estimate& after, double allowed) {
  return !(std::abs(after.value - before.value) <= std::max(allowed, kErrors * std::hypot(before.error, after.error)));
}

}  // namespace

class EquilibrationMonitor::Impl {
 public:
  explicit Impl(const std::vector<RelaxingGroup>& groups) {
    int first = 0;
    for (const RelaxingGroup& group : groups) {
      if (group.number < 1) throw std::invalid_argument("EquilibrationMonitor: groups; accepted: numbers above 0");
      const auto begin = static_cast<std::size_t>(first);
      ranges_.push_back({begin, begin + static_cast<std::size_t>(group.number), false});
      turns_.push_back(group.turns);
      first += group.number;
    }
    stationarity_ = internal::Stationarity(turning_ranges());
  }

  void begin(const Simulation& simulation) {
    simulation.sample(origin_);
    if (ranges_.empty() || ranges_.back().end != origin_.position.size()) {
      throw std::invalid_argument("EquilibrationMonitor: groups; accepted: numbers that add up to that of the bodies");
    }
    grid_ = internal::structure_grid(simulation.system());
    packing_fraction_ = packing_fraction(simulation.system());
    structure_.assign(grid_.shells(), 0);
    structure_before_ = structure_;
    virial_ = simulation.virial();
    time_ = simulation.time();
    stationarity_.begin(grid_.box, grid_.length);
    add_structure(origin_);
    q_ = state_.q;
  }

  void measure(const Simulation& simulation) {
    Snapshot now;
    simulation.sample(now);
    add_structure(now);
    add_sample(simulation, now);
    correlate(now);
    if (!(state_.f_self >= kDecayed) && !decayed_after_) decayed_after_ = now.time - origin_.time;
    judge_order(now);
    const bool over = state_.f_self < kDecayed && !(state_.c2 >= kDecayed) && S_.size() >= kLeastSamples;
    if (over) end_relaxation(now);
  }

  const Relaxation& state() const { return state_; }

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.state_, self.origin_, self.q_, self.grid_, self.packing_fraction_, self.structure_, self.frames_,
            self.structure_before_, self.frames_before_, self.Z_, self.S_, self.Z_before_.value, self.Z_before_.error,
            self.S_before_.value, self.S_before_.error, self.virial_, self.time_, self.decayed_after_,
            self.stationarity_);
    expect(archive, self.fits(), "the equilibration does not fit together");
  }

 private:
  bool fits() const {
    const std::size_t n = ranges_.empty() ? 0 : ranges_.back().end;
    for (const auto* vectors : {&origin_.position, &origin_.axis}) {
      if (vectors->size() != n) return false;
    }
    const bool grid = grid_.box > 0 && grid_.length > 0 && grid_.box < 1e6 * grid_.length;
    const bool sums = structure_.size() == grid_.shells() && structure_before_.size() == grid_.shells();
    const bool frames = frames_ >= 0 && frames_before_ >= 0 && frames_ + frames_before_ > 0 && packing_fraction_ > 0 &&
                        packing_fraction_ < 1;
    return grid && sums && frames && Z_.size() == S_.size();
  }

  /// Adds S(q) of a frame to that of the relaxation, and looks for the peak in that and in the one before.
  void add_structure(const Snapshot& now) {
    if (!vectors_) vectors_.emplace(grid_, kFrom / grid_.length, kTo / grid_.length, kVectorsPerShell);
    const std::vector<double> S = vectors_->structure_factor(now.position, {0, now.position.size(), false});
    for (std::size_t k = 0; k < S.size(); ++k) structure_[k] += S[k];
    frames_ += 1;
    const double frames = frames_ + frames_before_;
    std::vector<double> mean(S.size());
    for (std::size_t k = 0; k < S.size(); ++k) mean[k] = (structure_[k] + structure_before_[k]) / frames;
    state_.q = internal::likely_peak(*vectors_, mean, frames, grid_, packing_fraction_);
  }

  /// Z and S of the last time unit.
  void add_sample(const Simulation& simulation, const Snapshot& now) {
    const double kT = simulation.kinetic().translational_kT;
    const double virial = simulation.virial();
    const double time = simulation.time();
    Z_.push_back(1 + (virial - virial_) / (3 * static_cast<double>(now.axis.size()) * kT * (time - time_)));
    S_.push_back(internal::largest_eigenvalue(internal::order_tensor(now.axis, 0, now.axis.size())));
    virial_ = virial;
    time_ = time;
  }

  void correlate(const Snapshot& now) {
    state_.f_self = -1;
    state_.c2 = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t g = 0; g < ranges_.size(); ++g) {
      state_.f_self = std::max(state_.f_self, internal::self_scattering(origin_, now, ranges_[g], q_));
      // fmax: of a number and NaN it takes the number.
      if (turns_[g]) state_.c2 = std::fmax(state_.c2, internal::mean_p2(origin_, now, ranges_[g]));
    }
  }

  std::vector<BodyRange> turning_ranges() const {
    std::vector<BodyRange> turning;
    for (std::size_t g = 0; g < ranges_.size(); ++g) {
      if (turns_[g]) turning.push_back(ranges_[g]);
    }
    return turning;
  }

  void reach(EquilibratedBy by) {
    if (state_.reached) return;
    state_.reached = true;
    state_.by = by;
  }

  /// Judges order and pressure where that is due. Positions are forgotten if F_self has decayed and stayed so.
  void judge_order(const Snapshot& now) {
    stationarity_.add(now, Z_.back());
    if (!stationarity_.due()) return;
    const bool stayed = state_.f_self < kDecayed && decayed_after_ && now.time - origin_.time >= 2 * *decayed_after_;
    state_.order = stationarity_.judge(state_.relaxations > 0 || stayed);
    if (state_.order.stationary) reach(EquilibratedBy::stationarity);
  }

  void end_relaxation(const Snapshot& now) {
    const Estimate Z = mean_of_blocks(Z_);
    const Estimate S = mean_of_blocks(S_);
    state_.relaxations += 1;
    state_.relaxation_time = now.time - origin_.time;
    if (state_.relaxations >= kInARow) {
      state_.Z_change = Z.value / Z_before_.value - 1;
      state_.S_change = S.value - S_before_.value;
      const bool drifting = drifts(Z_before_, Z, kZDrift * Z.value) || drifts(S_before_, S, kSDrift);
      if (!drifting) reach(EquilibratedBy::decay);
    }
    Z_before_ = Z;
    S_before_ = S;
    Z_.clear();
    S_.clear();
    origin_ = now;
    decayed_after_.reset();
    q_ = state_.q;
    // The frame at which one ends and the next begins has been counted.
    structure_before_ = structure_;
    frames_before_ = frames_;
    std::fill(structure_.begin(), structure_.end(), 0.0);
    frames_ = 0;
  }

  std::vector<BodyRange> ranges_;  ///< bodies of each group
  std::vector<bool> turns_;
  Relaxation state_;
  Snapshot origin_;  ///< first frame of the current relaxation
  double q_ = 0;     ///< wave number at which that relaxation is measured
  StructureGrid grid_;
  std::optional<WaveVectors> vectors_;  ///< wave vectors of the grid, made when they are first used
  double packing_fraction_ = 0;
  std::vector<double> structure_;  ///< S(q), summed over the frames of the relaxation
  double frames_ = 0;
  std::vector<double> structure_before_;  ///< sum of the relaxation before
  double frames_before_ = 0;
  std::vector<double> Z_, S_;  ///< values of each time unit of the relaxation
  Estimate Z_before_, S_before_;
  double virial_ = 0;
  double time_ = 0;
  std::optional<double> decayed_after_;  ///< time from the relaxation's begin until F_self had decayed
  internal::Stationarity stationarity_;
};

EquilibrationMonitor::EquilibrationMonitor(const Simulation& simulation, const std::vector<RelaxingGroup>& groups)
    : impl_(std::make_unique<Impl>(groups)) {
  impl_->begin(simulation);
}
EquilibrationMonitor::EquilibrationMonitor(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EquilibrationMonitor::~EquilibrationMonitor() = default;
EquilibrationMonitor::EquilibrationMonitor(EquilibrationMonitor&&) noexcept = default;
EquilibrationMonitor& EquilibrationMonitor::operator=(EquilibrationMonitor&&) noexcept = default;

void EquilibrationMonitor::measure(const Simulation& simulation) {
  impl_->measure(simulation);
}
const Relaxation& EquilibrationMonitor::state() const {
  return impl_->state();
}

std::string EquilibrationMonitor::save() const {
  internal::Writer writer;
  writer(kEquilibrationFormat);
  Impl::fields(writer, *impl_);
  return writer.take();
}

EquilibrationMonitor EquilibrationMonitor::restore(std::string_view state, const std::vector<RelaxingGroup>& groups) {
  auto impl = std::make_unique<Impl>(groups);
  internal::Reader reader(state);
  internal::check_format(reader, kEquilibrationFormat);
  Impl::fields(reader, *impl);
  reader.finish();
  return EquilibrationMonitor(std::move(impl));
}

const char* to_string(EquilibratedBy by) {
  switch (by) {
    case EquilibratedBy::nothing:
      return "nothing";
    case EquilibratedBy::decay:
      return "decay";
    case EquilibratedBy::stationarity:
      return "stationarity";
  }
  return "unknown";
}

}  // namespace ed
