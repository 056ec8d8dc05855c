#include "report_view.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

ViewShape view_shape(const ed::BodyShape& shape) {
  ViewShape result{ed::half_extents(shape), {1, 1}};
  if (const auto* s = std::get_if<geom::Superellipsoid>(&shape)) result.exponents = {s->e1(), s->e2()};
  return result;
}

using ShapeKey = std::tuple<double, double, double, double, double>;

ShapeKey key_of(const ViewShape& s) {
  return {s.semi_axes.x(), s.semi_axes.y(), s.semi_axes.z(), s.exponents.x(), s.exponents.y()};
}

/// The image in the box about the origin.
float centred(double x, double box) {
  return static_cast<float>(x - box * std::round(x / box));
}

/// A rotation matrix's rounding, which a quaternion does not have, does not show.
ViewFrame frame_of(const ed::System& system, double time) {
  ViewFrame frame;
  frame.time = time;
  for (const ed::Body& body : system.bodies) {
    const Eigen::Quaterniond q(body.rotation);
    for (int k = 0; k < 3; ++k) frame.positions.push_back(centred(body.position[k], system.box));
    for (const double x : {q.w(), q.x(), q.y(), q.z()}) frame.orientations.push_back(static_cast<float>(x));
  }
  return frame;
}

template <class T>
std::vector<T> picked(const std::vector<T>& all, const std::vector<std::size_t>& bodies, std::size_t width) {
  std::vector<T> some;
  for (const std::size_t body : bodies) {
    for (std::size_t k = 0; k < width; ++k) some.push_back(all[body * width + k]);
  }
  return some;
}

/// Those that the last frame has in a corner of the box which holds about as many as may be shown.
std::vector<std::size_t> bodies_in_corner(const View& view) {
  const double share = static_cast<double>(kMostBodiesShown) / view.number;
  const auto limit = static_cast<float>(view.box * (std::cbrt(share) - 0.5));
  const std::vector<float>& r = view.frames.back().positions;
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < view.shape_of.size() && bodies.size() < kMostBodiesShown; ++i) {
    if (std::max({r[3 * i], r[3 * i + 1], r[3 * i + 2]}) < limit) bodies.push_back(i);
  }
  return bodies;
}

void thin_out_bodies(View& view) {
  if (view.shape_of.size() <= kMostBodiesShown) return;
  const std::vector<std::size_t> bodies = bodies_in_corner(view);
  view.shape_of = picked(view.shape_of, bodies, 1);
  view.species_of = picked(view.species_of, bodies, 1);
  for (ViewFrame& frame : view.frames) {
    frame.positions = picked(frame.positions, bodies, 3);
    frame.orientations = picked(frame.orientations, bodies, 4);
  }
  view.note += fmt::format("{} of {} bodies are shown, those in a corner of the box. ", bodies.size(), view.number);
}

void thin_out_frames(View& view) {
  const std::size_t most = std::max<std::size_t>(1, kMostBodyFrames / std::max<std::size_t>(1, view.shape_of.size()));
  const std::size_t all = view.frames.size();
  if (all <= most) return;
  std::vector<ViewFrame> some;
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t index = most == 1 ? all - 1 : (k * (all - 1) + (most - 1) / 2) / (most - 1);
    some.push_back(std::move(view.frames[index]));
  }
  view.frames = std::move(some);
  view.note += fmt::format("{} of {} stored frames are shown. ", most, all);
}

}  // namespace

View view_of(const ed::System& system, const std::vector<int>& numbers, double time) {
  View view;
  view.box = system.box;
  view.number = system.size();
  std::map<ShapeKey, std::uint32_t> known;
  std::size_t species = 0;
  int left = numbers.empty() ? view.number : numbers[0];
  for (int i = 0; i < view.number; ++i, --left) {
    while (left == 0 && species + 1 < numbers.size()) left = numbers[++species];
    const ViewShape shape = view_shape(system.species_of(i).shape);
    const auto [place, is_new] = known.emplace(key_of(shape), static_cast<std::uint32_t>(view.shapes.size()));
    if (is_new) view.shapes.push_back(shape);
    view.shape_of.push_back(place->second);
    view.species_of.push_back(static_cast<std::uint32_t>(species));
  }
  view.frames.push_back(frame_of(system, time));
  return view;
}

void thin_out(View& view) {
  if (view.frames.empty()) return;
  thin_out_bodies(view);
  thin_out_frames(view);
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t taken = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (j < taken ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[k + j])) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) text += j <= taken ? kDigits[group >> (18 - 6 * j) & 63U] : '=';
  }
  return text;
}

}  // namespace hardbody
