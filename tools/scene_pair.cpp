#include "tools/scene_pair.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "tools/palette.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(Eigen::Index i) {
  return static_cast<size_t>(i);
}

constexpr int kCheckerCells = 16;  // along the target's longest side: cells stay visible in a panel

struct Box {
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::RowVector3d high = -low;

  void include(const MatrixX3d& points) {
    if (points.rows() == 0) return;
    low = low.cwiseMin(points.colwise().minCoeff());
    high = high.cwiseMax(points.colwise().maxCoeff());
  }
  [[nodiscard]] double diagonal() const { return (high - low).norm(); }
  [[nodiscard]] Vector3d middle() const { return (low + high).transpose() / 2; }
};

Box box_of(const Scene& scene) {
  Box box;
  for (const Surface& surface : scene.surfaces) box.include(surface.V);
  return box;
}

/// The least and the greatest coordinate along a direction.
std::pair<double, double> extent(const Scene& scene, const Vector3d& direction) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Surface& surface : scene.surfaces) {
    if (surface.V.rows() == 0) continue;
    const Eigen::VectorXd along = surface.V * direction;
    low = std::min(low, along.minCoeff());
    high = std::max(high, along.maxCoeff());
  }
  return {low, high};
}

}  // namespace

MatrixX3d image_positions(const std::vector<SurfacePoint>& map,
                          const MatrixX3d& target_V,
                          const MatrixX3i& target_F) {
  MatrixX3d places(static_cast<Eigen::Index>(map.size()), 3);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    const SurfacePoint& p = map[static_cast<size_t>(i)];
    places.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!p.valid()) continue;
    places.row(i).setZero();
    for (int k = 0; k < 3; ++k) places.row(i) += p.bary[k] * target_V.row(target_F(p.face, k));
  }
  return places;
}

void color_by_place(Surface& surface,
                    const MatrixX3d& places,
                    const MatrixX3d& target_V,
                    PairPattern pattern) {
  assert(places.rows() == surface.V.rows());
  Box box;
  box.include(target_V);
  const Eigen::RowVector3d size = (box.high - box.low).cwiseMax(std::numeric_limits<double>::min());
  const bool checker = pattern == PairPattern::kChecker;
  surface.corner_color.assign(static_cast<size_t>(3 * surface.F.rows()), neutral_color());
  if (checker) surface.corner_solid = MatrixX3d::Zero(3 * surface.F.rows(), 3);
  for (int f = 0; f < surface.F.rows(); ++f) {
    bool mapped = true;
    for (int k = 0; k < 3; ++k) mapped = mapped && places.row(surface.F(f, k)).allFinite();
    if (!mapped) continue;
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector3d offset = places.row(surface.F(f, k)) - box.low;
      surface.corner_color[at(Eigen::Index{3} * f + k)] =
          position_color(offset.cwiseQuotient(size).transpose());
      if (checker) surface.corner_solid.row(3 * f + k) = kCheckerCells / size.maxCoeff() * offset;
    }
  }
}

PlacedPair place_beside(const Scene& first,
                        Scene second,
                        const Eigen::Matrix3d& turn,
                        const Vector3d& right) {
  for (Surface& surface : second.surfaces) {
    surface.V = (surface.V * turn.transpose()).eval();
    if (surface.corner_normal.rows() > 0)
      surface.corner_normal = (surface.corner_normal * turn.transpose()).eval();
  }
  for (Rod& rod : second.rods) {
    rod.a = (turn * rod.a).eval();
    rod.b = (turn * rod.b).eval();
  }
  const Box one = box_of(first), two = box_of(second);
  const double scale = one.diagonal() / std::max(two.diagonal(), 1e-300);
  PlacedPair pair{first, scale, turn, Vector3d::Zero()};
  const double gap = 0.08 * one.diagonal();
  pair.shift = one.middle() - pair.scale * two.middle();
  const double second_low = pair.scale * extent(second, right).first + pair.shift.dot(right);
  pair.shift += (extent(first, right).second + gap - second_low) * right;
  const int first_texture = static_cast<int>(first.textures.size());
  pair.scene.textures.insert(
      pair.scene.textures.end(), second.textures.begin(), second.textures.end());
  for (Surface surface : second.surfaces) {
    surface.V = ((pair.scale * surface.V).rowwise() + pair.shift.transpose()).eval();
    for (int& texture : surface.face_texture)
      if (texture >= 0) texture += first_texture;
    pair.scene.surfaces.push_back(std::move(surface));
  }
  for (Rod rod : second.rods) {
    rod.a = pair.scale * rod.a + pair.shift;
    rod.b = pair.scale * rod.b + pair.shift;
    rod.radius *= pair.scale;
    pair.scene.rods.push_back(rod);
  }
  return pair;
}

void add_correspondences(Scene& scene,
                         const MatrixX3d& first,
                         const MatrixX3d& second,
                         double radius) {
  assert(first.rows() == second.rows());
  for (int i = 0; i < first.rows(); ++i)
    scene.rods.push_back(
        {first.row(i).transpose(), second.row(i).transpose(), radius, category_color(i)});
}

}  // namespace crosspatch
