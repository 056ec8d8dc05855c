#include "report/view.h"

#include "base/console.h"
#include "base/shapes.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

namespace hardbody {
namespace {

using ShapeKey = std::tuple<double, double, double, double, double, std::size_t>;

ShapeKey key_of(const ViewShape& s) {
  return {s.semi_axes.x(), s.semi_axes.y(), s.semi_axes.z(),
          s.exponents.x(), s.exponents.y(), s.polytope ? 1 + *s.polytope : 0};
}

/// Returns whether two polytopes look alike: bodies of different sizes are the same form, to rounding.
bool alike(const SweptPolytope& a, const SweptPolytope& b) {
  constexpr double kAlike = 1e-6;
  if (a.vertices.size() != b.vertices.size() || a.faces != b.faces) return false;
  if (std::abs(a.rounding - b.rounding) > kAlike) return false;
  return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(),
                    [](const Eigen::Vector3d& x, const Eigen::Vector3d& y) { return (x - y).norm() <= kAlike; });
}

/// Returns the index of a form among `known`, to which it is added if it is new.
std::size_t index_of(SweptPolytope form, std::vector<SweptPolytope>& known) {
  const auto found = std::find_if(known.begin(), known.end(), [&](const SweptPolytope& k) { return alike(k, form); });
  const auto index = static_cast<std::size_t>(found - known.begin());
  if (found == known.end()) known.push_back(std::move(form));
  return index;
}

/// Returns the coordinate of the image in the box about the origin.
float centred(double x, double box) {
  return static_cast<float>(x - box * std::round(x / box));
}

/// Returns the bodies in a corner of the box that contains about as many as may be shown; all bodies if there are no
/// more.
std::vector<std::size_t> bodies_shown(const Frame& frame) {
  const std::size_t all = frame.bodies.size();
  const double share = static_cast<double>(kMostBodiesShown) / static_cast<double>(all);
  const double limit = share >= 1 ? std::numeric_limits<double>::infinity() : std::cbrt(share) - 0.5;
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < all && bodies.size() < kMostBodiesShown; ++i) {
    const Eigen::Array3d place = frame.bodies[i].position.array() / frame.box.array();
    if ((place - place.round()).maxCoeff() < limit) bodies.push_back(i);
  }
  return bodies;
}

/// Returns `most` of 0 .. all - 1, including the last one.
std::vector<std::size_t> frames_shown(std::size_t all, std::size_t most) {
  std::vector<std::size_t> list;
  for (std::size_t k = 0; k < std::min(all, most); ++k) {
    if (all <= most) {
      list.push_back(k);
    } else {
      list.push_back(most == 1 ? all - 1 : (2 * k * (all - 1) + (most - 1)) / (2 * (most - 1)));
    }
  }
  return list;
}

/// Returns the shape of a type; an unknown one is shown as a sphere.
ViewShape shape_of(const FrameType& type, std::vector<SweptPolytope>& forms) {
  if (!type.shape) return {{1, 1, 1}};
  const ShapeNumbers numbers = numbers_of(*type.shape);
  std::optional<SweptPolytope> form = swept_polytope(*type.shape);
  if (!form) return {numbers.lengths, numbers.exponents};
  const double radius = ed::bounding_radius(*type.shape);
  for (Eigen::Vector3d& x : form->vertices) x /= radius;
  form->rounding /= radius;
  return {Eigen::Vector3d::Constant(radius), {1, 1}, index_of(std::move(*form), forms)};
}

void set_bodies(View& view, const Frame& frame, const std::vector<std::size_t>& bodies) {
  std::map<ShapeKey, std::uint32_t> known;
  std::map<std::uint32_t, std::uint32_t> shape_of_type;
  for (const std::size_t body : bodies) {
    const std::uint32_t type = frame.bodies[body].type;
    if (!shape_of_type.contains(type)) {
      const ViewShape shape = shape_of(frame.types.at(type), view.polytopes);
      const auto [place, is_new] = known.emplace(key_of(shape), static_cast<std::uint32_t>(view.shapes.size()));
      if (is_new) view.shapes.push_back(shape);
      shape_of_type[type] = place->second;
    }
    view.shape_of.push_back(shape_of_type[type]);
    view.species_of.push_back(frame.bodies[body].group);
  }
}

ViewFrame view_frame(const Frame& frame, const std::vector<std::size_t>& bodies) {
  ViewFrame result;
  result.time = frame.time;
  for (const std::size_t i : bodies) {
    const FrameBody& body = frame.bodies.at(i);
    const Eigen::Quaterniond q(body.rotation);
    for (int k = 0; k < 3; ++k) result.positions.push_back(centred(body.position[k], frame.box[k]));
    for (const double x : {q.w(), q.x(), q.y(), q.z()}) result.orientations.push_back(static_cast<float>(x));
  }
  return result;
}

}  // namespace

View view_of(const FrameSource& source) {
  const Frame last = source.read(source.count - 1);
  const std::vector<std::size_t> bodies = bodies_shown(last);
  View view;
  view.box = last.box.x();
  view.number = last.bodies.size();
  set_bodies(view, last, bodies);
  const std::size_t most = std::max<std::size_t>(1, kMostBodyFrames / std::max<std::size_t>(1, bodies.size()));
  const std::vector<std::size_t> frames = frames_shown(source.count, most);
  for (const std::size_t k : frames) {
    console().poll();
    view.frames.push_back(view_frame(k + 1 == source.count ? last : source.read(k), bodies));
  }
  if (bodies.size() < view.number) {
    view.note += fmt::format("{} of {} bodies are shown, those in a corner of the box. ", bodies.size(), view.number);
  }
  if (frames.size() < source.count) {
    view.note += fmt::format("{} of {} stored frames are shown. ", frames.size(), source.count);
  }
  return view;
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
