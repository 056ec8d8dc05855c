#include "batch/checks.h"

#include <geom/any_shape.h>
#include <geom/batch.h>

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <variant>

namespace geom {
namespace {

using kernel::checked;
using kernel::Input;

std::optional<Ellipsoid> as_ellipsoid(const Shape& shape) {
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) return *ellipsoid;
  const auto* superellipsoid = std::get_if<Superellipsoid>(&shape);
  if (superellipsoid != nullptr && superellipsoid->is_ellipsoid()) return Ellipsoid(superellipsoid->semi_axes());
  return std::nullopt;
}

/// Pairs of ellipsoids among other shapes, copied side by side for the kernels.
class EllipsoidPairs {
 public:
  /// Constructs the collection; `options` must have no starts.
  EllipsoidPairs(std::span<DistanceResult> results, const BatchOptions& options)
      : results_(results), options_(options) {}

  void add(std::size_t pair, const Ellipsoid& a, const Pose& X_WA, const Ellipsoid& b, const Pose& X_WB,
           const Eigen::Vector3d& start) {
    pairs_[count_] = pair;
    a_[count_] = a;
    b_[count_] = b;
    X_WA_[count_] = X_WA;
    X_WB_[count_] = X_WB;
    starts_[count_] = start;
    if (++count_ == kMost) flush();
  }

  void flush() {
    const auto first = [this](const auto& all) { return std::span(all).first(count_); };
    options_.starts = first(starts_);
    redone_ +=
        distance_batch(first(a_), first(X_WA_), first(b_), first(X_WB_), std::span(found_).first(count_), options_)
            .redone;
    for (std::size_t k = 0; k < count_; ++k) results_[pairs_[k]] = found_[k];
    count_ = 0;
  }

  std::size_t redone() const { return redone_; }

 private:
  static constexpr std::size_t kMost = 64;
  template <std::size_t... k>
  static std::array<Ellipsoid, kMost> balls(std::index_sequence<k...>) {
    return {((void)k, Ellipsoid(Eigen::Vector3d::Ones()))...};
  }

  std::span<DistanceResult> results_;
  BatchOptions options_;
  std::size_t count_ = 0;
  std::size_t redone_ = 0;
  std::array<std::size_t, kMost> pairs_{};
  std::array<Ellipsoid, kMost> a_ = balls(std::make_index_sequence<kMost>());
  std::array<Ellipsoid, kMost> b_ = a_;
  std::array<Pose, kMost> X_WA_;
  std::array<Pose, kMost> X_WB_;
  std::array<Eigen::Vector3d, kMost> starts_;
  std::array<DistanceResult, kMost> found_;
};

}  // namespace

BatchSummary distance_batch(std::span<const Shape> a, std::span<const Pose> X_WA, std::span<const Shape> b,
                            std::span<const Pose> X_WB, std::span<DistanceResult> results,
                            const BatchOptions& options) {
  const std::size_t pairs = results.size();
  const Input<Shape> in_a = checked("a", a, pairs), in_b = checked("b", b, pairs);
  const Input<Pose> in_X_WA = checked("X_WA", X_WA, pairs), in_X_WB = checked("X_WB", X_WB, pairs);
  kernel::check_starts(options, pairs);
  const InstructionSet set = kernel::chosen(options.instruction_set);
  BatchOptions of_ellipsoids = options;
  of_ellipsoids.instruction_set = set;
  EllipsoidPairs ellipsoids(results, of_ellipsoids);
  DistanceOptions scalar = kernel::scalar_options(options);
  std::size_t redone = 0;
  for (std::size_t k = 0; k < pairs; ++k) {
    if (!options.starts.empty()) scalar.start = options.starts[k];
    const std::optional<Ellipsoid> s = as_ellipsoid(in_a[k]);
    const std::optional<Ellipsoid> t = s ? as_ellipsoid(in_b[k]) : std::nullopt;
    if (t) {
      ellipsoids.add(k, *s, in_X_WA[k], *t, in_X_WB[k], scalar.start);
    } else {
      results[k] = distance(in_a[k], in_X_WA[k], in_b[k], in_X_WB[k], scalar);
      ++redone;
    }
  }
  ellipsoids.flush();
  return {set, redone + ellipsoids.redone()};
}

}  // namespace geom
