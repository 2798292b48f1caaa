// Notation: a face of the moving mesh has corners X_k on the sphere; its point with barycentric
// coordinates b lies at y = sum b_k X_k, and in face g of the other mesh where the values
// v_m(b) = det(Y_m+1, Y_m+2, y), linear in b, are positive. They are g's barycentric coordinates up
// to a factor, so that a cell, the face clipped by them, is known on both surfaces.
#include "param/cell_relaxation.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/index.hpp"
#include "param/lift.hpp"
#include "param/ring_kernel.hpp"
#include "param/sphere_optimizer.hpp"
#include "param/sphere_orientation.hpp"
#include "param/vertex_colours.hpp"

namespace crosspatch {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Energy times weight, and weight.
struct Energy {
  double sum = 0, weight = 0;
};

/// A triangle clipped by three lines, barycentric in the moving face.
struct Cell {
  /// Six, if exact. Where rounding scatters the signs at the n corners of a flat one, a clip leaves
  /// up to n / 2 of them and n crossings: 3, 4, 6, 9.
  static constexpr int kMost = 9;
  std::array<Vector3d, kMost> corner;
  int size = 0;

  void add(const Vector3d& p) { corner[idx(size++)] = p; }
};

/// Space that is used again and again; one a thread.
struct Scratch {
  std::vector<int> seen;  ///< per face of the other mesh: number of the last visit
  int visit = 0;
  std::vector<int> waiting, met;  ///< faces of the other mesh: to be looked at, and under cells
  std::vector<std::pair<int, int>> ring;
};

class CellRelaxation {
 public:
  /// When a vertex last moved, in sweeps over one colour, per vertex of either mesh.
  using Times = std::vector<int>;

  CellRelaxation(const TriangleMesh& mesh,
                 const TriangleMesh& other,
                 const MatrixX3d& Y,
                 const std::vector<int>& pinned,
                 MatrixX3d& X)
      : mesh_(mesh),
        other_(other),
        Y_(Y),
        X_(X),
        lift_(other, Y),
        flat_(flatten(mesh)),
        other_flat_(flatten(other)),
        hint_(idx(mesh.vertex_count()), 0),
        tried_(idx(mesh.vertex_count()), -1),
        scratch_([&] {
          Scratch s;
          s.seen.assign(idx(other.face_count()), 0);
          return s;
        }) {
    std::vector<bool> is_free(idx(mesh.vertex_count()), true);
    for (const int v : pinned) is_free[idx(v)] = false;
    colours_ = vertex_colours(mesh.F, is_free);
    int face = 0;
    for (int v = 0; v < mesh.vertex_count(); ++v)
      hint_[idx(v)] = face = lift_.locate(X.row(v).transpose(), face);
  }

  /// Tries every vertex near which something has moved since its last try. Returns by how much
  /// their energies fall.
  double run(int& now, Times& moved, const Times& others_moved) {
    find_sides();
    for (int v = 0; v < mesh_.vertex_count(); ++v)
      hint_[idx(v)] = lift_.locate(X_.row(v).transpose(), hint_[idx(v)]);
    constexpr std::size_t kGrain = 8;
    double gained = 0;
    for (const std::vector<int>& colour : colours_) {
      ++now;
      std::vector<double> gain(colour.size());
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, colour.size(), kGrain),
                        [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                            const int v = colour[i];
                            const Move made = move(v, moved, others_moved, scratch_.local());
                            gain[i] = made.gain;
                            tried_[idx(v)] = now;
                            if (made.is_notable) moved[idx(v)] = now;
                          }
                        });
      gained = std::accumulate(gain.begin(), gain.end(), gained);
    }
    return gained;
  }

 private:
  using Corners = Eigen::Matrix<double, 2, 3>;

  /// Every face laid out in the plane, slivers thickened: exact ones outweigh all else, and what is
  /// around them is crumpled to straighten the images of their sides.
  static std::vector<Corners> flatten(const TriangleMesh& mesh) {
    std::vector<Corners> flat(idx(mesh.face_count()));
    for (int f = 0; f < mesh.face_count(); ++f) {
      const Vector3d a = mesh.position(mesh.F(f, 0));
      const Vector3d u = mesh.position(mesh.F(f, 1)) - a, v = mesh.position(mesh.F(f, 2)) - a;
      flat[idx(f)] << Vector2d::Zero(), thickened_sides(u, v);
    }
    return flat;
  }

  /// Of every face of the other mesh: the normals of the planes through its edges and the origin.
  void find_sides() {
    sides_.resize(idx(other_.face_count()));
    tbb::parallel_for(0, other_.face_count(), [&](int g) {
      for (int m = 0; m < 3; ++m) {
        const Vector3d a = Y_.row(other_.F(g, (m + 1) % 3)), b = Y_.row(other_.F(g, (m + 2) % 3));
        sides_[idx(g)].row(m) = a.cross(b - a).transpose();
      }
    });
  }

  struct Move {
    double gain = 0;          ///< by how much the energy falls
    bool is_notable = false;  ///< whether others should be tried again for it
  };

  Move move(int v, const Times& moved, const Times& others_moved, Scratch& scratch) {
    constexpr double kBound = 5;
    const Vector3d center = X_.row(v).transpose();
    scratch.met.clear();
    const Energy now = around(v, center, hint_[idx(v)], kInfinity, scratch);
    if (!(now.sum > kBound * now.weight) || !(now.sum < kInfinity)) return {};
    const int last = tried_[idx(v)];
    bool changed = moved[idx(v)] >= last;
    for_each_outgoing(
        mesh_, v, [&](int h) { changed = changed || moved[idx(mesh_.to(h))] > last; });
    for (std::size_t i = 0; i < scratch.met.size() && !changed; ++i)
      for (int k = 0; k < 3; ++k)
        changed = changed || others_moved[idx(other_.F(scratch.met[i], k))] > last;
    if (!changed) return {};
    scratch.ring.clear();
    for_each_outgoing(
        mesh_, v, [&](int h) { scratch.ring.emplace_back(mesh_.to(h), mesh_.to(next(h))); });
    const RingKernel kernel(X_, scratch.ring, center);
    if (kernel.corners().empty()) return {};
    constexpr double kWorthwhile = 1e-3;
    double best = now.sum;
    Vector2d place = Vector2d::Zero();
    const auto consider = [&](const Vector2d& p) {
      const Vector3d x = kernel.on_sphere(p);
      const int face = lift_.locate(x, hint_[idx(v)]);
      const double bound = best - kWorthwhile * now.sum;
      const double sum = around(v, x, face, bound, scratch).sum;
      if (!(sum < bound)) return false;
      best = sum;
      place = p;
      X_.row(v) = x.transpose();
      hint_[idx(v)] = face;
      return true;
    };
    constexpr double kCrumpled = 20;
    if (now.sum > kCrumpled * now.weight)
      search(kernel, place, consider);
    else
      newton_step(v, kernel, now.sum, consider, scratch);
    constexpr double kNotable = 1e-2;  // less costs more time than it is worth
    return {now.sum - best, now.sum - best > kNotable * now.sum};
  }

  /// A step to the minimum of the quadratic through the energies at v and five places around it.
  template <class Consider>
  void newton_step(
      int v, const RingKernel& kernel, double energy, const Consider& consider, Scratch& scratch) {
    // Into the kernel all around: a part of the way to its nearest side.
    double room = kInfinity;
    const std::vector<Vector2d>& corners = kernel.corners();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d p = corners[i], side = corners[(i + 1) % corners.size()] - p;
      room = std::min(room, std::abs(side[0] * p[1] - side[1] * p[0]) / side.norm());
    }
    constexpr double kStencil = 0.1;
    const double h = kStencil * room;
    const auto at_place = [&](double x, double y) {
      const Vector3d place = kernel.on_sphere(h * Vector2d(x, y));
      return around(v, place, lift_.locate(place, hint_[idx(v)]), kInfinity, scratch).sum;
    };
    const double e = at_place(1, 0), w = at_place(-1, 0), n = at_place(0, 1), s = at_place(0, -1),
                 ne = at_place(1, 1);
    const Vector2d g((e - w) / 2, (n - s) / 2);
    const double mixed = ne - e - n + energy;
    Eigen::Matrix2d H;
    H << e - 2 * energy + w, mixed, mixed, n - 2 * energy + s;
    if (!g.allFinite() || !H.allFinite()) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(H);
    const double least = 0.1 * eigen.eigenvalues().cwiseAbs().maxCoeff();
    const Vector2d curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(least);
    const Vector2d step =
        -h * (eigen.eigenvectors() *
              ((eigen.eigenvectors().transpose() * g).array() / curvature.array()).matrix());
    if (!step.allFinite()) return;
    constexpr int kHalvings = 3;
    double t = 1;
    for (int i = 0; i < kHalvings && !consider(t * step); ++i) t /= 2;
  }

  /// Towards the kernel's centroid and its corners, by shorter steps when no step of a length gains
  /// any more.
  template <class Consider>
  static void search(const RingKernel& kernel, const Vector2d& place, const Consider& consider) {
    consider(kernel.centroid());
    constexpr double kLongest = 0.6, kShortest = 0.05;
    constexpr int kMostSteps = 12;
    int steps = 0;
    for (double s = kLongest; s > kShortest && steps < kMostSteps;) {
      bool better = false;
      const Vector2d from = place;
      for (const Vector2d& corner : kernel.corners())
        better = consider(from + s * (corner - from)) || better;
      if (better)
        ++steps;
      else
        s /= 2;
    }
  }

  /// Energy of the faces around v, with v at x in `face` of the other mesh; infinite where one is
  /// turned over. Not summed to the end once it reaches `bound`.
  [[nodiscard]] Energy around(
      int v, const Vector3d& x, int face, double bound, Scratch& scratch) const {
    Energy energy;
    for_each_outgoing(mesh_, v, [&](int h) {
      if (energy.sum < bound) add_face(h / 3, v, x, face, bound, scratch, energy);
    });
    return energy;
  }

  void add_face(int f,
                int v,
                const Vector3d& x,
                int face,
                double bound,
                Scratch& scratch,
                Energy& energy) const {
    Eigen::Matrix3d corners;
    scratch.waiting.clear();
    ++scratch.visit;
    const auto visit = [&](int g) {
      if (g < 0 || scratch.seen[idx(g)] == scratch.visit) return;
      scratch.seen[idx(g)] = scratch.visit;
      scratch.waiting.push_back(g);
    };
    for (int k = 0; k < 3; ++k) {
      const int u = mesh_.F(f, k);
      corners.col(k) = u == v ? x : Vector3d(X_.row(u).transpose());
      visit(u == v ? face : hint_[idx(u)]);
    }
    if (!(sphere_orientation(corners.col(0), corners.col(1), corners.col(2)) > 0)) {
      energy.sum = kInfinity;
      return;
    }
    double covered = 0;
    for (std::size_t i = 0; i < scratch.waiting.size(); ++i) {
      const int g = scratch.waiting[i];
      Eigen::Matrix3d values;  // row m: v_m at the corners
      for (int m = 0; m < 3; ++m)
        values.row(m) =
            sides_[idx(g)].row(m) *
            (corners.colwise() - Vector3d(Y_.row(other_.F(g, (m + 1) % 3)).transpose()));
      if ((values.rowwise().maxCoeff().array() <= 0).any()) continue;
      const Cell cell = clip(values);
      const double share = area_share(cell);
      if (!(share > 0)) continue;
      covered += share;
      scratch.met.push_back(g);
      add_cell(f, g, values, cell, energy);
      if (!(energy.sum < bound)) return;
      for (int m = 0; m < 3; ++m)
        if (values.row(m).minCoeff() < 0) {
          const int twin = other_.twin[idx(3 * g + (m + 1) % 3)];
          if (twin >= 0) visit(twin / 3);
        }
    }
    constexpr double kMissing = 1e-6;
    if (std::abs(covered - 1) > kMissing) energy.sum = kInfinity;
  }

  /// Clips the face by the three values (Sutherland & Hodgman 1974).
  static Cell clip(const Eigen::Matrix3d& values) {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell.add(Vector3d::Unit(k));
    for (int m = 0; m < 3; ++m) {
      if (values.row(m).minCoeff() >= 0) continue;
      const Cell uncut = cell;
      cell.size = 0;
      std::array<double, Cell::kMost> value;
      for (int i = 0; i < uncut.size; ++i) value[idx(i)] = values.row(m) * uncut.corner[idx(i)];
      for (int i = 0; i < uncut.size; ++i) {
        const int next = i + 1 < uncut.size ? i + 1 : 0;
        const Vector3d &p = uncut.corner[idx(i)], &q = uncut.corner[idx(next)];
        const double a = value[idx(i)], b = value[idx(next)];
        if (a > 0) cell.add(p);
        if ((a > 0) != (b > 0)) cell.add(p + (q - p) * (a / (a - b)));
      }
      if (cell.size < 3) return {};
    }
    return cell;
  }

  /// Of the face's area.
  static double area_share(const Cell& cell) {
    double share = 0;
    for (int i = 1; i + 1 < cell.size; ++i)
      share += cell.corner[0].dot(cell.corner[idx(i)].cross(cell.corner[idx(i + 1)]));
    return share;
  }

  void add_cell(
      int f, int g, const Eigen::Matrix3d& values, const Cell& cell, Energy& energy) const {
    std::array<Vector2d, Cell::kMost> on_mesh, on_other;
    for (int i = 0; i < cell.size; ++i) {
      const Vector3d& b = cell.corner[idx(i)];
      on_mesh[idx(i)] = flat_[idx(f)] * b;
      const Vector3d c = (values * b).cwiseMax(0);
      on_other[idx(i)] = other_flat_[idx(g)] * (c / c.sum());
    }
    for (int i = 1; i + 1 < cell.size; ++i) {
      Eigen::Matrix2d E, G;
      E << on_mesh[idx(i)] - on_mesh[0], on_mesh[idx(i + 1)] - on_mesh[0];
      G << on_other[idx(i)] - on_other[0], on_other[idx(i + 1)] - on_other[0];
      constexpr double kNothing = 1e-16;  // as measure_map leaves out
      const double a = std::max(E.determinant(), kNothing), b = std::max(G.determinant(), kNothing);
      if (a == kNothing && b == kNothing) continue;
      Eigen::Matrix2d adjugate;
      adjugate << E(1, 1), -E(0, 1), -E(1, 0), E(0, 0);
      const double norm = (G * adjugate).squaredNorm() / (a * a);  // |J|^2
      const double weight = (a + b) / 4;
      energy.sum += weight * norm * (1 + (a * a) / (b * b));
      energy.weight += weight;
    }
  }

  const TriangleMesh& mesh_;
  const TriangleMesh& other_;
  const MatrixX3d& Y_;
  MatrixX3d& X_;
  MeshLift lift_;
  std::vector<Corners> flat_, other_flat_;
  std::vector<Eigen::Matrix3d> sides_;  ///< per face of the other mesh, see find_sides
  std::vector<int> hint_;               ///< per vertex: face of the other mesh that holds it
  std::vector<int> tried_;              ///< per vertex: when it was last tried
  std::vector<std::vector<int>> colours_;
  tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace

double relax_cells(const TriangleMesh& mesh,
                   const TriangleMesh& other,
                   const MatrixX3d& Y,
                   const std::vector<int>& pinned,
                   MatrixX3d& X) {
  CellRelaxation::Times moved(idx(mesh.vertex_count()), 0);
  int now = 0;
  return CellRelaxation(mesh, other, Y, pinned, X)
      .run(now, moved, CellRelaxation::Times(idx(other.vertex_count()), 0));
}

double relax_cells(const MovingMesh& a, const MovingMesh& b, int rounds, double worthwhile) {
  CellRelaxation of_a(a.mesh, b.mesh, b.X, a.pinned, a.X), of_b(b.mesh, a.mesh, a.X, b.pinned, b.X);
  CellRelaxation::Times a_moved(idx(a.mesh.vertex_count()), 0),
      b_moved(idx(b.mesh.vertex_count()), 0);
  double sum = 0, gain = worthwhile;
  int now = 0;
  for (int i = 0; i < rounds && gain >= worthwhile; ++i) {
    gain = of_a.run(now, a_moved, b_moved);
    gain += of_b.run(now, b_moved, a_moved);
    sum += gain;
  }
  return sum;
}

}  // namespace crosspatch
