#include "param/chain_disc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "param/lift.hpp"
#include "param/sphere_optimizer.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A mesh under refinement: splitting an edge costs O(1) but for the copy of the arrays' ends.
class Splitter {
 public:
  explicit Splitter(TriangleMesh mesh) : mesh_(std::move(mesh)) {}

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] const std::vector<std::array<int, 2>>& split_edges() const { return split_edges_; }

  /// Inserts the midpoint m of half-edge h = (u, v): its face (u, v, w) becomes (u, m, w) and (m,
  /// v, w), likewise across.
  int split(int h) {
    const int g = mesh_.twin[at(h)];
    const int m = mesh_.vertex_count(), f = mesh_.face_count();
    const int u = mesh_.from(h), v = mesh_.to(h);
    mesh_.V.conservativeResize(m + 1, Eigen::NoChange);
    mesh_.V.row(m) = (mesh_.V.row(u) + mesh_.V.row(v)) / 2;
    mesh_.F.conservativeResize(f + 2, Eigen::NoChange);
    mesh_.twin.resize(at(3 * (f + 2)));
    mesh_.out.push_back(-1);
    halve(h, m, f);
    halve(g, m, f + 1);
    // Halves of the edge: h is now (u, m), the new face's first side (m, v); g is (v, m), its new
    // face's (m, u).
    pair(h, 3 * (f + 1));
    pair(g, 3 * f);
    mesh_.out[at(m)] = 3 * f;
    mesh_.out[at(u)] = h;
    mesh_.out[at(v)] = g;
    split_edges_.push_back({u, v});
    return m;
  }

 private:
  void pair(int a, int b) {
    mesh_.twin[at(a)] = b;
    mesh_.twin[at(b)] = a;
  }

  /// Keeps (u, m, w) in h's face and makes `fresh` = (m, v, w).
  void halve(int h, int m, int fresh) {
    const int v = mesh_.to(h), w = mesh_.tip(h);
    const int across = mesh_.twin[at(next(h))];
    mesh_.F(h / 3, next(h) % 3) = m;
    mesh_.F.row(fresh) << m, v, w;
    pair(3 * fresh + 1, across);
    pair(3 * fresh + 2, next(h));
    mesh_.out[at(w)] = 3 * fresh + 2;
    if (mesh_.out[at(v)] == next(h)) mesh_.out[at(v)] = 3 * fresh + 1;
  }

  TriangleMesh mesh_;
  std::vector<std::array<int, 2>> split_edges_;
};

/// Shortest paths over vertices and edge midpoints: node v < #V is a vertex, #V + h the midpoint of
/// edge min(h, twin(h)).
class PathTracer {
 public:
  PathTracer(const TriangleMesh& mesh,
             const std::vector<bool>& blocked,
             const std::vector<bool>& blocked_edge)
      : mesh_(mesh), blocked_(blocked), blocked_edge_(blocked_edge), n_(mesh.vertex_count()) {}

  /// Nodes from `source` to `target`, both included; empty if there is no way.
  std::vector<int> trace(int source, int target) {
    distance_.assign(at(n_ + mesh_.halfedge_count()), kInfinity);
    before_.assign(distance_.size(), -1);
    goal_ = mesh_.position(target);
    target_ = target;
    reach(source, 0, -1);
    while (!queue_.empty()) {
      const auto [key, node] = queue_.top();
      queue_.pop();
      if (node == target) break;
      if (key > distance_[at(node)] + (place(node) - goal_).norm() + 1e-12) continue;
      visit_neighbours(node);
    }
    std::vector<int> path;
    if (before_[at(target)] < 0) return path;
    for (int node = target; node >= 0; node = before_[at(node)]) path.push_back(node);
    std::reverse(path.begin(), path.end());
    return path;
  }

 private:
  using Entry = std::pair<double, int>;

  [[nodiscard]] Vector3d place(int node) const {
    if (node < n_) return mesh_.position(node);
    const int h = node - n_;
    return (mesh_.position(mesh_.from(h)) + mesh_.position(mesh_.to(h))) / 2;
  }

  void reach(int node, double d, int from) {
    if (!(d < distance_[at(node)])) return;
    if (node < n_ && from >= 0 && node != target_ && blocked_[at(node)]) return;
    if (node >= n_ && blocked_edge_[at(node - n_)]) return;
    distance_[at(node)] = d;
    before_[at(node)] = from;
    queue_.emplace(d + (place(node) - goal_).norm(), node);
  }

  [[nodiscard]] int midpoint(int h) const { return n_ + std::min(h, mesh_.twin[at(h)]); }

  void step(int from, int to) {
    reach(to, distance_[at(from)] + (place(from) - place(to)).norm(), from);
  }

  void visit_neighbours(int node) {
    if (node < n_) {
      for_each_outgoing(mesh_, node, [&](int h) {
        step(node, mesh_.to(h));
        step(node, midpoint(next(h)));
      });
      return;
    }
    for (const int h : {node - n_, mesh_.twin[at(node - n_)]}) {
      step(node, mesh_.tip(h));
      step(node, midpoint(next(h)));
      step(node, midpoint(prev(h)));
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<bool>& blocked_;
  const std::vector<bool>& blocked_edge_;
  int n_;
  int target_ = -1;
  Vector3d goal_ = Vector3d::Zero();
  std::vector<double> distance_;
  std::vector<int> before_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

struct Chain {
  std::vector<int> vertices;  ///< of the refined mesh, first landmark to last
  std::vector<int> corners;   ///< index into vertices of each landmark
};

/// Traces the chain, splitting the edges it crosses.
Result<Chain> trace_chain(Splitter& splitter, const std::vector<int>& landmarks) {
  Chain chain{{landmarks[0]}, {0}};
  for (size_t i = 0; i + 1 < landmarks.size(); ++i) {
    const TriangleMesh& mesh = splitter.mesh();
    std::vector<bool> blocked(at(mesh.vertex_count()), false),
        blocked_edge(at(mesh.halfedge_count()), false);
    for (int v : landmarks) blocked[at(v)] = true;
    for (int v : chain.vertices) blocked[at(v)] = true;
    for (size_t j = 0; j + 1 < chain.vertices.size(); ++j) {
      const int h = find_halfedge(mesh, chain.vertices[j], chain.vertices[j + 1]);
      blocked_edge[at(h)] = blocked_edge[at(mesh.twin[at(h)])] = true;
    }
    const std::vector<int> path =
        PathTracer(mesh, blocked, blocked_edge).trace(landmarks[i], landmarks[i + 1]);
    if (path.size() < 2)
      return fail(
          ErrorCode::kNumerical,
          fmt::format("chain: no way from vertex {} to vertex {}", landmarks[i], landmarks[i + 1]));
    // Ends of the crossed edges survive the other splits, half-edge numbers need not.
    const int n = mesh.vertex_count();
    std::vector<std::array<int, 2>> steps;
    for (int node : path)
      steps.push_back(node < n ? std::array{node, -1}
                               : std::array{mesh.from(node - n), mesh.to(node - n)});
    for (size_t j = 1; j < steps.size(); ++j)
      chain.vertices.push_back(steps[j][1] < 0 ? steps[j][0]
                                               : splitter.split(find_halfedge(
                                                     splitter.mesh(), steps[j][0], steps[j][1])));
    chain.corners.push_back(static_cast<int>(chain.vertices.size()) - 1);
  }
  return chain;
}

/// Gives the faces right of the chain copies of its inner vertices. Returns the boundary loop,
/// surface on the left.
std::vector<int> cut_open(const TriangleMesh& mesh,
                          const std::vector<int>& chain,
                          MatrixX3i& F,
                          std::vector<int>& vertex) {
  std::vector<int> right;
  for (size_t i = 1; i + 1 < chain.size(); ++i) {
    const int copy = static_cast<int>(vertex.size());
    vertex.push_back(chain[i]);
    right.push_back(copy);
    // Counter-clockwise from the way back to the way on: the faces on the chain's right.
    const int stop = find_halfedge(mesh, chain[i], chain[i + 1]);
    for (int h = find_halfedge(mesh, chain[i], chain[i - 1]); h != stop; h = mesh.twin[at(prev(h))])
      F(h / 3, h % 3) = copy;
  }
  std::vector<int> loop = chain;
  loop.insert(loop.end(), right.rbegin(), right.rend());
  return loop;
}

/// Places of the loop on the unit circle: sides of equal angle, divided by arc length.
MatrixX2d circle_positions(const TriangleMesh& mesh,
                           const std::vector<int>& chain,
                           const std::vector<int>& corners) {
  const int sides = 2 * (static_cast<int>(corners.size()) - 1);
  const int n = static_cast<int>(chain.size());
  std::vector<double> angle(at(n), 0);
  for (size_t s = 0; s + 1 < corners.size(); ++s) {
    double length = 0;
    for (int i = corners[s]; i < corners[s + 1]; ++i) {
      length += (mesh.position(chain[at(i)]) - mesh.position(chain[at(i + 1)])).norm();
      angle[at(i + 1)] = length;
    }
    for (int i = corners[s] + 1; i <= corners[s + 1]; ++i)
      angle[at(i)] =
          2 * std::numbers::pi / sides * (static_cast<double>(s) + angle[at(i)] / length);
  }
  MatrixX2d positions(2 * (n - 1), 2);
  for (int i = 0; i < positions.rows(); ++i) {
    const double a = i < n ? angle[at(i)] : 2 * std::numbers::pi - angle[at(2 * (n - 1) - i)];
    positions.row(i) << std::cos(a), std::sin(a);
  }
  return positions;
}

double one_way_distortion(const ChainDisc& a, const ChainDisc& b) {
  // A face that falls into a line has no finite energy; this one is far beyond any face of a usable
  // map.
  constexpr double kWorst = 1e8;
  const MatrixX3d image = through_disc(a, b, b.mesh.V);
  const SphereProblem rest = make_sphere_problem(a.mesh.F, a.mesh.V, {});
  double sum = 0;
  for (int f = 0; f < a.mesh.face_count(); ++f) {
    const double e = distortion(Distortion::kSymmetricDirichlet,
                                rest.rest_inverse[at(f)],
                                image.row(a.mesh.F(f, 0)).transpose(),
                                image.row(a.mesh.F(f, 1)).transpose(),
                                image.row(a.mesh.F(f, 2)).transpose());
    sum += rest.rest_area[f] * std::log(std::min(e, kWorst));
  }
  return sum / rest.rest_area.sum();
}

}  // namespace

Result<ChainDisc> cut_along_chain(const TriangleMesh& mesh, const std::vector<int>& landmarks) {
  Splitter splitter(mesh);
  const auto chain = trace_chain(splitter, landmarks);
  if (!chain) return tl::unexpected(chain.error());
  const TriangleMesh& refined = splitter.mesh();
  ChainDisc disc;
  disc.split_edges = splitter.split_edges();
  disc.vertex.resize(at(refined.vertex_count()));
  for (int v = 0; v < refined.vertex_count(); ++v) disc.vertex[at(v)] = v;
  disc.disc_vertex.assign(disc.vertex.begin(), disc.vertex.begin() + mesh.vertex_count());
  MatrixX3i F = refined.F;
  const std::vector<int> loop = cut_open(refined, chain->vertices, F, disc.vertex);
  MatrixX3d V = refined.V(disc.vertex, Eigen::all);
  auto cut = make_mesh(std::move(V), std::move(F));
  if (!cut) return tl::unexpected(cut.error());
  disc.mesh = std::move(*cut);
  for (size_t i = 0; i + 1 < chain->vertices.size(); ++i)
    disc.chain_length +=
        (refined.position(chain->vertices[i]) - refined.position(chain->vertices[i + 1])).norm();
  const auto uv =
      tutte_embedding(disc.mesh, loop, circle_positions(refined, chain->vertices, chain->corners));
  if (!uv) return tl::unexpected(uv.error());
  disc.domain.resize(uv->rows(), 3);
  disc.domain << *uv, Eigen::VectorXd::Ones(uv->rows());
  return disc;
}

MatrixX3d to_disc(const ChainDisc& disc, const MatrixX3d& values) {
  const int n = static_cast<int>(values.rows());
  MatrixX3d all(n + static_cast<int>(disc.split_edges.size()), 3);
  all.topRows(n) = values;
  for (size_t i = 0; i < disc.split_edges.size(); ++i)
    all.row(n + static_cast<int>(i)) =
        (all.row(disc.split_edges[i][0]) + all.row(disc.split_edges[i][1])) / 2;
  return all(disc.vertex, Eigen::all);
}

MatrixX3d through_disc(const ChainDisc& a, const ChainDisc& b, const MatrixX3d& values_b) {
  const TriangleMesh surface{values_b, b.mesh.F, b.mesh.twin, b.mesh.out};
  const MeshLift lift(surface, b.domain);
  MatrixX3d result(a.mesh.vertex_count(), values_b.cols());
  std::vector<int> hint(at(a.mesh.vertex_count()), -1);
  // Along the edges of a, each search starts beside the last one.
  std::vector<int> queue{0};
  hint[0] = 0;
  for (size_t i = 0; i < queue.size(); ++i) {
    const int v = queue[i];
    result.row(v) = lift.point(a.domain.row(v).transpose(), hint[at(v)]).transpose();
    for_each_outgoing(a.mesh, v, [&](int h) {
      for (const int w : {a.mesh.to(h), a.mesh.tip(h)})
        if (hint[at(w)] < 0) {
          hint[at(w)] = hint[at(v)];
          queue.push_back(w);
        }
    });
  }
  return result;
}

double disc_distortion(const ChainDisc& a, const ChainDisc& b) {
  return (one_way_distortion(a, b) + one_way_distortion(b, a)) / 2;
}

}  // namespace crosspatch
