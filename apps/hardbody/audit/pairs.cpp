#include "audit/pairs.h"

#include "base/console.h"
#include "io/text_file.h"

#include <ed/shape.h>
#include <ed/system.h>

#include <geom/distance.h>
#include <geom/pose.h>

#include <fmt/format.h>
#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace hardbody {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

/// Maximum number of images of a cell that are tested along an edge on either side: bodies that reach further fill the
/// box many times over.
constexpr int kMostImagesAlong = 4;

/// Returns the edges of the box as columns.
Matrix3d edges_of(const Frame& frame) {
  Matrix3d edges = frame.box.asDiagonal();
  edges(0, 1) = frame.tilt.x();
  edges(0, 2) = frame.tilt.y();
  edges(1, 2) = frame.tilt.z();
  return edges;
}

/// Bodies of known shapes, sorted into cells of the box. Cells are counted along the edges of the box; cells beyond a
/// face are images of those inside.
class PeriodicCells {
 public:
  PeriodicCells(const Frame& frame, double reach) : edges_(edges_of(frame)), inverse_(edges_.inverse()) {
    const double most = std::cbrt(static_cast<double>(frame.bodies.size())) + 1;
    for (int k = 0; k < 3; ++k) {
      // Distance of opposite faces: across it a cell is as wide as the reach, or the box is one cell.
      const double width = 1 / inverse_.row(k).norm();
      cells_[k] = static_cast<int>(std::clamp(std::floor(width / reach), 1.0, most));
      const double around = std::ceil(reach * cells_[k] / width);
      too_wide_ = too_wide_ || !(around <= kMostImagesAlong);
      around_[k] = too_wide_ ? 0 : static_cast<int>(around);
    }
    first_.assign(static_cast<std::size_t>(cells_.prod()) + 1, 0);
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
      const FrameBody& body = frame.bodies[i];
      if (frame.types[body.type].shape) place(i, body.position);
    }
    sort();
  }

  /// Returns whether bodies reach over more images of the box than are tested.
  bool too_wide() const { return too_wide_; }
  std::size_t size() const { return placed_.size(); }
  std::size_t body(std::size_t k) const { return placed_[k].body; }

  /// Calls `visit(body, r)` for every image of every body that may be within reach of the k-th placed one, r from its
  /// centre to that of the image. Each pair of two placed bodies is visited once for each image, from the earlier body.
  template <class Visit>
  void neighbours(std::size_t k, const Visit& visit) const {
    const Placed& from = placed_[k];
    for (int z = -around_.z(); z <= around_.z(); ++z) {
      for (int y = -around_.y(); y <= around_.y(); ++y) {
        for (int x = -around_.x(); x <= around_.x(); ++x) {
          Vector3i cell = from.cell + Vector3i(x, y, z);
          Vector3i images;
          for (int a = 0; a < 3; ++a) {
            images[a] = (cell[a] - (cell[a] < 0 ? cells_[a] - 1 : 0)) / cells_[a];
            cell[a] -= images[a] * cells_[a];
          }
          const Vector3d shift = edges_ * images.cast<double>();
          const auto number = static_cast<std::size_t>(number_of(cell));
          for (std::size_t m = first_[number]; m < first_[number + 1]; ++m) {
            if (m > k || (m == k && positive(images))) {
              visit(placed_[m].body, placed_[m].position + shift - from.position);
            }
          }
        }
      }
    }
  }

 private:
  struct Placed {
    std::size_t body;
    Vector3d position;  ///< position within the box
    Vector3i cell;
  };

  /// Returns true for exactly one of each pair of opposite vectors.
  static bool positive(const Vector3i& v) { return v.z() != 0 ? v.z() > 0 : v.y() != 0 ? v.y() > 0 : v.x() > 0; }

  int number_of(const Vector3i& cell) const { return (cell.z() * cells_.y() + cell.y()) * cells_.x() + cell.x(); }

  void place(std::size_t i, const Vector3d& position) {
    const Vector3d share = inverse_ * position;
    const Vector3d whole = share.array().floor();
    Placed placed{i, position - edges_ * whole, Vector3i::Zero()};
    for (int a = 0; a < 3; ++a) {
      placed.cell[a] = std::clamp(static_cast<int>((share[a] - whole[a]) * cells_[a]), 0, cells_[a] - 1);
    }
    placed_.push_back(placed);
  }

  void sort() {
    std::stable_sort(placed_.begin(), placed_.end(),
                     [&](const Placed& a, const Placed& b) { return number_of(a.cell) < number_of(b.cell); });
    for (const Placed& placed : placed_) ++first_[static_cast<std::size_t>(number_of(placed.cell)) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
  }

  Matrix3d edges_;
  Matrix3d inverse_;
  Vector3i cells_ = Vector3i::Ones();
  Vector3i around_ = Vector3i::Zero();
  bool too_wide_ = false;
  std::vector<std::size_t> first_;
  std::vector<Placed> placed_;
};

/// Notes the types without a shape of which there are bodies.
void note_missing_shapes(const Frame& frame, PairAudit& audit) {
  std::vector<bool> used(frame.types.size(), false);
  for (const FrameBody& body : frame.bodies) used[body.type] = true;
  for (std::size_t k = 0; k < frame.types.size(); ++k) {
    if (!used[k] || frame.types[k].shape) continue;
    audit.not_tested.push_back(
        fmt::format("bodies of type {} have no shape in the file", one_line(frame.types[k].name, 40)));
  }
}

/// Returns whether the frame determines the orientation of a body, as far as it matters.
bool lies_as_known(const Frame& frame, const FrameBody& body) {
  return frame.orientations || ed::is_sphere(*frame.types[body.type].shape);
}

/// Tests a pair, r from the centre of the first to that of the second.
void audit_pair(const Frame& frame, std::size_t i, std::size_t j, const Vector3d& r, double tolerance,
                PairAudit& audit) {
  const FrameBody& a = frame.bodies[i];
  const FrameBody& b = frame.bodies[j];
  const ed::BodyShape& shape_a = *frame.types[a.type].shape;
  const ed::BodyShape& shape_b = *frame.types[b.type].shape;
  if (!lies_as_known(frame, a) || !lies_as_known(frame, b)) {
    const std::string reason = "orientations of bodies that are near each other are not known";
    if (std::find(audit.not_tested.begin(), audit.not_tested.end(), reason) == audit.not_tested.end()) {
      audit.not_tested.push_back(reason);
    }
    return;
  }
  const geom::DistanceResult d =
      ed::distance(shape_a, geom::Pose(a.rotation, Vector3d::Zero()), shape_b, geom::Pose(b.rotation, r));
  if (!(d.status == geom::DistanceStatus::separated || d.status == geom::DistanceStatus::overlapping)) {
    ++audit.unanswered;
    return;
  }
  const double size = ed::bounding_radius(shape_a) + ed::bounding_radius(shape_b);
  if (d.distance < -std::max(tolerance, ed::kAuditOverlap * size)) ++audit.overlaps;
  if (d.distance >= audit.minimum_distance) return;
  audit.minimum_distance = d.distance;
  audit.closest_i = std::min(i, j);
  audit.closest_j = std::max(i, j);
}

}  // namespace

PairAudit audit_pairs(const Frame& frame, double tolerance) {
  PairAudit audit;
  note_missing_shapes(frame, audit);
  std::vector<double> radii;
  double largest = 0;
  for (const FrameType& type : frame.types) {
    radii.push_back(type.shape ? ed::bounding_radius(*type.shape) : 0);
    largest = std::max(largest, radii.back());
  }
  if (largest == 0) return audit;
  const PeriodicCells cells(frame, 2 * largest);
  if (cells.too_wide()) {
    audit.not_tested.push_back(fmt::format("the box is too small for bodies of bounding radius {:g}", largest));
    return audit;
  }
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (k % 256 == 0) console().poll();
    const std::size_t i = cells.body(k);
    cells.neighbours(k, [&](std::size_t j, const Vector3d& r) {
      if (r.norm() > radii[frame.bodies[i].type] + radii[frame.bodies[j].type]) return;
      audit_pair(frame, i, j, r, tolerance, audit);
    });
  }
  return audit;
}

}  // namespace hardbody
