#pragma once

#include <random>
#include <string>
#include <vector>

#include "shapes.hpp"

namespace crosspatch::shapes {

/// A function on a mesh, with a name for messages.
struct Field {
  std::string name;
  TriangleMesh mesh;
  Eigen::VectorXd values;
};

/// Independent uniform values in [1, 2]: as many critical points as a mesh can have.
inline Eigen::VectorXd noise(const TriangleMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  Eigen::VectorXd values(mesh.vertex_count());
  for (double& value : values) value = 1 + static_cast<double>(random()) / 4294967296.0;
  return values;
}

/// Fields from calm to wild, on surfaces of genus 0 and 1 with and without boundary, with ties.
inline std::vector<Field> morse_fields() {
  std::vector<Field> fields;
  for (const auto& [name, mesh] : {std::pair{"tetrahedron", tetrahedron()},
                                   std::pair{"sphere", icosphere(3)},
                                   std::pair{"torus", torus(3, 1, 24, 12)},
                                   std::pair{"grid", grid(12)}}) {
    const std::string n = name;
    fields.push_back({n + " height", mesh, 5 + mesh.V.col(0).array()});
    fields.push_back({n + " flat", mesh, Eigen::VectorXd::Ones(mesh.vertex_count())});
    fields.push_back({n + " waves",
                      mesh,
                      3 + (4 * mesh.V.col(0).array()).sin() * (5 * mesh.V.col(1).array()).cos()});
    fields.push_back({n + " steps", mesh, 20 + (3 * mesh.V.col(0).array()).floor()});
    for (unsigned seed = 1; seed < 4; ++seed)
      fields.push_back({n + " noise " + std::to_string(seed), mesh, noise(mesh, seed)});
  }
  return fields;
}

/// chi of the surface with its boundary loops closed.
inline int closed_euler(const TriangleMesh& mesh) {
  return euler_characteristic(mesh) + static_cast<int>(boundary_loops(mesh).size());
}

}  // namespace crosspatch::shapes
