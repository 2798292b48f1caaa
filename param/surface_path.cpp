#include "param/surface_path.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kPerEdge = 3;
constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr int kStart = -1;

int common_face(const std::vector<int>& a, const std::vector<int>& b) {
  for (const int f : a)
    if (std::find(b.begin(), b.end(), f) != b.end()) return f;
  return -1;
}

}  // namespace

SurfacePaths::SurfacePaths(const TriangleMesh& mesh)
    : mesh_(mesh),
      distance_(idx(mesh.vertex_count() + kPerEdge * mesh.halfedge_count()), kFar),
      parent_(distance_.size(), kStart) {}

SurfacePaths::Node SurfacePaths::node(int id) const {
  if (id < mesh_.vertex_count()) return {id, -1, 0};
  const int h = (id - mesh_.vertex_count()) / kPerEdge, k = (id - mesh_.vertex_count()) % kPerEdge;
  return {mesh_.from(h), mesh_.to(h), (k + 1.0) / (kPerEdge + 1)};
}

Vector3d SurfacePaths::place(const Node& n) const {
  if (n.v < 0) return mesh_.position(n.u);
  return (1 - n.s) * mesh_.position(n.u) + n.s * mesh_.position(n.v);
}

SurfacePoint SurfacePaths::in(int face, const Node& n) const {
  SurfacePoint p{face, Vector3d::Zero()};
  for (int k = 0; k < 3; ++k) {
    if (mesh_.F(face, k) == n.u) p.bary[k] = 1 - n.s;
    if (mesh_.F(face, k) == n.v) p.bary[k] = n.s;
  }
  return p;
}

/// Offers all nodes of a face a way over `from`.
void SurfacePaths::relax(int from, int face, const Vector3d& at, double distance) {
  const auto offer = [&](int id) {
    const double d = distance + (place(node(id)) - at).norm();
    if (d >= distance_[idx(id)]) return;
    if (distance_[idx(id)] == kFar) touched_.push_back(id);
    distance_[idx(id)] = d;
    parent_[idx(id)] = from;
    queue_.emplace_back(d, id);
    std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
  };
  for (int k = 0; k < 3; ++k) {
    const int h = 3 * face + k, twin = mesh_.twin[idx(h)];
    offer(mesh_.from(h));
    for (int i = 0; i < kPerEdge; ++i)
      offer(mesh_.vertex_count() + kPerEdge * (twin < 0 ? h : std::min(h, twin)) + i);
  }
}

/// The nodes between two points that share no face; none if there is no way.
std::vector<int> SurfacePaths::search(const SurfacePoint& from, const SurfacePoint& to) {
  const std::vector<int> goal = faces_at(mesh_, to);
  const Vector3d end = position(mesh_, to);
  for (const int face : faces_at(mesh_, from)) relax(kStart, face, position(mesh_, from), 0);
  double best = kFar;
  int last = kStart;
  while (!queue_.empty() && queue_.front().first < best) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [distance, id] = queue_.back();
    queue_.pop_back();
    if (distance > distance_[idx(id)]) continue;
    const Node n = node(id);
    const int any = n.v < 0 ? mesh_.out[idx(n.u)] : (id - mesh_.vertex_count()) / kPerEdge;
    const Vector3d at = place(n);
    for (const int face : faces_at(mesh_, in(face_of(any), n))) {
      relax(id, face, at, distance);
      if (std::find(goal.begin(), goal.end(), face) == goal.end()) continue;
      const double total = distance + (end - at).norm();
      if (total < best) {
        best = total;
        last = id;
      }
    }
  }
  std::vector<int> ids;
  for (int id = last; id != kStart; id = parent_[idx(id)]) ids.push_back(id);
  std::reverse(ids.begin(), ids.end());
  for (const int id : touched_) distance_[idx(id)] = kFar;
  touched_.clear();
  queue_.clear();
  return ids;
}

/// Moves each crossing of an edge to where its neighbours, unfolded into a plane, see each other.
void SurfacePaths::straighten(std::vector<Node>& nodes,
                              const Vector3d& from,
                              const Vector3d& to) const {
  // The search leaves a path a per cent too long; long paths settle slowly, but what is left of
  // that after so many sweeps is far less.
  constexpr int kSweeps = 200;
  constexpr double kSettled = 1e-7;  // of an edge
  double moved = 1;
  for (int sweep = 0; sweep < kSweeps && moved > kSettled; ++sweep) {
    moved = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      Node& n = nodes[i];
      if (n.v < 0) continue;
      const Vector3d origin = mesh_.position(n.u), edge = mesh_.position(n.v) - origin;
      const double length = edge.norm();
      if (!(length > 0)) continue;
      const Vector3d axis = edge / length;
      const Vector3d a = (i == 0 ? from : place(nodes[i - 1])) - origin;
      const Vector3d b = (i + 1 == nodes.size() ? to : place(nodes[i + 1])) - origin;
      const double height_a = (a - a.dot(axis) * axis).norm();
      const double height_b = (b - b.dot(axis) * axis).norm();
      if (!(height_a + height_b > 1e-12 * length)) continue;
      const double along =
          (a.dot(axis) * height_b + b.dot(axis) * height_a) / (height_a + height_b);
      const double s = std::clamp(along / length, 0.0, 1.0);
      moved = std::max(moved, std::abs(s - n.s));
      n.s = s;
    }
  }
}

std::vector<FaceSegment> SurfacePaths::path(const SurfacePoint& from, const SurfacePoint& to) {
  const std::vector<int> start = faces_at(mesh_, from), goal = faces_at(mesh_, to);
  std::vector<FaceSegment> segments;
  const auto add = [&](const SurfacePoint& a, const SurfacePoint& b) {
    if (a.bary != b.bary) segments.push_back({a.face, a.bary, b.bary});
  };
  if (const int face = common_face(start, goal); face >= 0) {
    add(in_face(mesh_, from, face), in_face(mesh_, to, face));
    return segments;
  }
  const std::vector<int> ids = search(from, to);
  if (ids.empty()) return {};
  std::vector<Node> nodes;
  std::vector<int> faces;  // of each segment; moving a crossing along its edge does not change them
  std::vector<int> before = start;
  for (const int id : ids) {
    const Node n = node(id);
    const int any = n.v < 0 ? mesh_.out[idx(n.u)] : (id - mesh_.vertex_count()) / kPerEdge;
    std::vector<int> here = faces_at(mesh_, in(face_of(any), n));
    faces.push_back(common_face(before, here));
    nodes.push_back(n);
    before = std::move(here);
  }
  faces.push_back(common_face(before, goal));
  straighten(nodes, position(mesh_, from), position(mesh_, to));
  for (std::size_t i = 0; i < faces.size(); ++i)
    add(i == 0 ? in_face(mesh_, from, faces[i]) : in(faces[i], nodes[i - 1]),
        i == nodes.size() ? in_face(mesh_, to, faces[i]) : in(faces[i], nodes[i]));
  return segments;
}

}  // namespace crosspatch
