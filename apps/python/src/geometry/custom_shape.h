#pragma once

/// Convex bodies whose support functions are written in Python.

#include <ed/shape.h>
#include <geom/shape.h>

#include <nanobind/nanobind.h>

#include <Eigen/Core>

#include <memory>
#include <string>

namespace hardbody::python {

namespace nb = nanobind;

/// Convex body given by a Python object with `support(n)`, as CustomShape in Python documents. Models
/// geom::SupportShape. May be called without the GIL, which it acquires. Exceptions of the object's methods, and what
/// is wrong with their values, are thrown.
class PythonShape {
 public:
  /// Reads the radii. Throws TypeError unless the object has what a shape needs.
  PythonShape(nb::object object, std::string name, bool has_volume);

  geom::Support support(const Eigen::Vector3d& n) const;
  /// Returns the object's own, or central differences of its support points.
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const;
  double bounding_radius() const;
  double inscribed_radius() const;
  double min_curvature_radius() const;

  /// Returns the user's object. The caller holds the GIL.
  nb::object object() const;
  /// Returns whether the volume of the CustomShape is the body's: nothing but dynamics needs it.
  bool has_volume() const;

 private:
  struct Held;
  std::shared_ptr<const Held> held_;
};

/// Returns the user's object of a shape that is written in Python, with its properties; None for another shape.
const PythonShape* python_shape(const ed::BodyShape& shape);

/// Returns whether a value has a method `support` and so may be a user's shape.
bool is_custom_shape(nb::handle value);

/// Returns the shape of an object with `support(n)`.
ed::CustomShape custom_shape_of(nb::handle object);

/// Keeps Ctrl-C in methods of shapes, in this thread, during the object's lifetime, instead of throwing it there. A
/// function that must not be left at any place asks again at the next where it may be.
class KeptInterrupt {
 public:
  KeptInterrupt();
  ~KeptInterrupt();
  KeptInterrupt(const KeptInterrupt&) = delete;
  KeptInterrupt& operator=(const KeptInterrupt&) = delete;

  /// Returns whether there was one.
  bool happened() const { return happened_; }

 private:
  friend class PythonShape;
  bool happened_ = false;
  KeptInterrupt* outer_;
};

}  // namespace hardbody::python
