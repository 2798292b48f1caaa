#include "param/congruence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "param/sphere_optimizer.hpp"
#include "param/sphere_orientation.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// A mesh that moves on the sphere, with its vertices in the space of both meshes.
struct Layer {
  const TriangleMesh& mesh;
  const std::vector<int>& pinned;
  MatrixX3d X;  ///< on the sphere
  MatrixX3d V;  ///< in space
};

Eigen::Matrix3d corners(const MatrixX3d& M, const TriangleMesh& mesh, int face) {
  return M(mesh.F.row(face), Eigen::all);
}

/// Where the vertices of a layer are on another one, in space, with its normals there.
struct Images {
  MatrixX3d place, normal;
};

Images images(const Layer& layer, const Layer& other) {
  const MeshLift lift(other.mesh, other.X);
  const Eigen::Index count = layer.X.rows();
  Images found{MatrixX3d(count, 3), MatrixX3d(count, 3)};
  int face = 0;
  for (Eigen::Index v = 0; v < count; ++v) {
    const SurfacePoint p = lift.surface_point(layer.X.row(v).transpose(), face);
    const Eigen::Matrix3d y = corners(other.V, other.mesh, p.face);
    found.place.row(v) = p.bary.transpose() * y;
    found.normal.row(v) = (y.row(1) - y.row(0)).cross(y.row(2) - y.row(0)).normalized();
  }
  return found;
}

Eigen::VectorXd distances(const Layer& layer, const Layer& other) {
  return (layer.V - images(layer, other).place).rowwise().norm();
}

double median(Eigen::VectorXd values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void align_with_images(const Images& images, MatrixX3d& V) {
  const Eigen::Matrix4d S = Eigen::umeyama(V.transpose(), images.place.transpose(), true);
  V = (V * S.topLeftCorner<3, 3>().transpose()).rowwise() + S.topRightCorner<3, 1>().transpose();
}

/// Moves the points V by the similarity that is best, to first order, for their distances to the
/// tangent planes at their images.
void align_with_planes(const Images& images, MatrixX3d& V) {
  constexpr double kAlong = 1e-3;  // weight of distances along the planes, for round surfaces
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  const Eigen::RowVector3d middle = V.colwise().mean();
  Eigen::Matrix<double, 7, 7> H = Eigen::Matrix<double, 7, 7>::Zero();
  Vector7 g = Vector7::Zero();
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    const Vector3d x = (V.row(v) - middle).transpose(), n = images.normal.row(v);
    Eigen::Matrix<double, 3, 7> J;  // by rotation vector, translation, logarithm of the scale
    for (int k = 0; k < 3; ++k) J.col(k) = Vector3d::Unit(k).cross(x);
    J.block<3, 3>(0, 3) = Eigen::Matrix3d::Identity();
    J.col(6) = x;
    const Eigen::Matrix3d W = n * n.transpose() + kAlong * Eigen::Matrix3d::Identity();
    H += J.transpose() * W * J;
    g += J.transpose() * W * (V.row(v) - images.place.row(v)).transpose();
  }
  const Vector7 step = -H.ldlt().solve(g);
  const double angle = step.head<3>().norm();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (angle > 0) R = Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix();
  V = (std::exp(step[6]) * (V.rowwise() - middle) * R.transpose()).rowwise() +
      (middle + step.segment<3>(3).transpose());
}

/// Slides the vertices of a layer towards the nearest places of the other one.
void draw_near(Layer& layer, const Layer& other) {
  constexpr double kWeight = 1e6;  // a slip of a thousandth costs as much as an energy of 1
  const Eigen::MatrixXd here = layer.V, there = other.V;
  const MeshLift lift(other.mesh, other.X, &there);
  SphereProblem problem = make_sphere_problem(layer.mesh.F, layer.mesh.V, layer.pinned);
  problem.fields = &here;
  problem.field_weight = kWeight;
  std::vector<int> hint(at(layer.mesh.vertex_count()), 0);
  optimize_on_sphere(problem,
                     lift,
                     {.max_iterations = 30, .relative_decrease = 1e-6, .barrier = 1e-6},
                     layer.X,
                     hint);
}

/// Barycentric coordinates of the point of a triangle (corners in the rows) that is nearest to p.
Vector3d nearest_in_triangle(const Vector3d& p, const Eigen::Matrix3d& triangle) {
  const Vector3d origin = triangle.row(0);
  Eigen::Matrix<double, 3, 2> E;
  E << triangle.row(1).transpose() - origin, triangle.row(2).transpose() - origin;
  const Vector2d c = (E.transpose() * E).ldlt().solve(E.transpose() * (p - origin));
  const Vector3d inside(1 - c.sum(), c[0], c[1]);
  if (inside.minCoeff() >= 0) return inside;
  Vector3d best = Vector3d::UnitX();
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vector3d from = triangle.row(k), side = triangle.row((k + 1) % 3).transpose() - from;
    const double t =
        std::clamp(side.dot(p - from) / std::max(side.squaredNorm(), 1e-300), 0.0, 1.0);
    const double distance = (from + t * side - p).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best.setZero();
    best[k] = 1 - t;
    best[(k + 1) % 3] = t;
  }
  return best;
}

/// The faces that share a vertex with `face`, and so on, `rings` times.
std::set<int> faces_around(const TriangleMesh& mesh, int face, int rings) {
  std::set<int> found{face};
  for (int ring = 0; ring < rings; ++ring)
    for (const int f : std::vector<int>(found.begin(), found.end()))
      for (int k = 0; k < 3; ++k)
        for_each_outgoing(mesh, mesh.F(f, k), [&](int h) { found.insert(face_of(h)); });
  return found;
}

bool is_upright_around(const TriangleMesh& mesh, const MatrixX3d& X, int v) {
  bool upright = true;
  for_each_outgoing(mesh, v, [&](int h) {
    const Eigen::Matrix3d x = corners(X, mesh, face_of(h));
    upright = upright && sphere_orientation(
                             x.row(0).transpose(), x.row(1).transpose(), x.row(2).transpose()) > 0;
  });
  return upright;
}

/// Puts every vertex at the nearest place of the other layer's faces around it at once, unless a
/// face turned over by that.
void leap(Layer& layer, const Layer& other) {
  constexpr double kThere = 1e-8;
  constexpr int kRings = 3;
  const MeshLift lift(other.mesh, other.X);
  std::vector<bool> held(at(layer.mesh.vertex_count()), false);
  for (const int v : layer.pinned) held[at(v)] = true;
  int face = 0;
  for (int v = 0; v < layer.mesh.vertex_count(); ++v) {
    if (held[at(v)]) continue;
    const Vector3d p = layer.V.row(v);
    SurfacePoint best = lift.surface_point(layer.X.row(v).transpose(), face);
    const auto distance = [&](const SurfacePoint& q) {
      return (corners(other.V, other.mesh, q.face).transpose() * q.bary - p).norm();
    };
    double least = distance(best);
    if (least < kThere) continue;
    for (const int f : faces_around(other.mesh, best.face, kRings)) {
      const SurfacePoint q{f, nearest_in_triangle(p, corners(other.V, other.mesh, f))};
      if (const double d = distance(q); d < least) {
        least = d;
        best = q;
      }
    }
    const Eigen::RowVector3d before = layer.X.row(v);
    layer.X.row(v) =
        (corners(other.X, other.mesh, best.face).transpose() * best.bary).normalized().transpose();
    if (!is_upright_around(layer.mesh, layer.X, v)) layer.X.row(v) = before;
  }
}

}  // namespace

bool make_congruent(const MovingMesh& a, const MovingMesh& b) {
  constexpr double kOnSurface = 1e-5;  // of files with six digits
  constexpr double kPromising = 1e-3;  // half of the vertices of one surface are closer by then
  constexpr int kRounds = 8, kAlignments = 3;
  Layer source{a.mesh, a.pinned, a.X, a.mesh.V}, target{b.mesh, b.pinned, b.X, b.mesh.V};
  align_with_images(images(source, target), source.V);
  for (int round = 0; round < kRounds; ++round) {
    for (int i = 0; i < kAlignments; ++i) align_with_planes(images(source, target), source.V);
    for (int i = 0; i < 2; ++i) {
      leap(source, target);
      leap(target, source);
    }
    const Eigen::VectorXd there = distances(source, target), back = distances(target, source);
    if (std::max(there.maxCoeff(), back.maxCoeff()) <= kOnSurface) {
      a.X = source.X;
      b.X = target.X;
      return true;
    }
    if (std::max(median(there), median(back)) > kPromising) return false;
    draw_near(source, target);
    draw_near(target, source);
  }
  return false;
}

}  // namespace crosspatch
