#include "config/box.h"

#include "base/errors.h"
#include "config/keys.h"
#include "config/species.h"

#include <ed/shape.h>
#include <ed/start.h>
#include <ed/system.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {
namespace {

/// Returns what a neighbour search needs a large box for.
const char* need_of(ed::Neighbours neighbours) {
  if (neighbours == ed::Neighbours::cells) return "three cells as wide as two of them must fit along an edge";
  if (neighbours == ed::Neighbours::obp) return "\"obp\" needs room for boxes that a body can turn in";
  return "a body would meet two images of another";
}

/// Returns the edge of the box that the bodies need over that of the box that they have.
double box_ratio(const Config& config) {
  const std::vector<ed::Component> components = config.components();
  return ed::smallest_box(components, config.neighbour_search()) / ed::box_for(components, config.packing_fraction);
}

/// Returns a number of bodies in the same proportions whose box is large enough, the least one where sizes are not
/// drawn; nullopt if that is above kMostBodies. A cell of an fcc lattice holds four.
std::optional<int> larger_number(const Config& config, bool drawn) {
  constexpr int kTrials = 20;
  const double in_a_cell = config.start == ed::Lattice::fcc ? 4 : 1;
  const auto enough = [&](int number, double ratio) {
    return std::ceil(std::max(2.0, std::ceil(number * (ratio * ratio * ratio))) / in_a_cell) * in_a_cell;
  };
  double number = enough(config.number, box_ratio(config));
  for (int trial = 0; drawn && trial < kTrials && number <= kMostBodies; ++trial) {
    // Drawn anew, the largest may be larger.
    const Config larger = with_number(config, static_cast<int>(number));
    const double ratio = box_ratio(larger);
    if (ratio <= 1) break;
    number = enough(larger.number, 1.02 * ratio);
  }
  if (number > kMostBodies) return std::nullopt;
  return static_cast<int>(number);
}

std::string larger_box(const Config& config) {
  const bool drawn =
      std::any_of(config.species.begin(), config.species.end(), [](const auto& s) { return s.sizes.has_value(); });
  const std::optional<int> number = larger_number(config, drawn);
  return (number ? fmt::format("a {} {}{}", drawn ? "larger number, for instance" : "number of at least", *number,
                               config.mixture ? " in these proportions" : "")
                 : std::string("a lower packing fraction")) +
         (config.mixture ? ", or bodies of less unequal sizes" : "");
}

}  // namespace

void check_box(const TomlDocument& document, const Config& config) {
  if (box_ratio(config) <= 1) return;
  double largest = 0;
  for (const ed::Component& c : config.components()) largest = std::max(largest, ed::bounding_radius(c.species.shape));
  const Entry* number = document.find(kNumberKey);
  const Entry* entry = number != nullptr ? number : document.find(kPackingKey);
  const bool by_species = config.mixture && number == nullptr;
  throw InputError(
      fmt::format("{}: {} is {}: the box, {:.4g} long at this packing fraction, is then too small for bodies of "
                  "bounding radius {:.4g}{} ({}); accepted: {}",
                  entry->where, by_species ? "the number of bodies" : kNumberKey, config.number,
                  ed::box_for(config.components(), config.packing_fraction), largest,
                  config.mixture ? ", the largest" : "", need_of(config.neighbour_search()), larger_box(config)));
}

void check_lattice(const TomlDocument& document, const Config& config) {
  const std::optional<ed::LatticeOptions> lattice = config.lattice();
  if (!lattice) return;
  try {
    (void)ed::lattice_start(config.components(), *lattice);
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    const Entry* entry = nullptr;
    for (const char* key : {kNumberKey, kPackingKey, kOrderKey}) {
      if (message.starts_with(std::string_view(key).substr(sizeof("system")))) entry = document.find(key);
    }
    if (const Entry* first = document.find("species[1].number"); entry == nullptr && first != nullptr) {
      if (const std::string number = fmt::format("number is {}", config.number); message.starts_with(number)) {
        throw InputError(fmt::format("{}: the numbers of all [[species]] add up to {}{}", first->where, config.number,
                                     message.substr(number.size())));
      }
    }
    if (entry == nullptr) entry = document.find(kStartKey);
    throw InputError(fmt::format("{}: system.{}", entry->where, message));
  }
}

}  // namespace hardbody
