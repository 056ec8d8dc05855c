#include <base/periodic.h>
#include <cells/grid.h>

#include <common/geom/batch.h>

#include <ed/archive.h>
#include <ed/random.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed::internal::CellGrid;
using ed::internal::NearBody;
using Eigen::Vector3d;

struct Case {
  int number;
  double box;
  double reach;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.number << " bodies, box " << c.box << ", reach " << c.reach;
}

Vector3d nearest_image(const Vector3d& r, double box) {
  return {r.x() - box * std::round(r.x() / box), r.y() - box * std::round(r.y() / box),
          r.z() - box * std::round(r.z() / box)};
}

/// Exactly the bodies whose nearest image is within `reach` (but for rounding), each once, with the vector to it.
void expect_exact(const CellGrid& grid, const std::vector<Vector3d>& positions, const Vector3d& centre, double box,
                  double reach, std::vector<NearBody>& buffer) {
  std::vector<int> times_found(positions.size(), 0);
  for (const NearBody& near : grid.collect(centre, reach, buffer)) {
    const auto i = static_cast<std::size_t>(near.body);
    ++times_found[i];
    // The images may differ where two are equally near; lengths may not.
    const double distance = nearest_image(positions[i] - centre, box).norm();
    EXPECT_NEAR(near.r.norm(), distance, 1e-14 * box);
    EXPECT_LE(nearest_image(centre + near.r - positions[i], box).norm(), 1e-14 * box);
    EXPECT_LE(distance, reach * (1 + 1e-12));
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_LE(times_found[i], 1) << "body " << i << " was collected twice";
    const double distance = nearest_image(positions[i] - centre, box).norm();
    EXPECT_TRUE(times_found[i] == 1 || distance >= reach * (1 - 1e-12)) << "body " << i << " at " << distance;
  }
}

/// Anywhere, in any image; one in four within rounding of a multiple of the box.
Vector3d draw(ed::Random& random, double box) {
  Vector3d p;
  for (double& x : p) {
    x = random.uniform() < 0.25 ? std::floor(5 * random.uniform() - 2) : 5 * random.uniform() - 2.5;
    x *= box;
    if (random.uniform() < 0.1) x = std::nextafter(x, -10 * box);
  }
  return p;
}

class CellGridIn : public testing::TestWithParam<Case> {};

TEST_P(CellGridIn, CollectsExactlyWhatIsWithinReach) {
  const auto& [number, box, reach] = GetParam();
  ed::Random random(11);
  CellGrid grid(number, box, reach);
  std::vector<Vector3d> positions(static_cast<std::size_t>(number));
  std::vector<NearBody> buffer;
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < number; ++i) {
      // Later rounds move half of them: what was placed before must leave its old cell.
      if (round > 0 && random.uniform() < 0.5) continue;
      positions[static_cast<std::size_t>(i)] = draw(random, box);
      grid.place(i, positions[static_cast<std::size_t>(i)]);
    }
    for (int k = 0; k < 40; ++k) {
      // Up to the reach that the grid was made for.
      const double asked = k % 2 == 0 ? reach : random.uniform() * reach;
      expect_exact(grid, positions, draw(random, box), box, asked, buffer);
    }
    for (const Vector3d& centre : positions) expect_exact(grid, positions, centre, box, reach, buffer);
  }
}

TEST_P(CellGridIn, CoversTheScaledReachAfterScaling) {
  const auto& [number, box, reach] = GetParam();
  ed::Random random(12);
  CellGrid grid(number, box, reach);
  std::vector<Vector3d> positions(static_cast<std::size_t>(number));
  std::vector<NearBody> buffer;
  for (int i = 0; i < number; ++i) {
    positions[static_cast<std::size_t>(i)] = box * Vector3d(random.uniform(), random.uniform(), random.uniform());
    grid.place(i, positions[static_cast<std::size_t>(i)]);
  }
  const double factor = 0.83;
  grid.scale(factor);
  for (Vector3d& p : positions) p *= factor;
  for (const Vector3d& centre : positions) expect_exact(grid, positions, centre, factor * box, factor * reach, buffer);
}

// From reaches beyond the box, where all cells count, to a grid of many cells, the narrowest among them.
INSTANTIATE_TEST_SUITE_P(Boxes, CellGridIn,
                         testing::Values(Case{1, 1.0, 3.0}, Case{5, 1.0, 1.0}, Case{8, 1.0, 0.6}, Case{20, 1.0, 0.49},
                                         Case{40, 2.0, 0.7}, Case{150, 3.0, 0.8}, Case{200, 10.0, 2.0},
                                         Case{300, 10.0, 0.5}, Case{3000, 1.0, 0.3}, Case{4000, 1.0, 0.28}));

TEST(CellGrid, BufferIsKeptAndNeverShrunk) {
  constexpr int kNumber = 200;
  ed::Random random(13);
  CellGrid grid(kNumber, 10, 4);
  for (int i = 0; i < kNumber; ++i) {
    grid.place(i, 10 * Vector3d(random.uniform(), random.uniform(), random.uniform()));
  }
  std::vector<NearBody> buffer;
  (void)grid.collect({5, 5, 5}, 4, buffer);
  const std::size_t size = buffer.size();
  const NearBody* const place = buffer.data();
  const auto found = grid.collect({5, 5, 5}, 1, buffer);
  EXPECT_EQ(buffer.size(), size);
  EXPECT_EQ(found.data(), place) << "a second look must not allocate";
}

TEST(CellGrid, ABodyPlacedTwiceIsOneAndStandsWhereItWasPutLast) {
  CellGrid grid(2, 1, 0.3);
  grid.place(0, {0.5, 0.5, 0.5});
  grid.place(0, {1.5, -0.5, 0.5});  // the same place, other images
  grid.place(0, {0.51, 0.5, 0.5});  // the same cell
  std::vector<NearBody> buffer;
  const auto found = grid.collect({0.5, 0.5, 0.5}, 0.3, buffer);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].body, 0);
  EXPECT_NEAR(found[0].r.x(), 0.01, 1e-15);
}

/// Bodies that a grid finds, in its order and bit by bit.
struct Found {
  std::vector<int> bodies;
  std::vector<Vector3d> r;

  bool operator==(const Found&) const = default;
};

Found found_by(const CellGrid& grid, const Vector3d& centre, double reach) {
  std::vector<NearBody> buffer;
  Found result;
  for (const NearBody& near : grid.collect(centre, reach, buffer)) {
    result.bodies.push_back(near.body);
    result.r.push_back(near.r);
  }
  return result;
}

/// Half of them in a corner, so that some cells hold many.
Vector3d draw_crowded(ed::Random& random, double box) {
  const double edge = random.uniform() < 0.5 ? 0.2 * box : box;
  return edge * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
}

std::vector<Vector3d> place_all(int number, double box, ed::Random& random, CellGrid& grid) {
  std::vector<Vector3d> positions;
  for (int i = 0; i < number; ++i) {
    positions.push_back(draw_crowded(random, box));
    grid.place(i, positions.back());
  }
  return positions;
}

TEST(CellGrid, EveryInstructionSetFindsTheSameBits) {
  constexpr int kNumber = 700;
  constexpr double kBox = 9;
  constexpr double kReach = 2.3;
  ed::Random scalar_places(14);
  CellGrid scalar(kNumber, kBox, kReach, std::nullopt);
  const std::vector<Vector3d> positions = place_all(kNumber, kBox, scalar_places, scalar);
  for (const geom::InstructionSet set : geom_test::instruction_sets()) {
    ed::Random places(14);
    CellGrid grid(kNumber, kBox, kReach, set);
    place_all(kNumber, kBox, places, grid);
    ed::Random random(15);
    std::size_t found = 0;
    for (int k = 0; k < 300; ++k) {
      const Vector3d centre = draw_crowded(random, kBox);
      const Found near = found_by(grid, centre, kReach);
      for (std::size_t n = 0; n < near.bodies.size(); ++n) {
        const Vector3d d = positions[static_cast<std::size_t>(near.bodies[n])] - centre;
        EXPECT_EQ(near.r[n], ed::internal::nearest_image(d, kBox)) << geom::to_string(set);
      }
      EXPECT_EQ(near, found_by(scalar, centre, kReach)) << geom::to_string(set);
      found += near.bodies.size();
    }
    EXPECT_GT(found, 10000U);
  }
}

TEST(CellGrid, GoesOnAsItWasAfterReading) {
  constexpr int kNumber = 500;
  constexpr double kBox = 8;
  constexpr double kReach = 1.9;
  ed::Random random(16);
  CellGrid grid(kNumber, kBox, kReach);
  place_all(kNumber, kBox, random, grid);
  grid.scale(0.9);
  const std::string bytes = ed::archive::bytes_of(grid);
  CellGrid read(kNumber, 0.9 * kBox, 0.9 * kReach);
  ed::archive::Reader reader(bytes);
  reader(read);
  EXPECT_EQ(ed::archive::bytes_of(read), bytes);
  // In the same order, too, after bodies have left their cells and come to others.
  for (int k = 0; k < 5000; ++k) {
    const int body = static_cast<int>(kNumber * random.uniform());
    const Vector3d place = draw_crowded(random, 0.9 * kBox);
    grid.place(body, place);
    read.place(body, place);
    if (k % 10 == 0) {
      const Vector3d centre = draw_crowded(random, 0.9 * kBox);
      ASSERT_EQ(found_by(grid, centre, 0.9 * kReach), found_by(read, centre, 0.9 * kReach)) << k;
    }
  }
  EXPECT_EQ(ed::archive::bytes_of(read), ed::archive::bytes_of(grid));
}

/// Bodies stand last but for their places: `back` of them from the end.
std::string with_body(std::string bytes, int number, int back, int body) {
  const std::size_t places = sizeof(std::uint64_t) + sizeof(Vector3d) * static_cast<std::size_t>(number);
  std::memcpy(bytes.data() + bytes.size() - places - sizeof body * static_cast<std::size_t>(back), &body, sizeof body);
  return bytes;
}

TEST(CellGrid, RefusesWhatHoldsNotEachBodyOnce) {
  constexpr int kNumber = 20;
  CellGrid grid(kNumber, 10, 2.5);
  ed::Random random(12);
  for (int i = 0; i < kNumber; ++i) grid.place(i, draw(random, 10));
  const std::string bytes = ed::archive::bytes_of(grid);
  const auto expect_refused = [](const std::string& bad, const std::string& what) {
    ed::archive::Reader reader(bad);
    CellGrid read(kNumber, 10, 2.5);
    EXPECT_THROW(reader(read), std::invalid_argument) << what;
  };
  ed::archive::Reader sound(bytes);
  EXPECT_NO_THROW(sound(grid));
  int last = 0;
  std::memcpy(&last, bytes.data() + bytes.size() - sizeof(std::uint64_t) - sizeof(Vector3d) * kNumber - sizeof last,
              sizeof last);
  ASSERT_EQ(with_body(bytes, kNumber, 1, last), bytes);
  for (const int body : {-1, kNumber, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    expect_refused(with_body(bytes, kNumber, 1, body), "body " + std::to_string(body));
  }
  expect_refused(with_body(bytes, kNumber, 2, last), "a body twice");
  // The first numbers are the box, the cells along an edge, how many cells there are, and the bodies in each.
  for (const int cells : {0, -1, 1, 1000, std::numeric_limits<int>::max()}) {
    std::string bad = bytes;
    std::memcpy(bad.data() + sizeof(double), &cells, sizeof cells);
    expect_refused(bad, std::to_string(cells) + " cells");
  }
  for (const int count : {-1, kNumber + 1, std::numeric_limits<int>::max()}) {
    std::string bad = bytes;
    std::memcpy(bad.data() + sizeof(double) + sizeof(int) + sizeof(std::uint64_t), &count, sizeof count);
    expect_refused(bad, std::to_string(count) + " bodies in a cell");
  }
  std::string bad = bytes;
  const double infinite = std::numeric_limits<double>::infinity();
  std::memcpy(bad.data() + bad.size() - sizeof infinite, &infinite, sizeof infinite);
  expect_refused(bad, "a body nowhere");
  for (const double box : {0.0, 5e-324, 9.0, -10.0, infinite, std::nan("")}) {
    std::string other = bytes;
    std::memcpy(other.data(), &box, sizeof box);
    expect_refused(other, "a box of " + std::to_string(box));
  }
}

}  // namespace
