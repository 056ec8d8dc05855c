/// The parts of the report that need no browser.

#include "base/errors.h"
#include "report/curves.h"
#include "report/page.h"
#include "report/svg.h"
#include "report/view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(ReportCurves, ReadsWhatARunWrites) {
  const Curves curves =
      parse_curves("t [l sqrt(m/kT)],msd [l^2],msd_error [l^2]\n0.5,1e-3,\n1,2.5,0.25\n", "msd", "msd.csv");
  EXPECT_EQ(curves.rows(), 2U);
  EXPECT_EQ(Curves::bare_name(curves.columns[1]), "msd");
  EXPECT_EQ(Curves::unit(curves.columns[0]), "l sqrt(m/kT)");
  ASSERT_NE(curves.find("msd"), nullptr);
  EXPECT_THAT(*curves.find("msd"), ElementsAre(1e-3, 2.5));
  EXPECT_TRUE(std::isnan((*curves.find("msd_error"))[0]));
  EXPECT_EQ(curves.find("vacf"), nullptr);
}

TEST(ReportCurves, NumbersThatAreNoneAreGaps) {
  const Curves curves = parse_curves("x\nnan\ninf\n1e999\n", "x", "x.csv");
  for (const double value : curves.values[0]) EXPECT_TRUE(std::isnan(value));
}

TEST(ReportCurves, NamesTheLineThatIsWrong) {
  const auto message = [](const char* text) -> std::string {
    try {
      (void)parse_curves(text, "x", "x.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("a,b\n1,2\n1\n"), HasSubstr("x.csv:3: has 1 fields; accepted: 2"));
  EXPECT_THAT(message("a\n1 \n"), HasSubstr("x.csv:2"));
  EXPECT_THAT(message(""), HasSubstr("x.csv: has no header line of columns"));
}

TEST(ReportCurves, NamesTheColumnThatIsMissing) {
  const fs::path directory = fs::path(testing::TempDir()) / "report_curves_test";
  fs::create_directories(directory / "observables");
  const auto message = [&](const char* text) -> std::string {
    std::ofstream(directory / "observables/g_r.csv") << text;
    try {
      (void)read_curves(directory);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("r [l],g [1],g_error [1],g2 [1],g2_error [1]\n1,1,,1,\n"), "");
  EXPECT_THAT(message("r [l],pairs [1],g_error [1],g2 [1],g2_error [1]\n1,1,,1,\n"),
              HasSubstr("g_r.csv:1: has no column g; accepted: "));
  fs::remove_all(directory);
}

/// RFC 4648, section 10.
TEST(ReportView, Base64) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\x00"), "//4=");
}

/// Bodies on a line, in two species.
Frame frame_with(std::size_t number, double time) {
  Frame frame;
  frame.time = time;
  frame.box = Eigen::Vector3d::Constant(10);
  frame.types = {{"A", geom::Ellipsoid({1, 1, 3})}, {"B", geom::Superellipsoid({1, 2, 3}, 0.5, 0.75)}};
  for (std::size_t k = 0; k < number; ++k) {
    FrameBody body;
    body.position = Eigen::Vector3d(10.0 * static_cast<double>(k) / static_cast<double>(number), 12, -4);
    body.type = body.group = static_cast<std::uint32_t>(k % 2);
    frame.bodies.push_back(body);
  }
  return frame;
}

/// Bodies of one form and several sizes share a mesh.
TEST(ReportView, HasTheFormsOfCapsulesAndBoxes) {
  const auto read = [](std::size_t /*k*/) {
    Frame frame = frame_with(5, 0);
    frame.types = {{"A", geom::Capsule(1, 0.5)},
                   {"B", geom::Capsule(3, 1.5)},
                   {"C", geom::Rounded<geom::Box>(geom::Box({1, 1, 1}), 0.5)},
                   {"D", geom::Box({2, 2, 2})},
                   {"E", geom::Sphere(2)}};
    for (std::size_t k = 0; k < 5; ++k) frame.bodies[k].type = static_cast<std::uint32_t>(k);
    return frame;
  };
  const View view = view_of({1, read});
  ASSERT_EQ(view.shapes.size(), 5U);
  ASSERT_EQ(view.polytopes.size(), 3U);
  EXPECT_EQ(view.shapes[0].polytope, 0U);
  EXPECT_EQ(view.shapes[1].polytope, 0U);
  EXPECT_EQ(view.shapes[1].semi_axes, Eigen::Vector3d::Constant(4.5));
  EXPECT_EQ(view.shapes[4].semi_axes, Eigen::Vector3d::Constant(2));
  EXPECT_FALSE(view.shapes[4].polytope);
  EXPECT_EQ(view.polytopes[0].vertices.size(), 2U);
  EXPECT_DOUBLE_EQ(view.polytopes[0].rounding, 1 / 3.0);
  EXPECT_EQ(view.polytopes[1].faces.size(), 6U);
  EXPECT_GT(view.polytopes[1].rounding, 0);
  EXPECT_EQ(view.polytopes[2].rounding, 0);
}

TEST(ReportView, HasEveryBodyOfEveryFrame) {
  const View view = view_of({3, [](std::size_t k) { return frame_with(10, static_cast<double>(k)); }});
  EXPECT_EQ(view.number, 10U);
  EXPECT_EQ(view.frames.size(), 3U);
  EXPECT_EQ(view.note, "");
  ASSERT_EQ(view.shapes.size(), 2U);
  EXPECT_EQ(view.shapes[1].exponents, Eigen::Vector2d(0.5, 0.75));
  EXPECT_THAT(view.shape_of, ElementsAre(0, 1, 0, 1, 0, 1, 0, 1, 0, 1));
  EXPECT_EQ(view.frames[2].time, 2);
  ASSERT_EQ(view.frames[0].positions.size(), 30U);
  // The image of body 7 in the box about the origin.
  EXPECT_FLOAT_EQ(view.frames[0].positions[21], -3);
  EXPECT_FLOAT_EQ(view.frames[0].positions[1], 2);
  EXPECT_FLOAT_EQ(view.frames[0].orientations[0], 1);
}

TEST(ReportView, LeavesOutFramesAndSaysSo) {
  const std::size_t number = 5000;
  const View view = view_of({100, [&](std::size_t k) { return frame_with(number, static_cast<double>(k)); }});
  EXPECT_EQ(view.frames.size(), kMostBodyFrames / number);
  EXPECT_EQ(view.frames.front().time, 0);
  EXPECT_EQ(view.frames.back().time, 99);
  for (std::size_t k = 1; k < view.frames.size(); ++k) {
    EXPECT_NEAR(view.frames[k].time - view.frames[k - 1].time, 99.0 / 39, 1);
  }
  EXPECT_THAT(view.note, HasSubstr("40 of 100 stored frames"));
}

TEST(ReportView, LeavesOutBodiesAndSaysSo) {
  Frame frame = frame_with(160'000, 0);
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const auto place = [&](std::size_t m) { return (static_cast<double>(m % 54) + 0.5) / 54 * 10 - 5; };
    frame.bodies[k].position = {place(k), place(k / 54), place(k / 54 / 54)};
  }
  const View view = view_of({1, [&](std::size_t /*k*/) { return frame; }});
  EXPECT_NEAR(static_cast<double>(view.shape_of.size()), kMostBodiesShown, 0.05 * kMostBodiesShown);
  EXPECT_LE(view.shape_of.size(), kMostBodiesShown);
  for (const float x : view.frames[0].positions) EXPECT_LT(x, 0.1F);
  EXPECT_THAT(view.note, HasSubstr("of 160000 bodies are shown"));
}

TEST(ReportPage, EscapesText) {
  EXPECT_EQ(html_text("<a href=\"x\" title='y'>&</a>"),
            "&lt;a href=&quot;x&quot; title=&#39;y&#39;&gt;&amp;&lt;/a&gt;");
}

TEST(ReportPlot, DrawsWhatCanBeDrawn) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const Plot plot{"a <plot>", "x", "y", true, true, {{"s", {0, 1, 10, 100, 1000}, {1, 1, kNone, 5, -1}}}};
  const std::string svg = svg_plot(plot);
  std::size_t points = 0;
  for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++points;
  EXPECT_EQ(points, 2U);
  EXPECT_THAT(svg, HasSubstr("a &lt;plot&gt;"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_EQ(svg_plot({"nothing", "x", "y", true, true, {{"s", {1, 2}, {kNone, 0}}}}), "");
}

TEST(ReportPlot, AConstantIsALine) {
  const std::string svg = svg_plot({"c", "x", "y", false, false, {{"s", {0, 1, 2}, {7, 7, 7}}}});
  EXPECT_THAT(svg, HasSubstr("<circle"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

}  // namespace
}  // namespace hardbody
