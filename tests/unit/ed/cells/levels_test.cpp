// Cells for bodies of any sizes, against all pairs.

#include <base/periodic.h>
#include <cells/levels.h>

#include <ed/archive.h>
#include <ed/random.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed::internal::CellLevels;
using ed::internal::NearBody;
using Eigen::Vector3d;

struct Bodies {
  double box;
  std::vector<double> sizes;
  std::vector<double> extents;
  std::vector<Vector3d> positions;
};

/// Sizes between 1 and `ratio`, evenly in their logarithm or of both ends alone; the small ones many more.
Bodies draw(ed::Random& random, int number, double ratio, bool two_sizes) {
  Bodies bodies{2.2 * ratio + 2 * std::cbrt(number), {}, {}, {}};
  for (int i = 0; i < number; ++i) {
    const double u = random.uniform();
    bodies.sizes.push_back(two_sizes ? (u < 0.01 || i == 0 ? ratio : 1) : std::pow(ratio, i == 0 ? 1 : u * u * u));
    bodies.extents.push_back(bodies.sizes.back() + 0.3);
    bodies.positions.push_back(bodies.box * Vector3d(random.uniform(), random.uniform(), random.uniform()));
  }
  return bodies;
}

std::size_t slot(int i) {
  return static_cast<std::size_t>(i);
}

/// Every body within the sum of both extents is found, once, with the vector to its nearest image. Returns the number
/// of bodies that were looked at.
std::size_t expect_found(const CellLevels& cells, const Bodies& bodies) {
  std::vector<NearBody> buffer;
  std::size_t candidates = 0;
  for (int i = 0; i < static_cast<int>(bodies.positions.size()); ++i) {
    std::set<int> found;
    cells.search(i, bodies.positions[slot(i)], buffer, [&](std::span<const NearBody> others) {
      candidates += others.size();
      for (const auto& [k, r] : others) {
        EXPECT_TRUE(found.insert(static_cast<int>(k)).second) << k << " was found twice by " << i;
        const Vector3d d = bodies.positions[slot(i)] + r - bodies.positions[slot(static_cast<int>(k))];
        EXPECT_LE(ed::internal::nearest_image(d, bodies.box).norm(), 1e-13 * bodies.box);
      }
    });
    for (int k = 0; k < static_cast<int>(bodies.positions.size()); ++k) {
      const Vector3d d = ed::internal::nearest_image(bodies.positions[slot(k)] - bodies.positions[slot(i)], bodies.box);
      if (d.norm() > (bodies.extents[slot(i)] + bodies.extents[slot(k)]) * (1 - 1e-12)) continue;
      EXPECT_TRUE(found.contains(k)) << k << " of size " << bodies.sizes[slot(k)] << " by " << i << " of size "
                                     << bodies.sizes[slot(i)];
    }
  }
  return candidates;
}

void place_all(CellLevels& cells, const Bodies& bodies) {
  for (int i = 0; i < static_cast<int>(bodies.positions.size()); ++i) cells.place(i, bodies.positions[slot(i)]);
}

TEST(CellLevels, FindsAllPairsOfBodiesOfAnySizes) {
  ed::Random random(3);
  for (const double ratio : {1.0, 2.6, 6.0, 20.0, 300.0}) {
    for (const bool two_sizes : {false, true}) {
      SCOPED_TRACE(ratio);
      Bodies bodies = draw(random, 400, ratio, two_sizes);
      CellLevels cells(bodies.extents, bodies.box);
      EXPECT_EQ(cells.classes() == 1, ratio < 3);
      place_all(cells, bodies);
      expect_found(cells, bodies);
      // Those that move leave their cells of all grids.
      for (Vector3d& p : bodies.positions) {
        if (random.uniform() < 0.5) p = 3 * bodies.box * (p / bodies.box - Vector3d::Constant(random.uniform()));
      }
      place_all(cells, bodies);
      expect_found(cells, bodies);
    }
  }
}

TEST(CellLevels, LargerBodiesAreOfLaterClasses) {
  const std::vector<double> sizes = {1, 100, 0.9, 3, 20, 99};
  EXPECT_EQ(ed::internal::size_classes(sizes), (std::vector<int>{0, 3, 0, 1, 2, 3}));
  EXPECT_EQ(CellLevels(sizes, 1000).classes(), 4);
}

TEST(CellLevels, SmallBodiesDoNotSearchAsFarAsLargeOnesWould) {
  ed::Random random(4);
  const Bodies bodies = draw(random, 2000, 20, true);
  CellLevels cells(bodies.extents, bodies.box);
  const std::vector<double> farthest(bodies.sizes.size(), 20.3);
  CellLevels one_grid(farthest, bodies.box);
  EXPECT_EQ(one_grid.classes(), 1);
  place_all(cells, bodies);
  place_all(one_grid, bodies);
  EXPECT_LT(20 * expect_found(cells, bodies), expect_found(one_grid, bodies));
}

TEST(CellLevels, CoverTheirExtentsUntilTheBoxHasShrunk) {
  ed::Random random(5);
  Bodies bodies = draw(random, 500, 20, false);
  CellLevels cells(bodies.extents, bodies.box, 0.8);
  EXPECT_TRUE(cells.cover(1 / 0.8));
  EXPECT_FALSE(cells.cover(50));
  place_all(cells, bodies);
  for (const double factor : {0.95, 0.9, 0.95}) {
    cells.scale(factor);
    bodies.box *= factor;
    for (Vector3d& p : bodies.positions) p *= factor;
    expect_found(cells, bodies);
  }
}

TEST(CellLevels, AreReadAsTheyWereWritten) {
  ed::Random random(6);
  const Bodies bodies = draw(random, 300, 20, false);
  CellLevels cells(bodies.extents, bodies.box);
  place_all(cells, bodies);
  const std::string bytes = ed::archive::bytes_of(cells);
  CellLevels read(bodies.extents, bodies.box);
  ed::archive::Reader reader(bytes);
  reader(read);
  reader.finish();
  EXPECT_EQ(ed::archive::bytes_of(read), bytes);
  expect_found(read, bodies);
  // Bodies of other classes are not those that were written.
  std::vector<double> others = bodies.extents;
  std::reverse(others.begin(), others.end());
  CellLevels other(others, bodies.box);
  ed::archive::Reader again(bytes);
  EXPECT_THROW(again(other), std::invalid_argument);
}

}  // namespace
