#include "param/untangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "param/sphere_orientation.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

/// Signed area of a spherical triangle (Van Oosterom & Strackee 1983).
double solid_angle(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  return 2 * std::atan2(x.dot((y - x).cross(z - x)), 1 + x.dot(y) + y.dot(z) + z.dot(x));
}

class Untangler {
 public:
  Untangler(const MatrixX3d& X, const std::vector<bool>& fixed, Refinement& level)
      : X_(X), fixed_(fixed), level_(level) {}

  bool run() {
    for (std::vector<int> waiting = turned_vertices(); !waiting.empty();
         waiting = turned_vertices()) {
      bool progress = false;
      for (int v : waiting) progress = collapse_best(v, 1) || progress;
      if (progress) continue;
      // Stuck: clear the neighbourhood, which leaves other rings to try.
      for (int v : waiting) {
        if (level_.faces(v).empty()) continue;
        for (int u : level_.neighbours(v)) progress = collapse_best(u, 0) || progress;
      }
      if (!progress) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] double orientation(int a, int b, int c) const {
    return sphere_orientation(X_.row(a).transpose(), X_.row(b).transpose(), X_.row(c).transpose());
  }

  [[nodiscard]] bool turned(int f) const {
    const auto row = level_.F().row(f);
    return !(orientation(row[0], row[1], row[2]) > 0);
  }

  [[nodiscard]] double solid_angle(int a, int b, int c) const {
    return crosspatch::solid_angle(
        X_.row(a).transpose(), X_.row(b).transpose(), X_.row(c).transpose());
  }

  /// Vertices of turned faces, those with most of them first.
  [[nodiscard]] std::vector<int> turned_vertices() const {
    std::vector<int> count(at(static_cast<int>(X_.rows())), 0), vertices;
    for (int f = 0; f < level_.F().rows(); ++f)
      if (level_.alive(f) && turned(f))
        for (int k = 0; k < 3; ++k)
          if (count[at(level_.F()(f, k))]++ == 0) vertices.push_back(level_.F()(f, k));
    std::sort(vertices.begin(), vertices.end(), [&](int a, int b) {
      return count[at(a)] != count[at(b)] ? count[at(a)] > count[at(b)] : a < b;
    });
    return vertices;
  }

  /// Collapses v where that removes at least `gain` turned faces; of these where fewest stay turned
  /// and, then, where the smallest orientation is largest.
  bool collapse_best(int v, int gain) {
    if (fixed_[at(v)] || level_.faces(v).empty()) return false;
    int before = 0;
    double covered = 0;
    for (int f : level_.faces(v)) {
      const auto row = level_.F().row(f);
      before += turned(f) ? 1 : 0;
      covered += solid_angle(row[0], row[1], row[2]);
    }
    int best = -1, fewest = before - gain + 1;
    double best_smallest = 0;
    for (int u : level_.neighbours(v)) {
      if (!level_.can_collapse(v, u)) continue;
      int after = 0;
      double smallest = std::numeric_limits<double>::infinity(), covered_after = 0;
      for (int f : level_.faces(v)) {
        auto row = level_.F().row(f).eval();
        if (row[0] == u || row[1] == u || row[2] == u) continue;
        for (int k = 0; k < 3; ++k)
          if (row[k] == v) row[k] = u;
        const double o = orientation(row[0], row[1], row[2]);
        after += o > 0 ? 0 : 1;
        smallest = std::min(smallest, o);
        covered_after += solid_angle(row[0], row[1], row[2]);
      }
      // Two fillings of one ring differ by whole spheres: the degree of the map must stay 1.
      if (std::abs(covered_after - covered) > 1) continue;
      if (after < fewest || (after == fewest && best >= 0 && smallest > best_smallest)) {
        fewest = after;
        best = u;
        best_smallest = smallest;
      }
    }
    if (best < 0) return false;
    level_.collapse(v, best);
    return true;
  }

  const MatrixX3d& X_;
  const std::vector<bool>& fixed_;
  Refinement& level_;
};

}  // namespace

int turned_faces(const MatrixX3i& F, const MatrixX3d& X) {
  int count = 0;
  for (int f = 0; f < F.rows(); ++f) {
    const double det = sphere_orientation(
        X.row(F(f, 0)).transpose(), X.row(F(f, 1)).transpose(), X.row(F(f, 2)).transpose());
    count += det > 0 ? 0 : 1;
  }
  return count;
}

double covered_area(const MatrixX3i& F, const MatrixX3d& X) {
  double covered = 0;
  for (int f = 0; f < F.rows(); ++f)
    covered += solid_angle(
        X.row(F(f, 0)).transpose(), X.row(F(f, 1)).transpose(), X.row(F(f, 2)).transpose());
  return covered;
}

int degree(const MatrixX3i& F, const MatrixX3d& X) {
  return static_cast<int>(std::lround(covered_area(F, X) / (4 * std::numbers::pi)));
}

bool collapse_turned_faces(const MatrixX3d& X, const std::vector<bool>& fixed, Refinement& level) {
  return Untangler(X, fixed, level).run();
}

}  // namespace crosspatch
