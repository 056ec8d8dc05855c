// Time correlations and averages over frames where they are known exactly, and against a recomputation from stored
// frames.

#include <common/ed/observed.h>
#include <common/ed/states.h>

#include <ed/ed.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace {

using ed_test::Inertia;
using ed_test::observed;
using ed_test::options_of;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Sums over some thousand terms of order 1, and positions of order 100 that differ by 1.
constexpr double kCorrelationRounding = 1e-11;

double sinc(double x) {
  return std::sin(x) / x;
}

/// The mean of f(body).
template <class F>
double mean(const ed::System& system, const F& f) {
  double sum = 0;
  for (const ed::Body& body : system.bodies) sum += f(body);
  return sum / system.size();
}

TEST(Correlations, OfFreeFlightAreExact) {
  const ed::System system = ed_test::maxwellian_gas(ed_test::species(3, Inertia::paper), 3, 200, 1);
  const std::vector<double> q = {0.5, 3, 11};
  const ed::Results results = observed(system, options_of(system, 20, 1, q));
  const double v2 = mean(system, [](const ed::Body& b) { return b.velocity.squaredNorm(); });
  const double v4 = mean(system, [](const ed::Body& b) { return std::pow(b.velocity.squaredNorm(), 2); });
  const double w2 = mean(system, [](const ed::Body& b) { return b.angular_velocity.squaredNorm(); });
  EXPECT_NEAR(results.v2.value, v2, kCorrelationRounding);
  EXPECT_NEAR(results.w2.value, w2, kCorrelationRounding * w2);
  for (const ed::LagRow& row : results.lags) {
    const double t = row.lag;
    EXPECT_NEAR(row.vacf.value, v2, kCorrelationRounding) << t;
    EXPECT_NEAR(row.wacf.value, w2, kCorrelationRounding * w2) << t;
    EXPECT_NEAR(row.alpha2.value, 3 * v4 / (5 * v2 * v2) - 1, 1e-8) << t;
    const double c1 = mean(system, [t](const ed::Body& b) { return std::cos(b.angular_velocity.norm() * t); });
    EXPECT_NEAR(row.c1.value, c1, kCorrelationRounding) << t;
    ASSERT_EQ(row.f_self.size(), q.size());
    for (std::size_t k = 0; k < q.size(); ++k) {
      const double wanted = mean(system, [&](const ed::Body& b) { return sinc(q[k] * b.velocity.norm() * t); });
      EXPECT_NEAR(row.f_self[k].value, wanted, 1e-10) << t;
    }
  }
}

TEST(Correlations, OfAMaxwellianGasAreGaussian) {
  // Displacements v t: alpha2 = 0, F_self = exp(-q^2 t^2 / 2). For N bodies alpha2 has the variance 8 / (15 N), from
  // the moments of v; F_self one below 1 / N.
  const ed::System system = ed_test::maxwellian_gas(ed_test::species(1, Inertia::paper), 20, 200, 2);
  const double n = system.size();
  const double q = 3;
  ed::Simulation simulation(system);
  ed::Observables observables(options_of(system, 1, 1, {q}));
  while (observables.next_time() <= 1) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  const ed::Results results = observables.results(simulation);
  ASSERT_EQ(simulation.counters().collisions, 0U);
  double deepest = 1;
  for (const ed::LagRow& row : results.lags) {
    EXPECT_LT(std::abs(row.alpha2.value), 3 * std::sqrt(8 / (15 * n))) << row.lag;
    const double wanted = std::exp(-0.5 * q * q * row.lag * row.lag);
    EXPECT_LT(std::abs(row.f_self[0].value - wanted), 3 / std::sqrt(n)) << row.lag;
    deepest = std::min(deepest, wanted);
  }
  EXPECT_LT(deepest, 0.02);
}

TEST(Correlations, SpinIsLeftOutOfTheAngularVelocity) {
  for (const bool general : {false, true}) {
    ed::System system = ed_test::maxwellian_gas(ed_test::species(3, Inertia::uniform), 3, 200, 3);
    const Vector3d axes = ed::half_extents(system.species[0].shape);
    if (general) system.species[0].shape = geom::Superellipsoid(axes, 1, 1);
    const double across = mean(system, [](const ed::Body& b) {
      return b.angular_velocity.squaredNorm() - std::pow(b.angular_velocity.dot(b.rotation.col(2)), 2);
    });
    const ed::Results results = observed(system, options_of(system, 4, 1));
    // Precession: what is left is turned, not shortened.
    EXPECT_NEAR(results.w2.value, across, kCorrelationRounding * across);
    EXPECT_LT(results.lags.back().wacf.value, 0.95 * across);
  }
}

TEST(Correlations, OfEachBodyAxis) {
  // Equal moments, so that bodies turn uniformly: u.u(0) = cos^2 a + sin^2 a cos(w t).
  ed::Species species = ed::uniform_species(geom::Ellipsoid({0.7, 1, 1.4}), 1);
  species.inertia = Vector3d::Constant(0.5);
  const ed::System system = ed_test::maxwellian_gas(species, 3, 200, 4);
  ed::ObservablesOptions options = options_of(system, 20, 1);
  options.groups = {{system.size(), 3}};
  const ed::Results results = observed(system, options);
  for (const ed::LagRow& row : results.lags) {
    for (int k = 0; k < 3; ++k) {
      const double c1 = mean(system, [&](const ed::Body& b) {
        const double w = b.angular_velocity.norm();
        const double cosine = b.angular_velocity.dot(b.rotation.col(k)) / w;
        return cosine * cosine + (1 - cosine * cosine) * std::cos(w * row.lag);
      });
      EXPECT_NEAR(row.c1_axis[static_cast<std::size_t>(k)].value, c1, kCorrelationRounding);
    }
    EXPECT_NEAR(row.c1.value, row.c1_axis[2].value, kCorrelationRounding);
  }
}

TEST(Correlations, WaveNumbersHaveToBeUsable) {
  const ed::System system = ed_test::maxwellian_gas(ed_test::species(1, Inertia::paper), 3, 200, 5);
  for (const std::vector<double>& q : {std::vector<double>{0.0}, {-1.0}, {std::nan("")}, std::vector<double>(9, 1.0)}) {
    EXPECT_THROW(ed::Observables(options_of(system, 20, 1, q)), std::invalid_argument);
  }
  EXPECT_THROW(ed::Observables(options_of(system, 20, 21, {1.0})), std::invalid_argument);  // lags beyond the run
}

TEST(Director, OfAlignedAxesIsTheirs) {
  ed::System system = ed_test::grid(ed_test::species(3, Inertia::paper), 3, 200);
  const Vector3d n = Vector3d(1, -2, 2) / 3;
  for (std::size_t i = 0; i < system.bodies.size(); ++i) {
    // Some up, some down; a little off to every side.
    const Vector3d off = 0.1 * Vector3d(i % 3 == 0, i % 3 == 1, i % 3 == 2) - Vector3d::Constant(0.1 / 3);
    const Vector3d u = (i % 2 == 0 ? 1 : -1) * (n + off - off.dot(n) * n).normalized();
    system.bodies[i].rotation = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), u).toRotationMatrix();
    system.bodies[i].velocity = Vector3d(i % 2 == 0 ? 1 : -1, 0, 0);
  }
  const ed::Results results = observed(system, options_of(system, 4, 0.25));
  EXPECT_GT(results.S.value, 0.98);
  // The largest component is positive. Of -2 and 2, which only rounding and `off` tell apart, either may be the
  // largest.
  EXPECT_LT(results.director.axis.cross(n).norm(), 1e-3);
  EXPECT_GT(results.director.axis.maxCoeff(), 0.5);
  EXPECT_NEAR(results.director.axis.norm(), 1, kCorrelationRounding);
  EXPECT_LT(results.director.error, 1e-6);
  for (const ed::BlockRow& row : results.blocks) EXPECT_LT(row.director.cross(n).norm(), 1e-3);
}

// ---- Pressure ------------------------------------------------------------------------------------------------------

TEST(Pressure, TensorHasTheTraceOfZAndIsSymmetric) {
  const ed::System system = ed_test::start({2, 0.45, 40, Inertia::paper, 10});
  ed::Simulation simulation(system);
  ed::Observables observables(options_of(system, 16, 1));
  while (observables.next_time() <= 16) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  EXPECT_NEAR(simulation.virial_tensor().trace() / simulation.virial(), 1, 1e-12);
  const ed::Results results = observables.results(simulation);
  const Matrix3d& P = results.pressure.value;
  EXPECT_NEAR(P.trace() / 3, results.Z.value, 1e-12 * results.Z.value);
  EXPECT_NEAR((P - P.transpose()).norm(), 0, kCorrelationRounding);
  ASSERT_EQ(results.blocks.size(), 16U);
  for (const ed::BlockRow& row : results.blocks) EXPECT_NEAR(row.pressure.trace() / 3, row.Z, 1e-12 * row.Z);
}

TEST(Pressure, OfTwoSpheresThatMeetIsAlongTheirCentres) {
  // Head on along x, with equal masses: r = 2 along x, and B gains 3 of momentum.
  ed::System system;
  system.box = 20;
  system.species = {ed::paper_species(geom::Ellipsoid({1, 1, 1}))};
  system.bodies.resize(2);
  system.bodies[1].position = {5, 0, 0};
  system.bodies[0].velocity = {2, 0.5, 0};
  system.bodies[1].velocity = {-1, 0.5, 0};
  ed::Simulation simulation(system);
  simulation.run_until(2);
  Matrix3d wanted = Matrix3d::Zero();
  wanted(0, 0) = 6;
  EXPECT_NEAR((simulation.virial_tensor() - wanted).norm(), 0, 1e-13);
}

// ---- Streaming -----------------------------------------------------------------------------------------------------

/// Sums at one lag over all pairs of stored frames that are this far apart, the first an origin.
struct Direct {
  double pairs = 0;
  double r2 = 0, r4 = 0, c1 = 0, c2 = 0, vacf = 0, wacf = 0, f_self = 0, phi2 = 0;

  void add(const ed::Snapshot& a, const ed::Snapshot& b, double q) {
    pairs += 1;
    const auto n = static_cast<double>(a.position.size());
    for (std::size_t i = 0; i < a.position.size(); ++i) {
      const double r = (b.position[i] - a.position[i]).norm();
      const double x = a.axis[i].dot(b.axis[i]);
      r2 += r * r / n;
      r4 += std::pow(r, 4) / n;
      c1 += x / n;
      c2 += (1.5 * x * x - 0.5) / n;
      vacf += a.velocity[i].dot(b.velocity[i]) / n;
      wacf += a.angular_velocity[i].dot(b.angular_velocity[i]) / n;
      f_self += sinc(q * r) / n;
      phi2 += (b.phi_lab[i] - a.phi_lab[i]).squaredNorm() / n;
    }
  }
};

Direct direct(const std::vector<ed::Snapshot>& frames, double spacing, double lag, double q) {
  const auto frame_at = [&](double t) {
    return std::find_if(frames.begin(), frames.end(),
                        [t](const ed::Snapshot& f) { return std::abs(f.time - t) < 1e-9; });
  };
  Direct sums;
  for (int k = 0; k * spacing + lag <= frames.back().time + 1e-9; ++k) {
    const auto a = frame_at(k * spacing);
    const auto b = frame_at(k * spacing + lag);
    if (a == frames.end() || b == frames.end()) {
      ADD_FAILURE() << "no frame at lag " << lag << " from " << k * spacing;
      return sums;
    }
    sums.add(*a, *b, q);
  }
  return sums;
}

TEST(Streaming, IsWhatStoredFramesGive) {
  const ed::System system = ed_test::start({2, 0.45, 40, Inertia::paper, 10});
  constexpr double kLongest = 0.05;  // more blocks than are kept
  constexpr double q = 4;
  std::vector<ed::Snapshot> frames;
  ed::ObservablesOptions options = options_of(system, 2.5, kLongest, {q});
  options.time_unit = kLongest / 16;  // origins are as far apart
  const ed::Results results =
      observed(system, options, [&](const ed::Simulation& simulation) { simulation.sample(frames.emplace_back()); });
  EXPECT_LT(results.blocks.size(), 32U);
  ASSERT_GT(results.lags.size(), 60U);
  for (std::size_t k = 0; k < results.lags.size(); k += 6) {
    const ed::LagRow& row = results.lags[k];
    const Direct d = direct(frames, kLongest / 16, row.lag, q);
    ASSERT_GT(d.pairs, 700);
    EXPECT_NEAR(row.msd.value, d.r2 / d.pairs, 1e-12);
    EXPECT_NEAR(row.alpha2.value, 3 * d.r4 * d.pairs / (5 * d.r2 * d.r2) - 1, 1e-9);
    EXPECT_NEAR(row.c1.value, d.c1 / d.pairs, 1e-12);
    EXPECT_NEAR(row.c2.value, d.c2 / d.pairs, 1e-12);
    EXPECT_NEAR(row.vacf.value, d.vacf / d.pairs, kCorrelationRounding);
    EXPECT_NEAR(row.wacf.value, d.wacf / d.pairs, kCorrelationRounding * results.w2.value);
    EXPECT_NEAR(row.f_self[0].value, d.f_self / d.pairs, 1e-12);
    EXPECT_NEAR(row.rot_msd.value, d.phi2 / d.pairs, kCorrelationRounding);
  }
}

}  // namespace
