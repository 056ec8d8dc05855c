#include "lammps_dump.h"

#include "text_file.h"

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <variant>
#include <vector>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// "shapex shapey shapez Phi Theta" of each type.
std::vector<std::string> shape_columns(const Frame& frame) {
  std::vector<std::string> columns;
  for (const FrameType& type : frame.types) {
    const Vector3d a = type.shape ? ed::half_extents(*type.shape) : Vector3d::Zero();
    const auto* barr = type.shape ? std::get_if<geom::Superellipsoid>(&*type.shape) : nullptr;
    columns.push_back(fmt::format("{} {} {} {} {}", 2 * a.x(), 2 * a.y(), 2 * a.z(), barr != nullptr ? barr->e2() : 1,
                                  barr != nullptr ? barr->e1() : 1));
  }
  return columns;
}

std::string frame_text(const Frame& frame) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS pp pp pp\n", frame.step,
                 frame.bodies.size());
  for (int k = 0; k < 3; ++k) fmt::format_to(out, "{} {}\n", -frame.box[k] / 2, frame.box[k] / 2);
  fmt::format_to(out,
                 "ITEM: ATOMS id type x y z quatw quati quatj quatk shapex shapey shapez SuperquadricRoundness.Phi "
                 "SuperquadricRoundness.Theta\n");
  const std::vector<std::string> shapes = shape_columns(frame);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const FrameBody& body = frame.bodies[i];
    const Eigen::Quaterniond q = Eigen::Quaterniond(body.rotation).normalized();
    fmt::format_to(out, "{} {} {} {} {} {} {} {} {} {}\n", i + 1, body.group + 1, body.position.x(), body.position.y(),
                   body.position.z(), q.w(), q.x(), q.y(), q.z(), shapes[body.type]);
  }
  return fmt::to_string(text);
}

}  // namespace

void LammpsWriter::open(FileMark mark) {
  mark_ = mark;
  if (mark.frames > 0) write_at(path_, mark.bytes, "");
}

void LammpsWriter::append(const Frame& frame) {
  const std::string text = frame_text(frame);
  write_at(path_, mark_.bytes, text, Flush::later);
  mark_.bytes += text.size();
  ++mark_.frames;
}

}  // namespace hardbody
