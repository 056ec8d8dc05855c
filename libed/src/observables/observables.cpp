#include "base/archive.h"
#include "observables/measured.h"

#include <ed/archive_observables.h>
#include <ed/observables.h>
#include <ed/system.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace ed {
namespace {

using Eigen::Vector3d;
using internal::BodyRange;
using internal::Measured;

/// Raised by every change of what save() writes.
constexpr std::uint32_t kObservablesFormat = 8;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A frame that later ones are correlated with.
struct Origin {
  Snapshot frame;
  std::size_t next_lag = 0;
  std::size_t block = 0;
  Vector3d director = Vector3d::UnitZ();  ///< director of the frame
  internal::Amplitudes amplitudes{};      ///< empty where not yet computed, as in restored observables

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.frame, self.next_lag, self.block, self.director);
  }
};

BodyRange all_of(const Snapshot& snapshot) {
  return {0, snapshot.position.size(), false};
}

BodyRange range_of(int first, int number) {
  const auto begin = static_cast<std::size_t>(first);
  return {begin, begin + static_cast<std::size_t>(number), false};
}

}  // namespace

double structure_peak(const System& system) {
  constexpr int kVectors = 100;
  const internal::StructureGrid grid = internal::structure_grid(system);
  const internal::WaveVectors vectors(grid, 0, 8 / grid.length, kVectors);
  std::vector<Vector3d> positions;
  for (const Body& body : system.bodies) positions.push_back(body.position);
  const std::vector<double> S = vectors.structure_factor(positions, {0, positions.size(), false});
  return internal::first_peak(vectors.wave_numbers(), S, grid.length).q;
}

double nematic_order(const std::vector<Vector3d>& axes) {
  return internal::largest_eigenvalue(internal::order_tensor(axes, 0, axes.size()));
}

double c2_between(const Snapshot& origin, const Snapshot& now) {
  return internal::mean_p2(origin, now, all_of(now));
}
double msd_between(const Snapshot& origin, const Snapshot& now) {
  return internal::mean_square_displacement(origin, now, all_of(now));
}
double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number) {
  return internal::self_scattering(origin, now, all_of(now), wave_number);
}
double c2_between(const Snapshot& origin, const Snapshot& now, int first, int number) {
  return internal::mean_p2(origin, now, range_of(first, number));
}
double msd_between(const Snapshot& origin, const Snapshot& now, int first, int number) {
  return internal::mean_square_displacement(origin, now, range_of(first, number));
}
double f_self_between(const Snapshot& origin, const Snapshot& now, double wave_number, int first, int number) {
  return internal::self_scattering(origin, now, range_of(first, number), wave_number);
}

/// Schedule of the frames that are taken, and of the frames that they are correlated with.
class Observables::Impl {
 public:
  explicit Impl(const ObservablesOptions& options) : measured_(options) {}

  const ObservablesOptions& options() const { return measured_.options; }
  const Measured& measured() const { return measured_; }

  double next_time() const {
    const double next = next_due();
    // A sample at the very end is wanted despite the rounding of the sums in next_due().
    const double duration = options().duration;
    return next <= duration * (1 + 1e-12) ? std::min(next, duration) : kInfinity;
  }

  void measure(const Simulation& simulation) {
    // A longer run takes this sample a rounding error later.
    if (!before_end_ && next_due() > options().duration) before_end_ = copy();
    take_frame(simulation);
    last_ = now_.time;
    const double due = now_.time * (1 + 1e-12);
    for (Origin& origin : origins_) {
      while (origin.next_lag < measured_.lags.size() && origin.frame.time + measured_.lags[origin.next_lag] <= due) {
        correlate_with(origin);
        ++origin.next_lag;
      }
    }
    std::erase_if(origins_, [this](const Origin& o) { return o.next_lag == measured_.lags.size(); });
    if (next_origin_ <= due) start_origin(simulation);
  }

  void extend(double duration) {
    const bool later = duration > last_ && duration >= measured_.lags.back() && std::isfinite(duration);
    if (!later || (before_end_ && !(duration > options().duration))) {
      throw std::invalid_argument(
          "Observables: extend: duration; accepted: a finite time beyond the last measurement, at least the longest "
          "lag");
    }
    if (before_end_) {
      measured_ = std::move(before_end_->measured_);
      origin_count_ = before_end_->origin_count_;
      next_origin_ = before_end_->next_origin_;
      origins_ = std::move(before_end_->origins_);
      last_ = before_end_->last_;
      before_end_.reset();
    }
    // The default would follow the duration.
    measured_.options.longest_lag = measured_.lags.back();
    measured_.options.duration = duration;
  }

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    own_fields(archive, self);
    bool ended = self.before_end_ != nullptr;
    archive(ended);
    if (!ended) return;
    if (!self.before_end_) self.before_end_ = std::make_unique<Impl>(self.options());
    own_fields(archive, *self.before_end_);
  }

 private:
  /// now_ lives during a measurement only.
  template <class Archive, class Self>
  static void own_fields(Archive& archive, Self& self) {
    archive(self.measured_, self.origin_count_, self.next_origin_, self.origins_, self.last_);
    const auto fits = [&self](const Origin& origin) { return self.fits(origin); };
    expect(archive, std::all_of(self.origins_.begin(), self.origins_.end(), fits), "the origins of the observables");
  }

  /// Returns the time of the next measurement, whether or not the planned duration covers it.
  double next_due() const {
    double next = next_origin_;
    for (const Origin& origin : origins_) {
      next = std::min(next, origin.frame.time + measured_.lags[origin.next_lag]);
    }
    return next;
  }

  std::unique_ptr<Impl> copy() const {
    auto result = std::make_unique<Impl>(options());
    result->measured_ = measured_;
    result->origin_count_ = origin_count_;
    result->next_origin_ = next_origin_;
    result->origins_ = origins_;
    result->last_ = last_;
    return result;
  }

  bool three_axes() const {
    const std::vector<BodyRange>& ranges = measured_.ranges;
    return std::any_of(ranges.begin(), ranges.end(), [](const BodyRange& r) { return r.three_axes; });
  }

  bool fits(const Origin& origin) const {
    const Snapshot& s = origin.frame;
    const auto n = static_cast<std::size_t>(options().number);
    for (const auto* vectors : {&s.position, &s.axis, &s.phi_lab, &s.phi_body, &s.velocity, &s.angular_velocity}) {
      if (vectors->size() != n) return false;
    }
    if (!(std::abs(origin.director.norm() - 1) < 1e-9)) return false;
    return origin.frame.rotation.size() == (three_axes() ? n : 0) && origin.next_lag < measured_.lags.size() &&
           origin.block < measured_.blocks.size();
  }

  void take_frame(const Simulation& simulation) {
    measured_.any_oriented() ? simulation.sample(now_) : simulation.sample_translations(now_);
    amplitudes_now_.clear();
    if (!three_axes()) {
      now_.rotation.clear();
    } else if (now_.rotation.empty()) {
      for (const Body& body : simulation.system().bodies) now_.rotation.push_back(body.rotation);
    }
  }

  void correlate_with(Origin& origin) {
    internal::Block& block = measured_.blocks[origin.block];
    measured_.add_lag(origin.frame, origin.director, now_, origin.next_lag, block);
    if (!options().collective) return;
    if (origin.amplitudes.empty()) origin.amplitudes = measured_.amplitudes_of(origin.frame);
    measured_.add_collective_lag(origin.amplitudes, amplitudes_of_now(), origin.next_lag, block);
  }

  const internal::Amplitudes& amplitudes_of_now() {
    if (amplitudes_now_.empty()) amplitudes_now_ = measured_.amplitudes_of(now_);
    return amplitudes_now_;
  }

  void start_origin(const Simulation& simulation) {
    if (measured_.add_origin(simulation, now_)) {
      for (Origin& origin : origins_) origin.block /= 2;
    }
    origins_.push_back({now_, 0, measured_.blocks.size() - 1, measured_.director(now_),
                        options().collective ? amplitudes_of_now() : internal::Amplitudes{}});
    ++origin_count_;
    next_origin_ = static_cast<double>(origin_count_) * measured_.spacing;
  }

  Measured measured_;
  std::int64_t origin_count_ = 0;
  double next_origin_ = 0;
  std::deque<Origin> origins_;
  double last_ = 0;  ///< time of the last measurement
  Snapshot now_;
  std::unique_ptr<Impl> before_end_;  ///< state before a sample that was due just beyond the duration; see extend()
  internal::Amplitudes amplitudes_now_;
};

Observables::Observables(const ObservablesOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Observables::~Observables() = default;
Observables::Observables(Observables&&) noexcept = default;
Observables& Observables::operator=(Observables&&) noexcept = default;
double Observables::next_time() const {
  return impl_->next_time();
}
void Observables::measure(const Simulation& simulation) {
  impl_->measure(simulation);
}
void Observables::extend(double duration) {
  impl_->extend(duration);
}
Results Observables::results(const Simulation& simulation) const {
  return internal::results_of(impl_->measured(), internal::totals_of(simulation, impl_->measured().ranges));
}

std::string Observables::save() const {
  std::string bytes;
  save([&bytes](std::string_view piece) { bytes += piece; });
  return bytes;
}

void Observables::save(const std::function<void(std::string_view)>& sink) const {
  internal::Writer writer(sink);
  writer(kObservablesFormat, internal::bytes_of(impl_->options()));
  Impl::fields(writer, *impl_);
  writer.flush();
}

Observables Observables::restore(std::string_view state, const ObservablesOptions& options) {
  Observables observables(options);
  internal::Reader reader(state);
  internal::check_format(reader, kObservablesFormat);
  if (reader.value<std::string>() != internal::bytes_of(observables.impl_->options())) {
    throw std::invalid_argument("state: the observables are those of another run");
  }
  Impl::fields(reader, *observables.impl_);
  reader.finish();
  return observables;
}

}  // namespace ed
