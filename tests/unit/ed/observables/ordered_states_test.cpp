// Whether ordered states are stationary, and results of stored frames whose order is known: walks, layers, columns.

#include <common/ed/lattices.h>

#include <observables/order/stationarity.h>

#include <ed/random.h>
#include <ed/stored_frames.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace {

using ed::internal::BodyRange;
using ed_test::kSimple;
using ed_test::lattice;
using ed_test::points;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// ---- Stationarity

/// Judges `samples` frames: axes about z with this scatter, or in two domains; positions of `sites` moved at random.
ed::Order judged(const std::vector<Vector3d>& sites, double scatter, bool domains, double drift_of_Z,
                 int samples = 64) {
  const double box = 6;
  const auto number = sites.size();
  ed::internal::Stationarity stationarity({{0, number, false}});
  stationarity.begin(box, 0.6);
  ed::Random random(12);
  for (int k = 1; k <= samples; ++k) {
    ed::Snapshot now;
    for (const Vector3d& site : sites) {
      const Vector3d n = domains && site.z() > 3 ? Vector3d::UnitX() : Vector3d::UnitZ();
      now.position.push_back(site + 0.05 * random.normal3());
      now.axis.push_back((n + scatter * random.normal3()).normalized());
    }
    stationarity.add(now, 10 * (1 + drift_of_Z * k / samples) + 0.05 * random.normal());
    EXPECT_EQ(stationarity.due(), k >= 48 && k % 8 == 0);
  }
  return stationarity.judge(true);
}

TEST(Stationarity, OfANematicIsThatOfItsOrderAndPressure) {
  const std::vector<Vector3d> fluid = points(500, 6, 13);
  const ed::Order nematic = judged(fluid, 0.3, false, 0);
  EXPECT_TRUE(nematic.nematic && nematic.uniform && nematic.stationary && !nematic.crystal);
  EXPECT_NEAR(nematic.S_octants, nematic.S, 0.05);
  const ed::Order drifting = judged(fluid, 0.3, false, 0.2);
  EXPECT_TRUE(drifting.nematic && !drifting.stationary);
  EXPECT_GT(drifting.Z_change, 0.03);
  const ed::Order domains = judged(fluid, 0.3, true, 0);
  EXPECT_FALSE(domains.stationary);
  EXPECT_GT(domains.S_octants - domains.S, 0.3);
  const ed::Order isotropic = judged(fluid, 30, false, 0);
  EXPECT_TRUE(!isotropic.nematic && !isotropic.crystal && !isotropic.stationary);
}

TEST(Stationarity, OfACrystalIsThatOfItsBraggPeaks) {
  const ed::Order crystal = judged(lattice(6, kSimple), 30, false, 0);
  EXPECT_TRUE(crystal.crystal && crystal.stationary && !crystal.nematic);
  // exp(-q^2 <u^2>) of the shortest reciprocal vectors.
  EXPECT_NEAR(crystal.bragg, std::exp(-std::pow(2 * std::numbers::pi * 0.05, 2)), 0.03);
  EXPECT_FALSE(judged(lattice(6, kSimple), 30, false, 0.2).stationary);
}

TEST(Stationarity, GoesOnFromItsBytes) {
  const std::vector<BodyRange> all = {{0, 60, false}};
  ed::internal::Stationarity straight(all), restored(all);
  straight.begin(6, 0.6);
  restored.begin(6, 0.6);
  for (int k = 0; k < 70; ++k) {
    ed::Snapshot now;
    now.position = points(60, 6, static_cast<std::uint64_t>(k));
    ed::Random random(static_cast<std::uint64_t>(k));
    for (int i = 0; i < 60; ++i) now.axis.push_back(random.direction());
    ed::internal::Writer writer;
    ed::internal::Stationarity::fields(writer, restored);
    const std::string bytes = writer.take();
    ed::internal::Reader reader(bytes);
    restored = ed::internal::Stationarity(all);
    ed::internal::Stationarity::fields(reader, restored);
    straight.add(now, k);
    restored.add(now, k);
  }
  ed::internal::Writer a, b;
  ed::internal::Stationarity::fields(a, straight);
  ed::internal::Stationarity::fields(b, restored);
  EXPECT_TRUE(a.take() == b.take());
}

// ---- Stored frames

/// Walks of independent Gaussian steps, of deviation `along` along n and `across` in each direction across it.
std::vector<ed::StoredFrame> walks(const Vector3d& n, double along, double across, const Matrix3d& rotation) {
  ed::Random random(7);
  std::vector<ed::StoredFrame> frames(300);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].time = static_cast<double>(k);
    for (int i = 0; i < 200; ++i) {
      const Vector3d step = random.normal3();
      const Vector3d moved = across * step + (along - across) * step.dot(n) * n;
      const Vector3d before = k == 0 ? Vector3d(9 * random.uniform(), 9 * random.uniform(), 9 * random.uniform())
                                     : frames[k - 1].position[static_cast<std::size_t>(i)];
      frames[k].position.push_back(before + moved);
      frames[k].rotation.push_back(rotation);
    }
  }
  return frames;
}

ed::StoredFramesOptions options_of_walks() {
  ed::StoredFramesOptions options;
  options.box = 9;
  options.groups = {{200, 3}};
  options.axis.assign(200, 2);
  options.wave_numbers = {3};
  options.longest_lag = 20;
  return options;
}

TEST(Directions, OfWalksAreTheirDiffusion) {
  const Matrix3d rotation = ed::Random(8).rotation();
  const Vector3d n = rotation.col(2);
  auto frames = walks(n, 0.6, 0.3, rotation);
  // Axes that scatter a little, so that something changes them.
  ed::Random random(9);
  for (ed::StoredFrame& frame : frames) {
    for (Matrix3d& R : frame.rotation) R = R * Eigen::AngleAxisd(0.05 * random.normal(), random.direction());
  }
  const ed::StoredResults results = ed::analyze_frames(frames, options_of_walks());
  ASSERT_TRUE(results.director.exists);
  EXPECT_NEAR(std::abs(results.director.axis.dot(n)), 1, 1e-4);
  // Half the variance of a step in each direction.
  EXPECT_NEAR(results.D_parallel.value, 0.18, 4 * results.D_parallel.error);
  EXPECT_NEAR(results.D_perp.value, 0.045, 4 * results.D_perp.error);
  EXPECT_LT(results.D_parallel.error, 0.02 * 0.18 * 4);
  EXPECT_NEAR((results.D_parallel.value + 2 * results.D_perp.value) / 3, results.D_trans.value, 1e-10);
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const ed::Estimate& D = results.D_box[static_cast<std::size_t>(k)];
    sum += D.value;
    EXPECT_NEAR(D.value, 0.045 + 0.135 * n[k] * n[k], 4 * D.error);
  }
  EXPECT_NEAR(sum / 3, results.D_trans.value, 1e-10);
  for (const ed::LagRow& row : results.lags) {
    EXPECT_NEAR(row.msd_parallel.value + row.msd_perp.value, row.msd.value, 1e-9);
  }
  // 1 - 5 <angle^2> of an axis, two thirds of the square of the angle of the rotation.
  EXPECT_NEAR(results.cubatic_order.value, 1 - 5 * (2.0 / 3) * 0.0025, 0.002);
}

TEST(Directions, NeedADirector) {
  auto frames = walks(Vector3d::UnitX(), 0.6, 0.3, Matrix3d::Identity());
  ed::Random random(10);
  for (ed::StoredFrame& frame : frames) {
    for (Matrix3d& R : frame.rotation) R = random.rotation();
  }
  const ed::StoredResults results = ed::analyze_frames(frames, options_of_walks());
  EXPECT_FALSE(results.director.exists);
  EXPECT_EQ(results.D_parallel.missing.reason, ed::MissingReason::no_director);
  EXPECT_EQ(results.lags[0].msd_perp.missing.reason, ed::MissingReason::no_director);
  EXPECT_GT(results.D_box[0].value, 3 * results.D_box[1].value);
  EXPECT_EQ(results.bragg_peak.missing.reason, ed::MissingReason::no_bragg_peak);
  EXPECT_EQ(results.q6.missing.reason, ed::MissingReason::not_asked);
  EXPECT_EQ(results.psi6.missing.reason, ed::MissingReason::not_asked);
}

TEST(Layers, OfIdealPlanesHaveSmecticOrderOne) {
  // Nine planes across z, bodies at random in each; then rods at random along z on a square lattice: columns.
  ed::Random random(11);
  std::vector<ed::StoredFrame> layers(4), columns(4);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    layers[k].time = columns[k].time = static_cast<double>(k);
    for (int i = 0; i < 324; ++i) {
      const double x = 9 * random.uniform(), y = 9 * random.uniform();
      layers[k].position.emplace_back(x, y, i % 9);
      columns[k].position.emplace_back(i % 9, (i / 9) % 9, x);
    }
    // Something turns them, from one frame to the next by ever more.
    layers[k].rotation.assign(324, Matrix3d(Eigen::AngleAxisd(1e-3 * static_cast<double>(k * k), Vector3d::UnitX())));
    columns[k].rotation = layers[k].rotation;
  }
  ed::StoredFramesOptions options;
  options.box = 9;
  options.groups = {{324, 2}};
  options.axis.assign(324, 2);
  options.unwrapped = false;
  options.bonds.steinhardt = true;
  const ed::StoredResults smectic = ed::analyze_frames(layers, options);
  EXPECT_NEAR(smectic.smectic_order.value, 1, 1e-10);
  EXPECT_EQ(smectic.bragg[0].n, Vector3i(0, 0, 9));
  EXPECT_NEAR(smectic.bragg[0].angle, 0, 1e-2);
  EXPECT_EQ(smectic.columnar_order.missing.reason, ed::MissingReason::no_bragg_peak);
  const ed::StoredResults columnar = ed::analyze_frames(columns, options);
  EXPECT_NEAR(columnar.columnar_order.value, 1, 1e-10);
  EXPECT_EQ(columnar.smectic_order.missing.reason, ed::MissingReason::no_bragg_peak);
  EXPECT_TRUE(columnar.q6.value > 0 && columnar.q6.value < 1);
  EXPECT_EQ(columnar.cubatic_order.missing.reason, ed::MissingReason::no_such_axis);
}

TEST(Layers, OfAHexagonalLatticeHaveHexaticOrder) {
  // 14 sites by 16 rows, stretched by 1 %, in layers 2 apart of bodies of length 1.5, shifted from layer to layer.
  std::vector<ed::StoredFrame> frames(4);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames[k].time = static_cast<double>(k);
    for (int i = 0; i < 14 * 16 * 7; ++i) {
      const int row = i / 14 % 16;
      const int layer = i / (14 * 16);
      frames[k].position.emplace_back(i % 14 + 0.5 * (row % 2) + 0.3 * layer, row * (14.0 / 16), 2 * layer);
    }
    const auto turn = Eigen::AngleAxisd(1e-3 * static_cast<double>(k * k), Vector3d::UnitX());
    frames[k].rotation.assign(frames[k].position.size(), Matrix3d(turn));
  }
  const int number = static_cast<int>(frames[0].position.size());
  ed::StoredFramesOptions options;
  options.box = 14;
  options.groups = {{number, 2}};
  options.axis.assign(frames[0].position.size(), 2);
  options.unwrapped = false;
  options.bonds.hexatic = true;
  EXPECT_EQ(ed::analyze_frames(frames, options).psi6.missing.reason, ed::MissingReason::not_told);
  options.axial_length = 1.5;
  const ed::StoredResults results = ed::analyze_frames(frames, options);
  EXPECT_NEAR(results.psi6.value, 1, 0.001);
  EXPECT_NEAR(results.psi6_local.value, 1, 0.001);
  EXPECT_EQ(results.q6.missing.reason, ed::MissingReason::not_asked);
  // Spheres have no director, whatever is known of their length.
  options.groups = {{number, 2, false}};
  EXPECT_EQ(ed::analyze_frames(frames, options).psi6.missing.reason, ed::MissingReason::no_director);
  options.axial_length = -1;
  EXPECT_THROW(static_cast<void>(ed::analyze_frames(frames, options)), std::invalid_argument);
}

}  // namespace
