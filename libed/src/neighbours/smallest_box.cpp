#include "contact/body_shapes.h"
#include "neighbours/cell.h"
#include "neighbours/limits.h"
#include "neighbours/oriented_slack.h"
#include "system/uniaxial.h"

#include <ed/system.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <variant>
#include <vector>

namespace ed {
namespace {

double smallest_box_of(const std::vector<BodyShape>& shapes, bool of_revolution, Neighbours neighbours) {
  double radius = 0;
  double inscribed = std::numeric_limits<double>::infinity();
  for (const BodyShape& shape : shapes) {
    radius = std::max(radius, bounding_radius(shape));
    inscribed = std::min(inscribed, inscribed_radius(shape));
  }
  const double by_images = internal::smallest_image_box(radius);
  if (neighbours == Neighbours::cells) return std::max(by_images, internal::CellLayout::smallest_box(radius));
  if (neighbours == Neighbours::dilated || of_revolution) return by_images;
  return std::max(by_images, internal::smallest_oriented_box(shapes, internal::kThinnestOriented * inscribed));
}

}  // namespace

double smallest_box(const std::vector<Component>& components, Neighbours neighbours) {
  std::vector<BodyShape> shapes;
  std::vector<Species> species;
  for (const Component& component : components) {
    shapes.push_back(component.species.shape);
    species.push_back(component.species);
  }
  return smallest_box_of(shapes, internal::are_uniaxial(species), neighbours);
}

int smallest_number(const BodyShape& shape, double packing_fraction, Neighbours neighbours) {
  if (!(packing_fraction > 0)) {
    std::ostringstream message;
    message << "packing_fraction is " << packing_fraction << "; accepted: above 0";
    throw std::invalid_argument(message.str());
  }
  const double box = smallest_box_of({shape}, internal::has_uniaxial_shape(shape), neighbours);
  const double number = std::ceil(packing_fraction * box * box * box / volume(shape));
  return static_cast<int>(std::clamp(number, 2.0, double{std::numeric_limits<int>::max()}));
}

}  // namespace ed
