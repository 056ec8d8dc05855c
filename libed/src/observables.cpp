#include <ed/observables.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <stdexcept>

namespace ed {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr double kLongestLag = 40;     ///< default cap: MSD slopes have settled well before, errors grow beyond
constexpr double kShortestLag = 1e-3;  ///< in units of the longest lag
constexpr double kLagsPerDecade = 20;
constexpr int kOriginsPerLongestLag = 16;
constexpr std::size_t kMaxBlocks = 32;
constexpr double kFitFrom = 0.4;    ///< diffusion is fitted from this share of the longest lag
constexpr double kLinearity = 0.2;  ///< of the logarithmic slope of a displacement that counts as diffusion
/// C2 is fitted from this many mean collision intervals: before, rotation is ballistic.
constexpr double kBallisticCollisions = 5;

/// Sums over the origins of a block of what is measured at one lag.
struct LagSums {
  double count = 0;
  double msd = 0;
  double rot_msd = 0;
  double rot_msd_body = 0;
  double c2 = 0;

  LagSums& operator+=(const LagSums& other) {
    count += other.count;
    msd += other.msd;
    rot_msd += other.rot_msd;
    rot_msd_body += other.rot_msd_body;
    c2 += other.c2;
    return *this;
  }
};

/// Totals at an instant, whose differences give block averages.
struct Totals {
  double time = 0;
  double collisions = 0;
  double virial = 0;
};

struct Block {
  std::vector<LagSums> lags;
  Totals begin;
  Totals end;
  double frames = 0;
  double S = 0;
  double translational_kT = 0;
  double rotational_kT = 0;
  int origins = 0;
};

struct Origin {
  Snapshot snapshot;
  std::size_t next_lag = 0;
  std::size_t block = 0;
};

LagSums correlate(const Snapshot& a, const Snapshot& b) {
  LagSums sums;
  const std::size_t n = a.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double x = a.axis[i].dot(b.axis[i]);
    sums.msd += (b.position[i] - a.position[i]).squaredNorm();
    sums.rot_msd += (b.phi_lab[i] - a.phi_lab[i]).squaredNorm();
    sums.rot_msd_body += (b.phi_body[i] - a.phi_body[i]).squaredNorm();
    sums.c2 += 1.5 * x * x - 0.5;
  }
  const auto bodies = static_cast<double>(n);
  sums.count = 1;
  sums.msd /= bodies;
  sums.rot_msd /= bodies;
  sums.rot_msd_body /= bodies;
  sums.c2 /= bodies;
  return sums;
}

std::vector<double> log_lags(double longest) {
  std::vector<double> lags;
  const int number = static_cast<int>(std::ceil(-std::log10(kShortestLag) * kLagsPerDecade));
  for (int k = -number; k <= 0; ++k) lags.push_back(longest * std::pow(10.0, k / kLagsPerDecade));
  return lags;
}

/// By what the standard error of block averages must be multiplied for a correlation at `lag`: the origins of a block
/// lie in one `length` of time, but look ahead by the lag, so that neighbouring blocks share data.
///
/// For displacements of a Brownian particle the averages over the origins of two neighbouring blocks have the
/// correlation coefficient rho = f / (8 - 2 f), f = lag / length <= 1 (the variance is the integral of
/// (1 - s/length) (1 - s/lag)^2 over the offset s, the covariance that of s (1 - s/lag)^2), and the mean of many blocks
/// then has the variance (1 + 2 rho) times that of independent ones: at most 4/3.
double shared_data_factor(double lag, double length) {
  const double f = std::min(1.0, lag / length);
  return std::sqrt(1 + 2 * f / (8 - 2 * f));
}

/// A correlation against lag, for one block or for all.
struct Curve {
  std::vector<double> t;
  std::vector<double> y;
};

/// D = slope / divisor over the fit window, if the curve is straight there.
double diffusion(const Curve& curve, double divisor) {
  if (curve.t.empty()) return std::numeric_limits<double>::quiet_NaN();
  Curve window;
  Curve logarithms;
  for (std::size_t k = 0; k < curve.t.size(); ++k) {
    if (curve.t[k] < kFitFrom * curve.t.back() * (1 - 1e-9) || !(curve.y[k] > 0)) continue;
    window.t.push_back(curve.t[k]);
    window.y.push_back(curve.y[k]);
    logarithms.t.push_back(std::log(curve.t[k]));
    logarithms.y.push_back(std::log(curve.y[k]));
  }
  const auto exponent = slope(logarithms.t, logarithms.y);
  const auto rate = slope(window.t, window.y);
  if (!exponent || !rate || std::abs(*exponent - 1) > kLinearity) return std::numeric_limits<double>::quiet_NaN();
  return *rate / divisor;
}

/// The C2 fit with the ballistic part and the noise at the end left out; nothing where rotation is ballistic all the
/// way.
std::optional<StretchedExponential> fit_c2(const Curve& c2, double collision_rate) {
  const double from = kBallisticCollisions / collision_rate;
  const auto decayed = first_crossing(c2.t, c2.y, 1 / std::exp(1.0));
  // Without collisions `from` is no number.
  if (!decayed || !(*decayed >= 3 * from)) return std::nullopt;
  Curve window;
  for (std::size_t k = 0; k < c2.t.size() && c2.y[k] > 0.03; ++k) {
    if (c2.t[k] < from) continue;
    window.t.push_back(c2.t[k]);
    window.y.push_back(c2.y[k]);
  }
  return fit_stretched_exponential(window.t, window.y);
}

}  // namespace

double nematic_order(const std::vector<Eigen::Vector3d>& axes) {
  Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& u : axes) Q += 1.5 * u * u.transpose();
  Q = Q / static_cast<double>(axes.size()) - 0.5 * Eigen::Matrix3d::Identity();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Q, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

double c2_between(const Snapshot& origin, const Snapshot& now) {
  return correlate(origin, now).c2;
}
double msd_between(const Snapshot& origin, const Snapshot& now) {
  return correlate(origin, now).msd;
}

class Observables::Impl {
 public:
  explicit Impl(const ObservablesOptions& options) : options_(options) {
    if (!(options.duration > 0) || !std::isfinite(options.duration) || options.number < 1) {
      throw std::invalid_argument(
          "Observables: duration and number; accepted: a positive finite time, at least 1 body");
    }
    double longest = options.longest_lag;
    if (!(longest > 0)) longest = std::min(kLongestLag, options.duration / 16);
    lags_ = log_lags(longest);
    const int origins = std::clamp(160000 / std::max(1, options.number), 1, kOriginsPerLongestLag);
    spacing_ = longest / origins;
    origins_per_block_ = origins;
  }

  double next_time() const {
    double next = next_origin_;
    for (const Origin& origin : origins_) {
      next = std::min(next, origin.snapshot.time + lags_[origin.next_lag]);
    }
    // A sample at the very end is wanted despite the rounding of the sums above.
    return next <= options_.duration * (1 + 1e-12) ? std::min(next, options_.duration) : kInfinity;
  }

  void measure(const Simulation& simulation) {
    simulation.sample(now_);
    const double due = now_.time * (1 + 1e-12);
    for (Origin& origin : origins_) {
      while (origin.next_lag < lags_.size() && origin.snapshot.time + lags_[origin.next_lag] <= due) {
        blocks_[origin.block].lags[origin.next_lag] += correlate(origin.snapshot, now_);
        ++origin.next_lag;
      }
    }
    std::erase_if(origins_, [this](const Origin& o) { return o.next_lag == lags_.size(); });
    if (next_origin_ <= due) start_origin(simulation);
  }

  Results results(const Simulation& simulation) const;

 private:
  void start_origin(const Simulation& simulation) {
    const Totals totals = totals_of(simulation);
    if (blocks_.empty() || blocks_.back().origins == origins_per_block_) {
      if (!blocks_.empty()) blocks_.back().end = totals;
      if (blocks_.size() == kMaxBlocks) merge_blocks();
      if (blocks_.empty() || blocks_.back().origins == origins_per_block_) {
        blocks_.emplace_back();
        blocks_.back().lags.resize(lags_.size());
        blocks_.back().begin = totals;
      }
    }
    Block& block = blocks_.back();
    const KineticState kinetic = simulation.kinetic();
    block.origins += 1;
    block.frames += 1;
    block.S += nematic_order(now_.axis);
    block.translational_kT += kinetic.translational_kT;
    block.rotational_kT += kinetic.rotational_kT;
    block.end = totals;
    origins_.push_back({now_, 0, blocks_.size() - 1});
    ++origin_count_;
    next_origin_ = static_cast<double>(origin_count_) * spacing_;
  }

  void merge_blocks() {
    for (std::size_t k = 0; k + 1 < blocks_.size(); k += 2) {
      Block merged = blocks_[k];
      const Block& other = blocks_[k + 1];
      for (std::size_t lag = 0; lag < lags_.size(); ++lag) merged.lags[lag] += other.lags[lag];
      merged.end = other.end;
      merged.frames += other.frames;
      merged.S += other.S;
      merged.translational_kT += other.translational_kT;
      merged.rotational_kT += other.rotational_kT;
      merged.origins += other.origins;
      blocks_[k / 2] = merged;
    }
    blocks_.resize(blocks_.size() / 2);
    for (Origin& origin : origins_) origin.block /= 2;
    origins_per_block_ *= 2;
  }

  static Totals totals_of(const Simulation& simulation) {
    return {simulation.time(), static_cast<double>(simulation.counters().collisions), simulation.virial()};
  }

  /// Blocks that are complete, or at least half so: what errors are made of.
  std::vector<const Block*> full_blocks() const {
    std::vector<const Block*> full;
    for (const Block& block : blocks_) {
      if (2 * block.origins > origins_per_block_ && block.end.time > block.begin.time) full.push_back(&block);
    }
    return full;
  }

  BlockRow block_row(const Block& block) const {
    const double time = block.end.time - block.begin.time;
    BlockRow row{};
    row.begin = block.begin.time;
    row.end = block.end.time;
    row.collision_rate = 2 * (block.end.collisions - block.begin.collisions) / (options_.number * time);
    row.translational_kT = block.translational_kT / block.frames;
    row.rotational_kT = block.rotational_kT / block.frames;
    row.S = block.S / block.frames;
    row.Z = 1 + (block.end.virial - block.begin.virial) / (3 * options_.number * row.translational_kT * time);
    return row;
  }

  template <class Value>
  Curve curve(const Block* one, const Value& value) const {
    Curve result;
    for (std::size_t k = 0; k < lags_.size(); ++k) {
      LagSums sums;
      if (one != nullptr) {
        sums = one->lags[k];
      } else {
        for (const Block& block : blocks_) sums += block.lags[k];
      }
      if (!(sums.count > 0)) continue;
      result.t.push_back(lags_[k]);
      result.y.push_back(value(sums) / sums.count);
    }
    return result;
  }

  /// The value from all data, with the standard error of the values from each block, for a quantity that depends on
  /// correlations up to `lag`.
  template <class Of>
  Estimate with_block_error(double lag, const Of& of) const {
    Estimate all{of(nullptr), std::numeric_limits<double>::quiet_NaN()};
    if (!std::isfinite(all.value)) return {};
    std::vector<double> values;
    for (const Block* block : full_blocks()) {
      const double value = of(block);
      if (std::isfinite(value)) values.push_back(value);
    }
    all.error = shared_data_factor(lag, origins_per_block_ * spacing_) * mean_of_blocks(values).error;
    return all;
  }

  template <class Value>
  Estimate diffusion_estimate(double divisor, const Value& value) const {
    return with_block_error(lags_.back(), [&](const Block* block) {
      const Curve all = curve(block, value);
      // A block whose origins have not reached the longest lag would be fitted over another window.
      if (all.t.empty() || all.t.back() < lags_.back()) return std::numeric_limits<double>::quiet_NaN();
      return diffusion(all, divisor);
    });
  }

  void add_lag_rows(Results& results) const;

  ObservablesOptions options_;
  std::vector<double> lags_;
  double spacing_ = 0;
  int origins_per_block_ = 0;
  std::int64_t origin_count_ = 0;
  double next_origin_ = 0;
  std::deque<Origin> origins_;
  std::vector<Block> blocks_;
  Snapshot now_;
};

void Observables::Impl::add_lag_rows(Results& results) const {
  const auto estimate = [&](std::size_t k, double LagSums::*member) {
    return with_block_error(lags_[k], [&](const Block* one) {
      LagSums sums;
      if (one != nullptr) {
        sums = one->lags[k];
      } else {
        for (const Block& block : blocks_) sums += block.lags[k];
      }
      return sums.count > 0 ? sums.*member / sums.count : std::numeric_limits<double>::quiet_NaN();
    });
  };
  for (std::size_t k = 0; k < lags_.size(); ++k) {
    const LagRow row{lags_[k], estimate(k, &LagSums::msd), estimate(k, &LagSums::rot_msd),
                     estimate(k, &LagSums::rot_msd_body), estimate(k, &LagSums::c2)};
    if (std::isfinite(row.msd.value)) results.lags.push_back(row);
  }
}

Results Observables::Impl::results(const Simulation& simulation) const {
  Results results;
  results.duration = simulation.time();
  std::vector<double> rate, Z, kT, kR, S;
  for (const Block* block : full_blocks()) {
    const BlockRow row = block_row(*block);
    results.blocks.push_back(row);
    rate.push_back(row.collision_rate);
    Z.push_back(row.Z);
    kT.push_back(row.translational_kT);
    kR.push_back(row.rotational_kT);
    S.push_back(row.S);
  }
  results.translational_kT = mean_of_blocks(kT);
  results.rotational_kT = mean_of_blocks(kR);
  results.S = mean_of_blocks(S);
  const Totals totals = totals_of(simulation);
  if (totals.collisions > 0 && totals.time > 0) {
    results.collision_rate = {2 * totals.collisions / (options_.number * totals.time), mean_of_blocks(rate).error};
    if (!kT.empty()) {
      results.Z = {1 + totals.virial / (3 * options_.number * results.translational_kT.value * totals.time),
                   mean_of_blocks(Z).error};
    }
  }
  add_lag_rows(results);
  results.D_trans = diffusion_estimate(6, [](const LagSums& s) { return s.msd; });
  results.D_rot = diffusion_estimate(4, [](const LagSums& s) { return s.rot_msd; });
  results.D_rot_body = diffusion_estimate(4, [](const LagSums& s) { return s.rot_msd_body; });
  const auto c2 = [](const LagSums& s) { return s.c2; };
  results.t_C2_1overe = with_block_error(lags_.back(), [&](const Block* block) {
    const Curve all = curve(block, c2);
    return first_crossing(all.t, all.y, 1 / std::exp(1.0)).value_or(std::numeric_limits<double>::quiet_NaN());
  });
  const auto fitted = [&](double StretchedExponential::*member) {
    return with_block_error(lags_.back(), [&](const Block* block) {
      const auto fit = fit_c2(curve(block, c2), results.collision_rate.value);
      return fit ? (*fit).*member : std::numeric_limits<double>::quiet_NaN();
    });
  };
  results.tau_C2 = fitted(&StretchedExponential::tau);
  results.beta_C2 = fitted(&StretchedExponential::beta);
  return results;
}

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
Results Observables::results(const Simulation& simulation) const {
  return impl_->results(simulation);
}

}  // namespace ed
