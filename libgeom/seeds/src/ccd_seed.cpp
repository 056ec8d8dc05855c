#include <geom/kernel/any_body.h>
#include <geom/seeds.h>

#include <ccd/ccd.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace geom {
namespace kernel {
namespace {

/// Inflation stops when the inflated bodies overlap by less than this, relative to the smaller inscribed radius.
constexpr double kContactDepth = 5e-2;
constexpr int kMaxInflations = 60;
constexpr unsigned long kMaxPortals = 200;
/// MPR's own tolerance, relative to the smaller inscribed radius.
constexpr double kPortalTolerance = 1e-3;

/// Body for libccd's callbacks: inflated by a ball, about `centre`.
struct InflatedBody {
  const SupportBody* body;
  Eigen::Vector3d centre;
  double skin;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& inflated = *static_cast<const InflatedBody*>(object);
  const Eigen::Vector3d n = Eigen::Map<const Eigen::Vector3d>(direction->v).stableNormalized();
  Eigen::Map<Eigen::Vector3d>(out->v) = inflated.centre + inflated.body->support_W(n) + inflated.skin * n;
}

void centre(const void* object, ccd_vec3_t* out) {
  Eigen::Map<Eigen::Vector3d>(out->v) = static_cast<const InflatedBody*>(object)->centre;
}

/// Result of MPR for two bodies that overlap.
struct Contact {
  double depth;
  Eigen::Vector3d normal;  ///< unit, A to B
  Eigen::Vector3d point;   ///< point in the middle of the overlap
};

class Mpr {
 public:
  Mpr(const SupportBody& a, const SupportBody& b, double unit)
      : a_{&a, Eigen::Vector3d::Zero(), 0}, b_{&b, b.pose().position() - a.pose().position(), 0} {
    CCD_INIT(&ccd_);
    ccd_.support1 = ccd_.support2 = support;
    ccd_.center1 = ccd_.center2 = centre;
    ccd_.max_iterations = kMaxPortals;
    ccd_.mpr_tolerance = kPortalTolerance * unit;
  }

  /// Returns whether both bodies, inflated by `skin`, overlap; if so, sets `contact`.
  bool overlap(double skin, Contact& contact) {
    a_.skin = b_.skin = skin;
    ccd_vec3_t direction, position;
    if (ccdMPRPenetration(&a_, &b_, &ccd_, &contact.depth, &direction, &position) != 0) return false;
    contact.normal = Eigen::Map<const Eigen::Vector3d>(direction.v);
    contact.point = Eigen::Map<const Eigen::Vector3d>(position.v);
    return true;
  }

 private:
  InflatedBody a_, b_;
  ccd_t ccd_;
};

/// Lowers `skin`, at which the bodies overlap, until they barely overlap; `contact` is MPR's result there.
///
/// MPR's depth is at least the true one, 2 skin - d: subtracting half of it may be too much, but not by far.
bool shrink_to_contact(Mpr& mpr, double tolerance, double& skin, Contact& contact) {
  double apart = 0;  // a skin with which the bodies are apart
  for (int i = 0; i < kMaxInflations; ++i) {
    if (contact.depth <= tolerance || skin - apart <= 0.5 * tolerance) return true;
    double next = skin - 0.5 * contact.depth + 0.25 * tolerance;
    if (!(next > apart)) next = 0.5 * (apart + skin);
    Contact at_next;
    if (mpr.overlap(next, at_next)) {
      skin = next;
      contact = at_next;
    } else {
      apart = next;
    }
  }
  return false;
}

}  // namespace

WitnessPair ccd_seed(const SupportBody& a, const SupportBody& b) {
  WitnessPair seed;
  const double unit = std::min(a.inscribed_radius(), b.inscribed_radius());
  const double centres = (b.pose().position() - a.pose().position()).norm();
  if (!(centres > 1e-12 * unit)) return seed;
  Mpr mpr(a, b, unit);
  Contact contact;
  if (mpr.overlap(0, contact)) {
    seed.point_a = a.pose().position() + a.support_W(contact.normal);
    seed.point_b = b.pose().position() + b.support_W(-contact.normal);
    seed.status = SeedStatus::usable;
    return seed;
  }
  // Inflated by this radius the inscribed spheres overlap.
  double skin = std::max(0.0, 0.5 * (centres - a.inscribed_radius() - b.inscribed_radius())) + unit * kContactDepth;
  if (!mpr.overlap(skin, contact) || !shrink_to_contact(mpr, kContactDepth * unit, skin, contact)) return seed;
  const double back = skin - 0.5 * contact.depth;
  seed.point_a = a.pose().position() + contact.point - back * contact.normal;
  seed.point_b = a.pose().position() + contact.point + back * contact.normal;
  seed.status = SeedStatus::usable;
  return seed;
}

}  // namespace kernel

WitnessPair ccd_seed(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return kernel::with_bodies(a, b, [&](const auto& s, const auto& t) { return ccd_seed(s, X_WA, t, X_WB); });
}

}  // namespace geom
