// Order of single frames where it is known: lattices, layers, aligned bodies, domains.

#include <common/ed/lattices.h>

#include <observables/frame_sums.h>
#include <observables/order/bonds.h>
#include <observables/order/bragg.h>
#include <observables/order/cubatic.h>
#include <observables/order/directed.h>
#include <observables/order/hexatic.h>
#include <observables/order/stationarity.h>

#include <ed/random.h>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using ed::internal::BodyRange;
using ed::internal::Bonds;
using ed_test::kBodyCentred;
using ed_test::kFaceCentred;
using ed_test::kSimple;
using ed_test::lattice;
using ed_test::points;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// ---- Bonds

TEST(Bonds, OfLatticesHaveSteinhardtsValues) {
  struct Known {
    std::vector<Vector3d> basis;
    std::size_t neighbours;
    double q4, q6;
  };
  // Steinhardt, Nelson and Ronchetti, Phys. Rev. B 28 (1983) 784, and in closed form.
  const std::vector<Known> all = {{kFaceCentred, 12, 0.190940654, 0.574524260},
                                  {kSimple, 6, 0.763762616, 0.353553391},
                                  {kBodyCentred, 14, 0.036369648, 0.510688230}};
  // In all pairs, and in cells.
  for (const int cells : {3, 11}) {
    for (const Known& known : all) {
      const std::vector<Vector3d> sites = lattice(cells, known.basis);
      for (const Bonds& bonds : ed::internal::nearest_bonds(sites, cells, known.neighbours)) {
        ASSERT_EQ(bonds.size(), known.neighbours);
        ASSERT_NEAR(ed::internal::steinhardt(bonds, 4), known.q4, 1e-8);
        ASSERT_NEAR(ed::internal::steinhardt(bonds, 6), known.q6, 1e-8);
      }
    }
  }
}

TEST(Bonds, AreThoseToTheNearest) {
  for (const int number : {9, 200, 1500}) {
    const double box = 7;
    const std::vector<Vector3d> all = points(number, box, 3);
    const std::vector<Bonds> found = ed::internal::nearest_bonds(all, box, 12);
    for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / 40) {
      std::vector<double> distances;
      for (std::size_t j = 0; j < all.size(); ++j) {
        const Vector3d r = all[j] - all[i];
        if (j != i) distances.push_back((r - box * (r / box).array().round().matrix()).norm());
      }
      std::sort(distances.begin(), distances.end());
      ASSERT_EQ(found[i].size(), std::min<std::size_t>(12, distances.size()));
      for (std::size_t k = 0; k < found[i].size(); ++k) EXPECT_NEAR(found[i][k].norm(), distances[k], 1e-12);
    }
  }
}

TEST(Bonds, OfOneDirectionAreOfFullOrder) {
  const Bonds bonds = {{1, 2, 3}, {-2, -4, -6}, {0.1, 0.2, 0.3}};
  for (const int l : {4, 6}) EXPECT_NEAR(ed::internal::steinhardt(bonds, l), 1, 1e-12);
  EXPECT_EQ(ed::internal::steinhardt({}, 6), 0);
}

// ---- Hexatic order

/// Returns layers of a triangular lattice across z in a box of edge 56, 56 sites by 64 rows, stretched by 1 % to fit.
/// Each layer has its own shift, and bodies are up to `scatter` off its plane.
std::vector<Vector3d> hexagonal_layers(int layers, double apart, double scatter, ed::Random& random) {
  std::vector<Vector3d> all;
  for (int layer = 0; layer < layers; ++layer) {
    const double shift = random.uniform();
    for (int row = 0; row < 64; ++row) {
      for (int i = 0; i < 56; ++i) {
        const double off = scatter * (2 * random.uniform() - 1);
        all.emplace_back(i + 0.5 * (row % 2) + shift, row * (56.0 / 64), layer * apart + off);
      }
    }
  }
  return all;
}

TEST(HexaticOrder, OfHexagonalLayersIsOne) {
  ed::Random random(20);
  // Layers three lengths of bodies apart, then one.
  for (const double apart : {9.0, 3.0}) {
    const std::vector<Vector3d> sites = hexagonal_layers(2, apart, 0.4, random);
    const ed::internal::HexaticOrder order = ed::internal::hexatic_order(sites, 56, Vector3d::UnitZ(), 2);
    // The lattice is stretched by 1 %.
    EXPECT_NEAR(order.coherent, 1, 0.001);
    EXPECT_NEAR(order.local, 1, 0.001);
  }
}

TEST(HexaticOrder, OfColumnsIsThatOfTheirLattice) {
  // Discs of length 1 in columns, 1.16 apart, each column at a height of its own: some neighbours come twice.
  ed::Random random(21);
  std::vector<Vector3d> sites;
  for (int row = 0; row < 16; ++row) {
    for (int i = 0; i < 14; ++i) {
      const double offset = random.uniform();
      for (int k = 0; k < 12; ++k) {
        sites.push_back({i + 0.5 * (row % 2), row * (14.0 / 16), std::fmod(1.16 * k + offset, 14.0)});
      }
    }
  }
  const Matrix3d swap = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).toRotationMatrix();
  std::vector<Vector3d> along_x;
  for (const Vector3d& r : sites) along_x.emplace_back(swap * r);
  const double reach = ed::internal::kLayerReach * 1.0;
  const ed::internal::HexaticOrder order = ed::internal::hexatic_order(sites, 14, Vector3d::UnitZ(), reach);
  EXPECT_GT(order.coherent, 0.99);
  EXPECT_GE(order.local, order.coherent);
  const ed::internal::HexaticOrder turned = ed::internal::hexatic_order(along_x, 14, swap * Vector3d::UnitZ(), reach);
  // Two bodies of a column are equally near, but for rounding, and the lattice is stretched by 1 %.
  EXPECT_NEAR(turned.coherent, order.coherent, 1e-4);
  EXPECT_NEAR(turned.local, order.local, 1e-4);
}

/// Returns psi_6 from all pairs and from angles.
ed::internal::HexaticOrder plain_hexatic_order(const std::vector<Vector3d>& all, double box, const Vector3d& n,
                                               double reach) {
  const Vector3d e1 = n.unitOrthogonal();
  const Vector3d e2 = n.cross(e1);
  std::complex<double> sum = 0;
  double local = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<std::pair<double, double>> near;  // distance and angle
    for (std::size_t j = 0; j < all.size(); ++j) {
      const Vector3d d = all[j] - all[i];
      const Vector3d r = d - box * (d / box).array().round().matrix();
      if (j != i && std::abs(r.dot(n)) <= reach) {
        near.emplace_back(std::hypot(r.dot(e1), r.dot(e2)), std::atan2(r.dot(e2), r.dot(e1)));
      }
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min<std::size_t>(6, near.size()));
    std::complex<double> own = 0;
    for (const auto& [distance, angle] : near) own += std::polar(1.0, 6 * angle) / static_cast<double>(near.size());
    sum += own;
    local += std::abs(own);
  }
  const auto number = static_cast<double>(all.size());
  return {std::abs(sum) / number, local / number};
}

TEST(HexaticOrder, IsThatOfTheSixNearestAcrossTheDirector) {
  ed::Random random(22);
  // Few enough in reach to have fewer than six; all pairs; cells; cells with a reach too long for them.
  for (const auto& [number, reach] :
       {std::pair(9, 0.4), std::pair(300, 0.5), std::pair(1500, 0.4), std::pair(1100, 2.5)}) {
    const double box = 7;
    const std::vector<Vector3d> all = points(number, box, 5);
    const Vector3d n = random.direction();
    const ed::internal::HexaticOrder found = ed::internal::hexatic_order(all, box, n, reach);
    const ed::internal::HexaticOrder plain = plain_hexatic_order(all, box, n, reach);
    EXPECT_NEAR(found.coherent, plain.coherent, 1e-12) << number;
    EXPECT_NEAR(found.local, plain.local, 1e-12) << number;
  }
}

TEST(HexaticOrder, OfPointsAtRandomIsSmall) {
  const std::vector<Vector3d> all = points(1500, 10, 6);
  const ed::internal::HexaticOrder order = ed::internal::hexatic_order(all, 10, Vector3d::UnitX(), 0.4);
  EXPECT_LT(order.coherent, 0.05);
  EXPECT_NEAR(order.local, 0.38, 0.03);  // sqrt(pi / 24) = 0.36 of six directions at random
  EXPECT_EQ(ed::internal::hexatic_order({}, 10, Vector3d::UnitX(), 1).local, 0);
}

// ---- Cubatic order

/// A rotation that permutes the axes.
Matrix3d permuted(ed::Random& random) {
  Matrix3d turn = Matrix3d::Zero();
  std::array<int, 3> to = {0, 1, 2};
  std::swap(to[0], to[static_cast<std::size_t>(3 * random.uniform()) % 3]);
  std::swap(to[1], to[1 + static_cast<std::size_t>(2 * random.uniform()) % 2]);
  for (int k = 0; k < 3; ++k) turn(to[static_cast<std::size_t>(k)], k) = random.uniform() < 0.5 ? -1 : 1;
  return turn.determinant() < 0 ? Matrix3d(-turn) : turn;
}

TEST(CubaticOrder, OfAlignedCubesIsOne) {
  ed::Random random(1);
  const Matrix3d common = random.rotation();
  std::vector<Matrix3d> bodies;
  for (int i = 0; i < 50; ++i) bodies.emplace_back(common * permuted(random));
  EXPECT_NEAR(ed::internal::cubatic_order(bodies, 0, 50), 1, 1e-12);
}

TEST(CubaticOrder, IsTheMaximumOverDirections) {
  ed::Random random(2);
  for (const int number : {1, 5, 60}) {
    std::vector<Matrix3d> bodies;
    for (int i = 0; i < number; ++i) bodies.push_back(random.rotation());
    double best = -1;
    for (int k = 0; k < 20000; ++k) {
      const Vector3d n = random.direction();
      double sum = 0;
      for (const Matrix3d& R : bodies) {
        for (int a = 0; a < 3; ++a) {
          const double x2 = std::pow(n.dot(R.col(a)), 2);
          sum += (35 * x2 * x2 - 30 * x2 + 3) / 14;
        }
      }
      best = std::max(best, sum / number);
    }
    // The 20 000 directions are 0.02 apart, and the maximum is quadratic in the distance to it.
    EXPECT_NEAR(ed::internal::cubatic_order(bodies, 0, bodies.size()), best, 0.005) << number;
    EXPECT_GE(ed::internal::cubatic_order(bodies, 0, bodies.size()), best - 1e-12) << number;
  }
}

TEST(CubaticOrder, OfAnIsotropicSystemIsSmall) {
  ed::Random random(3);
  std::vector<Matrix3d> bodies;
  for (int i = 0; i < 10000; ++i) bodies.push_back(random.rotation());
  EXPECT_LT(ed::internal::cubatic_order(bodies, 0, bodies.size()), 0.03);
}

// ---- Bragg peaks

TEST(Bragg, VectorsAreAllThatTheBoxAllows) {
  const double box = 5;
  const double largest = 6.1;
  const std::vector<Vector3i> found = ed::internal::allowed_vectors(box, largest, 100);
  std::size_t number = 0;
  for (int x = -10; x <= 10; ++x) {
    for (int y = -10; y <= 10; ++y) {
      for (int z = -10; z <= 10; ++z) {
        const double q = 2 * std::numbers::pi / box * Vector3d(x, y, z).norm();
        if (q > 0 && q <= largest) ++number;
      }
    }
  }
  EXPECT_EQ(2 * found.size(), number);
  for (std::size_t k = 1; k < found.size(); ++k) EXPECT_NE(found[k], -found[k - 1]);
}

TEST(Bragg, IntensitiesAreThoseOfTheSumOverBodies) {
  const double box = 5;
  const std::vector<Vector3d> all = points(70, box, 4);
  const std::vector<Vector3i> vectors = ed::internal::allowed_vectors(box, 5, 70);
  const std::vector<double> found = ed::internal::intensities(vectors, box, all, {10, 60, false});
  for (std::size_t k = 0; k < vectors.size(); k += 7) {
    const Vector3d q = 2 * std::numbers::pi / box * vectors[k].cast<double>();
    double re = 0, im = 0;
    for (std::size_t i = 10; i < 60; ++i) re += std::cos(q.dot(all[i])), im += std::sin(q.dot(all[i]));
    EXPECT_NEAR(found[k], (re * re + im * im) / 2500, 1e-12);
  }
}

TEST(Bragg, PeaksOfAFaceCentredLatticeAreItsReciprocalVectors) {
  const int cells = 4;
  const std::vector<Vector3d> sites = lattice(cells, kFaceCentred);
  const std::vector<Vector3i> vectors = ed::internal::allowed_vectors(cells, 2 * std::numbers::pi * 2.1, 256);
  const std::vector<double> found = ed::internal::intensities(vectors, cells, sites, {0, sites.size(), false});
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    // Multiples of the reciprocal cell whose indices are all even or all odd.
    const Vector3i h = vectors[k] / cells;
    const bool whole = h * cells == vectors[k];
    const bool same = (h.x() - h.y()) % 2 == 0 && (h.y() - h.z()) % 2 == 0;
    EXPECT_NEAR(found[k], whole && same ? 1 : 0, 1e-12) << vectors[k].transpose();
  }
}

// ---- Directions, octants

TEST(Directions, OfDisplacementsAddUp) {
  ed::Random random(5);
  ed::Snapshot a, b;
  for (int i = 0; i < 20; ++i) {
    a.position.push_back(random.normal3());
    b.position.push_back(random.normal3());
  }
  const Vector3d n = random.direction();
  const ed::internal::DirectedSums sums = ed::internal::directed_sums(a, b, 3, 17, n);
  double along2 = 0, along4 = 0, across4 = 0;
  Vector3d edge2 = Vector3d::Zero(), edge4 = Vector3d::Zero();
  for (std::size_t i = 3; i < 17; ++i) {
    const Vector3d r = b.position[i] - a.position[i];
    along2 += std::pow(r.dot(n), 2);
    along4 += std::pow(r.dot(n), 4);
    across4 += std::pow((r - r.dot(n) * n).norm(), 4);
    edge2 += r.cwiseProduct(r);
    edge4 += r.array().pow(4).matrix();
  }
  EXPECT_NEAR(sums.along2, along2, 1e-12);
  EXPECT_NEAR(sums.along4, along4, 1e-11);
  EXPECT_NEAR(sums.across4, across4, 1e-11);
  EXPECT_TRUE(sums.edge2.isApprox(edge2, 1e-12));
  EXPECT_TRUE(sums.edge4.isApprox(edge4, 1e-12));
}

TEST(Octants, ShowDomains) {
  ed::Snapshot uniform, domains;
  uniform.position = domains.position = points(800, 9, 6);
  for (const Vector3d& r : uniform.position) {
    uniform.axis.push_back(Vector3d::UnitX());
    domains.axis.push_back(r.z() < 4.5 ? Vector3d::UnitX() : Vector3d::UnitY());
  }
  const std::vector<BodyRange> all = {{0, 800, false}};
  EXPECT_NEAR(ed::internal::octant_order(uniform, 9, all), 1, 1e-12);
  EXPECT_NEAR(ed::internal::octant_order(domains, 9, all), 1, 1e-12);
  EXPECT_LT(ed::internal::largest_eigenvalue(ed::internal::order_tensor(domains.axis, 0, 800)), 0.3);
}

}  // namespace
