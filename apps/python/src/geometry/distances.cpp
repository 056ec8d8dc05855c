#include "base/arguments.h"
#include "base/arrays.h"
#include "base/parallel.h"
#include "geometry/bind.h"
#include "geometry/bodies.h"
#include "geometry/options.h"

#include <geom/any_shape.h>
#include <geom/batch.h>
#include <geom/queries.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace hardbody::python {
namespace {

using geom::DistanceResult;
using geom::Ellipsoid;
using geom::Pose;

/// Returns the shape as an ellipsoid, for the kernels of distance_batch, if it is one.
std::optional<Ellipsoid> as_ellipsoid(const geom::Shape& shape) {
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) return *ellipsoid;
  const auto* superellipsoid = std::get_if<geom::Superellipsoid>(&shape);
  if (superellipsoid != nullptr && superellipsoid->is_ellipsoid()) return Ellipsoid(superellipsoid->semi_axes());
  return std::nullopt;
}

/// Number of pairs whose numbers, poses and answers fit into the first-level cache.
constexpr std::size_t kBlock = 32;

/// Number of rows whose answers no cache near the processor holds.
constexpr std::size_t kManyRows = std::size_t{1} << 15;

/// Stores two numbers past the caches; `to` is aligned.
void stream(double* to, const double& first, const double& second) {
  _mm_stream_pd(to, _mm_loadh_pd(_mm_load_sd(&first), &second));
}

/// Arrays of the answers.
struct Columns {
  explicit Columns(std::size_t rows)
      : many(rows >= kManyRows),
        distance(new_array<double>({rows})),
        normal(new_array<double>({rows, 3})),
        point_a(new_array<double>({rows, 3})),
        point_b(new_array<double>({rows, 3})),
        error_bound(new_array<double>({rows})),
        residual(new_array<double>({rows})),
        iterations(new_array<std::int32_t>({rows})),
        status(new_array<std::uint8_t>({rows})) {}

  /// Puts answers of successive rows, column by column.
  void put(std::size_t row, std::span<const DistanceResult> results) const {
    put_column(distance, row, results, &DistanceResult::distance);
    put_column(normal, row, results, &DistanceResult::normal);
    put_column(point_a, row, results, &DistanceResult::point_a);
    put_column(point_b, row, results, &DistanceResult::point_b);
    put_column(error_bound, row, results, &DistanceResult::error_bound);
    put_column(residual, row, results, &DistanceResult::residual);
    for (std::size_t k = 0; k < results.size(); ++k) {
      iterations.data[row + k] = results[k].iterations;
      status.data[row + k] = static_cast<std::uint8_t>(results[k].status);
    }
  }

  bool many;  ///< whether the caller reads the first answers long after they were written
  NewArray<double> distance, normal, point_a, point_b, error_bound, residual;
  NewArray<std::int32_t> iterations;
  NewArray<std::uint8_t> status;

 private:
  /// Puts one member of answers. Where they are many, their lines need not be fetched before.
  void put_column(const NewArray<double>& column, std::size_t row, std::span<const DistanceResult> results,
                  double DistanceResult::*member) const {
    double* const to = column.data + row;
    std::size_t k = 0;
    if (past_caches(to)) {
      for (; k + 2 <= results.size(); k += 2) stream(to + k, results[k].*member, results[k + 1].*member);
    }
    for (; k < results.size(); ++k) to[k] = results[k].*member;
  }
  void put_column(const NewArray<double>& column, std::size_t row, std::span<const DistanceResult> results,
                  Eigen::Vector3d DistanceResult::*member) const {
    double* const to = column.data + 3 * row;
    std::size_t k = 0;
    if (past_caches(to)) {
      for (; k + 2 <= results.size(); k += 2) {
        const Eigen::Vector3d& u = results[k].*member;
        const Eigen::Vector3d& v = results[k + 1].*member;
        stream(to + 3 * k, u.x(), u.y());
        stream(to + 3 * k + 2, u.z(), v.x());
        stream(to + 3 * k + 4, v.y(), v.z());
      }
    }
    for (; k < results.size(); ++k) Eigen::Vector3d::Map(to + 3 * k) = results[k].*member;
  }
  bool past_caches(const double* to) const { return many && reinterpret_cast<std::uintptr_t>(to) % 16 == 0; }
};

/// Pairs of a call, answered in blocks: ellipsoids by distance_batch, other pairs one by one.
class Distances {
 public:
  Distances(const PairQuery& query, const geom::DistanceOptions& options, const Columns& out)
      : query_(query), options_(options), out_(out) {
    for (const geom::Shape& shape : query.bodies.shapes()) ellipsoids_.push_back(as_ellipsoid(shape));
  }

  /// Returns work on ranges of the pairs, with memory of its own.
  Work work() {
    return
        [this, block = std::make_shared<Block>()](std::size_t begin, std::size_t end) { answer(begin, end, *block); };
  }

  /// Returns the number of pairs that the kernels did not answer.
  std::size_t redone() const { return redone_; }

 private:
  /// Bodies of successive pairs.
  struct Indices {
    std::array<std::size_t, kBlock> a, b;
  };

  struct Block {
    std::array<std::size_t, kBlock> rows;  ///< row of each pair of ellipsoids
    std::array<Indices, 2> indices;
    std::array<geom::EllipsoidPair, kBlock> pairs;
    std::array<Eigen::Vector3d, kBlock> starts;
    std::array<Pose, kBlock> slots_a;
    std::array<Pose, kBlock> slots_b;
    std::array<DistanceResult, kBlock> found;
  };

  /// Reads the bodies of pairs, unchecked, and asks for the memory of their poses.
  void read(std::size_t begin, std::size_t end, Indices& indices) const {
    const auto take = [&](std::size_t row, std::size_t column, std::size_t& index) {
      index = query_.pairs.unchecked(row, column);
      if (index < query_.bodies.size()) query_.poses.prefetch(index);
    };
    for (std::size_t row = begin; row < end; ++row) {
      take(row, 0, indices.a[row - begin]);
      take(row, 1, indices.b[row - begin]);
    }
  }

  /// Answers pairs in blocks; the next block is read before one is answered.
  void answer(std::size_t begin, std::size_t end, Block& block) {
    const auto end_of = [end](std::size_t first) { return std::min(end, first + kBlock); };
    std::size_t redone = 0;
    std::size_t turn = 0;
    read(begin, end_of(begin), block.indices[0]);
    for (std::size_t first = begin; first < end; first = end_of(first), turn = 1 - turn) {
      const std::size_t count = end_of(first) - first;
      read(first + count, end_of(first + count), block.indices[1 - turn]);
      redone += answer_block(first, count, block.indices[turn], block);
    }
    redone_ += redone;
    _mm_sfence();  // other threads see what was streamed once this one has ended its work
  }

  /// Answers a block; returns the number of pairs that the kernels did not answer.
  std::size_t answer_block(std::size_t first, std::size_t count, const Indices& bodies, Block& block) const {
    std::size_t ellipsoids = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t a = bodies.a[k], b = bodies.b[k];
      query_.pairs.check(first + k, a, b, query_.bodies.size());
      const auto& shape_a = ellipsoids_[query_.bodies.shape_index(a)];
      const auto& shape_b = ellipsoids_[query_.bodies.shape_index(b)];
      const Pose* const X_WA = query_.poses.get(a, block.slots_a[k]);
      const Pose* const X_WB = query_.poses.get(b, block.slots_b[k]);
      if (!shape_a || !shape_b) {
        put_one(first + k, a, *X_WA, b, *X_WB);
        continue;
      }
      block.pairs[ellipsoids] = {&*shape_a, X_WA, &*shape_b, X_WB};
      block.rows[ellipsoids] = first + k;
      if (query_.starts) block.starts[ellipsoids] = query_.start(first + k);
      ++ellipsoids;
    }
    if (ellipsoids == 0) return count;
    geom::BatchOptions options{.max_iterations = options_.max_iterations, .penetration = options_.penetration};
    if (query_.starts) options.starts = std::span(block.starts).first(ellipsoids);
    const std::span found = std::span(block.found).first(ellipsoids);
    const std::size_t redone = geom::distance_batch(std::span(block.pairs).first(ellipsoids), found, options).redone;
    if (ellipsoids == count) {
      out_.put(first, found);
    } else {
      for (std::size_t k = 0; k < ellipsoids; ++k) out_.put(block.rows[k], found.subspan(k, 1));
    }
    return redone + (count - ellipsoids);
  }

  /// Answers a pair of other bodies.
  void put_one(std::size_t row, std::size_t a, const Pose& X_WA, std::size_t b, const Pose& X_WB) const {
    geom::DistanceOptions options = options_;
    options.start = query_.start(row);
    const DistanceResult found = geom::distance(query_.bodies.shape(a), X_WA, query_.bodies.shape(b), X_WB, options);
    out_.put(row, std::span(&found, 1));
  }

  const PairQuery& query_;
  const geom::DistanceOptions& options_;
  const Columns& out_;
  std::vector<std::optional<Ellipsoid>> ellipsoids_;
  std::atomic<std::size_t> redone_ = 0;
};

nb::tuple distance_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle pairs,
                        nb::handle shape_of, nb::handle threads, nb::handle start, nb::handle max_iterations,
                        nb::handle penetration) {
  const geom::DistanceOptions options = distance_options(max_iterations, penetration);
  const PairQuery query(shapes, positions, quaternions, pairs, shape_of, threads, start);
  const Columns out(query.pairs.size());
  Distances distances(query, options, out);
  query.run(std::function<Work()>([&] { return distances.work(); }));
  return nb::make_tuple(out.distance.array, out.normal.array, out.point_a.array, out.point_b.array,
                        out.error_bound.array, out.residual.array, out.iterations.array, out.status.array,
                        distances.redone(), to_string(geom::batch_instruction_set()));
}

nb::tuple overlap_many(nb::handle shapes, nb::handle positions, nb::handle quaternions, nb::handle pairs,
                       nb::handle shape_of, nb::handle threads, nb::handle start) {
  const PairQuery query(shapes, positions, quaternions, pairs, shape_of, threads, start);
  const std::size_t rows = query.pairs.size();
  const NewArray<bool> yes = new_array<bool>({rows}), unknown = new_array<bool>({rows});
  query.for_each([&](std::size_t row, std::size_t a, const Pose& X_WA, std::size_t b, const Pose& X_WB) {
    const geom::Answer answer =
        geom::overlap(query.bodies.shape(a), X_WA, query.bodies.shape(b), X_WB, query.start(row));
    yes.data[row] = answer == geom::Answer::yes;
    unknown.data[row] = answer == geom::Answer::unknown;
  });
  return nb::make_tuple(yes.array, unknown.array);
}

}  // namespace

void bind_distances(nb::module_& module) {
  const auto required = [](const char* name) { return nb::arg(name).none(); };
  module.def("distance_many", &distance_many, required("shapes"), required("positions"), required("quaternions"),
             required("pairs"), required("shape_of"), required("threads"), required("start"),
             required("max_iterations"), required("penetration"),
             nb::sig("def distance_many(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, "
                     "pairs: typing.Any, shape_of: typing.Any, threads: typing.Any, start: typing.Any, "
                     "max_iterations: typing.Any, penetration: typing.Any) -> tuple[typing.Any, ...]"));
  module.def("overlap_many", &overlap_many, required("shapes"), required("positions"), required("quaternions"),
             required("pairs"), required("shape_of"), required("threads"), required("start"),
             nb::sig("def overlap_many(shapes: typing.Any, positions: typing.Any, quaternions: typing.Any, "
                     "pairs: typing.Any, shape_of: typing.Any, threads: typing.Any, start: typing.Any) "
                     "-> tuple[typing.Any, ...]"));
}

}  // namespace hardbody::python
