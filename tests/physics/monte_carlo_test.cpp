// Pressures of capsules, cubes and octahedra against a Monte Carlo that shares no code with the event loop but geom's
// overlap query; B2 of capsules against the exact one; the nematic of long capsules. HARDBODY_FULL=1: all states, to
// 1 % and three standard errors, an hour.

#include <common/ed/measure.h>
#include <common/ed/monte_carlo.h>
#include <common/full_form.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

namespace {

using ed_test::Measured;

struct Solid {
  std::string name;
  geom::Shape shape;
};

/// Returns the capsule of diameter 1 with this distance between the centres of its caps.
Solid capsule(double length) {
  return {"capsules L/D = " + std::to_string(length).substr(0, 3), geom::Capsule(0.5 * length, 0.5)};
}
Solid cube() {
  return {"cubes", geom::Box({0.5, 0.5, 0.5})};
}
Solid octahedron() {
  return {"octahedra", geom::ConvexPolyhedron::in_principal_frame(geom::solid_vertices("octahedron"))};
}

ed::Species species(const Solid& solid) {
  return std::visit([](const auto& shape) { return ed::uniform_species(shape); }, solid.shape);
}

ed::System start(const Solid& solid, int number, double packing_fraction) {
  ed::StartOptions options;
  options.number = number;
  options.packing_fraction = packing_fraction;
  return ed::random_start(species(solid), options);
}

/// Mean, its standard error from the means of ten blocks, and the variance of the samples.
struct Mean {
  double value;
  double error;
  double variance;
};
Mean mean_of_blocks(const std::vector<double>& samples) {
  constexpr std::size_t kBlocks = 10;
  const std::size_t length = samples.size() / kBlocks;
  double sum = 0, squares = 0, variance = 0;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    double mean = 0;
    for (std::size_t k = 0; k < length; ++k) mean += samples[block * length + k] / static_cast<double>(length);
    sum += mean / kBlocks;
    squares += mean * mean / kBlocks;
  }
  for (const double sample : samples) variance += (sample - sum) * (sample - sum) / static_cast<double>(samples.size());
  return {sum, std::sqrt((squares - sum * sum) / (kBlocks - 1)), variance};
}

Measured run(const Solid& solid, int number, double packing_fraction, double duration) {
  ed::Simulation simulation(start(solid, number, packing_fraction));
  simulation.run_until(0.1 * duration);
  ed::System system = simulation.system();
  ed::rescale_velocities(system);
  return ed_test::measure(system, {0, duration, duration / 20});
}

/// Runs the event loop at a packing fraction, the Monte Carlo at the pressure that it had, and the event loop at the
/// packing fraction that the Monte Carlo has at that pressure: its pressure is the same again, but for the curvature of
/// P(rho) over the fluctuations of rho (0.1 to 0.2 %).
void expect_monte_carlo_pressure(const Solid& solid, double packing_fraction) {
  const int number = full_form() ? 256 : 108;
  const double duration = full_form() ? 400 : 40;
  const int sweeps = full_form() ? 40000 : 3000;
  const double body = geom::volume(solid.shape);
  const double guess = run(solid, number, packing_fraction, 0.2 * duration).results.Z.value;
  const double pressure = guess * packing_fraction / body;

  ed_test::MonteCarlo monte_carlo(start(solid, number, packing_fraction), solid.shape, pressure,
                                  1 + static_cast<std::uint64_t>(1000 * packing_fraction));
  monte_carlo.equilibrate(sweeps / 5);
  std::vector<double> densities;  // the mean pressure at the densities is that of the ensemble
  for (int k = 0; k < sweeps; ++k) {
    monte_carlo.sweep();
    densities.push_back(number / monte_carlo.volume());
  }
  const Mean density = mean_of_blocks(densities);
  const double found = density.value * body;
  const double Z = pressure * body / found;

  const Measured measured = run(solid, number, found, duration);
  const ed::Estimate mine = measured.results.Z;
  // The Monte Carlo's error of rho changes the pressure by d(rho Z)/d(rho), which the fluctuations of rho tell.
  const double stiffness = density.value * density.value / (number * density.variance);
  const double error = std::hypot(mine.error, stiffness * density.error / density.value);
  std::printf("%s, phi = %.4f: Z %.4f +- %.4f, Monte Carlo %.4f, together +- %.4f (%+.2f %%)\n", solid.name.c_str(),
              found, mine.value, mine.error, Z, error, 100 * (mine.value / Z - 1));
  EXPECT_EQ(measured.overlaps, 0U);
  EXPECT_LE(std::abs(mine.value - Z), 3 * error + (full_form() ? 0.0 : Z / number));
  EXPECT_LE(std::abs(mine.value / Z - 1), full_form() ? 0.01 : 0.1);
  EXPECT_LE(error, (full_form() ? 0.007 : 0.04) * Z);
}

TEST(MonteCarlo, HasThePressureOfCapsules) {
  for (const double phi : full_form() ? std::vector{0.1, 0.15, 0.2, 0.25, 0.3, 0.35} : std::vector{0.1}) {
    expect_monte_carlo_pressure(capsule(5), phi);
  }
}

TEST(MonteCarlo, HasThePressureOfCubes) {
  for (const double phi : full_form() ? std::vector{0.2, 0.4} : std::vector{0.1}) {
    expect_monte_carlo_pressure(cube(), phi);
  }
}

TEST(MonteCarlo, HasThePressureOfOctahedra) {
  for (const double phi : full_form() ? std::vector{0.2, 0.4} : std::vector{0.1}) {
    expect_monte_carlo_pressure(octahedron(), phi);
  }
}

/// (Z - 1) / phi times N / (N - 1), quadratic in phi, goes to B2 / v0; B2 = (2/3) pi D^3 + pi L D^2 + (pi/4) L^2 D.
TEST(Capsules, HaveTheSecondVirialCoefficient) {
  for (const double L : full_form() ? std::vector{1.0, 3.0, 5.0} : std::vector{3.0}) {
    const Solid solid = capsule(L);
    const double pi = std::numbers::pi;
    const double wanted = (2 * pi / 3 + pi * L + pi / 4 * L * L) / geom::volume(solid.shape);
    // Multiples of phi B2 / v0, which tells how much the next virial coefficients matter.
    const std::vector<double> shares =
        full_form() ? std::vector{0.1, 0.2, 0.3, 0.45, 0.6, 0.75} : std::vector{0.2, 0.6, 1.0};
    const int number = 256;
    const auto points = static_cast<Eigen::Index>(shares.size());
    Eigen::MatrixXd matrix(points, 3);
    Eigen::VectorXd values(points);
    for (Eigen::Index k = 0; k < points; ++k) {
      const double phi = shares[static_cast<std::size_t>(k)] / wanted;
      const ed::Estimate Z = run(solid, number, phi, (full_form() ? 4000 : 6) / phi).results.Z;
      const double error = Z.error / phi;
      matrix.row(k) = Eigen::RowVector3d(1, phi, phi * phi) / error;
      values[k] = (Z.value - 1) / phi * number / (number - 1) / error;
    }
    const Eigen::Vector3d fit = matrix.colPivHouseholderQr().solve(values);
    const double error = std::sqrt((matrix.transpose() * matrix).inverse()(0, 0));
    std::printf("L/D = %.0f: B2 / v0 %.4f +- %.4f for %.4f (%+.2f %%)\n", L, fit[0], error, wanted,
                100 * (fit[0] / wanted - 1));
    EXPECT_LE(std::abs(fit[0] / wanted - 1), full_form() ? 0.003 : 3 * error / wanted);
    EXPECT_LE(error, (full_form() ? 0.003 : 0.06) * wanted);
  }
}

/// The order of long capsules crosses 0.3 between 0.38 and 0.44.
TEST(Capsules, AreNematicWhenDense) {
  const Solid solid = capsule(5);
  for (const double phi : full_form() ? std::vector{0.38, 0.44} : std::vector{0.44}) {
    ed::LatticeOptions options;
    options.packing_fraction = phi;
    const int number = full_form() ? 504 : 256;
    ed::System system = ed::lattice_start({{species(solid), number}}, options);
    const double duration = full_form() ? 2000 : 60;
    ed::Simulation simulation(system);
    simulation.run_until(duration);
    system = simulation.system();
    ed::rescale_velocities(system);
    const ed::Estimate S = ed_test::measure(system, {0, duration, duration / 20}).results.S;
    std::printf("capsules L/D = 5, phi = %.2f: S %.3f +- %.3f\n", phi, S.value, S.error);
    if (phi > 0.4) {
      EXPECT_GT(S.value, 0.3);
    } else {
      EXPECT_LT(S.value, 0.3);
    }
  }
}

}  // namespace
