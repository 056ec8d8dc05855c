#pragma once

#include "base/poll.h"
#include "bodies/pair.h"
#include "cells/levels.h"
#include "loop/parts/periodic_box.h"
#include "neighbours/envelopes.h"
#include "neighbours/lists.h"

#include <ed/simulation.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace ed::internal {

/// Neighbours of all bodies: envelopes, cells in which the bodies near another are found, and lists of pairs.
template <class Bodies>
class Neighbourhood {
 public:
  /// Makes no envelopes and lists yet. All but `batches` (see CellGrid) must outlive this.
  Neighbourhood(Bodies& bodies, PeriodicBox& box, Counters& counters,
                const std::optional<geom::InstructionSet>& batches)
      : bodies_(bodies), box_(box), counters_(counters), batches_(batches), lists_(bodies.number()) {}

  NeighbourLists& lists() { return lists_; }
  const NeighbourLists& lists() const { return lists_; }
  const Envelopes<Bodies>& envelopes() const { return *envelopes_; }
  const CellLevels& cells() const { return *cells_; }

  void set_envelopes(std::unique_ptr<Envelopes<Bodies>> envelopes) { envelopes_ = std::move(envelopes); }
  /// Reads what these envelopes hold.
  void load_envelopes(Reader& reader) { envelopes_->load(reader); }
  /// Makes cells in which bodies are found whose envelopes may overlap, until the box has shrunk by `least_scale`.
  void make_cells(double least_scale = 1) {
    std::vector<double> extents;
    extents.reserve(static_cast<std::size_t>(bodies_.number()));
    for (int i = 0; i < bodies_.number(); ++i) extents.push_back(envelopes_->extent(bodies_.bounding_radius(i)));
    cells_.emplace(extents, box_.edge(), least_scale, batches_);
  }

  /// Uses the kernels of an instruction set from now on.
  void use(geom::InstructionSet set) {
    batches_ = set;
    envelopes_->use(bodies_, set);
    cells_->use(set);
  }

  /// Returns the vector from the centre of i to that of j, in the image in which they can touch.
  Eigen::Vector3d between(const Pair& pair, double now) const {
    const Eigen::Vector3d d = bodies_.position_at(pair.j, now) - bodies_.position_at(pair.i, now);
    return envelopes_->image(pair.i, pair.j, d, box_.edge());
  }

  /// Predicts when body i leaves its envelope.
  void renew_exit(int i, double now) {
    ++counters_.envelope_checks;
    bodies_.events(i).exit = envelopes_->exit_time(i, bodies_, now, box_.edge());
  }
  /// Whether body i stays in its envelope for so long that a new one would be a waste.
  bool lasts(int i, double now) const { return !(bodies_.events(i).exit - now < envelopes_->worthwhile(i, bodies_)); }

  // The new envelope and list of a body, in three steps.

  /// Gives body i a new envelope where it is now.
  void place(int i, double now) {
    bodies_.move(i, now);
    box_.wrap(bodies_, i, now);
    envelopes_->place(i, bodies_, now);
    cells_->place(i, bodies_.position_at(i, now));
  }
  /// Removes all pairs of body i, after `removing(index, partner)`.
  template <class Removing>
  void drop_list(int i, const Removing& removing) {
    lists_.drop(i, removing);
  }
  /// Makes the list of body i, which has none.
  void find_list(int i, double now) { counters_.candidate_tests += add_pairs(i, now, 0); }

  /// Makes envelopes, cells, exits and lists of all bodies. The pairs are to be predicted. `poll`: see
  /// SimulationOptions.
  void make_all(double now, const std::function<void()>& poll = {}) {
    lists_ = NeighbourLists(bodies_.number());
    // The cells shrink with the box between two calls of this, but what they must cover does not.
    make_cells(envelopes_->least_scale());
    list_scale_ = 1;
    for (int i = 0; i < bodies_.number(); ++i) {
      poll_at(i, poll);
      place(i, now);
      renew_exit(i, now);
    }
    for (int i = 0; i < bodies_.number(); ++i) {
      poll_at(i, poll);
      (void)add_pairs(i, now, i + 1);
    }
  }

  /// Makes room, so that nothing allocates while events are processed unless a list becomes longer than any before.
  /// Returns the length of lists that have room.
  std::size_t reserve() {
    const std::size_t longest = lists_.reserve();
    overlapping_.reserve(longest);
    // Candidates are two to three times as many as neighbours.
    near_.resize(std::max(near_.size(), 2 * longest + kCandidatesReserved));
    return longest;
  }

  /// Least factor by which the box may be scaled with these lists.
  double least_factor() const { return envelopes_->least_scale() / list_scale_; }
  /// Whether the lists have to be made anew before the box shrinks on.
  bool is_used_up() const { return list_scale_ <= 0.9 * envelopes_->least_scale() + 0.1; }
  /// Scales envelopes and cells, after box and bodies, and renews all exits.
  void scale(double factor, double now) {
    list_scale_ *= factor;
    envelopes_->scale(factor);
    cells_->scale(factor);
    for (int i = 0; i < bodies_.number(); ++i) renew_exit(i, now);
  }

  /// Whether cells and scale that were read fit the envelopes.
  bool is_sound() const {
    // Otherwise cells would be too narrow for the reach of a search, now or after the box has shrunk further.
    const double least = envelopes_->least_scale();
    const bool shrinks = list_scale_ > 0 && list_scale_ <= 1 && list_scale_ >= least * (1 - 1e-9);
    return least > 0 && shrinks && cells_->cover(list_scale_ / least);
  }

  /// Cells, lists, scale of the box since all lists were made; states hold them apart.
  template <class Self>
  static auto members(Self& self) {
    return std::tie(*self.cells_, self.lists_, self.list_scale_);
  }

 private:
  /// Room for candidates beyond those that become neighbours: a block of each cell that is looked into, at most.
  static constexpr std::size_t kCandidatesReserved = 2048;

  /// Adds the pairs of body i with bodies from number `first` on. Returns the number of candidates.
  std::size_t add_pairs(int i, double now, int first) {
    std::size_t number = 0;
    cells_->search(i, bodies_.position_at(i, now), near_, [&](std::span<const NearBody> candidates) {
      envelopes_->find_overlapping(i, candidates, first, overlapping_);
      for (const auto& [k, normal] : overlapping_) lists_.add(i, k, normal);
      number += candidates.size();
    });
    return number;
  }

  Bodies& bodies_;
  PeriodicBox& box_;
  Counters& counters_;
  std::optional<geom::InstructionSet> batches_;
  std::unique_ptr<Envelopes<Bodies>> envelopes_;
  std::optional<CellLevels> cells_;
  NeighbourLists lists_;
  double list_scale_ = 1;  ///< factor by which the box has shrunk since all lists were made
  // Room for the list of one body.
  std::vector<NearBody> near_;
  std::vector<OverlappingEnvelope> overlapping_;
};

}  // namespace ed::internal
