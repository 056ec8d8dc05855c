/// Trajectories as the program's own reader sees them: states that come back to every bit, files that end anywhere,
/// files that lie. What other programs read in them is tested by test_trajectory.py.

#include "base/errors.h"
#include "base/shapes.h"
#include "config/config.h"
#include "trajectory/frame.h"
#include "trajectory/gsd/container.h"
#include "trajectory/gsd/frames.h"

#include <ed/archive_system.h>
#include <ed/random.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <unistd.h>

namespace {

using hardbody::Frame;
using hardbody::GsdReader;
using hardbody::GsdWriter;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// An ellipsoid of revolution without spin, one of three axes, a sphere, superellipsoids of sizes.
constexpr const char* kMixture =
    "[system]\npacking_fraction = 0.1\n"
    "[[species]]\nsemi_axes = [0.5, 0.5, 1.5]\nnumber = 20\ninertia = \"paper\"\n"
    "[[species]]\nsemi_axes = [0.5, 0.7, 1]\nnumber = 20\nmass = 3\n"
    "[[species]]\nsemi_axes = [0.7, 0.7, 0.7]\nnumber = 20\n"
    "[[species]]\nkind = \"superellipsoid\"\nsemi_axes = [0.6, 0.7, 0.8]\nexponents = [0.5, 1.2]\nnumber = 24\n"
    "sizes = \"gaussian\"\nwidth = 0.1\n";

const std::vector<int> kGroups = {20, 20, 20, 24};

ed::System start() {
  ed::StartOptions options;
  options.packing_fraction = 0.1;
  return ed::random_start(hardbody::parse_config(kMixture, "memory").components(), options);
}

TEST(Shapes, AreTheSameByKindLengthsAndExponents) {
  const ed::BodyShape box = geom::Superellipsoid({1, 2, 3}, 0.5, 0.8);
  const auto other = [](double c, double e1, double e2) -> ed::BodyShape {
    return geom::Superellipsoid({1, 2, c}, e1, e2);
  };
  EXPECT_TRUE(hardbody::same_shape(box, box, 0, 0));
  EXPECT_TRUE(hardbody::same_shape(other(3 + 1e-6, 0.5, 0.8), box, 1e-6, 0));
  EXPECT_FALSE(hardbody::same_shape(other(3 + 1e-5, 0.5, 0.8), box, 1e-6, 0));
  EXPECT_FALSE(hardbody::same_shape(other(3, 0.5 + 1e-5, 0.8), box, 1e-6, 1e-6));
  EXPECT_FALSE(hardbody::same_shape(other(3, 0.5, 0.8 - 1e-5), box, 1e-6, 1e-6));
  EXPECT_TRUE(hardbody::same_shape(other(3, 0.5, 0.8 - 1e-7), box, 1e-6, 1e-6));
  const ed::BodyShape ellipsoid = geom::Ellipsoid({1, 2, 3});
  EXPECT_FALSE(hardbody::same_shape(ellipsoid, other(3, 1, 1), 1e-6, 1e-6));
  EXPECT_EQ(hardbody::numbers_of(ellipsoid).exponents, Eigen::Vector2d(1, 1));
}

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A file of frames of a run, and what was written.
class Trajectory : public testing::Test {
 protected:
  static constexpr int kFrames = 4;

  static void SetUpTestSuite() {
    path = fs::path(testing::TempDir()) / ("hardbody_trajectory_" + std::to_string(::getpid()) + ".gsd");
    GsdWriter writer(path, kFrames + 1);
    ed::Simulation simulation(start());
    marks.push_back(writer.mark());
    for (int k = 0; k < kFrames; ++k) {
      simulation.run_until(2.0 * k);
      frames.push_back(hardbody::frame_of(simulation, kGroups, static_cast<std::uint64_t>(k)));
      writer.append(frames.back());
      marks.push_back(writer.mark());
    }
    bytes = content(path);
  }
  static void TearDownTestSuite() { fs::remove(path); }

  static GsdReader reader(std::string of) { return {hardbody::stored_bytes_in_memory(std::move(of)), "t.gsd"}; }

  /// The file with an 8-byte number replaced.
  static std::string with(std::size_t place, std::uint64_t value) {
    std::string changed = bytes;
    std::memcpy(changed.data() + place, &value, sizeof value);
    return changed;
  }
  /// The one message of what is wrong with a file.
  static std::string refusal(const std::string& of) {
    try {
      const GsdReader gsd = reader(of);
      for (std::uint64_t k = 0; k < gsd.frame_count(); ++k) (void)gsd.read(k);
    } catch (const hardbody::InputError& error) {
      return error.what();
    }
    return "none";
  }
  /// Finds an array of frame 0.
  static hardbody::GsdChunk chunk(const char* name) {
    const hardbody::GsdFile file(hardbody::stored_bytes_in_memory(bytes), "t.gsd");
    return *file.find(0, name);
  }
  /// The file with the k-th number of an array of frame 0 replaced.
  template <class T>
  static std::string with_number(const char* name, std::size_t k, T value) {
    std::string changed = bytes;
    std::memcpy(changed.data() + chunk(name).location + k * sizeof value, &value, sizeof value);
    return changed;
  }

  static inline fs::path path;
  static inline std::vector<Frame> frames;
  static inline std::vector<hardbody::FileMark> marks;
  static inline std::string bytes;
};

TEST_F(Trajectory, StatesComeBackToEveryBit) {
  const GsdReader gsd(path);
  ASSERT_EQ(gsd.frame_count(), static_cast<std::uint64_t>(kFrames));
  EXPECT_TRUE(gsd.exact());
  EXPECT_THAT(gsd.application(), HasSubstr("hardbody"));
  for (std::uint64_t k = 0; k < kFrames; ++k) {
    const Frame read = gsd.read(k);
    const Frame& written = frames[k];
    EXPECT_EQ(ed::archive::bytes_of(*read.exact), ed::archive::bytes_of(*written.exact)) << "frame " << k;
    EXPECT_EQ(read.step, k);
    EXPECT_EQ(read.time, 2.0 * static_cast<double>(k));
    EXPECT_EQ(read.energy, written.energy);
    EXPECT_EQ(read.S, written.S);
    EXPECT_TRUE(k == 0 ? std::isnan(read.Z) : read.Z == written.Z);
    for (std::size_t i = 0; i < written.bodies.size(); ++i) {
      EXPECT_EQ(read.bodies[i].position, written.bodies[i].position);
      EXPECT_EQ(read.bodies[i].group, written.bodies[i].group);
      EXPECT_LT((read.bodies[i].unwrapped - written.bodies[i].unwrapped).norm(), 1e-13 * read.box.norm());
    }
  }
}

/// The 32-bit numbers by themselves, as another program's file has them: close to the state, and without it.
TEST_F(Trajectory, IsReadWithoutTheDoubles) {
  std::string other = bytes;
  for (std::size_t at = other.find("log/hardbody/time"); at != std::string::npos; at = std::string::npos) {
    other[at] = 'X';
  }
  const GsdReader gsd = reader(other);
  EXPECT_FALSE(gsd.exact());
  ASSERT_EQ(gsd.frame_count(), static_cast<std::uint64_t>(kFrames));
  const Frame read = gsd.read(kFrames - 1);
  const Frame& written = frames[kFrames - 1];
  EXPECT_FALSE(read.exact);
  EXPECT_TRUE(std::isnan(read.time));
  double farthest = 0;
  for (std::size_t i = 0; i < written.bodies.size(); ++i) {
    const hardbody::FrameBody& a = read.bodies[i];
    const hardbody::FrameBody& b = written.bodies[i];
    EXPECT_LT((a.unwrapped - b.unwrapped).norm(), 1e-5);
    const geom::Pose X_BS = read.types[a.type].X_BS.value_or(geom::Pose());
    EXPECT_LT((a.rotation * X_BS.rotation().transpose() - b.rotation).norm(), 1e-6);
    EXPECT_LT((a.velocity - b.velocity).norm(), 1e-6);
    EXPECT_LT((a.angular_velocity - b.angular_velocity).norm(), 1e-5);
    EXPECT_LT(std::abs(a.mass - b.mass), 1e-6);
    farthest = std::max(farthest, (b.unwrapped - b.position).norm());
  }
  EXPECT_GT(farthest, 1) << "no body has crossed a face: images are not tested";
  // Shapes: ellipsoids and spheres as they are, superellipsoids as the polyhedra with corners on them that files have.
  EXPECT_EQ(ed::describe(*read.types[0].shape), ed::describe(*written.types[0].shape));
  EXPECT_EQ(ed::describe(*read.types[2].shape), ed::describe(*written.types[2].shape));
  EXPECT_THAT(ed::describe(*read.types[3].shape), HasSubstr("polyhedron of "));
}

/// Cut off at any byte, the frames that are whole are still there, and no other.
TEST_F(Trajectory, EndsAnywhere) {
  const std::uint64_t head = chunk("configuration/dimensions").location;
  std::vector<std::uint64_t> sizes;
  for (std::uint64_t size = 0; size < bytes.size(); size += size < 400 ? 1 : 397) sizes.push_back(size);
  ed::Random random(1);
  for (int k = 0; k < 200; ++k) {
    sizes.push_back(static_cast<std::uint64_t>(random.uniform() * static_cast<double>(bytes.size())));
  }
  for (const std::uint64_t size : sizes) {
    const std::string cut = bytes.substr(0, size);
    if (size < head) {
      const std::string message = refusal(cut);
      EXPECT_THAT(message, testing::AnyOf(HasSubstr("is cut off after " + std::to_string(size) + " bytes"),
                                          HasSubstr("is not a GSD file")));
      continue;
    }
    std::uint64_t whole = 0;
    while (whole < kFrames && marks[whole + 1].bytes <= size) ++whole;
    const GsdReader gsd = reader(cut);
    ASSERT_EQ(gsd.frame_count(), whole) << "of " << size << " bytes";
    EXPECT_EQ(gsd.cut_off(), whole < kFrames);
    if (whole > 0) {
      EXPECT_EQ(ed::archive::bytes_of(*gsd.read(whole - 1).exact), ed::archive::bytes_of(*frames[whole - 1].exact));
    }
  }
}

/// Tears the file at any byte of a frame's entries, as while they are being written.
TEST_F(Trajectory, AFrameShowsOnlyWhenItIsWhole) {
  const std::size_t end = hardbody::GsdHead::entry_location(11 + 4 * 14);
  const std::size_t begin = hardbody::GsdHead::entry_location(11 + 3 * 14);
  for (std::size_t torn = begin; torn < end; ++torn) {
    std::string half = bytes;
    std::memset(half.data() + torn, 0, end - torn);
    std::uint64_t count = 0;
    try {
      count = reader(half).frame_count();
    } catch (const hardbody::InputError&) {  // half an entry: only a failing disk writes that
      EXPECT_NE(torn % 32, 0U) << "torn at " << torn;
      continue;
    }
    EXPECT_EQ(count, torn + 8 > end ? 4U : 3U) << "torn at " << torn;
  }
}

TEST_F(Trajectory, IsCutBackAndGoesOnWithTheSameBytes) {
  const fs::path copy = path.string() + ".copy";
  for (std::uint64_t k = 0; k < kFrames; ++k) {
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
    GsdWriter writer(copy, kFrames + 1);
    writer.open(marks[k]);
    if (k > 0) {
      EXPECT_EQ(GsdReader(copy).frame_count(), k);
    }
    for (std::uint64_t next = k; next < kFrames; ++next) writer.append(frames[next]);
    EXPECT_EQ(content(copy), bytes) << "from frame " << k;
  }
  fs::remove(copy);
}

TEST_F(Trajectory, LiesAreRefusedInOneLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal("GSD"), HasSubstr("is not a GSD file"));
  EXPECT_THAT(refusal(with(0, 0)), HasSubstr("is not a GSD file"));
  EXPECT_THAT(refusal(with(8, 1ULL << 63)), HasSubstr("before the end of its index"));
  EXPECT_THAT(refusal(with(16, 1ULL << 59)), HasSubstr("before the end of its index"));
  EXPECT_THAT(refusal(with(24, ~0ULL)), HasSubstr("before the end of its names"));
  EXPECT_THAT(refusal(with(32, 1ULL << 58)), HasSubstr("before the end of its names"));
  EXPECT_THAT(refusal(with(40, 0x0003000000010004)), HasSubstr("version 3.0"));
  // The first array's frame, type and flags, columns.
  EXPECT_THAT(refusal(with(256, 1ULL << 60)), HasSubstr("a frame beyond the end"));
  EXPECT_THAT(refusal(with(256 + 24, 0x0100000000000001)), HasSubstr("an array of unknown type"));
  EXPECT_THAT(refusal(with(256 + 24, 0x01010000'00000001)), HasSubstr("unknown flags"));
  EXPECT_THAT(refusal(with(256 + 24, 0x00010000'00000000)), HasSubstr("without columns"));
  EXPECT_THAT(refusal(with(256 + 24, 0x0001FFFF'00000001)), HasSubstr("whose name is not in the list"));
  // The second array's frame: 1, before the others' 0.
  EXPECT_THAT(refusal(with(256 + 32, 1)), HasSubstr("frames in descending order"));
  EXPECT_THAT(refusal(with_number<std::uint32_t>("particles/N", 0, 1U << 31)), HasSubstr("accepted: at most 10^7"));
  EXPECT_THAT(refusal(with_number<std::uint32_t>("particles/N", 0, 1U << 20)), HasSubstr("accepted: 1048576 x"));
  EXPECT_THAT(refusal(with_number<std::uint32_t>("particles/N", 0, 0)), HasSubstr("has no bodies"));
  EXPECT_THAT(refusal(with_number<float>("particles/position", 4, static_cast<float>(nan))),
              HasSubstr("particles/position of body 1 is nan"));
  EXPECT_THAT(refusal(with_number<float>("particles/orientation", 4, 3)), HasSubstr("is a quaternion of length"));
  EXPECT_THAT(refusal(with_number<std::uint32_t>("particles/typeid", 2, 99)), HasSubstr("body 2 is of type 99"));
  EXPECT_THAT(refusal(with_number<float>("configuration/box", 0, -1)), HasSubstr("an edge of -1"));
  EXPECT_THAT(refusal(with_number<float>("configuration/box", 3, 0.5)), HasSubstr("tilted"));
  EXPECT_THAT(refusal(with_number<double>("log/hardbody/box", 0, nan)), HasSubstr("log/hardbody/box"));
  EXPECT_THAT(refusal(with_number<double>("log/hardbody/species", 0, 99)), HasSubstr("kind of shape"));
  EXPECT_THAT(refusal(with_number<double>("log/hardbody/species", 1, -1)), HasSubstr("species 0: "));
  EXPECT_THAT(refusal(with_number<double>("log/particles/hardbody/rotation", 0, 3)), HasSubstr("body 0: "));
  EXPECT_THAT(refusal(with_number<double>("log/particles/hardbody/position", 0, 1e30)), HasSubstr("outside the box"));
  EXPECT_THAT(refusal(with_number<char>("particles/type_shapes", 0, '[')), HasSubstr("the shape of type 0"));
  for (const std::string& bad : {with(0, 0), with(16, 1ULL << 59), with_number<float>("configuration/box", 0, -1)}) {
    const std::string message = refusal(bad);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, HasSubstr("; accepted: ")) << message;
    EXPECT_EQ(message.rfind("t.gsd: ", 0), 0U) << message;
  }
}

}  // namespace
