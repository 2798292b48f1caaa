#include "tools/benchmarks/deformations.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace crosspatch {
namespace {

/// The coordinate axis along which the mesh is longer: 1 (up) or 2 (front).
int long_axis(const TriangleMesh& mesh) {
  const Eigen::RowVector3d size = mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff();
  return size[1] > size[2] ? 1 : 2;
}

void bend(TriangleMesh& mesh, double radians) {
  if (radians == 0) return;
  const int along = long_axis(mesh), across = 3 - along;
  const Eigen::RowVector3d low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
  const double radius = (high[along] - low[along]) / radians;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const double angle = (mesh.V(v, along) - (low[along] + high[along]) / 2) / radius;
    const double height = radius - (mesh.V(v, across) - (low[across] + high[across]) / 2);
    mesh.V(v, along) = std::sin(angle) * height;
    mesh.V(v, across) = -std::cos(angle) * height;
  }
}

void stretch(TriangleMesh& mesh, double strength) {
  const int along = long_axis(mesh);
  mesh.V.col(along) *= 1 + 0.2 * strength;
  mesh.V.col(0) += 0.1 * strength * mesh.V.col(along);
}

void swell(TriangleMesh& mesh, double strength) {
  constexpr double kReach = 0.2;  // of the length
  const int along = long_axis(mesh);
  Eigen::Index end = 0;
  const double high = mesh.V.col(along).maxCoeff(&end);
  const double reach = kReach * (high - mesh.V.col(along).minCoeff());
  const Eigen::RowVector3d centre = mesh.V.row(end);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::RowVector3d offset = mesh.V.row(v) - centre;
    const double near = std::exp(-offset.squaredNorm() / (2 * reach * reach));
    mesh.V.row(v) = centre + (1 + 0.2 * strength * near) * offset;
  }
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    sum += (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
  return sum / mesh.halfedge_count();
}

/// Moves one vertex in `every` along its normal.
void add_noise(TriangleMesh& mesh, double edges, int every) {
  const MatrixX3d normals = vertex_normals(mesh);
  const double deviation = edges * mean_edge(mesh);
  std::mt19937 random(1);
  // Sums of uniform numbers, as the library's normal distribution differs between compilers.
  const auto deviate = [&] {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    return sum - 6;
  };
  for (int v = 0; v < mesh.vertex_count(); v += every)
    mesh.V.row(v) += deviation * deviate() * normals.row(v);
}

}  // namespace

std::string name(Deformation deformation) {
  switch (deformation) {
    case Deformation::kBend:
      return "bend";
    case Deformation::kAffine:
      return "affine";
    case Deformation::kLocalScale:
      return "local_scale";
    case Deformation::kNoise:
      return "noise";
    case Deformation::kShotNoise:
      break;
  }
  return "shot_noise";
}

TriangleMesh deform(TriangleMesh mesh, Deformation deformation, double strength) {
  switch (deformation) {
    case Deformation::kBend:
      bend(mesh, strength / 5 * 4 * std::numbers::pi / 3);
      break;
    case Deformation::kAffine:
      stretch(mesh, strength);
      break;
    case Deformation::kLocalScale:
      swell(mesh, strength);
      break;
    case Deformation::kNoise:
      add_noise(mesh, 0.1 * strength, 1);
      break;
    case Deformation::kShotNoise:
      add_noise(mesh, 0.5 * strength, 100);
      break;
  }
  return mesh;
}

TriangleMesh morph(TriangleMesh mesh, double step) {
  swell(mesh, 5 * step);
  stretch(mesh, 2 * step);
  bend(mesh, step * std::numbers::pi / 2);
  return mesh;
}

}  // namespace crosspatch
