#include "core/cut_handles.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

#include "core/fill_holes.hpp"
#include "core/index.hpp"
#include "core/open_along.hpp"
#include "core/union_find.hpp"

namespace crosspatch {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

struct Loop {
  std::vector<int> vertices;
  double length = kFar;
};

/// Shortest paths along edges from `base`, through vertices below `vertex_count` only.
struct PathTree {
  std::vector<double> distance;
  std::vector<int> parent;  ///< half-edge that leads to the vertex, -1 at the base
};

double length(const TriangleMesh& mesh, int h) {
  return (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
}

PathTree path_tree(const TriangleMesh& mesh, int base, int vertex_count) {
  PathTree tree{std::vector<double>(idx(mesh.vertex_count()), kFar),
                std::vector<int>(idx(mesh.vertex_count()), -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  tree.distance[idx(base)] = 0;
  queue.emplace(0, base);
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > tree.distance[idx(v)]) continue;
    for_each_outgoing(mesh, v, [&](int h) {
      const int w = mesh.to(h);
      const double there = d + length(mesh, h);
      if (w >= vertex_count || there >= tree.distance[idx(w)]) return;
      tree.distance[idx(w)] = there;
      tree.parent[idx(w)] = h;
      queue.emplace(there, w);
    });
  }
  return tree;
}

std::vector<int> path_to_base(const TriangleMesh& mesh, const PathTree& tree, int v) {
  std::vector<int> path{v};
  while (tree.parent[idx(v)] >= 0) {
    v = mesh.from(tree.parent[idx(v)]);
    path.push_back(v);
  }
  return path;
}

/// The closed path of edge h and the tree's paths from its ends up to where they meet.
Loop loop_through(const TriangleMesh& mesh, const PathTree& tree, int h) {
  std::vector<int> a = path_to_base(mesh, tree, mesh.from(h));
  std::vector<int> b = path_to_base(mesh, tree, mesh.to(h));
  while (a.size() > 1 && b.size() > 1 && a[a.size() - 2] == b[b.size() - 2]) {
    a.pop_back();
    b.pop_back();
  }
  Loop loop;
  loop.length = tree.distance[idx(mesh.from(h))] + tree.distance[idx(mesh.to(h))] +
                length(mesh, h) - 2 * tree.distance[idx(a.back())];
  loop.vertices = a;
  loop.vertices.insert(loop.vertices.end(), b.rbegin() + 1, b.rend());
  return loop;
}

/// The shortest of the loops that a tree of shortest paths from `base` and the longest tree across
/// the other edges leave over: as many as twice the genus, none of which separates the surface.
Loop shortest_loop_near(const TriangleMesh& mesh, int base, int vertex_count) {
  const PathTree tree = path_tree(mesh, base, vertex_count);
  std::vector<bool> in_tree(idx(mesh.halfedge_count()), false);
  for (const int h : tree.parent)
    if (h >= 0) in_tree[idx(h)] = in_tree[idx(mesh.twin[idx(h)])] = true;
  std::vector<std::pair<double, int>> edges;
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (h < mesh.twin[idx(h)] && !in_tree[idx(h)])
      edges.emplace_back(
          tree.distance[idx(mesh.from(h))] + tree.distance[idx(mesh.to(h))] + length(mesh, h), h);
  std::sort(edges.begin(), edges.end(), std::greater<>());
  UnionFind faces(mesh.face_count());
  Loop best;
  for (const auto& [weight, h] : edges) {
    if (faces.join(face_of(h), face_of(mesh.twin[idx(h)]))) continue;
    Loop loop = loop_through(mesh, tree, h);
    if (loop.length < best.length) best = std::move(loop);
  }
  return best;
}

/// About the shortest loop that does not separate the closed surface, through vertices below
/// `vertex_count`. With many handles one is near any base, so that fewer bases do.
Loop shortest_loop(const TriangleMesh& mesh, int vertex_count) {
  const int bases = std::clamp(96 / genus(mesh), 6, 48);
  Loop best;
  int base = 0;
  std::vector<double> nearest(idx(vertex_count), kFar);
  const auto try_base = [&](int v) {
    Loop loop = shortest_loop_near(mesh, v, vertex_count);
    if (loop.length < best.length) best = std::move(loop);
  };
  for (int i = 0; i < bases; ++i) {
    try_base(base);
    // The next base is the vertex farthest from all before, as the crow flies.
    for (int v = 0; v < vertex_count; ++v)
      nearest[idx(v)] =
          std::min(nearest[idx(v)], (mesh.position(v) - mesh.position(base)).squaredNorm());
    base = static_cast<int>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
  }
  // A base on a loop finds the shortest loop through it.
  constexpr std::size_t kAlong = 8;
  for (int round = 0; round < 2; ++round) {
    const std::vector<int> found = best.vertices;
    for (std::size_t i = 0; i < found.size(); i += std::max<std::size_t>(1, found.size() / kAlong))
      try_base(found[i]);
  }
  return best;
}

}  // namespace

Result<CutMesh> cut_handles(const TriangleMesh& mesh) {
  CutMesh cut{mesh, std::vector<int>(idx(mesh.vertex_count())), {}};
  std::iota(cut.vertex.begin(), cut.vertex.end(), 0);
  while (genus(cut.mesh) > 0) {
    const auto closed = fill_holes(cut.mesh);
    if (!closed) return tl::unexpected(closed.error());
    const Loop loop = shortest_loop(closed->mesh, closed->vertex_count);
    if (loop.vertices.size() < 3)
      return fail(ErrorCode::kInternal, "cut: a surface with handles has no loop");
    std::vector<bool> marked(idx(cut.mesh.halfedge_count()), false);
    std::vector<int> original;
    for (std::size_t i = 0; i < loop.vertices.size(); ++i) {
      const int u = loop.vertices[i], v = loop.vertices[(i + 1) % loop.vertices.size()];
      for (const int h : {find_halfedge(cut.mesh, u, v), find_halfedge(cut.mesh, v, u)})
        if (h >= 0) marked[idx(h)] = true;
      original.push_back(cut.vertex[idx(u)]);
    }
    const int before = genus(cut.mesh);
    auto opened = open_along(cut.mesh, marked);
    if (!opened) return tl::unexpected(opened.error());
    if (genus(opened->mesh) >= before)
      return fail(ErrorCode::kInternal, "cut: a loop left as many handles as before");
    for (int& v : opened->vertex) v = cut.vertex[idx(v)];
    cut.mesh = std::move(opened->mesh);
    cut.vertex = std::move(opened->vertex);
    cut.loops.push_back(std::move(original));
  }
  return cut;
}

}  // namespace crosspatch
