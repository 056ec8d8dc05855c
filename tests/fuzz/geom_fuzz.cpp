/// libFuzzer: distances and queries of geom/queries.h on raw doubles. Ellipsoids, superellipsoids and mixed pairs.
///
/// What must hold whatever the numbers: constructors refuse by std::invalid_argument and nothing else throws; an answer
/// has no number that is not finite, and the gap that its normal certifies is its distance; what is no answer has none.

#include "fuzz/fuzz_input.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <variant>

namespace {

using Eigen::Vector3d;
using fuzz::Input;
using geom::DistanceResult;
using geom::DistanceStatus;
using geom::Pose;
using geom::Shape;

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
};

/// Prints a body with all its digits, to be made again.
void print(const Shape& shape, const Pose& X) {
  const auto list = [](const auto& values) {
    for (int k = 0; k < values.size(); ++k) std::fprintf(stderr, "%s%.17g", k == 0 ? "" : ", ", values.reshaped()[k]);
  };
  if (const auto* ellipsoid = std::get_if<geom::Ellipsoid>(&shape)) list(ellipsoid->semi_axes());
  if (const auto* barr = std::get_if<geom::Superellipsoid>(&shape)) {
    list(barr->semi_axes());
    std::fprintf(stderr, "; exponents %.17g, %.17g", barr->e1(), barr->e2());
  }
  std::fprintf(stderr, "; rotation by columns ");
  list(X.rotation());
  std::fprintf(stderr, "; position ");
  list(X.position());
  std::fprintf(stderr, "\n");
}

const Pair* asked = nullptr;  ///< pair of the input that runs

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  if (asked != nullptr) {
    print(asked->a, asked->X_WA);
    print(asked->b, asked->X_WB);
  }
  std::abort();
}

/// Returns the length that errors are relative to. It is infinite where squares overflow: then nothing is compared.
double size_of(const Pair& pair) {
  return (pair.X_WB.position() - pair.X_WA.position()).norm() + geom::bounding_radius(pair.a) +
         geom::bounding_radius(pair.b);
}

bool is_answer(DistanceStatus status) {
  return status == DistanceStatus::separated || status == DistanceStatus::overlapping;
}

void check(const Pair& pair, const DistanceResult& r) {
  if (!is_answer(r.status)) {
    require(std::isnan(r.distance), "a declined answer has no distance");
    return;
  }
  require(std::isfinite(r.distance), "an answer is finite");
  require(r.point_a.allFinite() && r.point_b.allFinite(), "its points are finite");
  require(std::abs(r.normal.norm() - 1) < 1e-9, "its normal is a unit vector");
  require(!std::isnan(r.residual), "its residual is a number");
  require((r.distance >= 0) == (r.status == DistanceStatus::separated), "its sign is what the status says");
  const double size = size_of(pair);
  require(r.error_bound >= 0, "its error bound is a number, none below 0");
  require(std::isinf(r.error_bound) || r.error_bound <= 1.01 * geom::kWidestDepthGap * size, "and not a wide one");
  const double gap = (r.point_b - r.point_a - r.distance * r.normal).norm();
  require(gap <= 1e-14 * (size + r.point_a.norm()), "its points are its distance apart, along its normal");
  const double g = geom::distance_lower_bound(pair.a, pair.X_WA, pair.b, pair.X_WB, r.normal);
  require(std::abs(g - r.distance) <= geom::kBoundGap * size, "its distance is the gap across its normal");
}

/// The search over all normals, of deep overlaps, is a thousand times slower than all the rest: now and then.
bool may_be_slow(const Input& input) {
  return input.is_one_in(256);
}

/// Newton's method on a hopeless seed takes hundreds of evaluations before it declines; the kernels of batches are not
/// optimised where the fuzzer runs.
bool may_be_tedious(const Input& input) {
  return input.is_one_in(16);
}

void ask_distance(const Pair& pair, Input& input) {
  geom::DistanceOptions options;
  if (!may_be_slow(input)) options.penetration = geom::Penetration::local;
  if (input.byte() % 2 == 1) options.start = input.vector();
  const DistanceResult r = geom::distance(pair.a, pair.X_WA, pair.b, pair.X_WB, options);
  check(pair, r);
}

/// Both orders of the pair in one batch: what `distance` answers is within rounding the same.
void ask_batch(const Pair& pair, Input& input) {
  geom::BatchOptions options;
  if (!may_be_slow(input)) options.penetration = geom::Penetration::local;
  const std::array<Shape, 2> a{pair.a, pair.b};
  const std::array<Shape, 2> b{pair.b, pair.a};
  const std::array<Pose, 2> X_WA{pair.X_WA, pair.X_WB};
  const std::array<Pose, 2> X_WB{pair.X_WB, pair.X_WA};
  std::array<DistanceResult, 2> results;
  (void)geom::distance_batch(a, X_WA, b, X_WB, results, options);
  check(pair, results[0]);
  check({pair.b, pair.a, pair.X_WB, pair.X_WA}, results[1]);
  const DistanceResult one = geom::distance(pair.a, pair.X_WA, pair.b, pair.X_WB, {.penetration = options.penetration});
  if (!is_answer(one.status) || !(one.distance > 0)) return;
  for (const DistanceResult& r : results) {
    require(is_answer(r.status), "a batch answers where `distance` does");
    require(std::abs(r.distance - one.distance) <= 1e-14 * size_of(pair) + one.error_bound + r.error_bound,
            "a batch answers what `distance` does");
  }
}

void ask_newton(const Pair& pair, Input& input) {
  const auto system = input.byte() % 2 == 0 ? geom::NewtonSystem::eight : geom::NewtonSystem::five;
  const int kind = input.byte() % 3;
  const Vector3d u = input.vector();
  const Vector3d v = input.vector();
  const geom::WitnessPair any{u, v, geom::SeedStatus::usable};
  const auto along_u = [&](const auto& a, const auto& b) { return geom::normal_seed(a, pair.X_WA, b, pair.X_WB, u); };
  const geom::WitnessPair seed = kind == 0   ? any
                                 : kind == 1 ? geom::kernel::with_bodies(pair.a, pair.b, along_u)
                                             : geom::centre_seed(pair.a, pair.X_WA, pair.b, pair.X_WB);
  const auto good = geom::checked_seed(pair.a, pair.X_WA, pair.b, pair.X_WB, seed);
  check(pair, geom::newton_distance(pair.a, pair.X_WA, pair.b, pair.X_WB, system, good));
}

/// True if the point is inside, or so far away that the body is lost in its rounding.
bool is_slow_point(const Pair& pair, const Vector3d& p) {
  const double way = (p - pair.X_WA.position()).norm();
  return geom::contains(pair.a, pair.X_WA, p) || !(way < 1e12 * geom::bounding_radius(pair.a));
}

void ask_point(const Pair& pair, Input& input) {
  const Vector3d p = input.vector();
  if (is_slow_point(pair, p) && !may_be_slow(input)) return;
  const geom::ClosestPoint closest = geom::closest_point(pair.a, pair.X_WA, p);
  if (is_answer(closest.status)) {
    require(std::isfinite(closest.distance) && closest.point.allFinite() && closest.normal.allFinite(),
            "a closest point is finite");
    require(closest.error_bound >= 0, "its error bound is a number, none below 0");
  }
}

void ask_ray(const Pair& pair, Input& input) {
  const Vector3d origin = input.vector();
  if (is_slow_point(pair, origin) && !may_be_slow(input)) return;
  const geom::RayHit hit = geom::ray_cast(pair.a, pair.X_WA, origin, input.vector());
  if (hit.status == geom::RayStatus::hit || hit.status == geom::RayStatus::inside) {
    require(hit.t >= 0 && std::isfinite(hit.t) && hit.point.allFinite() && hit.normal.allFinite(), "a hit is finite");
  }
}

void ask_overlap(const Pair& pair, Input& input) {
  const DistanceResult r =
      geom::distance(pair.a, pair.X_WA, pair.b, pair.X_WB, {.penetration = geom::Penetration::local});
  const bool certified = is_answer(r.status) && std::isfinite(r.error_bound);
  if (!certified && !may_be_slow(input)) return;
  const geom::Answer answer = geom::overlap(pair.a, pair.X_WA, pair.b, pair.X_WB, input.vector());
  if (answer == geom::Answer::unknown || !certified || !(std::abs(r.distance) > 1e-8 * size_of(pair))) return;
  require((answer == geom::Answer::yes) == (r.distance < 0), "overlap says what distance says");
}

std::optional<Pair> read_pair(Input& input) {
  try {
    const Shape a = input.shape();
    const Shape b = input.shape();
    const Pose X_WA = input.pose(input.vector());
    const Vector3d p_B = input.vector();
    const bool beside = input.byte() % 8 != 1;  // near enough to be interesting, far enough to be apart
    const double reach = geom::bounding_radius(a) + geom::bounding_radius(b);
    return Pair{a, b, X_WA, input.pose(beside ? X_WA.position() + input.fraction() * reach * p_B : p_B)};
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Numbers of inputs and of those that were skipped; printed at the end.
struct Counters {
  long inputs = 0;
  long refused = 0;   ///< inputs refused by a constructor
  long rationed = 0;  ///< inputs skipped as too slow
  ~Counters() {
    std::fprintf(stderr, "%ld inputs: %ld refused by constructors, %ld too slow to be asked, %ld answered\n", inputs,
                 refused, rationed, inputs - refused - rationed);
  }
};
Counters counters;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const int question = input.byte() % 8;
  const std::optional<Pair> pair = read_pair(input);
  ++counters.inputs;
  if (!pair) {
    ++counters.refused;
    return 0;
  }
  if (!fuzz::are_quick(pair->a, pair->X_WA, pair->b, pair->X_WB) && !may_be_slow(input)) {
    ++counters.rationed;
    return 0;
  }
  asked = &*pair;
  switch (question) {
    case 0:
      if (may_be_tedious(input)) {
        ask_newton(*pair, input);
      } else {
        ask_distance(*pair, input);
      }
      break;
    case 1:
      ask_point(*pair, input);
      break;
    case 2:
      ask_ray(*pair, input);
      break;
    case 3:
      ask_overlap(*pair, input);
      break;
    case 4:
      if (may_be_tedious(input)) {
        ask_batch(*pair, input);
      } else {
        ask_distance(*pair, input);
      }
      break;
    default:
      ask_distance(*pair, input);
  }
  asked = nullptr;
  return 0;
}
