#include "param/exact_isometry.hpp"

#include <algorithm>
#include <cmath>

#include "param/sphere_optimizer.hpp"
#include "param/sphere_orientation.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

double shortest_edge(const TriangleMesh& mesh, const MatrixX3d& X, int v) {
  double length = 2;  // no chord of the unit sphere is longer
  for_each_outgoing(
      mesh, v, [&](int h) { length = std::min(length, (X.row(v) - X.row(mesh.to(h))).norm()); });
  return length;
}

/// Moves the vertices that are not fixed downhill to an isometry onto the surface of `lift`.
void descend(const SphereProblem& problem, const MeshLift& lift, int iterations, MatrixX3d& X) {
  if (std::all_of(problem.fixed.begin(), problem.fixed.end(), [](bool fixed) { return fixed; }))
    return;
  std::vector<int> hint(problem.fixed.size(), 0);
  // The barrier would pull away from the isometry. Energies rise with the square of the distance
  // from it: what is left of them at the end is a distance of a millionth.
  const SphereOptimizerOptions options{
      .max_iterations = iterations, .relative_decrease = 1e-12, .barrier = 0};
  optimize_on_sphere(problem, lift, options, X, hint);
}

/// The largest difference between an edge's length and the distance between its ends' images.
double worst_stretch(const TriangleMesh& mesh, const MeshLift& lift, const MatrixX3d& X) {
  MatrixX3d Y(mesh.vertex_count(), 3);
  int face = 0;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    Y.row(v) = lift.point(X.row(v).transpose(), face).transpose();
  double worst = 0;
  for (int h = 0; h < 3 * mesh.face_count(); ++h) {
    const int a = mesh.from(h), b = mesh.to(h);
    worst = std::max(
        worst, std::abs((Y.row(a) - Y.row(b)).norm() - (mesh.V.row(a) - mesh.V.row(b)).norm()));
  }
  return worst;
}

bool is_isometry(const TriangleMesh& mesh, const MeshLift& lift, const MatrixX3d& X) {
  constexpr double kRounding = 1e-5;  // of files with six digits, and of the last step
  return worst_stretch(mesh, lift, X) <= kRounding;
}

bool is_upright(const TriangleMesh& mesh, const MatrixX3d& X) {
  return smallest_orientation(mesh.F, X) > 0;
}

/// Puts every vertex of `coarse` on the vertex of `fine` it all but meets, and returns those in the
/// order of `coarse`; none if one meets nothing, or a face has no area left.
std::vector<int> meet(const TriangleMesh& coarse,
                      const TriangleMesh& fine,
                      const MatrixX3d& Y,
                      MatrixX3d& X) {
  constexpr double kClose = 1e-2;  // of the shortest edge at the fine vertex
  const MeshLift lift(fine, Y);
  std::vector<int> met;
  int face = 0;
  for (int v = 0; v < coarse.vertex_count(); ++v) {
    face = lift.locate(X.row(v).transpose(), face);
    const auto distance = [&](int w) { return (Y.row(w) - X.row(v)).norm(); };
    const auto corner = fine.F.row(face);
    const int w = *std::min_element(
        corner.begin(), corner.end(), [&](int a, int b) { return distance(a) < distance(b); });
    if (distance(w) > kClose * shortest_edge(fine, Y, w)) return {};
    X.row(v) = Y.row(w);
    met.push_back(w);
  }
  return is_upright(coarse, X) ? met : std::vector<int>{};
}

/// Moves the vertices that lie on edges of `other` aside, by a length that no texture shows and
/// that still leaves areas beyond rounding to what is cut off there.
void step_off_edges(const std::vector<bool>& held,
                    const TriangleMesh& other,
                    const MatrixX3d& X,
                    MatrixX3d& Y) {
  constexpr double kAside = 1e-5;  // of the way to the middle of the face
  const MeshLift lift(other, X);
  int face = 0;
  for (int v = 0; v < Y.rows(); ++v) {
    if (held[at(v)]) continue;
    const Vector3d y = Y.row(v);
    const SurfacePoint p = lift.surface_point(y, face);
    if (p.bary.minCoeff() > kAside / 3) continue;
    const auto corner = other.F.row(p.face);
    const Vector3d middle = (X.row(corner[0]) + X.row(corner[1]) + X.row(corner[2])) / 3;
    Y.row(v) = (y + kAside * (middle - y)).normalized().transpose();
  }
}

}  // namespace

bool make_exact_isometry(const MovingMesh& coarse, const MovingMesh& fine, int iterations) {
  const TriangleMesh &a = coarse.mesh, &b = fine.mesh;
  MatrixX3d X = coarse.X, Y = fine.X;
  const MeshLift to_fine(b, Y), to_coarse(a, X);
  descend(make_sphere_problem(a.F, a.V, coarse.pinned), to_fine, iterations, X);
  std::vector<int> held = meet(a, b, Y, X);
  if (held.empty() || !is_isometry(a, to_fine, X)) return false;
  held.insert(held.end(), fine.pinned.begin(), fine.pinned.end());
  const SphereProblem rest = make_sphere_problem(b.F, b.V, held);
  descend(rest, to_coarse, iterations, Y);
  step_off_edges(rest.fixed, a, X, Y);
  if (!is_upright(b, Y) || !is_isometry(b, to_coarse, Y)) return false;
  coarse.X = X;
  fine.X = Y;
  return true;
}

}  // namespace crosspatch
