/// Superellipsoids and mixed pairs: distances of FCL, libccd and CGAL, of tessellated bodies or with our support
/// functions, against ours.

#include "common/finder/scale.h"
#include "common/forked.h"
#include "common/full_form.h"
#include "common/geom/manufactured.h"
#include "common/geom/superellipsoid_sets.h"
#include "oracle/fcl_raw.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>
#include <geom/seeds.h>
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <variant>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using finder_test::scaled;
using geom_test::any_exponent;
using geom_test::FclDistance;
using geom_test::kExponents;
using geom_test::lower_bound;
using geom_test::ManufacturedPair;
using geom_test::Random;

constexpr double kFclTolerance = 1e-6;  // what its distance_tolerance promises, an absolute length

/// Directions on the faces of an octahedron, each face with side `side`: 4 side^2 + 2 nodes and 8 side^2 triangles.
template <class Visit>
void for_each_triangle(int side, const Visit& visit) {
  for (int octant = 0; octant < 8; ++octant) {
    const Vector3d sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
    const auto node = [&](int i, int j) { return Vector3d(sign.cwiseProduct(Vector3d(i, j, side - i - j)) / side); };
    for (int i = 0; i < side; ++i) {
      for (int j = 0; i + j < side; ++j) {
        visit(node(i, j), node(i + 1, j), node(i, j + 1));
        if (i + j + 2 <= side) visit(node(i + 1, j), node(i, j + 1), node(i + 1, j + 1));
      }
    }
  }
}

/// A body and a polytope inscribed in it.
struct Tessellated {
  Superellipsoid shape;
  std::vector<Vector3d> vertices;
  double error;  ///< bound of h - h_P over all directions: how far the body reaches out of the polytope
};

/// Returns about 500 support points, and the bound of what lies between them.
///
/// On a triangle of directions n = sum of l_i n_i, sum of l_i = 1, l_i >= 0: h(n) <= sum of l_i h(n_i), for h is
/// convex, and h_P(n) >= n.v for every vertex v. So h(n) - h_P(n) <= max_i (h(n_i) - n_i.v), with the vertex that is
/// best at the centre, over |n| for a unit direction.
Tessellated tessellate(const Superellipsoid& shape) {
  Tessellated out{shape, {}, 0};
  const auto scaled_to_widths = [&](const Vector3d& u) { return Vector3d(u.cwiseQuotient(shape.semi_axes())); };
  for_each_triangle(11, [&](const auto&... corners) {
    (out.vertices.push_back(shape.support(scaled_to_widths(corners)).point), ...);
  });
  const auto before = [](const Vector3d& x, const Vector3d& y) {
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
  };
  std::sort(out.vertices.begin(), out.vertices.end(), before);
  out.vertices.erase(std::unique(out.vertices.begin(), out.vertices.end()), out.vertices.end());
  for_each_triangle(55, [&](const auto&... corners) {
    const std::array<Vector3d, 3> n{scaled_to_widths(corners)...};
    const Vector3d centre = (n[0] + n[1] + n[2]) / 3;
    const Vector3d& v = *std::max_element(out.vertices.begin(), out.vertices.end(),
                                          [&](const auto& x, const auto& y) { return centre.dot(x) < centre.dot(y); });
    double most = 0;
    double radius = 0;
    for (const Vector3d& corner : n) {
      most = std::max(most, shape.support(corner).height - corner.dot(v));
      radius = std::max(radius, (corner - centre).norm());
    }
    out.error = std::max(out.error, most / (centre.norm() - radius));
  });
  return out;
}

/// h(n) - h_P(n): how far the body reaches out of its polytope in one direction.
double height_over(const Tessellated& body, const Vector3d& n) {
  double height = -std::numeric_limits<double>::infinity();
  for (const Vector3d& v : body.vertices) height = std::max(height, n.dot(v));
  return body.shape.support(n).height - height;
}

const std::vector<Tessellated>& tessellated_bodies() {
  static const std::vector<Tessellated> bodies = [] {
    std::vector<Tessellated> all;
    Random random(1);
    for (const double e1 : kExponents) {
      for (const double e2 : {e1, any_exponent(random)}) {
        all.push_back(tessellate(Superellipsoid(random.biaxial(3).semi_axes(), e1, e2)));
      }
    }
    return all;
  }();
  return bodies;
}

/// Returns the distance of `point` from the surface, to first order in f.
double offset(const Superellipsoid& shape, const Pose& X, const Vector3d& point) {
  const Vector3d x = X.to_body(point);
  return std::abs(shape.value(x)) / shape.gradient(x).norm();
}

/// A pair of which FCL's distance is not within what is certified.
struct Disagreement {
  int pair;  ///< seed of the pair less one
  double fcl, lower, upper;
};

struct Comparison {
  std::array<Disagreement, 10> first{};
  int listed = 0;
  void list(const Disagreement& d) {
    if (listed < static_cast<int>(first.size())) first[static_cast<std::size_t>(listed++)] = d;
  }
  void print_list() const {
    for (int k = 0; k < listed; ++k) {
      const Disagreement& d = first[static_cast<std::size_t>(k)];
      std::printf("  pair %d: FCL %.9g, certified %.9g to %.9g\n", d.pair, d.fcl, d.lower, d.upper);
    }
  }

  int pairs = 0;
  int agree = 0;
  int fcl_far = 0;    ///< larger than that of our points and the tessellation error: both are certified bounds
  int fcl_near = 0;   ///< smaller than g(n), which no points of the bodies come below
  int undecided = 0;  ///< ours does not hold
  int fcl_threw = 0;
  double worst = 0;       ///< largest excess over the bounds, of polytopes also over FCL's tolerance
  double margins = 0;     ///< sum of the tessellation errors, over all directions
  int agree_closely = 0;  ///< pairs that agree with the tessellation error along FCL's own normal alone
  double close_margins = 0;
};

TEST(SuperellipsoidOracle, FclAgreesToTheTessellationOrIsWrong) {
  const std::vector<Tessellated>& bodies = tessellated_bodies();
  for (const Tessellated& body : bodies) EXPECT_GE(body.vertices.size(), 100U);
  Comparison comparison;
  const int pairs = scaled(3'000, 50'000);
  const int aborts = geom_test::run_forked(pairs, comparison, [&](int i, Comparison& record) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const Tessellated& a = bodies[static_cast<std::size_t>(random.uniform() * static_cast<double>(bodies.size()))];
    const Tessellated& b = bodies[static_cast<std::size_t>(random.uniform() * static_cast<double>(bodies.size()))];
    const ManufacturedPair pair = geom_test::manufacture(a.shape, b.shape, random.log_uniform(1e-3, 10), random);
    const DistanceResult ours = distance(a.shape, pair.X_WA, b.shape, pair.X_WB);
    ++record.pairs;
    const double g = lower_bound(a.shape, pair.X_WA, b.shape, pair.X_WB, ours.normal);
    const double rounding = 1e-12 * (pair.size + pair.X_WA.position().norm());
    const double off_surfaces =
        offset(a.shape, pair.X_WA, ours.point_a) + offset(b.shape, pair.X_WB, ours.point_b);  // at sharp tips
    const double upper = (ours.point_b - ours.point_a).norm() + off_surfaces;
    if (ours.status != DistanceStatus::separated || !(upper - g <= rounding + 0.1 * kFclTolerance)) {
      ++record.undecided;
      return;
    }
    const FclDistance fcl = geom_test::fcl_distance(a.vertices, pair.X_WA, b.vertices, pair.X_WB);
    if (fcl.outcome == FclDistance::Outcome::threw) {
      ++record.fcl_threw;
      return;
    }
    const double margin = a.error + b.error;
    record.margins += margin;
    // The polytopes are inside: their distance is between ours and ours plus the tessellation error.
    const double below = g - kFclTolerance - rounding - fcl.distance;
    const double above = fcl.distance - (upper + margin + kFclTolerance + rounding);
    record.worst = std::max({record.worst, below, above});
    // Along the normal n of the polytopes' closest points d_P = g_P(n) = g(n) + e(n) <= d + e(n).
    const Vector3d n = (fcl.point_b - fcl.point_a).normalized();
    const double close_margin =
        height_over(a, pair.X_WA.rotation().transpose() * n) + height_over(b, pair.X_WB.rotation().transpose() * -n);
    record.close_margins += close_margin;
    record.agree_closely += below <= 0 && fcl.distance <= upper + close_margin + kFclTolerance + rounding;
    if (below > 0 || above > 0) record.list({i, fcl.distance, g, upper + margin});
    ++(below > 0 ? record.fcl_near : above > 0 ? record.fcl_far : record.agree);
  });
  std::printf(
      "%d pairs, %d agree within %g and the tessellation error (%.2g on average; %d with the error along FCL's normal "
      "alone, %.2g); FCL wrong, certified: %d too far, %d too near (by up to %.1e); %d threw, %d aborts, %d "
      "undecided\n",
      comparison.pairs, comparison.agree, kFclTolerance, comparison.margins / comparison.pairs,
      comparison.agree_closely, comparison.close_margins / comparison.pairs, comparison.fcl_far, comparison.fcl_near,
      comparison.worst, comparison.fcl_threw, aborts, comparison.undecided);
  comparison.print_list();
  EXPECT_EQ(comparison.undecided, 0);
  EXPECT_GE(comparison.agree_closely, 1'000);
  EXPECT_GE(comparison.agree, 0.95 * pairs);
  EXPECT_LE(comparison.worst, 1e-2);
  EXPECT_LE(aborts, pairs / 100);
}

// ---------------------------------------------------------------------------------------------------------------------

/// A body as FCL's GJK sees it.
struct Fed {
  const Shape* shape;
  const Pose* X_W;
};

Vector3d fed_support(const void* body, const Vector3d& direction) {
  const auto& fed = *static_cast<const Fed*>(body);
  const Eigen::Matrix3d& R = fed.X_W->rotation();
  return fed.X_W->position() + R * support(*fed.shape, R.transpose() * direction).point;
}

/// FCL's GJK on the bodies as they are: disagreements of more than its tolerance, an absolute length, are its own where
/// our bounds say so.
TEST(SuperellipsoidOracle, FclsGjkOnOurSupportFunctionsAgreesOrIsWrong) {
  Comparison comparison;
  const int pairs = full_form() ? 50'000 : 3'000;
  const int aborts = geom_test::run_forked(pairs, comparison, [&](int i, Comparison& record) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const auto shape = [&] {
      return Superellipsoid(random.biaxial(3).semi_axes(), any_exponent(random), any_exponent(random));
    };
    const Shape a = shape();
    const Shape b = shape();
    const auto& barr_a = std::get<Superellipsoid>(a);
    const auto& barr_b = std::get<Superellipsoid>(b);
    const ManufacturedPair pair = geom_test::manufacture(barr_a, barr_b, random.log_uniform(1e-3, 10), random);
    const DistanceResult ours = distance(a, pair.X_WA, b, pair.X_WB);
    ++record.pairs;
    const double rounding = 1e-12 * (pair.size + pair.X_WA.position().norm());
    const double g = distance_lower_bound(a, pair.X_WA, b, pair.X_WB, ours.normal) - rounding;
    const double upper = (ours.point_b - ours.point_a).norm() + offset(barr_a, pair.X_WA, ours.point_a) +
                         offset(barr_b, pair.X_WB, ours.point_b) + rounding;
    if (ours.status != DistanceStatus::separated || !(upper - g <= 0.1 * kFclTolerance)) {
      ++record.undecided;
      return;
    }
    const Fed fed_a{&a, &pair.X_WA};
    const Fed fed_b{&b, &pair.X_WB};
    const double fcl = geom_test::fcl_gjk_distance(&fed_a, &fed_b, fed_support);
    record.worst = std::max({record.worst, g - fcl, fcl - upper});
    if (std::max(g - fcl, fcl - upper) > kFclTolerance) record.list({i, fcl, g, upper});
    ++(g - fcl > kFclTolerance ? record.fcl_near : fcl - upper > kFclTolerance ? record.fcl_far : record.agree);
  });
  std::printf(
      "%d pairs, %d agree within %g; FCL wrong, certified: %d too far, %d too near or overlapping (by up to %.1e); %d "
      "aborts, %d undecided\n",
      comparison.pairs, comparison.agree, kFclTolerance, comparison.fcl_far, comparison.fcl_near, comparison.worst,
      aborts, comparison.undecided);
  comparison.print_list();
  EXPECT_EQ(comparison.undecided, 0);
  EXPECT_GE(comparison.agree, 1'000);
  EXPECT_LE(aborts, pairs / 100);
}

constexpr std::array kMethods{"`distance`", "FCL: ellipsoids its own, others polytopes of 500 vertices",
                              "FCL's GJK, fed with our support functions", "libccd: MPR of inflated bodies",
                              "CGAL: polytopes of 200 vertices"};
constexpr int kMostErrors = 2'000;

/// Errors of the distance over the size of the pair; infinite: no answer, or the bodies are said to overlap.
struct Errors {
  std::array<std::array<double, kMostErrors>, kMethods.size()> of{};
};

double length_of(const WitnessPair& seed) {
  return seed.status == SeedStatus::usable ? (seed.point_b - seed.point_a).norm() : HUGE_VAL;
}

/// Asks each library about the same pair, apart by 1e-3 to 10.
void try_libraries(bool ellipsoids, std::size_t i, Errors& errors) {
  Random random(i + 1);
  const auto shape = [&]() -> Shape {
    const Ellipsoid body = random.biaxial(3);
    if (ellipsoids) return body;
    return Superellipsoid(body.semi_axes(), any_exponent(random), any_exponent(random));
  };
  const Shape a = shape();
  const Shape b = shape();
  const ManufacturedPair pair = kernel::with_bodies(a, b, [&](const auto& s, const auto& t) {
    return geom_test::manufacture(s, t, random.log_uniform(1e-3, 10), random);
  });
  const double wanted = kernel::with_bodies(
      a, b, [&](const auto& s, const auto& t) { return lower_bound(s, pair.X_WA, t, pair.X_WB, pair.normal); });
  const auto error = [&](double distance) { return std::abs(distance - wanted) / pair.size; };
  for (auto& method : errors.of) method[i] = HUGE_VAL;  // what remains of the pair if the process ends
  errors.of[0][i] = error(distance(a, pair.X_WA, b, pair.X_WB).distance);
  errors.of[1][i] = error(length_of(fcl_seed(a, pair.X_WA, b, pair.X_WB)));
  errors.of[3][i] = error(length_of(ccd_seed(a, pair.X_WA, b, pair.X_WB)));
#if HARDBODY_WITH_CGAL
  errors.of[4][i] = error(length_of(cgal_seed(a, pair.X_WA, b, pair.X_WB)));
#endif
  const Fed fed_a{&a, &pair.X_WA};
  const Fed fed_b{&b, &pair.X_WB};
  const double gjk = geom_test::fcl_gjk_distance(&fed_a, &fed_b, fed_support);
  errors.of[2][i] = gjk >= 0 ? error(gjk) : HUGE_VAL;
}

/// The table of docs/accuracy.md.
TEST(SuperellipsoidOracle, ErrorsOfEachLibraryOnTheSamePairs) {
  const int pairs = scaled(200, kMostErrors);
  for (const bool ellipsoids : {true, false}) {
    static Errors errors;  // too large for the stack
    const int aborts = geom_test::run_forked(
        pairs, errors, [&](int i, Errors& record) { try_libraries(ellipsoids, static_cast<std::size_t>(i), record); });
    std::printf("%s, %d pairs, %d aborts of FCL's GJK\n| method | median error | largest error | none |\n",
                ellipsoids ? "ellipsoids" : "superellipsoids", pairs, aborts);
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      auto* const begin = errors.of[k].begin();
      auto* const end = begin + pairs;
      std::sort(begin, end);
      const auto answers = std::lower_bound(begin, end, HUGE_VAL) - begin;
      if (answers == 0) continue;  // not built in
      std::printf("| %s | %.0e | %.0e | %ld |\n", kMethods[k], begin[answers / 2], begin[answers - 1],
                  static_cast<long>(pairs - answers));
      // Ours is exact; of the others it is enough that they mean the same question.
      EXPECT_LE(begin[answers - 1], k == 0 ? 1e-12 : 0.1) << kMethods[k];
      EXPECT_LE(begin[answers / 2], k == 0 ? 1e-15 : 1e-2) << kMethods[k];
      EXPECT_GE(static_cast<double>(answers), (k == 0 ? 1.0 : 0.95) * pairs) << kMethods[k];
    }
  }
}

}  // namespace
}  // namespace geom
