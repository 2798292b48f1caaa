#pragma once

#include <vector>

#include "param/surface_map.hpp"

namespace crosspatch {

/// A straight segment inside a face.
struct FaceSegment {
  int face = -1;
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();  ///< barycentric
};

/// Finds short paths over a surface between any of its points.
///
/// Points of one face are joined straight. Others: Dijkstra's algorithm over the vertices and three
/// points on every edge, then each crossing is moved along its edge until the path is straight when
/// unfolded. It is the shortest path through the triangles it crosses, and may pass through
/// vertices.
class SurfacePaths {
 public:
  /// `mesh` must outlive the paths.
  explicit SurfacePaths(const TriangleMesh& mesh);

  /// From one point to the other; empty where they are not connected or are the same. Cost: as much
  /// of the mesh as is nearer than the goal.
  [[nodiscard]] std::vector<FaceSegment> path(const SurfacePoint& from, const SurfacePoint& to);

 private:
  /// A point of the graph, on the edge from `u` to `v`, or at `u`.
  struct Node {
    int u = -1, v = -1;
    double s = 0;  ///< share of the way to v
  };
  [[nodiscard]] Node node(int id) const;
  [[nodiscard]] Vector3d place(const Node& node) const;
  [[nodiscard]] SurfacePoint in(int face, const Node& node) const;
  void relax(int from, int face, const Vector3d& place, double distance);
  [[nodiscard]] std::vector<int> search(const SurfacePoint& from, const SurfacePoint& to);
  void straighten(std::vector<Node>& nodes, const Vector3d& from, const Vector3d& to) const;

  const TriangleMesh& mesh_;
  std::vector<double> distance_;  ///< per node; infinite between calls
  std::vector<int> parent_;
  std::vector<int> touched_;
  std::vector<std::pair<double, int>> queue_;
};

}  // namespace crosspatch
