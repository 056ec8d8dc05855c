#include "start/from_file.h"

#include "base/errors.h"
#include "base/shapes.h"
#include "config/keys.h"
#include "io/text_file.h"
#include "start/velocities.h"
#include "trajectory/reader.h"

#include <ed/start.h>

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Relative difference of packing fractions, a length to the third power, that counts as rounding.
constexpr double kSamePacking = 1e-4;
/// Largest factor by which overlapping bodies are moved apart.
constexpr double kMostMending = 1.1;

/// Returns whether a polyhedron at X_BS is what files have of a superellipsoid: corners on its surface.
bool has_corners_on(const ed::BodyShape& surface, const ed::BodyShape& polyhedron, const geom::Pose& X_BS) {
  constexpr double kOnSurface = 1e-4;  // coordinates are rounded to 7 digits, and powers of them up to 8 are taken
  const auto* barr = std::get_if<geom::Superellipsoid>(&surface);
  const auto* corners = std::get_if<geom::ConvexPolyhedron>(&polyhedron);
  if (barr == nullptr || corners == nullptr) return false;
  for (int k = 0; k < corners->vertex_count(); ++k) {
    const Vector3d x = X_BS.rotation() * corners->vertex(k) + X_BS.position();
    if (!(std::abs(barr->value(x)) <= kOnSurface)) return false;
  }
  return X_BS.position().norm() <= kSameLength * barr->bounding_radius();
}

/// Returns the orientation of the config's body axes (the axis of revolution last) in the file's body axes; nullopt if
/// the two shapes are different.
std::optional<Matrix3d> axes_in_file(const FrameType& type, const ed::BodyShape& config) {
  const ed::BodyShape& file = *type.shape;
  const ShapeNumbers in_config = numbers_of(config);
  const ShapeNumbers in_file = numbers_of(file);
  if (!has_semi_axes(in_config.kind)) {
    return same_shape(file, config, kSameLength, kSameLength) ? std::optional<Matrix3d>(Matrix3d::Identity())
                                                              : std::nullopt;
  }
  const geom::Pose X_BS = type.X_BS.value_or(geom::Pose());
  if (has_corners_on(config, file, X_BS)) return X_BS.rotation().transpose();
  if (!has_semi_axes(in_file.kind) && in_file.kind != ShapeKind::sphere) return std::nullopt;
  const Eigen::Vector2d apart = in_file.exponents - in_config.exponents;
  if (!(apart.cwiseAbs().maxCoeff() <= kSameLength)) return std::nullopt;
  const Vector3d& wanted = in_config.lengths;
  const Vector3d& given = in_file.lengths;
  for (int shift = 0; shift < (has_equivalent_axes(in_config.kind) ? 3 : 1); ++shift) {
    Matrix3d axes;
    for (int k = 0; k < 3; ++k) axes.col(k) = Vector3d::Unit((k + shift) % 3);
    const Vector3d turned = axes.transpose() * given;
    if (((turned - wanted).cwiseQuotient(wanted)).cwiseAbs().maxCoeff() <= kSameLength) return axes;
  }
  return std::nullopt;
}

/// Returns the refusal of a frame without orientations, with the reader's notices of columns that may contain some.
InputError no_orientations(const Frame& frame, const std::string& file, const std::string& body) {
  std::string hint;
  for (const std::string& notice : frame.notices) {
    if (notice.find("orient") != std::string::npos) hint += fmt::format(" ({})", notice);
  }
  return InputError(
      fmt::format("{}: has no orientations, and {}{}; accepted: columns quatw quati quatj quatk, in GSD files "
                  "particles/orientation of the frame, or spheres",
                  file, body, hint));
}

/// Returns the bodies of the config at the positions of those of the file, without velocities.
ed::System placed(const Config& config, const Frame& frame, const std::vector<std::size_t>& order) {
  const std::string& file = config.start_file->file;
  ed::System system;
  system.box = box_of(frame, file);
  for (const ed::Component& component : config.components()) {
    for (int k = 0; k < component.number; ++k) {
      const std::size_t i = order[system.bodies.size()];
      const FrameBody& from = frame.bodies[i];
      ed::Body& body = system.bodies.emplace_back();
      body.species = static_cast<int>(system.species.size());
      body.position = from.position;
      body.rotation = from.rotation;
      if (!frame.orientations && !ed::is_sphere(component.species.shape)) {
        throw no_orientations(frame, file,
                              fmt::format("body {:.17g} is {}", from.id, ed::describe(component.species.shape)));
      }
      const std::optional<ed::BodyShape>& shape = frame.types[from.type].shape;
      if (!shape) continue;
      const std::optional<Matrix3d> axes = axes_in_file(frame.types[from.type], component.species.shape);
      if (!axes) {
        throw InputError(
            fmt::format("{}: body {:.17g} is {}, in the config {}; accepted: the same, or no shape in the config", file,
                        from.id, ed::describe(*shape), ed::describe(component.species.shape)));
      }
      if (!axes->isIdentity(0)) body.rotation = from.rotation * *axes;
    }
    system.species.push_back(component.species);
  }
  return system;
}

bool overlaps(const ed::Audit& audit) {
  return audit.overlaps > 0 || audit.unanswered > 0;
}

ed::System scaled(const ed::System& system, double factor) {
  ed::System result = system;
  result.box *= factor;
  for (ed::Body& body : result.bodies) body.position *= factor;
  return result;
}

/// Returns the smallest factor of box and positions without overlap, to a thousandth of its excess over 1; nullopt if
/// it would be more than kMostMending.
std::optional<double> mending_factor(const ed::System& system) {
  double low = 0;
  double high = 1e-9;
  while (overlaps(ed::audit(scaled(system, 1 + high)))) {
    low = high;
    high *= 4;
    if (1 + high > kMostMending) return std::nullopt;
  }
  while (high - low > 1e-3 * high) {
    const double middle = 0.5 * (low + high);
    (overlaps(ed::audit(scaled(system, 1 + middle))) ? low : high) = middle;
  }
  return 1 + high;
}

/// Describes the bodies that overlap, the worst pair by the numbers of the file. `ids`: those of the bodies of the
/// state.
std::string overlap_text(const ed::Audit& audit, const std::vector<double>& ids) {
  if (audit.overlaps == 0) return fmt::format("{} pairs of bodies overlap too deeply for a distance", audit.unanswered);
  return fmt::format("{} pairs of bodies overlap, the worst by {:.3g} (bodies {:.17g} and {:.17g} of the file)",
                     audit.overlaps + audit.unanswered, -audit.minimum_distance,
                     ids[static_cast<std::size_t>(audit.closest_i)], ids[static_cast<std::size_t>(audit.closest_j)]);
}

/// Throws InputError if a body could meet two images of another, whatever is mended.
void check_images(const ed::System& system, const std::string& file) {
  std::vector<ed::Component> components;
  components.reserve(system.species.size());
  for (const ed::Species& species : system.species) components.push_back({species, 1});
  const double least = ed::smallest_box(components, ed::Neighbours::dilated);
  if (system.box >= least * (1 - 1e-12)) return;
  throw InputError(
      fmt::format("{}: a box of {:g} is too short: a body could meet two images of another; accepted: at least {:g}",
                  file, system.box, least));
}

/// Removes overlaps if the config requests it; returns what was done.
std::string mend(ed::System& system, const StartFile& start, const std::vector<double>& ids) {
  check_images(system, start.file);
  const ed::Audit audit = ed::audit(system);
  if (!overlaps(audit)) return "";
  if (!start.mend) {
    throw InputError(fmt::format("{}: {}; accepted: overlaps of at most {:g} of their size, or {} = true", start.file,
                                 overlap_text(audit, ids), ed::kAuditOverlap, kMendKey));
  }
  const std::optional<double> factor = mending_factor(system);
  if (!factor) {
    throw InputError(
        fmt::format("{}: {}: a box {} times as large does not separate them; accepted: a state of these bodies",
                    start.file, overlap_text(audit, ids), kMostMending));
  }
  system = scaled(system, *factor);
  return fmt::format(", mended: {}: box and positions scaled by 1 + {:.6g}", overlap_text(audit, ids), *factor - 1);
}

/// Reverses the motion: except for rounding errors the bodies retrace their paths.
void reverse(ed::System& system) {
  for (ed::Body& body : system.bodies) {
    body.velocity = -body.velocity;
    body.angular_velocity = -body.angular_velocity;
  }
}

bool same_packing(double a, double b) {
  return std::abs(a / b - 1) <= kSamePacking;
}

/// Returns whether the config is denser than the state, which had the packing fraction `before` and has `after`,
/// mended. Throws InputError if it is less dense, or too dense to be reached by compression.
bool has_to_be_compressed(const Config& config, double before, double after) {
  const double wanted = config.packing_fraction;
  if (same_packing(before, wanted) || same_packing(after, wanted)) return false;
  const double densest = ed::densest_start(config.components());
  if (after < wanted && wanted <= densest) return true;
  throw InputError(fmt::format(
      "{}: its packing fraction is {:.8g}, in the config {:.8g}; accepted: {}, or no {}", config.start_file->file,
      before, wanted,
      after < densest ? fmt::format("the same, a larger one up to {:.4g}, to which it is compressed", densest)
                      : std::string("the same"),
      kPackingKey));
}

}  // namespace

FileStart start_from_file(const Config& config, std::optional<StartFrame> loaded) {
  const StartFile& start = *config.start_file;
  const auto [frame, k, cut_off] = loaded ? std::move(*loaded) : read_start_frame(start);
  const std::vector<std::vector<std::size_t>> groups = groups_of(frame);
  std::vector<int> found;
  std::vector<std::size_t> order;
  for (const std::vector<std::size_t>& group : groups) {
    found.push_back(static_cast<int>(group.size()));
    order.insert(order.end(), group.begin(), group.end());
  }
  const std::vector<int> wanted = config.numbers();
  if (found != wanted) {
    throw InputError(fmt::format("{}: has {} bodies of its types, the config {}; accepted: the same numbers",
                                 start.file, fmt::join(found, ", "), fmt::join(wanted, ", ")));
  }
  FileStart result;
  for (const std::string& notice : frame.notices) {
    result.notices.push_back(fmt::format("start: {}: {}", one_line(start.file), notice));
  }
  result.system = placed(config, frame, order);
  const double before = ed::packing_fraction(result.system);
  std::string velocities = set_velocities(result.system, config, frame, order);
  if (start.reverse) {
    reverse(result.system);
    velocities += ", reversed";
  }
  std::vector<double> ids;
  ids.reserve(order.size());
  for (const std::size_t i : order) ids.push_back(frame.bodies[i].id);
  const std::string mended = mend(result.system, start, ids);
  const double after = ed::packing_fraction(result.system);
  result.packing_fraction = after;
  result.compress = has_to_be_compressed(config, before, after);
  result.report = fmt::format("start: {} bodies of frame {} of {} at packing fraction {:.8g}, {}{}{}", order.size(), k,
                              one_line(start.file), after, velocities, mended, cut_off ? kCutOff : "");
  return result;
}

}  // namespace hardbody
