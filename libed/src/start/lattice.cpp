#include "base/poll.h"
#include "neighbours/limits.h"
#include "start/lattice_cells.h"
#include "start/nematic.h"
#include "start/parts.h"

#include <ed/random.h>
#include <ed/shape.h>
#include <ed/start.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;
using internal::fits;
using internal::free_box;
using internal::in_box;
using internal::is_site;
using internal::least_box;
using internal::near_vectors;
using internal::reach_of;
using internal::shortest_vector;
using internal::sites_in_cell;
using internal::Turned;
using internal::ways_to_fill;

/// Largest number of ways that are tried for bodies other than ellipsoids: for the best way, and for each alternative
/// number. (For ellipsoids the shortest vector decides.)
constexpr std::size_t kTriedWays = 24;
constexpr std::size_t kTriedWaysOfOthers = 4;

/// Number of steps away up to which numbers are tried for the message that names the nearest ones with a packing
/// fraction.
constexpr int kTriedNumbers = 1000;

// ---- Request

/// Request, with quantities derived from it.
struct Request {
  const std::vector<Component>& components;
  const LatticeOptions& options;
  int number = 0;
  double box = 0;
  Vector3d extents = Vector3d::Zero();  ///< half of the extents of a typical body along x, y, z
  /// Body on all sites, if they are all of one species.
  std::optional<Turned> body = std::nullopt;
};

int axis_of(const Species& species, const LatticeOptions& options) {
  return options.axis.value_or(internal::ordered_axis(species));
}

/// Returns the r.m.s. of the extents over the bodies.
Vector3d typical_extents(const std::vector<Component>& components, const LatticeOptions& options) {
  Vector3d squares = Vector3d::Zero();
  double number = 0;
  for (const auto& [species, count] : components) {
    squares += count * (internal::aligned(axis_of(species, options)) * half_extents(species.shape)).cwiseAbs2();
    number += count;
  }
  return (squares / number).cwiseSqrt();
}

void check_options(const LatticeOptions& options) {
  std::ostringstream message;
  if (!(options.packing_fraction > 0 && options.packing_fraction < 1)) {
    message << "packing_fraction is " << options.packing_fraction << "; accepted: above 0, below 1";
    throw std::invalid_argument(message.str());
  }
  if (options.axis && (*options.axis < 0 || *options.axis > 2)) {
    message << "axis is " << *options.axis << "; accepted: 0, 1 or 2";
    throw std::invalid_argument(message.str());
  }
}

Request request_of(const std::vector<Component>& components, const LatticeOptions& options) {
  Request request{.components = components, .options = options};
  for (const Component& component : components) request.number += component.number;
  request.box = box_for(components, options.packing_fraction);
  request.extents = typical_extents(components, options);
  if (components.size() == 1) {
    const Species& species = components[0].species;
    request.body = Turned{&species.shape, internal::aligned(axis_of(species, options))};
  }
  return request;
}

// ---- Numbers

/// Returns whether this number of bodies can be divided into cells, in a box that is large enough for nearest images.
bool possible(const Request& request, int number) {
  if (number < 1 || number % sites_in_cell(request.options.lattice) != 0) return false;
  const double box = request.box * std::cbrt(static_cast<double>(number) / request.number);
  return box >= internal::smallest_image_box(internal::largest_radius(request.components));
}

/// Returns whether this number of bodies, of one species and aligned, reaches the packing fraction on this lattice.
bool holds(const Request& request, int number) {
  if (!possible(request, number)) return false;
  const Lattice lattice = request.options.lattice;
  const double box = request.box * std::cbrt(static_cast<double>(number) / request.number);
  const auto ways = ways_to_fill(lattice, number / sites_in_cell(lattice), request.extents, kTriedWaysOfOthers);
  return std::any_of(ways.begin(), ways.end(),
                     [&](const Vector3i& way) { return fits(box, lattice, way, *request.body); });
}

/// Returns the largest packing fraction of ellipsoids of these extents in the best cells for this number, over that in
/// cells of exactly their proportions.
double filling(const Request& request, int number) {
  const Lattice lattice = request.options.lattice;
  const Vector3i way = ways_to_fill(lattice, number / sites_in_cell(lattice), request.extents, 1).front();
  const double shortest = shortest_vector(lattice, way, request.extents);
  // Edges of 1, relative to the extents, give the number of cells in a box.
  const double perfect = shortest_vector(lattice, Vector3i::Ones(), Vector3d::Ones());
  const double sites = sites_in_cell(lattice) / request.extents.prod();
  return number * shortest * shortest * shortest / (sites * perfect * perfect * perfect);
}

/// Value of filling() from which on cells fit the bodies.
constexpr double kFits = 0.95;

/// Returns "500 or 576", the nearest numbers on either side; empty if there are none near.
template <typename Wanted>
std::string nearest_numbers(const Request& request, const Wanted& wanted) {
  std::string text;
  for (const int sign : {-1, 1}) {
    for (int step = 1; step <= std::min(kTriedNumbers, request.number); ++step) {
      const int number = request.number + sign * step;
      if (!possible(request, number) || !wanted(number)) continue;
      text += (text.empty() ? "" : " or ") + std::to_string(number);
      break;
    }
  }
  return text;
}

std::string numbers_that_hold(const Request& request) {
  return nearest_numbers(request, [&](int number) { return holds(request, number); });
}

std::string numbers_that_fit(const Request& request) {
  return nearest_numbers(request, [&](int number) { return filling(request, number) >= kFits; });
}

void check_number(const Request& request) {
  if (request.number % sites_in_cell(request.options.lattice) == 0) return;
  std::string accepted = request.body ? numbers_that_hold(request) : "";
  if (accepted.empty()) accepted = "a multiple of 4";
  const std::string fitting = request.body ? "" : numbers_that_fit(request);
  if (!fitting.empty()) accepted += ", best " + fitting + ", whose cells fit the bodies";
  std::ostringstream message;
  message << "number is " << request.number << ": the fcc lattice has 4 bodies in a cell; accepted: " << accepted;
  throw std::invalid_argument(message.str());
}

/// Returns, for a mixture, whose bodies are on sites drawn at random, body counts whose lattice cells fit the mean
/// ellipsoid; or else the packing fraction that the nearest counts that fit would reach.
std::string numbers_of_mixture(const Request& request, double most) {
  constexpr double kMargin = 1.02;  // neighbours may be different then
  const double now = filling(request, request.number);
  const double wanted = kMargin * request.options.packing_fraction / most * now;
  const std::string enough = nearest_numbers(request, [&](int number) { return filling(request, number) >= wanted; });
  constexpr const char* kWhy = " in these proportions, whose cells fit the bodies better";
  if (!enough.empty()) return ", or a number of " + enough + kWhy;
  const std::string better = now < kFits / kMargin ? numbers_that_fit(request) : "";
  if (better.empty()) return "";
  std::ostringstream text;
  text << "; about " << std::setprecision(2) << most / now * kFits << " with a number of " << better << kWhy;
  return text.str();
}

/// Throws for bodies that overlap: the box would have to be `box`.
[[noreturn]] void refuse_packing(const Request& request, const Vector3i& cells, double box) {
  // Rounded down to four digits, so that the value in the message is accepted.
  const double ratio = request.box / box;
  const double exact = request.options.packing_fraction * (ratio * ratio * ratio);
  const double unit = std::pow(10, std::floor(std::log10(exact)) - 3);
  const double most = std::floor(exact / unit) * unit;
  std::ostringstream message;
  message << "packing_fraction is " << request.options.packing_fraction << " and number is " << request.number
          << ": bodies in " << cells.x() << " x " << cells.y() << " x " << cells.z() << " cells of the "
          << to_string(request.options.lattice) << " lattice overlap; accepted: at most " << most;
  if (!request.body) {
    message << numbers_of_mixture(request, most);
  } else if (const std::string nearest = numbers_that_hold(request); !nearest.empty()) {
    message << ", or a number of " << nearest;
  }
  throw std::invalid_argument(message.str());
}

// ---- Placement

/// Returns the number of cells along each edge, and the smallest box of them in which the bodies do not overlap; 0 if
/// they are of several species, which may be on any site.
std::pair<Vector3i, double> choose_cells(const Request& request) {
  const Lattice lattice = request.options.lattice;
  const auto ways = ways_to_fill(lattice, request.number / sites_in_cell(lattice), request.extents, kTriedWays);
  if (!request.body) return {ways.front(), 0};
  // Box in which the bodies would fill all space.
  const double smallest = request.box * std::cbrt(request.options.packing_fraction);
  Vector3i best = ways.front();
  double best_box = std::numeric_limits<double>::infinity();
  // Ways that differ by rounding are equivalent up to a rotation.
  const auto better = [&](double box) { return box < best_box * (1 - 1e-9); };
  for (const Vector3i& way : ways) {
    if (!better(least_box(lattice, way, *request.body))) continue;
    const double box = free_box(smallest, lattice, way, *request.body);
    if (!better(box)) continue;
    best = way;
    best_box = box;
  }
  return {best, best_box};
}

std::vector<Vector3i> sites_of(Lattice lattice, const Vector3i& cells) {
  std::vector<Vector3i> sites;
  for (int z = 0; z < 2 * cells.z(); ++z) {
    for (int y = 0; y < 2 * cells.y(); ++y) {
      for (int x = 0; x < 2 * cells.x(); ++x) {
        if (is_site(lattice, {x, y, z})) sites.emplace_back(x, y, z);
      }
    }
  }
  return sites;
}

/// Shuffles the sites, for bodies of several species; those of one species are placed cell by cell.
void shuffle(std::vector<Vector3i>& sites, Random& random) {
  for (std::size_t i = sites.size(); i > 1; --i) std::swap(sites[i - 1], sites[random.bits() % i]);
}

/// Returns the smallest box, `box` or larger, in which no two of these bodies overlap.
double free_box_of(const System& system, const LatticeOptions& options, const Vector3i& cells,
                   const std::vector<Vector3i>& sites) {
  const auto place = [&](Vector3i p) {
    for (int k = 0; k < 3; ++k) p[k] = (p[k] + 2 * cells[k]) % (2 * cells[k]);
    return (static_cast<std::size_t>(p.z()) * static_cast<std::size_t>(2 * cells.y()) +
            static_cast<std::size_t>(p.y())) *
               static_cast<std::size_t>(2 * cells.x()) +
           static_cast<std::size_t>(p.x());
  };
  std::vector<std::size_t> body_at(8 * sites.size());
  std::vector<Turned> bodies;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    body_at[place(sites[i])] = i;
    bodies.push_back({&system.species_of(static_cast<int>(i)).shape, system.bodies[i].rotation});
  }
  double box = system.box;
  for (const Vector3i& p : near_vectors(options.lattice, cells, reach_of(bodies) / box)) {
    for (std::size_t i = 0; i < sites.size(); ++i) {
      internal::poll_at(static_cast<int>(i), options.poll);
      box = free_box(box, bodies[i], bodies[body_at[place(sites[i] + p)]], in_box(p, cells));
    }
  }
  return box;
}

}  // namespace

const char* to_string(Lattice lattice) {
  return lattice == Lattice::fcc ? "fcc" : "cubic";
}

System lattice_start(const std::vector<Component>& components, const LatticeOptions& options) {
  internal::check_components(components);
  check_options(options);
  const Request request = request_of(components, options);
  internal::check_target(components, request.box);
  check_number(request);
  const auto [cells, smallest] = choose_cells(request);
  // Identical bodies all have the same neighbours.
  if (request.body && !fits(request.box, options.lattice, cells, *request.body)) {
    refuse_packing(request, cells, smallest);
  }
  Random random(options.seed);
  std::vector<Vector3i> sites = sites_of(options.lattice, cells);
  if (components.size() > 1) shuffle(sites, random);
  System system = internal::bodies_of(components);
  system.box = request.box;
  std::vector<int> axes;
  axes.reserve(components.size());
  for (const Component& component : components) axes.push_back(axis_of(component.species, options));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    internal::poll_at(static_cast<int>(i), options.poll);
    Body& body = system.bodies[i];
    // Shifted by a quarter of a cell: no body is on a face of the box.
    const Vector3d quarter = Vector3d(0.25, 0.25, 0.25).cwiseQuotient(cells.cast<double>());
    body.position = system.box * (in_box(sites[i], cells) + quarter - Vector3d::Constant(0.5));
    body.rotation = internal::aligned(axes[static_cast<std::size_t>(body.species)]);
  }
  if (!request.body) {
    const double box = free_box_of(system, options, cells, sites);
    if (box > request.box) refuse_packing(request, cells, box);
  }
  if (options.nematic_order) {
    const auto numbers = [&] { return filling(request, request.number) < kFits ? numbers_that_fit(request) : ""; };
    internal::turn_to_order(system, axes, *options.nematic_order, random, numbers, options.poll);
  }
  internal::number_along_curve(system);
  internal::draw_velocities(system, random);
  rescale_velocities(system, options.groups);
  return system;
}

}  // namespace ed
