#include "oracle/cgal_hull.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <cstddef>
#include <iterator>
#include <vector>

namespace geom_test {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

CgalHull cgal_hull(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Kernel::Point_3> all;
  for (const Eigen::Vector3d& p : points) all.emplace_back(p.x(), p.y(), p.z());
  std::vector<Kernel::Point_3> extreme;
  CGAL::extreme_points_3(all, std::back_inserter(extreme));
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  CGAL::convex_hull_3(all.begin(), all.end(), mesh);
  Kernel::FT six_volumes = 0;
  for (const auto face : mesh.faces()) {
    std::vector<Kernel::Point_3> p;
    for (const auto vertex : CGAL::vertices_around_face(mesh.halfedge(face), mesh)) p.push_back(mesh.point(vertex));
    for (std::size_t k = 1; k + 1 < p.size(); ++k) {
      six_volumes += 6 * CGAL::volume(Kernel::Point_3(0, 0, 0), p[0], p[k], p[k + 1]);
    }
  }
  return {static_cast<int>(extreme.size()), CGAL::to_double(six_volumes) / 6};
}

}  // namespace geom_test
