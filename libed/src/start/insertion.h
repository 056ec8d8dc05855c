#pragma once

/// Random insertion of bodies, the first part of random starts.

#include "cells/levels.h"
#include "start/nematic.h"

#include <ed/random.h>
#include <ed/start.h>
#include <ed/system.h>

#include <geom/pose.h>

#include <optional>
#include <vector>

namespace ed::internal {

/// Reports the packing fraction that is reached. Throws std::runtime_error if the start is to stop.
void report(const StartOptions& options, double packing_fraction);

/// Returns the packing fraction up to which bodies are inserted at random, with no compression.
double dilute_packing(const std::vector<Component>& components);

/// Returns whether the sizes of the bodies differ so much that they are of several classes (CellLevels).
bool has_size_classes(const System& system);

/// Random sequential insertion, one class of sizes after the other (CellLevels), the largest bodies first.
///
/// A large body would find no place among thousands of small ones. Small ones find theirs between large ones that have
/// been compressed already, as long as they are dilute in the space that is left: a box of few large bodies and many
/// small ones needs little or no compression of all of them, which would take a time that grows with the square of
/// their number.
class Insertion {
 public:
  /// Constructs a box that is large enough for the insertion of the first class. The options must outlive this.
  Insertion(const std::vector<Component>& components, const StartOptions& options);

  /// Inserts the next class. Returns whether another one is left. Throws std::runtime_error where no place is found,
  /// and if the start is to stop.
  bool insert_class(Random& random);

  /// Returns the edge, at least `target`, of a box into which the classes that are left can still be inserted.
  double next_box(double target) const { return box_before(next_class_, target); }

  /// Returns the largest number of bodies that are compressed together on the way to a box of edge `target`, if none is
  /// in the box yet.
  int most_compressed(double target) const;

  /// Returns the bodies that are in the box, in their order, without velocities.
  System inserted() const;
  /// Moves the bodies that are in the box, which may be another one from now on.
  void set_inserted(const System& system);

 private:
  /// Returns the edge, at least `target`, of a box into which this class and smaller ones can be inserted.
  double box_before(int c, double target) const;
  std::vector<int> bodies_inserted() const;
  std::vector<double> roomy_boxes(const std::vector<Component>& components) const;
  void insert(int i, CellLevels& cells, Random& random);
  bool is_blocked(int i, const geom::Pose& pose, const CellLevels& cells);

  const StartOptions* options_;
  System system_;
  std::vector<int> class_of_;        ///< class of each body; that of the smallest ones is 0
  int next_class_;                   ///< the class that is inserted next; those after it are in the box
  std::vector<double> roomy_boxes_;  ///< edge of a box into which it can be inserted, for each class
  std::optional<NematicOrientations> nematic_;
  std::vector<NearBody> near_;
};

}  // namespace ed::internal
