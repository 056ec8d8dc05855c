#include "config/shape_forms.h"

#include "config/rules.h"

#include <geom/polyhedron.h>

#include <Eigen/Geometry>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Largest bounding radius over the inscribed one; that of semi-axes is the same (key_table.cpp).
constexpr double kThinnestForm = 100;
/// Distance of two points, relative to the size, that counts as rounding.
constexpr double kSamePoint = 1e-9;

// ---- Ellipsoids and superellipsoids

/// Returns the index of the axis of revolution in [a, b, c] (of a shape with equivalent axes); 2 for a sphere; -1:
/// there is none.
int axis_of_revolution(const Vector3d& axes) {
  if (axes.x() == axes.y()) return 2;
  if (axes.y() == axes.z()) return 0;
  return axes.x() == axes.z() ? 1 : -1;
}

/// Returns that index for the body that the user means.
int axis_of_revolution(const ShapeConfig& shape) {
  if (!shape.semi_axes) return 2;
  if (!has_equivalent_axes(shape.kind)) return shape.semi_axes->x() == shape.semi_axes->y() ? 2 : -1;
  return axis_of_revolution(*shape.semi_axes);
}

/// Returns the shape in the program's units, an ellipsoid's axis of revolution last.
geom::Shape make_smooth(const ShapeConfig& shape, bool literal) {
  const std::optional<double> ratio = shape.true_aspect_ratio();
  if (!shape.semi_axes || (ratio && !literal)) {
    const double b = 1 / std::cbrt(*ratio);
    return make_shape({shape.kind, {b, b, *ratio * b}, shape.exponents});
  }
  const Vector3d axes = axis_last(*shape.semi_axes, axis_moved_last(shape));
  return make_shape({shape.kind, literal ? axes : Vector3d(axes / std::cbrt(axes.prod())), shape.exponents});
}

std::string smooth_keys(const ShapeNumbers& numbers) {
  std::string text = fmt::format("semi_axes = {}\n", value_text(numbers.lengths));
  if (has_exponents(numbers.kind)) text += fmt::format("exponents = {}\n", value_text(numbers.exponents));
  return text;
}

// ---- Other kinds

/// Returns the shape with the volume of the unit sphere; `literal`: as it is.
geom::Shape in_unit(geom::Shape shape, bool literal) {
  if (literal) return shape;
  const double factor = std::cbrt(4 * std::numbers::pi / 3 / geom::volume(shape));
  return std::visit([factor](const auto& s) -> geom::Shape { return s.scaled(factor); }, shape);
}

/// Returns the factor by which lengths are multiplied before anything is computed from them, so that no power of
/// lengths in any unit leaves the range of doubles.
double first_factor(double longest, bool literal) {
  return literal ? 1 : 1 / longest;
}

std::string rounding_keys(double rounding) {
  return rounding > 0 ? fmt::format("rounding = {}\n", value_text(rounding)) : "";
}

std::string rounding_text(double rounding) {
  return rounding > 0 ? fmt::format(", rounding {:.5g}", rounding) : "";
}

/// Returns why a rounding is refused beside the longest length.
std::optional<ShapeRefusal> check_rounding(const ShapeConfig& shape, double longest) {
  if (shape.rounding <= kThinnestForm * longest) return std::nullopt;
  return ShapeRefusal{"rounding", fmt::format("at most {:g}, {:g} times the size of the body without it",
                                              kThinnestForm * longest, kThinnestForm)};
}

geom::Shape make_sphere_form(const ShapeConfig& shape, bool literal) {
  return geom::Sphere(literal ? 0.5 * *shape.diameter : 1);
}

std::string sphere_keys(const ShapeNumbers& numbers) {
  return fmt::format("diameter = {}\n", value_text(2 * numbers.lengths.x()));
}

std::string sphere_title(const ShapeConfig& /*shape*/) {
  return "spheres";
}

std::string sphere_lengths(const ed::BodyShape& shape) {
  return fmt::format("radius {:.5g}", ed::bounding_radius(shape));
}

std::optional<ShapeRefusal> check_capsule(const ShapeConfig& shape) {
  if (*shape.length + *shape.diameter <= kThinnestForm * *shape.diameter) return std::nullopt;
  return ShapeRefusal{"length", fmt::format("0 to {:g}, {:g} times the diameter", (kThinnestForm - 1) * *shape.diameter,
                                            kThinnestForm - 1)};
}

geom::Shape make_capsule_form(const ShapeConfig& shape, bool literal) {
  const double factor = 0.5 * first_factor(std::max(*shape.length, *shape.diameter), literal);
  return in_unit(geom::Capsule(factor * *shape.length, factor * *shape.diameter), literal);
}

std::string capsule_keys(const ShapeNumbers& numbers) {
  return fmt::format("length = {}\ndiameter = {}\n", value_text(2 * numbers.lengths.z()),
                     value_text(2 * numbers.lengths.x()));
}

std::string capsule_title(const ShapeConfig& shape) {
  return fmt::format("capsules, length / diameter = {:.4g}", *shape.length / *shape.diameter);
}

std::string capsule_lengths(const ed::BodyShape& shape) {
  const Vector3d lengths = numbers_of(shape).lengths;
  return fmt::format("length {:.5g}, diameter {:.5g}", 2 * lengths.z(), 2 * lengths.x());
}

/// Returns the cylinder, or the cone in the frame of its centre of mass, in lengths times a factor.
geom::Shape round_shape(const ShapeConfig& shape, double factor) {
  const double length = factor * *shape.length;
  const double radius = 0.5 * factor * *shape.diameter;
  const double rounding = factor * shape.rounding;
  if (shape.kind == ShapeKind::cylinder) {
    return make_shape({shape.kind, {radius, radius, 0.5 * length}, {1, 1}, rounding});
  }
  const double base = geom::Cone::in_principal_frame(length, radius, rounding).base();
  return make_shape({shape.kind, {radius, -base, length}, {1, 1}, rounding});
}

std::optional<ShapeRefusal> check_round(const ShapeConfig& shape) {
  const double longest = std::max(*shape.length, *shape.diameter);
  // A cone is half as thick about its centre of mass.
  const double thinnest = shape.kind == ShapeKind::cone ? 0.5 * kThinnestForm : kThinnestForm;
  const double least = *shape.diameter / thinnest;
  const double most = *shape.diameter * thinnest;
  if (!(*shape.length >= least && *shape.length <= most)) {
    return ShapeRefusal{"length", fmt::format("{0:g} to {1:g}, 1/{2:g} to {2:g} diameters", least, most, thinnest)};
  }
  if (auto refused = check_rounding(shape, longest)) return refused;
  try {
    (void)round_shape(shape, first_factor(longest, false));
    return std::nullopt;
  } catch (const std::invalid_argument& error) {
    return ShapeRefusal{"rounding", "a radius with which the centre of mass is well inside the cone",
                        fmt::format(" ({})", error.what())};
  }
}

/// Returns the length of a cylinder or cone.
double length_of(const ShapeNumbers& numbers) {
  return (numbers.kind == ShapeKind::cylinder ? 2 : 1) * numbers.lengths.z();
}

geom::Shape make_round_form(const ShapeConfig& shape, bool literal) {
  const double factor = first_factor(std::max(*shape.length, *shape.diameter), literal);
  const ShapeNumbers numbers = numbers_of(body_shape(in_unit(round_shape(shape, factor), literal)));
  // From the lengths in use, as a config that has these makes it.
  ShapeConfig used;
  used.kind = shape.kind;
  used.length = length_of(numbers);
  used.diameter = 2 * numbers.lengths.x();
  used.rounding = numbers.rounding;
  return round_shape(used, 1);
}

std::string round_keys(const ShapeNumbers& numbers) {
  return fmt::format("length = {}\ndiameter = {}\n{}", value_text(length_of(numbers)),
                     value_text(2 * numbers.lengths.x()), rounding_keys(numbers.rounding));
}

std::string round_title(const ShapeConfig& shape) {
  std::string name = fmt::format("{}, length / diameter = {:.4g}", plural(shape.kind), *shape.length / *shape.diameter);
  if (shape.rounding == 0) return name;
  return fmt::format("{}, rounded by {:.4g} of the diameter", name, shape.rounding / *shape.diameter);
}

std::string round_lengths(const ed::BodyShape& shape) {
  const ShapeNumbers n = numbers_of(shape);
  return fmt::format("length {:.5g}, diameter {:.5g}", length_of(n), 2 * n.lengths.x()) + rounding_text(n.rounding);
}

ShapeForm round_form(ShapeKind kind) {
  return {kind,         {{"length"}, {"diameter"}}, {"rounding"}, check_round, make_round_form, round_keys, round_title,
          round_lengths};
}

std::optional<ShapeRefusal> check_box_form(const ShapeConfig& shape) {
  return check_rounding(shape, shape.edges->maxCoeff());
}

geom::Shape make_box_form(const ShapeConfig& shape, bool literal) {
  const double factor = first_factor(shape.edges->maxCoeff(), literal);
  const Vector3d half = 0.5 * factor * *shape.edges;
  return in_unit(make_shape({ShapeKind::box, half, {1, 1}, factor * shape.rounding}), literal);
}

std::string box_keys(const ShapeNumbers& numbers) {
  return fmt::format("edges = {}\n", value_text(Vector3d(2 * numbers.lengths))) + rounding_keys(numbers.rounding);
}

std::string box_title(const ShapeConfig& shape) {
  const Vector3d ratios = *shape.edges / shape.edges->minCoeff();
  std::string name = ratios == Vector3d::Ones()
                         ? std::string("cubes")
                         : fmt::format("boxes {:.4g} : {:.4g} : {:.4g}", ratios.x(), ratios.y(), ratios.z());
  if (shape.rounding == 0) return name;
  return fmt::format("{}, rounded by {:.4g} of the shortest edge", name, shape.rounding / shape.edges->minCoeff());
}

std::string box_lengths(const ed::BodyShape& shape) {
  const ShapeNumbers n = numbers_of(shape);
  return fmt::format("edges {:.5g}, {:.5g}, {:.5g}", 2 * n.lengths.x(), 2 * n.lengths.y(), 2 * n.lengths.z()) +
         rounding_text(n.rounding);
}

// ---- Polyhedra

std::vector<Vector3d> points_of(const ShapeConfig& shape) {
  return shape.solid ? geom::solid_vertices(*shape.solid) : *shape.vertices;
}

double longest_of(const std::vector<Vector3d>& points) {
  double longest = 0;
  for (const Vector3d& x : points) longest = std::max(longest, x.cwiseAbs().maxCoeff());
  return longest;
}

/// Returns the polyhedron in a frame that a body may have.
geom::Shape polyhedron_of(const std::vector<Vector3d>& points, double rounding) {
  return framed_polyhedron(points, rounding, kSamePoint).shape;
}

/// Returns the first point that is no corner of the hull of all; nullopt if there is none.
std::optional<std::size_t> no_corner(const std::vector<Vector3d>& points) {
  geom::Pose X_BP;
  const geom::ConvexPolyhedron hull = geom::ConvexPolyhedron::in_principal_frame(points, &X_BP);
  if (hull.vertex_count() == static_cast<int>(points.size())) return std::nullopt;
  const double apart = kSamePoint * hull.bounding_radius();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto here = points.begin() + static_cast<std::ptrdiff_t>(k);
    bool corner = false;
    for (int v = 0; v < hull.vertex_count() && !corner; ++v) {
      corner = (X_BP.rotation() * hull.vertex(v) + X_BP.position() - points[k]).norm() <= apart;
    }
    if (!corner || std::find(points.begin(), here, points[k]) != here) return k;
  }
  return points.size() - 1;
}

std::optional<ShapeRefusal> check_polyhedron(const ShapeConfig& shape) {
  std::vector<Vector3d> points = points_of(shape);
  const double longest = longest_of(points);
  const char* key = shape.solid ? "solid" : "vertices";
  const auto refusal = [&](const std::string& why) {
    return ShapeRefusal{key, "the corners of a convex polyhedron, each once", why};
  };
  if (!(longest > 0)) return refusal(", all of them in one point");
  for (Vector3d& x : points) x /= longest;
  try {
    if (const std::optional<std::size_t> k = no_corner(points)) {
      const Vector3d x = points[*k] * longest;
      return refusal(fmt::format(
          ", whose point {}, ({:g}, {:g}, {:g}), is no corner of their hull: inside it, on a face, on an edge or given "
          "twice",
          *k + 1, x.x(), x.y(), x.z()));
    }
    const ed::BodyShape body = body_shape(polyhedron_of(points, shape.rounding / longest));
    if (auto refused = check_rounding(shape, longest)) return refused;
    const double ratio = ed::bounding_radius(body) / ed::inscribed_radius(body);
    if (ratio <= kThinnestForm) return std::nullopt;
    return ShapeRefusal{key, fmt::format("at most {:g}", kThinnestForm),
                        fmt::format(", and the furthest corner is {:.4g} times as far from the centre of mass as the "
                                    "nearest face",
                                    ratio)};
  } catch (const std::invalid_argument& error) {
    const std::string why = error.what();
    const bool flat = why.find("in a plane") != std::string::npos;
    return refusal(flat ? ", which all lie in a plane" : fmt::format(" ({})", why));
  }
}

geom::Shape make_polyhedron_form(const ShapeConfig& shape, bool literal) {
  std::vector<Vector3d> points = points_of(shape);
  const double factor = first_factor(longest_of(points), literal);
  for (Vector3d& x : points) x *= factor;
  return in_unit(polyhedron_of(points, factor * shape.rounding), literal);
}

std::string polyhedron_keys(const ShapeNumbers& numbers) {
  return fmt::format("vertices = {}\n", value_text(numbers.vertices)) + rounding_keys(numbers.rounding);
}

std::string polyhedron_title(const ShapeConfig& shape) {
  std::string name = shape.solid ? fmt::format("polyhedra ({})", *shape.solid)
                                 : fmt::format("polyhedra of {} vertices", shape.vertices->size());
  if (shape.rounding == 0) return name;
  return shape.solid ? fmt::format("{}, rounded by {:.4g} of the circumradius", name, shape.rounding)
                     : name + ", rounded";
}

std::string polyhedron_lengths(const ed::BodyShape& shape) {
  return fmt::format("radii {:.5g} to {:.5g}", ed::inscribed_radius(shape), ed::bounding_radius(shape)) +
         rounding_text(numbers_of(shape).rounding);
}

// ---- Table

const std::vector<ShapeForm>& forms() {
  using Kind = ShapeKind;
  static const std::vector<ShapeForm> table = {
      {Kind::ellipsoid, {{"aspect_ratio", "semi_axes"}}, {}, nullptr, make_smooth, smooth_keys, nullptr, nullptr},
      {Kind::superellipsoid,
       {{"aspect_ratio", "semi_axes"}, {"exponents"}},
       {},
       nullptr,
       make_smooth,
       smooth_keys,
       nullptr,
       nullptr},
      {Kind::sphere, {{"diameter"}}, {}, nullptr, make_sphere_form, sphere_keys, sphere_title, sphere_lengths},
      {Kind::capsule,
       {{"length"}, {"diameter"}},
       {},
       check_capsule,
       make_capsule_form,
       capsule_keys,
       capsule_title,
       capsule_lengths},
      {Kind::box, {{"edges"}}, {"rounding"}, check_box_form, make_box_form, box_keys, box_title, box_lengths},
      {Kind::polyhedron,
       {{"vertices", "solid"}},
       {"rounding"},
       check_polyhedron,
       make_polyhedron_form,
       polyhedron_keys,
       polyhedron_title,
       polyhedron_lengths},
      round_form(Kind::cylinder),
      round_form(Kind::cone),
  };
  return table;
}

}  // namespace

bool ShapeForm::has(std::string_view key) const {
  const auto in = [key](const auto& keys) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  return in(others) || std::any_of(needed.begin(), needed.end(), in);
}

const ShapeForm& form_of(ShapeKind kind) {
  return *std::find_if(forms().begin(), forms().end(), [kind](const ShapeForm& form) { return form.kind == kind; });
}

std::string kinds_with(std::string_view key) {
  std::string kinds;
  for (const ShapeForm& form : forms()) {
    if (form.has(key)) kinds += fmt::format("{}\"{}\"", kinds.empty() ? "" : " or ", to_string(form.kind));
  }
  return kinds;
}

std::string with_article(ShapeKind kind) {
  const std::string name = to_string(kind);
  return (name.find_first_of("aeiou") == 0 ? "an " : "a ") + name;
}

int axis_moved_last(const ShapeConfig& shape) {
  return has_equivalent_axes(shape.kind) ? axis_of_revolution(shape) : -1;
}

Vector3d axis_last(const Vector3d& v, int axis) {
  return axis < 0 ? v : Vector3d(v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]);
}

std::optional<double> ShapeConfig::true_aspect_ratio() const {
  if (!has_semi_axes(kind)) return kind == ShapeKind::sphere ? std::optional<double>(1) : std::nullopt;
  if (aspect_ratio) return *aspect_ratio;
  // From the axes as given: the rescaled ones would turn 3 into 2.9999999999999996.
  const int axis = axis_of_revolution(*this);
  if (axis < 0) return std::nullopt;
  return (*semi_axes)[axis] / (*semi_axes)[(axis + 1) % 3];
}

}  // namespace hardbody
