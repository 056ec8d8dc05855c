/// libFuzzer: derivatives, contact patches, scenes and given motions of bodies of all kinds, on raw doubles.
///
/// What must hold whatever the numbers: bad arguments are refused by std::invalid_argument and nothing else throws; an
/// answer has no number that is not finite, and is of the form that its header describes.

#include "fuzz/fuzz_input.h"

#include <ed/given/contact.h>
#include <ed/given/motion.h>
#include <ed/given/scene.h>

#include <geom/contact_patch.h>
#include <geom/derivatives.h>
#include <geom/geom.h>
#include <geom/scene.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

namespace {

using Eigen::Vector3d;
using fuzz::Input;
using geom::DistanceStatus;
using geom::Pose;
using geom::Shape;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

Shape body_shape(Input& input) {
  switch (input.byte() % 8) {
    case 0:
      return geom::Sphere(input.length());
    case 1: {
      const double half = input.length();
      return geom::Capsule(half, input.length());
    }
    case 2:
      return geom::Box({input.length(), input.length(), input.length()});
    case 3: {
      std::vector<Vector3d> points(4 + input.byte() % 6);
      for (Vector3d& point : points) point = input.vector();
      return geom::ConvexPolyhedron(points);
    }
    case 4: {
      const double half = input.length();
      return geom::Cylinder(half, input.length());
    }
    case 5: {
      const double height = input.length();
      return geom::Cone(height, input.length());
    }
    default:
      return input.shape();
  }
}

/// Position of a body beside another one, mostly.
Vector3d place(Input& input, const Vector3d& near, double reach) {
  const Vector3d p = input.vector();
  return input.byte() % 8 == 1 ? p : Vector3d(near + 0.3 * input.fraction() * reach * p);
}

bool is_answer(DistanceStatus status) {
  return status == DistanceStatus::separated || status == DistanceStatus::overlapping;
}

/// Patches of curved bodies take a hundred times as long as other questions.
bool have_slow_patches(const Shape& a, const Shape& b, const Input& input) {
  const auto is_polytope = [](const Shape& shape) {
    return std::holds_alternative<geom::Box>(shape) || std::holds_alternative<geom::ConvexPolyhedron>(shape);
  };
  return !(is_polytope(a) && is_polytope(b)) && !input.is_one_in(64);
}

/// Deep overlaps search all normals, and very flat bodies are slow: now and then.
bool are_slow(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Input& input) {
  return !fuzz::are_quick(a, X_WA, b, X_WB) && !input.is_one_in(256);
}

/// Points deep inside search all normals: now and then.
bool is_deep(const Shape& shape, const Pose& X_WS, const Vector3d& p, const Input& input) {
  return (p - X_WS.position()).norm() < 0.9 * geom::inscribed_radius(shape) && !input.is_one_in(32);
}

void ask_derivatives(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  geom::DistanceResult at;
  const geom::DistanceDerivatives d =
      geom::distance_derivatives(a, X_WA, b, X_WB, {.penetration = geom::Penetration::local}, &at);
  if (d.status == geom::DerivativeStatus::twice) {
    require(is_answer(at.status), "derivatives are those of an answer");
    require(d.gradient.allFinite() && d.hessian.allFinite() && d.normal.allFinite() && d.point_a.allFinite() &&
                d.point_b.allFinite(),
            "derivatives are finite");
  }
  if (d.status == geom::DerivativeStatus::once) require(d.gradient.allFinite(), "a gradient is finite");
}

void ask_patch(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Input& input) {
  const geom::DistanceResult at = geom::distance(a, X_WA, b, X_WB, {.penetration = geom::Penetration::local});
  geom::PatchOptions options;
  options.within = input.byte() % 4 == 0 ? input.coordinate() : std::abs(at.distance) * (1 + input.fraction());
  if (input.byte() % 4 == 0) options.tolerance = input.coordinate();
  options.max_points = input.byte() % 16;
  const geom::ContactPatch patch = geom::contact_patch(a, X_WA, b, X_WB, at, options);
  const std::size_t least = patch.kind == geom::PatchKind::polygon   ? 3
                            : patch.kind == geom::PatchKind::segment ? 2
                            : patch.kind == geom::PatchKind::point   ? 1
                                                                     : 0;
  require(patch.kind == geom::PatchKind::polygon ? patch.points.size() >= least : patch.points.size() == least,
          "a patch has as many points as its kind says");
  require(patch.points.size() <= static_cast<std::size_t>(std::max(options.max_points, 3)), "and no more than wanted");
  require(patch.error >= 0 && std::isfinite(patch.error) && std::isfinite(patch.area), "its size is finite");
  for (const geom::PatchPoint& p : patch.points) {
    require(p.point_a.allFinite() && p.point_b.allFinite() && std::isfinite(p.depth), "its points are finite");
  }
}

/// Returns whether a body may have thousands of images within a few times `reach` or, where vectors differ much in
/// length, between two bodies that are far from each other along a long one; up to 1e8.
bool has_many_images(const geom::Lattice& lattice, double reach) {
  double volume = 1, least = reach, largest = reach;
  for (std::size_t k = 0; k < 3; ++k) {
    Vector3d v = lattice.vectors[k];
    if (!v.any()) continue;
    least = std::min(least, v.norm());
    largest = std::max(largest, v.norm());
    for (std::size_t m = 0; m < k; ++m) {  // the part across the ones before
      const Vector3d& w = lattice.vectors[m];
      if (w.any()) v -= v.dot(w) / w.squaredNorm() * w;
    }
    volume *= std::min(1.0, v.norm() / reach);  // vectors that are long leave the images along the others
  }
  return !(volume > 0.1) || !(largest < 1e3 * least);
}

bool is_periodic(const geom::Scene& scene) {
  const auto& vectors = scene.options().lattice.vectors;
  return std::any_of(vectors.begin(), vectors.end(), [](const Vector3d& v) { return v.any(); });
}

geom::SceneOptions scene_options(Input& input, double reach) {
  geom::SceneOptions options;
  if (input.byte() % 4 == 0) options.margin = input.coordinate();
  const int kind = input.byte() % 4;
  if (!input.is_one_in(16)) return options;
  switch (kind) {
    case 0:
      options.lattice = geom::Lattice::cube(reach * (0.5 + input.length()));
      break;
    case 1:
      for (Vector3d& v : options.lattice.vectors) v = input.vector();
      break;
    default:
      break;
  }
  if (has_many_images(options.lattice, reach) && !input.is_one_in(65536)) options.lattice = {};
  // Boxes that are so much larger than the bodies overlap millions of images.
  options.margin = std::min(options.margin, 2 * reach);
  return options;
}

ed::GivenMotion motion(Input& input, const Pose& X) {
  if (input.byte() % 4 == 0) {
    std::vector<double> times{input.coordinate()};
    std::vector<Pose> poses{X};
    for (int k = 0; k < 3; ++k) {
      times.push_back(times.back() + input.length());
      poses.push_back(input.pose(place(input, X.position(), 1)));
    }
    return ed::GivenMotion::spline(times, poses);
  }
  ed::Screw screw;
  screw.pose = X;
  screw.axis = input.vector();
  screw.point = place(input, X.position(), 1);
  screw.angular_speed = input.coordinate();
  screw.speed = input.coordinate();
  screw.time = input.byte() % 8 == 0 ? input.coordinate() : 0;
  ed::GivenMotion found = ed::GivenMotion::screw(screw);
  return input.byte() % 8 == 0 ? found.on(ed::GivenMotion::resting(X)) : found;
}

void check_contact(const ed::ContactResult& r, double from, double to) {
  require(r.time >= from && r.time <= to, "a contact is within the interval");
  if (r.status == ed::ContactStatus::hit) {
    require(r.point.allFinite() && std::abs(r.normal.norm() - 1) < 1e-9, "a hit has a point and a normal");
  }
}

void ask_contact(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Input& input) {
  const auto moving = [](const Shape& shape) {
    return std::visit([](const auto& s) { return ed::BodyShape(s); }, shape);
  };
  const double from = input.byte() % 4 == 0 ? input.coordinate() : 0, to = from + input.length();
  const ed::GivenMotion motion_a = motion(input, X_WA), motion_b = motion(input, X_WB);
  if (are_slow(a, motion_a.pose(from), b, motion_b.pose(from), input)) return;
  check_contact(ed::time_of_contact(moving(a), motion_a, moving(b), motion_b, from, to, {.max_evaluations = 16}), from,
                to);
}

void ask_scene(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Input& input) {
  const double reach = geom::bounding_radius(a) + geom::bounding_radius(b);
  geom::Scene scene(scene_options(input, reach));
  std::vector<geom::BodyId> bodies{scene.add(a, X_WA), scene.add(b, X_WB)};
  if (input.byte() % 2 == 0) {
    const Pose X_W3 = input.pose(place(input, X_WB.position(), reach));
    const bool slow = are_slow(a, X_W3, a, X_WA, input) || are_slow(a, X_W3, b, X_WB, input);
    if (!slow) bodies.push_back(scene.add(a, X_W3));
  }
  switch (input.byte() % 6) {
    case 0: {
      if (is_periodic(scene) && !input.is_one_in(16)) break;  // thousands of pairs
      std::vector<geom::ScenePair> pairs;
      double cutoff = input.byte() % 4 == 0 ? input.coordinate() : reach * input.fraction();
      // Larger ones have millions of images within reach.
      if (is_periodic(scene)) cutoff = std::min(cutoff, 2 * reach);
      scene.pairs_within(cutoff, pairs, {.penetration = geom::Penetration::local});
      for (const geom::ScenePair& pair : pairs) {
        require(pair.i < pair.j && pair.image.allFinite(), "pairs are in order");
        if (is_answer(pair.result.status)) require(std::isfinite(pair.result.distance), "their distances are finite");
      }
      break;
    }
    case 1: {
      const Vector3d p = input.vector();
      // Images along a line are about equally far from a point beside it: millions, now and then.
      if (is_periodic(scene) && !input.is_one_in(256)) break;
      if (is_deep(a, X_WA, p, input) || is_deep(b, X_WB, p, input)) break;
      const geom::ScenePoint found = scene.closest_point(p);
      require(!found.body || scene.has(found.body->body), "a closest body is one of the scene");
      break;
    }
    case 2: {
      const Vector3d origin = input.vector();
      const geom::SceneRayHit found = scene.ray_cast(origin, input.vector(), 16 * reach);
      require(!found.body || scene.has(found.body->body), "a body that a ray meets is one of the scene");
      break;
    }
    case 3: {
      std::vector<geom::SceneImage> found;
      // Larger ones overlap millions of images.
      const double radius = std::min(input.length(), 4 * reach);
      scene.overlapping(geom::Sphere(radius), Pose::translation(input.vector()), found);
      break;
    }
    case 4: {
      scene.move(bodies, std::vector<Pose>(bodies.size(), X_WB));
      scene.remove(bodies[0]);
      require(scene.size() + 1 == bodies.size(), "a body that is removed is gone");
      break;
    }
    default: {
      const double to = input.length();
      if (is_periodic(scene) && !input.is_one_in(512)) break;  // millions of images
      const std::vector<ed::MovingBody> moving{{bodies[0], motion(input, X_WA)}};
      const Pose X_W0 = moving[0].motion.pose(0);
      if (are_slow(a, X_W0, b, X_WB, input)) break;
      if (bodies.size() > 2 && are_slow(a, X_W0, a, scene.pose(bodies[2]), input)) break;
      check_contact(ed::first_contact(scene, moving, 0, to, {.max_evaluations = 16}).contact, 0, to);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input(data, size);
  const int question = input.byte() % 4;
  try {
    const Shape a = body_shape(input), b = body_shape(input);
    const Pose X_WA = input.pose(input.vector());
    const Pose X_WB = input.pose(place(input, X_WA.position(), geom::bounding_radius(a) + geom::bounding_radius(b)));
    if (are_slow(a, X_WA, b, X_WB, input)) return 0;
    switch (question) {
      case 0:
        ask_derivatives(a, X_WA, b, X_WB);
        break;
      case 1:
        if (!have_slow_patches(a, b, input)) ask_patch(a, X_WA, b, X_WB, input);
        break;
      case 2:
        ask_contact(a, X_WA, b, X_WB, input);
        break;
      default:
        ask_scene(a, X_WA, b, X_WB, input);
    }
  } catch (const std::invalid_argument&) {
    return 0;
  }
  return 0;
}
