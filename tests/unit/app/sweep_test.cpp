/// Grids of a sweep, the files they are read from, and lines of constant value.

#include "base/errors.h"
#include "io/csv_table.h"
#include "plot/contours.h"
#include "sweep/changes.h"
#include "sweep/file.h"
#include "sweep/grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace {

using hardbody::contour_lines;
using hardbody::ContourLine;
using hardbody::lattice_of;
using hardbody::Sample;
using hardbody::SweepFile;
using hardbody::SweepPoint;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kBase = "seed = 3\n[system]\nnumber = 64\npacking_fraction = 0.2\n[shape]\naspect_ratio = 2\n";

SweepFile sweep_of(const std::string& grid) {
  return hardbody::parse_sweep(kBase + grid, "sweep.toml", ".");
}

std::vector<std::string> names_of(const std::string& grid) {
  std::vector<std::string> names;
  for (const SweepPoint& point : hardbody::expand(sweep_of(grid).grids)) names.push_back(point.name);
  return names;
}

std::vector<std::string> assignments_of(const std::string& grid) {
  std::vector<std::string> list;
  for (const SweepPoint& point : hardbody::expand(sweep_of(grid).grids)) {
    std::string text;
    for (const hardbody::Setting& s : point.settings) text += s.assignment() + ";";
    list.push_back(text);
  }
  return list;
}

std::string refusal_of(const std::string& grid) {
  try {
    (void)hardbody::expand(sweep_of(grid).grids);
  } catch (const hardbody::InputError& error) {
    return error.what();
  }
  return "accepted";
}

// ---- Ranges

TEST(SweepRanges, EndIsIncludedWhereAStepFallsOnIt) {
  EXPECT_THAT(hardbody::stepped(0.1, 0.4, 0.1), ElementsAre(0.1, 0.2, 0.3, 0.4));
  EXPECT_THAT(hardbody::stepped(0.1, 0.39, 0.1), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(hardbody::stepped(2, -1, -1.5), ElementsAre(2, 0.5, -1));
  EXPECT_THAT(hardbody::stepped(0.3, 0.3, 0.1), ElementsAre(0.3));
}

TEST(SweepRanges, AreRoundedToWhatAnybodyWrites) {
  // 0.1 + 2 * 0.1 is 0.30000000000000004 in binary.
  for (const double x : hardbody::stepped(0, 1, 0.1)) EXPECT_EQ(x, std::round(10 * x) / 10);
  for (const double x : hardbody::spaced(0, 1, 11, hardbody::Spacing::linear)) EXPECT_EQ(x, std::round(10 * x) / 10);
}

TEST(SweepRanges, NonsenseIsEmpty) {
  EXPECT_TRUE(hardbody::stepped(0, 1, -0.1).empty());
  EXPECT_TRUE(hardbody::stepped(0, 1, 0).empty());
  EXPECT_TRUE(hardbody::stepped(0, 1, 1e-12).empty());
  EXPECT_TRUE(hardbody::stepped(0, std::nan(""), 0.1).empty());
}

TEST(SweepRanges, LogarithmicOnesHaveEqualFactors) {
  EXPECT_THAT(hardbody::spaced(0.25, 4, 5, hardbody::Spacing::log), ElementsAre(0.25, 0.5, 1, 2, 4));
  EXPECT_THAT(hardbody::spaced(5, 1, 3, hardbody::Spacing::linear), ElementsAre(5, 3, 1));
}

// ---- Grids

TEST(SweepGrids, LastKeyVariesFastest) {
  EXPECT_THAT(assignments_of("[grid]\nshape.aspect_ratio = [3, 0.5]\nsystem.packing_fraction = [0.1, 0.2]\n"),
              ElementsAre("shape.aspect_ratio=3;system.packing_fraction=0.1;",
                          "shape.aspect_ratio=3;system.packing_fraction=0.2;",
                          "shape.aspect_ratio=0.5;system.packing_fraction=0.1;",
                          "shape.aspect_ratio=0.5;system.packing_fraction=0.2;"));
  // The order of the file, not of the alphabet.
  EXPECT_THAT(assignments_of("[grid]\nsystem.packing_fraction = [0.1, 0.2]\nshape.aspect_ratio = 3\n"),
              ElementsAre("system.packing_fraction=0.1;shape.aspect_ratio=3;",
                          "system.packing_fraction=0.2;shape.aspect_ratio=3;"));
}

TEST(SweepGrids, IntegersStayIntegers) {
  EXPECT_THAT(assignments_of("[grid]\nseed = {from = 2, to = 6, step = 2}\n"),
              ElementsAre("seed=2;", "seed=4;", "seed=6;"));
  EXPECT_THAT(assignments_of("[grid]\nsystem.number = {from = 100, to = 200, count = 3}\n"),
              ElementsAre("system.number=100;", "system.number=150;", "system.number=200;"));
  EXPECT_THAT(assignments_of("[grid]\nproduction.time = {from = 1.0, to = 2.0, step = 1.0}\n"),
              ElementsAre("production.time=1.0;", "production.time=2.0;"));
}

TEST(SweepGrids, ValuesOfAnyKind) {
  EXPECT_THAT(assignments_of("[grid]\nproduction.time = [\"auto\", 3]\n"),
              ElementsAre("production.time=\"auto\";", "production.time=3;"));
  EXPECT_THAT(assignments_of("[grid]\nshape.semi_axes = [[1, 1, 2], [1.5, 1, 1]]\n"),
              ElementsAre("shape.semi_axes=[1, 1, 2];", "shape.semi_axes=[1.5, 1, 1];"));
  EXPECT_THAT(assignments_of("[grid]\n\"species[2].mass\" = [1, 2]\n"),
              ElementsAre("species[2].mass=1;", "species[2].mass=2;"));
  EXPECT_THAT(assignments_of("[grid]\nsystem.start = \"a\\\"b\\\\c\\n\"\n"),
              ElementsAre("system.start=\"a\\\"b\\\\c\\u000A\";"));
}

TEST(SweepGrids, ZippedListsAreWalkedTogether) {
  const std::string grid = "[grid]\nseed = [1, 2]\nsystem.packing_fraction = [0.1, 0.2]\nsystem.number = [64, 65]\n";
  EXPECT_EQ(names_of(grid).size(), 8u);
  EXPECT_THAT(names_of(grid + "zip = [\"system.number\", \"seed\"]\n"),
              ElementsAre("packing_fraction=0.1_number=64_seed=1", "packing_fraction=0.1_number=65_seed=2",
                          "packing_fraction=0.2_number=64_seed=1", "packing_fraction=0.2_number=65_seed=2"));
  EXPECT_EQ(names_of(grid + "zip = [\"system.number\", \"seed\", \"system.packing_fraction\"]\n").size(), 2u);
  EXPECT_EQ(names_of("[grid]\nseed = [1, 2]\nsystem.number = [64, 65]\nsystem.packing_fraction = [0.1, 0.2, 0.3]\n"
                     "production.time = [1, 2, 3]\nzip = [[\"seed\", \"system.number\"], [\"production.time\", "
                     "\"system.packing_fraction\"]]\n")
                .size(),
            6u);
}

TEST(SweepGrids, NamesTellPointsApart) {
  // Keys of one last part keep their whole names; what is too long, or the same, becomes a number.
  EXPECT_THAT(names_of("[grid]\nequilibration.time = 1\nproduction.time = 2\n"),
              ElementsAre("equilibration.time=1_production.time=2"));
  EXPECT_THAT(names_of("[grid]\nsystem.start = [\"a/b\", \"a b\", \"c\"]\n"),
              ElementsAre("point_00001", "point_00002", "start=c"));
  EXPECT_THAT(names_of("[grid]\nsystem.start = \"" + std::string(200, 'x') + "\"\n"), ElementsAre("point_00001"));
  EXPECT_THAT(names_of("[grid]\nsystem.start = \"../../etc\"\n"), ElementsAre("start=..-..-etc"));
}

TEST(SweepGrids, PointsThatAreThereTwice) {
  EXPECT_THAT(refusal_of("[grid]\nsystem.packing_fraction = [0.1, 0.10]\n"),
              HasSubstr("packing_fraction = 0.1 occurs twice"));
  EXPECT_THAT(refusal_of("[grid]\nshape.aspect_ratio = [2, 2.0]\n"), HasSubstr("occurs twice"));
  EXPECT_THAT(refusal_of("[grid]\nshape.semi_axes = [[1, 1, 2], [1.0, 1, 2.0]]\n"), HasSubstr("occurs twice"));
  EXPECT_THAT(refusal_of("[[grid]]\nseed = [1, 2]\nsystem.number = 64\n[[grid]]\nsystem.number = [64, 70]\nseed = 2\n"),
              HasSubstr("also in sweep.toml:7"));
  EXPECT_EQ(
      names_of("[[grid]]\nseed = [1, 2]\nsystem.number = 64\n[[grid]]\nsystem.number = [65, 70]\nseed = 2\n").size(),
      4u);
}

TEST(SweepGrids, ChainsGoFromTheSmallestValue) {
  const std::vector<SweepPoint> points = hardbody::expand(
      sweep_of("[grid]\nsystem.packing_fraction = [0.3, 0.1, 0.2]\nshape.aspect_ratio = [2, 5]\n").grids);
  EXPECT_THAT(predecessors(points, "system.packing_fraction"), ElementsAre(4u, 5u, std::nullopt, std::nullopt, 2u, 3u));
}

TEST(SweepGrids, AreNotLargerThanAnybodyWants) {
  EXPECT_THAT(
      refusal_of("[grid]\nseed = {from = 0, to = 999, step = 1}\nsystem.number = {from = 64, to = 1063, step = 1}\n"),
      HasSubstr("more than 100000 points"));
}

// ---- Documents

TEST(SweepFiles, DocumentIsTheSameAgain) {
  const SweepFile sweep = sweep_of(
      "[[grid]]\nshape.aspect_ratio = {from = 0.1, to = 0.7, count = 3}\n\"species[1].mass\" = 1\n"
      "[[grid]]\nshape.aspect_ratio = 5\n\"species[1].mass\" = [0.1, 2e300]\n");
  const std::string text = document_text(sweep.whole);
  const hardbody::TomlDocument again = hardbody::read_toml(text, "again", {});
  EXPECT_EQ(document_text(again), text);
  EXPECT_NO_THROW(hardbody::check_continues(hardbody::parse_sweep(text, "again", "."), sweep, "out"));
  EXPECT_THAT(document_text(sweep.base), testing::Not(HasSubstr("grid")));
}

/// Returns the message with which a sweep is refused to continue another one; "accepted" if it is not.
std::string refusal_to_continue(const SweepFile& before, const SweepFile& now) {
  try {
    hardbody::check_continues(before, now, "out");
  } catch (const hardbody::InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SweepFiles, ChangedKeyIsNamed) {
  const std::string grid =
      "[grid]\nshape.aspect_ratio = [1, 2]\nsystem.packing_fraction = {from = 0.1, to = 0.2, step = 0.1}\n";
  const SweepFile before = sweep_of(grid);
  const SweepFile same =
      sweep_of("[grid]\nsystem.packing_fraction = {from = 0.1, step = 0.1, to = 0.2}\nshape.aspect_ratio = [1, 2.0]\n");
  EXPECT_EQ(refusal_to_continue(before, same), "accepted");
  EXPECT_THAT(refusal_to_continue(before, sweep_of(grid + "seed = 7\n")),
              HasSubstr("sweep.toml:10: grid.seed is 7, but not there in the sweep that out holds"));
}

TEST(SweepFiles, MorePointsContinue) {
  const SweepFile before = sweep_of("[grid]\nshape.aspect_ratio = [1, 2]\n");
  EXPECT_EQ(refusal_to_continue(before, sweep_of("[grid]\nshape.aspect_ratio = [0.5, 1, 1.5, 2]\n")), "accepted");
  EXPECT_THAT(refusal_to_continue(before, sweep_of("[grid]\nshape.aspect_ratio = [1, 3]\n")),
              HasSubstr("lacks the point aspect_ratio=2"));
}

TEST(SweepFiles, PointsHaveTheConfigOfTheirValues) {
  const SweepFile sweep = sweep_of("[grid]\nsystem.packing_fraction = [0.1, 0.25]\nequilibration.time = 7\n");
  const std::vector<SweepPoint> points = hardbody::expand(sweep.grids);
  const hardbody::Config config = hardbody::read_config(document_of(sweep, points[1]));
  EXPECT_EQ(config.packing_fraction, 0.25);
  EXPECT_EQ(config.equilibration_time, 7);
  EXPECT_EQ(config.number, 64);
  EXPECT_EQ(config.seed, 3);
}

// ---- Contours

/// Samples of f on a grid, without those where `hole` says so.
template <class F, class Hole>
std::vector<Sample> samples_of(const F& f, const Hole& hole) {
  std::vector<Sample> samples;
  for (double x = -1; x <= 1.001; x += 0.1) {
    for (double y = -1; y <= 1.001; y += 0.1) {
      if (!hole(x, y)) samples.push_back({x, y, f(x, y)});
    }
  }
  return samples;
}

constexpr auto kNoHole = [](double, double) { return false; };
constexpr auto kCircle = [](double x, double y) { return x * x + y * y; };

TEST(Contours, CircleIsClosed) {
  const std::vector<ContourLine> lines = contour_lines(lattice_of(samples_of(kCircle, kNoHole)), 0.5);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_GT(lines[0].size(), 20u);
  EXPECT_EQ(lines[0].front().x, lines[0].back().x);
  EXPECT_EQ(lines[0].front().y, lines[0].back().y);
  // Linear interpolation of x^2 + y^2 over 0.1 is off by at most 0.1^2 / 4 along each edge.
  for (const hardbody::PlanePoint& p : lines[0]) EXPECT_NEAR(kCircle(p.x, p.y), 0.5, 0.0025 + 1e-9);
}

TEST(Contours, LineOfAPlaneIsExact) {
  const auto plane = [](double x, double y) { return x + 2 * y; };
  const std::vector<ContourLine> lines = contour_lines(lattice_of(samples_of(plane, kNoHole)), 0.33);
  ASSERT_EQ(lines.size(), 1u);
  for (const hardbody::PlanePoint& p : lines[0]) EXPECT_NEAR(plane(p.x, p.y), 0.33, 1e-12);
  // From edge to edge of the grid, in one direction.
  EXPECT_NEAR(std::abs(lines[0].front().x - lines[0].back().x), 2, 1e-9);
  for (std::size_t k = 2; k < lines[0].size(); ++k) {
    EXPECT_GT((lines[0][k].x - lines[0][k - 1].x) * (lines[0][1].x - lines[0][0].x), -1e-12);
  }
}

TEST(Contours, SaddleIsTwoLines) {
  const auto saddle = [](double x, double y) { return x * y; };
  for (const double level : {0.01, -0.01}) {
    const std::vector<ContourLine> lines = contour_lines(lattice_of(samples_of(saddle, kNoHole)), level);
    ASSERT_EQ(lines.size(), 2u);
    for (const ContourLine& line : lines) {
      for (const hardbody::PlanePoint& p : line) EXPECT_GT(p.x * p.y * level, -1e-12);
    }
  }
}

TEST(Contours, RaggedEdgesEndTheLine) {
  // Nothing is known beyond x + y = 0.75.
  const auto lines =
      contour_lines(lattice_of(samples_of(kCircle, [](double x, double y) { return x + y > 0.75; })), 0.5);
  ASSERT_GE(lines.size(), 1u);
  EXPECT_TRUE(lines[0].front().x != lines[0].back().x || lines[0].front().y != lines[0].back().y);
  for (const hardbody::PlanePoint& p : lines[0]) EXPECT_LT(p.x + p.y, 0.86);
}

TEST(Contours, StepsOfARaggedEdgeDoNotCutTheLine) {
  // Columns end three rows higher, each: between their ends triangles fan out. The line runs along the edge.
  std::vector<Sample> samples;
  const auto top = [](int i) { return 3 * i + 1; };
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= top(i); ++j) samples.push_back({i * 1.0, j * 1.0, j - 3.0 * i});
  }
  for (const double level : {0.5, -0.5}) {
    const auto lines = contour_lines(lattice_of(samples), level);
    ASSERT_EQ(lines.size(), 1u) << level;
    EXPECT_NEAR(std::abs(lines[0].front().x - lines[0].back().x), 5, 0.2);
    for (const hardbody::PlanePoint& p : lines[0]) EXPECT_NEAR(p.y - 3 * p.x, level, 1e-12);
  }
  // So at the lower edge.
  for (Sample& s : samples) s.y = -s.y;
  EXPECT_EQ(contour_lines(lattice_of(samples), 0.5).size(), 1u);
}

TEST(Contours, HighStepsDo) {
  // A column that ends after its first two rows says nothing of what is far above.
  std::vector<Sample> samples = {{1, 0, 0}, {1, 1, 1}};
  for (const double x : {0.0, 2.0}) {
    for (int j = 0; j <= 20; ++j) samples.push_back({x, j * 1.0, j * 1.0});
  }
  EXPECT_EQ(contour_lines(lattice_of(samples), 0.5).size(), 1u);
  EXPECT_TRUE(contour_lines(lattice_of(samples), 15.5).empty());
}

TEST(Contours, HolesAreFilledAlongY) {
  const auto hole = [](double x, double y) { return std::abs(x - 0.5) < 0.01 && std::abs(y) < 0.55; };
  const auto plane = [](double x, double y) { return x + 2 * y; };
  const std::vector<ContourLine> lines = contour_lines(lattice_of(samples_of(plane, hole)), 0.33);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(std::abs(lines[0].front().x - lines[0].back().x), 2, 1e-9);
  for (const hardbody::PlanePoint& p : lines[0]) EXPECT_NEAR(plane(p.x, p.y), 0.33, 1e-12);
}

TEST(Contours, NothingWhereThereIsNothing) {
  EXPECT_TRUE(contour_lines(lattice_of({}), 1).empty());
  EXPECT_TRUE(contour_lines(lattice_of({{0, 0, 1}}), 1).empty());
  EXPECT_TRUE(contour_lines(lattice_of(samples_of(kCircle, kNoHole)), 5).empty());
}

TEST(Contours, SamplesOfOnePointAreAveraged) {
  const hardbody::Lattice lattice = lattice_of({{0, 0, 1}, {0, 0, 3}, {1, 0, 5}});
  EXPECT_EQ(lattice.at(0, 0), 2);
  EXPECT_EQ(lattice.at(1, 0), 5);
}

// ---- Tables

TEST(CsvTables, AreReadWithTheirQuotes) {
  const hardbody::CsvTable table = hardbody::parse_csv("a.b,c\n\"x, \"\"y\"\"\nz\",2\n,\r\n", "t.csv");
  EXPECT_THAT(table.header, ElementsAre("a.b", "c"));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][0], "x, \"y\"\nz");
  EXPECT_EQ(table.number(0, table.column("c")), 2);
  EXPECT_FALSE(table.number(1, 1).has_value());
  EXPECT_EQ(table.column("b"), 0u);
}

TEST(CsvTables, BadOnesAreRefusedWithTheirLine) {
  const auto refusal = [](const char* text) {
    try {
      const hardbody::CsvTable table = hardbody::parse_csv(text, "t.csv");
      (void)table.number(0, table.column("phi"));
    } catch (const hardbody::InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal(""), HasSubstr("t.csv: is empty"));
  EXPECT_THAT(refusal("phi,b\n1,2\n1,2,3\n"), HasSubstr("t.csv:3: has 3 fields; accepted: 2"));
  EXPECT_THAT(refusal("phi,b\n1,\"2\n"), HasSubstr("t.csv:2: a quote is not closed"));
  EXPECT_THAT(refusal("phy,b\n1,2\n"), HasSubstr("has no column phi, did you mean phy?"));
  EXPECT_THAT(refusal("phi,b\n1x,2\n"), HasSubstr("phi of row 1 is 1x; accepted: numbers"));
}

}  // namespace
