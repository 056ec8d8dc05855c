#include "start/insertion.h"

#include "base/poll.h"
#include "neighbours/limits.h"
#include "start/parts.h"
#include "system/bounding_radii.h"

#include <ed/shape.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <stdexcept>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Packing fraction of the random insertion up to an aspect ratio of 10, where the excluded volume is 13 times a
/// body's. Beyond, it falls as the excluded volume grows, so that a position is found within a few tries.
constexpr double kDilute = 0.04;

/// Packing fraction of small bodies in the space between large ones, in units of that: some tries a body are cheaper
/// than a compression of all bodies.
constexpr double kBetween = 2.5;

/// Maximum number of tries to insert one body.
constexpr int kInsertions = 100000;

/// Returns a dilute box whose bodies are not placed yet.
System empty_box(const std::vector<Component>& components, double packing_fraction) {
  System system = bodies_of(components);
  const double dilute = dilute_packing(components);
  system.box = std::max(box_for(components, std::min(packing_fraction, dilute)),
                        1.05 * smallest_image_box(largest_radius(components)));
  // A box at the wanted packing fraction is used unchanged, so that nothing is left to compress.
  if (packing_fraction <= dilute) system.box = box_for(components, packing_fraction);
  return system;
}

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

void report(const StartOptions& options, double packing_fraction) {
  if (options.progress && !options.progress(packing_fraction)) {
    throw std::runtime_error("interrupted during the compression");
  }
}

double dilute_packing(const std::vector<Component>& components) {
  double least = 1;
  for (const auto& [species, number] : components) {
    least = std::min(least, 10 * inscribed_radius(species.shape) / bounding_radius(species.shape));
  }
  return kDilute * least;
}

bool has_size_classes(const System& system) {
  const std::vector<int> classes = size_classes(bounding_radii(system));
  return *std::max_element(classes.begin(), classes.end()) > 0;
}

Insertion::Insertion(const std::vector<Component>& components, const StartOptions& options)
    : options_(&options),
      system_(empty_box(components, options.packing_fraction)),
      class_of_(size_classes(bounding_radii(system_))),
      next_class_(*std::max_element(class_of_.begin(), class_of_.end())) {
  if (options.nematic_order) nematic_.emplace(*options.nematic_order);
  if (next_class_ == 0 || options.packing_fraction <= dilute_packing(components)) return;
  roomy_boxes_ = roomy_boxes(components);
  system_.box =
      std::max({*std::max_element(roomy_boxes_.begin(), roomy_boxes_.end()),
                box_for(components, options.packing_fraction), 1.05 * smallest_image_box(largest_radius(components))});
}

/// Returns for each class the edge of a box in which it is dilute between the larger bodies. These keep the centres of
/// smaller ones out of their own volume, taken as a sphere, and of a shell as thick as the radius of a smaller one.
std::vector<double> Insertion::roomy_boxes(const std::vector<Component>& components) const {
  const std::vector<double> radii = bounding_radii(system_);
  std::vector<double> radius(at(next_class_ + 1)), own(at(next_class_ + 1)), taken(at(next_class_ + 1));
  for (std::size_t i = 0; i < radii.size(); ++i) {
    radius[at(class_of_[i])] = std::max(radius[at(class_of_[i])], radii[i]);
    own[at(class_of_[i])] += volume(system_.species_of(static_cast<int>(i)).shape);
  }
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double large = volume(system_.species_of(static_cast<int>(i)).shape);
    const double r = std::cbrt(0.75 * std::numbers::inv_pi * large);
    for (int c = 0; c < class_of_[i]; ++c) taken[at(c)] += large * std::pow(1 + radius[at(c)] / r, 3);
  }
  const double dilute = dilute_packing(components);
  std::vector<double> boxes;
  boxes.reserve(own.size());
  for (std::size_t c = 0; c < own.size(); ++c) {
    const double density = c + 1 < own.size() ? kBetween * dilute : dilute;
    boxes.push_back(std::cbrt(own[c] / density + taken[c]));
  }
  return boxes;
}

bool Insertion::insert_class(Random& random) {
  CellLevels cells(bounding_radii(system_), system_.box);
  int inserted = 0;
  for (const int i : bodies_inserted()) {
    cells.place(i, system_.bodies[at(i)].position);
    ++inserted;
  }
  const double share = packing_fraction(system_) / system_.size();
  for (int i = 0; i < system_.size(); ++i) {
    if (class_of_[at(i)] != next_class_) continue;
    poll_at(inserted, [&] { report(*options_, inserted * share); });
    insert(i, cells, random);
    ++inserted;
  }
  --next_class_;
  return next_class_ >= 0;
}

double Insertion::box_before(int c, double target) const {
  for (const double box : std::span(roomy_boxes_).first(std::min(roomy_boxes_.size(), at(c + 1)))) {
    target = std::max(target, box);
  }
  return target;
}

int Insertion::most_compressed(double target) const {
  std::vector<int> members(at(next_class_ + 1), 0);
  for (const int c : class_of_) ++members[at(c)];
  int most = 0;
  int inside = 0;
  double box = system_.box;
  for (int c = next_class_; c >= 0; --c) {
    inside += members[at(c)];
    const double next = box_before(c - 1, target);
    if (!(box > next)) continue;
    most = inside;
    box = next;
  }
  return most;
}

System Insertion::inserted() const {
  System system;
  system.box = system_.box;
  system.species = system_.species;
  const std::vector<int> bodies = bodies_inserted();
  system.bodies.reserve(bodies.size());
  for (const int i : bodies) system.bodies.push_back(system_.bodies[at(i)]);
  return system;
}

void Insertion::set_inserted(const System& system) {
  auto next = system.bodies.begin();
  for (const int i : bodies_inserted()) {
    system_.bodies[at(i)].position = next->position;
    system_.bodies[at(i)].rotation = next->rotation;
    ++next;
  }
  system_.box = system.box;
}

std::vector<int> Insertion::bodies_inserted() const {
  std::vector<int> bodies;
  for (int i = 0; i < system_.size(); ++i) {
    if (class_of_[at(i)] > next_class_) bodies.push_back(i);
  }
  return bodies;
}

void Insertion::insert(int i, CellLevels& cells, Random& random) {
  // Drawn once a body: if it were drawn again with each position, aligned bodies would be accepted more often.
  Matrix3d orientation;
  if (nematic_) orientation = nematic_->draw(ordered_axis(system_.species_of(i)), random);
  for (int attempt = 0; attempt < kInsertions; ++attempt) {
    const double x = random.uniform() - 0.5;
    const double y = random.uniform() - 0.5;
    const double z = random.uniform() - 0.5;
    const geom::Pose pose(nematic_ ? orientation : random.rotation(), system_.box * Vector3d(x, y, z));
    if (is_blocked(i, pose, cells)) continue;
    system_.bodies[at(i)].position = pose.position();
    system_.bodies[at(i)].rotation = pose.rotation();
    cells.place(i, pose.position());
    return;
  }
  throw std::runtime_error("random start: no place found for a body");
}

bool Insertion::is_blocked(int i, const geom::Pose& pose, const CellLevels& cells) {
  bool blocked = false;
  cells.search(i, pose.position(), near_, [&](std::span<const NearBody> others) {
    blocked =
        blocked || std::any_of(others.begin(), others.end(), [&](const NearBody& other) {
          const geom::Pose X(system_.bodies[at(static_cast<int>(other.body))].rotation, pose.position() + other.r);
          return overlaps(system_.species_of(i).shape, pose, system_.species_of(static_cast<int>(other.body)).shape, X);
        });
  });
  return blocked;
}

}  // namespace ed::internal
