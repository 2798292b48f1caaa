// Tutte 1963, "How to draw a graph"; Floater 2003, "Mean value coordinates" and "One-to-one
// piecewise linear mappings over triangulations": positive weights that need not be symmetric
// embed a disc over a convex polygon.
#include "param/tutte.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <Eigen/UmfPackSupport>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/blas.hpp"
#include "core/index.hpp"
#include "param/predicates.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Triplets = std::vector<Eigen::Triplet<double>>;

Status check_disc(const TriangleMesh& disc, const std::vector<int>& loop) {
  if (euler_characteristic(disc) != 1)
    return fail(ErrorCode::kBadInput,
                fmt::format("disc: Euler characteristic is {}, not 1", euler_characteristic(disc)));
  size_t boundary = 0;
  for (int h = 0; h < disc.halfedge_count(); ++h) boundary += disc.twin[idx(h)] < 0 ? 1U : 0U;
  if (boundary != loop.size())
    return fail(
        ErrorCode::kBadInput,
        fmt::format(
            "disc: {} boundary edges, but the loop has {} vertices", boundary, loop.size()));
  for (size_t i = 0; i < loop.size(); ++i) {
    const int u = loop[i], v = loop[(i + 1) % loop.size()];
    if (u < 0 || u >= disc.vertex_count())
      return fail(ErrorCode::kBadInput, fmt::format("disc: no boundary vertex {}", u));
    const int h = disc.out[idx(u)];
    if (disc.twin[idx(h)] >= 0 || disc.to(h) != v)
      return fail(ErrorCode::kBadInput,
                  fmt::format("disc: ({}, {}) is no boundary edge, surface on the left", u, v));
  }
  return {};
}

Status check_polygon(const MatrixX2d& positions, size_t count) {
  if (static_cast<size_t>(positions.rows()) != count || count < 3)
    return fail(
        ErrorCode::kBadInput,
        fmt::format("polygon: {} corners for {} boundary vertices", positions.rows(), count));
  const Eigen::Index n = positions.rows();
  double turning = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector2d a = positions.row(i), b = positions.row((i + 1) % n);
    const Vector2d c = positions.row((i + 2) % n);
    const Vector2d d = b - a, e = c - b;
    // Points placed along a slanted straight side are collinear up to rounding only.
    const double cross = d.x() * e.y() - d.y() * e.x();
    if (!positions.row(i).allFinite() || d.norm() == 0 || cross < -1e-9 * d.norm() * e.norm())
      return fail(ErrorCode::kBadInput,
                  fmt::format("polygon: not convex at corner {}", (i + 1) % n));
    turning += std::atan2(cross, d.dot(e));
  }
  if (std::abs(turning - 2 * EIGEN_PI) > 1e-3)
    return fail(ErrorCode::kBadInput,
                fmt::format("polygon: turns by {} radians, not once", turning));
  return {};
}

/// tan(angle / 2) at the corner between the edge vectors a and b.
double half_angle_tangent(const Vector3d& a, const Vector3d& b) {
  const double cross = a.cross(b).norm(), lengths = a.norm() * b.norm();
  return a.dot(b) > 0 ? cross / (lengths + a.dot(b)) : (lengths - a.dot(b)) / cross;
}

/// Mean-value weight w(h) of the vertex to(h) as seen from from(h), per half-edge; on a boundary
/// edge only one of its two triangles counts.
std::vector<double> mean_value_weights(const TriangleMesh& mesh) {
  std::vector<double> w(idx(mesh.halfedge_count()), 0.0);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const Vector3d apex = mesh.position(mesh.from(h));
    const Vector3d a = mesh.position(mesh.to(h)) - apex, b = mesh.position(mesh.tip(h)) - apex;
    const double t = half_angle_tangent(a, b);
    w[idx(h)] += t / a.norm();
    if (const int g = mesh.twin[idx(prev(h))]; g >= 0) w[idx(g)] += t / b.norm();
  }
  return w;
}

/// Weights per half-edge, all positive and, around each vertex, within four orders of magnitude:
/// longer ratios give means that rounding cannot tell from a neighbour. Vertices with a degenerate
/// triangle fall back to uniform weights of the same size.
std::vector<double> positive_weights(const TriangleMesh& mesh, TutteWeights kind) {
  if (kind == TutteWeights::kUniform) return std::vector<double>(idx(mesh.halfedge_count()), 1.0);
  constexpr double kSmallestRatio = 1e-4;
  std::vector<double> w = mean_value_weights(mesh);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    double largest = 0;
    bool usable = true;
    for_each_outgoing(mesh, v, [&](int h) {
      usable = usable && std::isfinite(w[idx(h)]);
      largest = std::max(largest, w[idx(h)]);
    });
    usable = usable && largest > 0 && std::isfinite(1 / largest);
    // Scaling a vertex's weights changes nothing for itself; it lets weights of both ends be added.
    for_each_outgoing(mesh, v, [&](int h) {
      w[idx(h)] = usable ? std::max(w[idx(h)] / largest, kSmallestRatio) : 1.0;
    });
  }
  return w;
}

/// Weakens edges where the image is too small, so that the next one gives that part more room:
/// weights are divided by the stretch of both ends (Yoshizawa, Belyaev & Seidel 2004, "A fast and
/// simple stretch-minimizing mesh parameterization"; they divide by that of the neighbour, the
/// other factor keeps symmetry and drops out of each mean).
void even_out(const TriangleMesh& disc, const MatrixX2d& uv, std::vector<double>& w) {
  Eigen::VectorXd surface = Eigen::VectorXd::Zero(disc.vertex_count()), image = surface;
  const Eigen::VectorXd areas = face_areas(disc);
  for (int f = 0; f < disc.face_count(); ++f) {
    const Vector2d a = uv.row(disc.F(f, 0)), b = uv.row(disc.F(f, 1)), c = uv.row(disc.F(f, 2));
    const Vector2d d = b - a, e = c - a;
    for (int k = 0; k < 3; ++k) {
      surface[disc.F(f, k)] += areas[f];
      image[disc.F(f, k)] += std::abs(d.x() * e.y() - d.y() * e.x()) / 2;
    }
  }
  const double scale = image.sum() / surface.sum();
  // Where the image has collapsed into rounding, its areas are noise: the part that is resolved
  // grows from round to round.
  constexpr double kMost = 1e6;
  const auto stretch = [&](int v) {
    const double ratio = scale * surface[v] / std::max(image[v], 1e-300);
    return std::clamp(std::sqrt(ratio), 1 / kMost, kMost);
  };
  for (int h = 0; h < disc.halfedge_count(); ++h)
    w[idx(h)] /= stretch(disc.from(h)) * stretch(disc.to(h));
}

struct InnerSystem {
  SparseMatrix matrix;   ///< #inner x #inner
  Eigen::MatrixX2d rhs;  ///< #inner x 2
  std::vector<int> row;  ///< per vertex, -1 on the boundary
};

InnerSystem inner_system(const TriangleMesh& disc,
                         const std::vector<double>& w,
                         const MatrixX2d& uv,
                         const std::vector<bool>& fixed,
                         bool symmetric) {
  InnerSystem s;
  s.row.assign(idx(disc.vertex_count()), -1);
  int n = 0;
  for (int v = 0; v < disc.vertex_count(); ++v)
    if (!fixed[idx(v)]) s.row[idx(v)] = n++;
  s.rhs = Eigen::MatrixX2d::Zero(n, 2);
  Triplets entries;
  entries.reserve(idx(disc.halfedge_count() + n));
  for (int v = 0; v < disc.vertex_count(); ++v) {
    const int i = s.row[idx(v)];
    if (i < 0) continue;
    double sum = 0;
    for_each_outgoing(disc, v, [&](int h) {
      const int u = disc.to(h), j = s.row[idx(u)];
      const double weight = symmetric ? w[idx(h)] + w[idx(disc.twin[idx(h)])] : w[idx(h)];
      sum += weight;
      if (j >= 0)
        entries.emplace_back(i, j, -weight);
      else
        s.rhs.row(i) += weight * uv.row(u);
    });
    entries.emplace_back(i, i, sum);
  }
  s.matrix.resize(n, n);
  s.matrix.setFromTriplets(entries.begin(), entries.end());
  return s;
}

/// Solves for the inner vertices and writes them into `uv`; false where the factorization fails.
bool solve_inner(const InnerSystem& s, bool symmetric, MatrixX2d& uv) {
  Eigen::MatrixX2d x;
  if (symmetric) {
    const Eigen::SimplicialLDLT<SparseMatrix> solver(s.matrix);
    if (solver.info() != Eigen::Success) return false;
    x = solver.solve(s.rhs);
  } else {
    const SingleThreadedBlas blas;
    const Eigen::UmfPackLU<SparseMatrix> solver(s.matrix);
    if (solver.info() != Eigen::Success) return false;
    x = solver.solve(s.rhs);
  }
  if (!x.allFinite()) return false;
  for (size_t v = 0; v < s.row.size(); ++v)
    if (s.row[v] >= 0) uv.row(static_cast<Eigen::Index>(v)) = x.row(s.row[v]);
  return true;
}

std::string describe_folds(const TriangleMesh& disc,
                           const MatrixX2d& uv,
                           const std::vector<int>& bad) {
  double worst = 1;
  int face = bad.front();
  for (const int f : bad) {
    const Vector2d a = uv.row(disc.F(f, 0)), b = uv.row(disc.F(f, 1)), c = uv.row(disc.F(f, 2));
    const Vector2d d = b - a, e = c - a;
    const double area = (d.x() * e.y() - d.y() * e.x()) / 2;
    if (area < worst) {
      worst = area;
      face = f;
    }
  }
  return fmt::format(
      "disc: {} of {} triangles are not positive in the plane; worst is {} with area {}",
      bad.size(),
      disc.face_count(),
      face,
      worst);
}

}  // namespace

std::vector<int> folded_faces(const TriangleMesh& mesh, const MatrixX2d& uv) {
  std::vector<int> bad;
  for (int f = 0; f < mesh.face_count(); ++f)
    if (orient2d(uv.row(mesh.F(f, 0)), uv.row(mesh.F(f, 1)), uv.row(mesh.F(f, 2))) <= 0)
      bad.push_back(f);
  return bad;
}

Result<MatrixX2d> tutte_embedding(const TriangleMesh& disc,
                                  const std::vector<int>& boundary_loop,
                                  const MatrixX2d& boundary_positions,
                                  const TutteOptions& options) {
  if (Status s = check_disc(disc, boundary_loop); !s) return tl::unexpected(s.error());
  if (Status s = check_polygon(boundary_positions, boundary_loop.size()); !s)
    return tl::unexpected(s.error());
  MatrixX2d uv = MatrixX2d::Zero(disc.vertex_count(), 2);
  std::vector<bool> fixed(idx(disc.vertex_count()), false);
  for (size_t i = 0; i < boundary_loop.size(); ++i) {
    fixed[idx(boundary_loop[i])] = true;
    uv.row(boundary_loop[i]) = boundary_positions.row(static_cast<Eigen::Index>(i));
  }
  std::string why = "disc: factorization failed";
  for (const TutteWeights kind : {options.weights, TutteWeights::kUniform}) {
    const bool symmetric = kind != TutteWeights::kMeanValue;
    std::vector<double> w = positive_weights(disc, kind);
    constexpr int kMostRounds = 30, kPatience = 3;
    size_t fewest = idx(disc.face_count()) + 1;
    std::optional<MatrixX2d> good;
    int evened = 0;
    for (int round = 0, idle = 0; round <= kMostRounds && idle < kPatience; ++round, ++idle) {
      const InnerSystem system = inner_system(disc, w, uv, fixed, symmetric);
      if (system.matrix.rows() > 0 && !solve_inner(system, symmetric, uv)) break;
      const std::vector<int> bad = folded_faces(disc, uv);
      if (bad.empty()) {
        good = uv;
        if (evened++ >= options.evening_rounds) break;
      } else if (good) {
        break;
      } else {
        why = describe_folds(disc, uv, bad);
      }
      if (bad.size() < fewest || good) idle = 0;
      fewest = std::min(fewest, bad.size());
      even_out(disc, uv, w);
    }
    if (good) return *good;
  }
  return fail(ErrorCode::kNumerical, why);
}

SplitMesh split_chords(const TriangleMesh& mesh) {
  std::vector<bool> on_boundary(idx(mesh.vertex_count()), false);
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin[idx(h)] < 0) on_boundary[idx(mesh.from(h))] = true;
  SplitMesh r;
  std::vector<int> middle(idx(mesh.halfedge_count()), -1);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const int g = mesh.twin[idx(h)];
    if (g < h || !on_boundary[idx(mesh.from(h))] || !on_boundary[idx(mesh.to(h))]) continue;
    middle[idx(h)] = middle[idx(g)] = mesh.vertex_count() + static_cast<int>(r.parent_edge.size());
    r.parent_edge.push_back({mesh.from(h), mesh.to(h)});
  }
  std::vector<std::array<int, 3>> faces;
  const auto add = [&](int f, int a, int b, int c) {
    faces.push_back({a, b, c});
    r.parent_face.push_back(f);
  };
  for (int f = 0; f < mesh.face_count(); ++f) {
    // Turn the face so that an unsplit edge, if split and unsplit ones meet, comes last.
    const auto split = [&](int k) { return middle[idx(3 * f + k % 3)] >= 0; };
    const int count = int{split(0)} + int{split(1)} + int{split(2)};
    int k = 0;
    while (count > 0 && count < 3 && !(split(k) && !split(k + 2))) ++k;
    const int a = mesh.F(f, k % 3), b = mesh.F(f, (k + 1) % 3), c = mesh.F(f, (k + 2) % 3);
    const int ab = middle[idx(3 * f + k % 3)], bc = middle[idx(3 * f + (k + 1) % 3)];
    const int ca = middle[idx(3 * f + (k + 2) % 3)];
    if (count == 0) {
      add(f, a, b, c);
    } else if (count == 1) {
      add(f, a, ab, c);
      add(f, ab, b, c);
    } else if (count == 2) {
      add(f, ab, b, bc);
      add(f, a, ab, bc);
      add(f, a, bc, c);
    } else {
      add(f, a, ab, ca);
      add(f, ab, b, bc);
      add(f, ca, bc, c);
      add(f, ab, bc, ca);
    }
  }
  MatrixX3d V(mesh.vertex_count() + static_cast<int>(r.parent_edge.size()), 3);
  V.topRows(mesh.vertex_count()) = mesh.V;
  for (size_t i = 0; i < r.parent_edge.size(); ++i)
    V.row(mesh.vertex_count() + static_cast<int>(i)) =
        (mesh.V.row(r.parent_edge[i][0]) + mesh.V.row(r.parent_edge[i][1])) / 2;
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (size_t i = 0; i < faces.size(); ++i)
    F.row(static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
  r.mesh = make_mesh(std::move(V), std::move(F)).value();  // splitting keeps a manifold one
  return r;
}

}  // namespace crosspatch
