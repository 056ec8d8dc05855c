#pragma once

/// @file
/// Shapes of bodies in motion: libgeom's, and a user's own.

#include <ed/export.h>

#include <geom/distance.h>
#include <geom/kernel/core.h>
#include <geom/pose.h>
#include <geom/shape.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace ed {

class CustomShape;

/// Shape of a body in a simulation: one of libgeom's, or a user's own.
using BodyShape = geom::AnyShape<CustomShape>;

/// Distance of a user's shape from another shape by the user's own method, a closed form for instance, in place of
/// libgeom's search on support functions. A is the user's shape at X_WA, B is `other` at X_WB; nullopt: the method does
/// not know this pair, and libgeom's answers. The options may be ignored; for overlapping bodies a local penetration
/// (geom::Penetration::local) suffices.
///
/// The answer must keep the contract of geom::DistanceResult: status, distance, unit normal from A to B, both points in
/// the world's axes, and an error bound that is true: contacts are certified with it. It must depend on its arguments
/// alone, so that runs repeat.
using PairDistance = std::function<std::optional<geom::DistanceResult>(
    const geom::Pose& X_WA, const BodyShape& other, const geom::Pose& X_WB, const geom::DistanceOptions& options)>;

/// User-defined convex body: any type that models geom::SupportShape, with the properties that dynamics needs beside
/// its surface. It is itself a SupportShape. Copies share the shape.
class ED_EXPORT CustomShape {
 public:
  /// Properties that cannot be taken from a support function.
  struct Properties {
    std::string name = "custom";       ///< name in messages
    double volume = 0;                 ///< > 0
    std::optional<int> symmetry_axis;  ///< body axis (0, 1, 2) about which the body is one of revolution, if any
    bool centrally_symmetric = false;  ///< -x is in the body for every x in it, which makes the paper's boxes tighter
    PairDistance pair_distance = {};   ///< the user's own distance from other shapes; empty: libgeom's
  };

  /// Constructs the body. Throws std::invalid_argument unless the radii are positive, finite and in order, the volume
  /// is between those of the inscribed and the bounding sphere, and the support function agrees with both radii along
  /// the axes.
  template <geom::SupportShape T>
  CustomShape(T shape, Properties properties)
      : shape_(std::make_shared<const Model<T>>(std::move(shape))), properties_(std::move(properties)) {
    check();
  }

  /// Forwards to the user's shape.
  /// @{
  geom::Support support(const Eigen::Vector3d& n) const { return shape_->support(n); }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const { return shape_->support_hessian(n); }
  double bounding_radius() const { return bounding_radius_; }
  double inscribed_radius() const { return inscribed_radius_; }
  double min_curvature_radius() const { return min_curvature_radius_; }  ///< 0 if the user's type does not provide it
  double volume() const { return properties_.volume; }
  const std::string& name() const { return properties_.name; }
  std::optional<int> symmetry_axis() const { return properties_.symmetry_axis; }
  bool centrally_symmetric() const { return properties_.centrally_symmetric; }
  const PairDistance& pair_distance() const { return properties_.pair_distance; }
  const std::string& description() const { return name(); }
  /// @}

  /// Returns the core of the user's shape if that is a geom::CoreShape, which this must outlive.
  std::optional<geom::kernel::CoreView> core() const { return shape_->core(); }

  /// Returns the user's shape if it is a T, else nullptr.
  template <class T>
  const T* target() const {
    const auto* model = dynamic_cast<const Model<T>*>(shape_.get());
    return model == nullptr ? nullptr : &model->shape;
  }

 private:
  struct Concept {
    virtual ~Concept() = default;
    virtual geom::Support support(const Eigen::Vector3d& n) const = 0;
    virtual Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const = 0;
    virtual double bounding_radius() const = 0;
    virtual double inscribed_radius() const = 0;
    virtual double min_curvature_radius() const = 0;
    virtual std::optional<geom::kernel::CoreView> core() const = 0;
  };
  template <class T>
  struct Model final : Concept {
    explicit Model(T s) : shape(std::move(s)) {}
    geom::Support support(const Eigen::Vector3d& n) const override { return shape.support(n); }
    Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const override { return shape.support_hessian(n); }
    double bounding_radius() const override { return shape.bounding_radius(); }
    double inscribed_radius() const override { return shape.inscribed_radius(); }
    double min_curvature_radius() const override {
      if constexpr (requires { shape.min_curvature_radius(); }) return shape.min_curvature_radius();
      return 0;
    }
    std::optional<geom::kernel::CoreView> core() const override {
      if constexpr (geom::CoreShape<T>) return shape.core();
      return std::nullopt;
    }
    T shape;
  };

  void check();

  std::shared_ptr<const Concept> shape_;
  Properties properties_;
  double bounding_radius_ = 0;
  double inscribed_radius_ = 0;
  double min_curvature_radius_ = 0;
};

/// Forwards to the member function of the shape inside, where it is documented.
/// @{
ED_EXPORT double bounding_radius(const BodyShape& shape);
ED_EXPORT double inscribed_radius(const BodyShape& shape);
/// Returns whether the shape is exactly a sphere, so that no rotation changes the space it fills.
ED_EXPORT bool is_sphere(const BodyShape& shape);
ED_EXPORT double volume(const BodyShape& shape);
ED_EXPORT geom::Support support(const BodyShape& shape, const Eigen::Vector3d& n);
/// @}

/// Returns the body axis (0, 1, 2) about which the shape is one of revolution: 2 if it is so about all; nullopt if
/// about none.
ED_EXPORT std::optional<int> symmetry_axis(const BodyShape& shape);

/// Returns whether the shape is an ellipsoid of revolution, spheres included.
ED_EXPORT bool is_spheroid(const BodyShape& shape);

/// Returns half the edges of the smallest box around the body along its own axes.
ED_EXPORT Eigen::Vector3d half_extents(const BodyShape& shape);

/// Returns the distance of the shapes inside: by the PairDistance of a user's shape where it knows the pair (that of A
/// is asked first), else geom::distance.
ED_EXPORT geom::DistanceResult distance(const BodyShape& a, const geom::Pose& X_WA, const BodyShape& b,
                                        const geom::Pose& X_WB, const geom::DistanceOptions& options = {});

/// Describes the shape in words, for messages: "ellipsoid of semi-axes 1 x 1 x 3".
ED_EXPORT std::string describe(const BodyShape& shape);

}  // namespace ed
