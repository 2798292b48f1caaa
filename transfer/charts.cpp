#include "transfer/charts.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <queue>
#include <tuple>

#include "core/index.hpp"
#include "param/parametrize.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

Vector3d area_vector(const TriangleMesh& mesh, int f) {
  const Vector3d a = mesh.position(mesh.F(f, 0));
  return (mesh.position(mesh.F(f, 1)) - a).cross(mesh.position(mesh.F(f, 2)) - a) / 2;
}

class Clustering {
 public:
  Clustering(const TriangleMesh& mesh, const ChartOptions& options)
      : mesh_(mesh), options_(options) {
    clusters_.resize(idx(mesh.face_count()));
    for (int f = 0; f < mesh.face_count(); ++f) {
      Cluster& c = clusters_[idx(f)];
      c.faces = {f};
      c.normal = area_vector(mesh, f);
      c.area = c.normal.norm();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const double length = (mesh.position(mesh.to(h)) - mesh.position(mesh.from(h))).norm();
        c.perimeter += length;
        if (mesh.twin[idx(h)] >= 0) c.border[face_of(mesh.twin[idx(h)])] += length;
      }
    }
  }

  Charts run() {
    for (int f = 0; f < mesh_.face_count(); ++f)
      for (const auto& entry : clusters_[idx(f)].border)
        if (entry.first > f) propose(f, entry.first);
    while (!queue_.empty()) {
      const Proposal best = queue_.top();
      queue_.pop();
      const Cluster &a = clusters_[idx(best.first)], &b = clusters_[idx(best.second)];
      if (a.version != best.first_version || b.version != best.second_version) continue;
      if (stays_upright(a, b)) join(best.first, best.second);
    }
    Charts charts;
    charts.of_face.resize(clusters_.size());
    for (const Cluster& c : clusters_) {
      if (c.faces.empty()) continue;
      for (const int f : c.faces) charts.of_face[idx(f)] = charts.count;
      ++charts.count;
    }
    return charts;
  }

 private:
  struct Cluster {
    std::vector<int> faces;
    Vector3d normal = Vector3d::Zero();  ///< sum of area vectors
    double area = 0;
    double perimeter = 0;
    std::map<int, double> border;  ///< length shared with each neighbour
    int version = 0;               ///< -1: joined into another
  };
  struct Proposal {
    double cost;
    int first, second, first_version, second_version;
    bool operator<(const Proposal& other) const {  // the cheapest on top
      return std::tie(cost, first, second) > std::tie(other.cost, other.first, other.second);
    }
  };

  void propose(int i, int j) {
    const Cluster &a = clusters_[idx(i)], &b = clusters_[idx(j)];
    const double area = a.area + b.area;
    const double bend = area > 0 ? 1 - (a.normal + b.normal).norm() / area : 0;
    if (bend > options_.bend) return;
    const double perimeter = a.perimeter + b.perimeter - 2 * a.border.at(j);
    const double outline = area > 0 ? perimeter * perimeter / (4 * std::numbers::pi * area) : 0;
    queue_.push({bend + options_.roundness * outline, i, j, a.version, b.version});
  }

  bool stays_upright(const Cluster& a, const Cluster& b) const {
    const Vector3d normal = (a.normal + b.normal).normalized();
    const auto upright = [&](int f) {
      const Vector3d n = area_vector(mesh_, f);
      return n.dot(normal) >= options_.least_cosine * n.norm();
    };
    return std::all_of(a.faces.begin(), a.faces.end(), upright) &&
           std::all_of(b.faces.begin(), b.faces.end(), upright);
  }

  void join(int i, int j) {
    if (clusters_[idx(i)].faces.size() < clusters_[idx(j)].faces.size()) std::swap(i, j);
    Cluster &a = clusters_[idx(i)], &b = clusters_[idx(j)];
    a.perimeter += b.perimeter - 2 * a.border.at(j);
    a.faces.insert(a.faces.end(), b.faces.begin(), b.faces.end());
    a.normal += b.normal;
    a.area += b.area;
    ++a.version;
    b.version = -1;
    b.faces.clear();
    a.border.erase(j);
    for (const auto& [k, length] : b.border) {
      if (k == i) continue;
      a.border[k] += length;
      auto& theirs = clusters_[idx(k)].border;
      theirs.erase(j);
      theirs[i] += length;
    }
    b.border.clear();
    for (const auto& entry : a.border) propose(std::min(i, entry.first), std::max(i, entry.first));
  }

  const TriangleMesh& mesh_;
  const ChartOptions& options_;
  std::vector<Cluster> clusters_;
  std::priority_queue<Proposal> queue_;
};

/// The chart as a mesh of its own: corners that meet across inner edges are one vertex. `vertex`:
/// per corner, in the order of `faces`.
Result<TriangleMesh> chart_mesh(const TriangleMesh& mesh,
                                const std::vector<int>& faces,
                                std::vector<int>& vertex) {
  std::map<int, int> place;
  for (std::size_t i = 0; i < faces.size(); ++i) place[faces[i]] = static_cast<int>(i);
  std::vector<int> root(3 * faces.size());
  for (std::size_t c = 0; c < root.size(); ++c) root[c] = static_cast<int>(c);
  const auto find = [&](int c) {
    while (root[idx(c)] != c) c = root[idx(c)] = root[idx(root[idx(c)])];
    return c;
  };
  const auto join = [&](int c, int d) {
    root[idx(std::max(find(c), find(d)))] = std::min(find(c), find(d));
  };
  const auto local = [&](int h, int chart_face) { return 3 * chart_face + h % 3; };
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int h = 3 * faces[i]; h < 3 * faces[i] + 3; ++h) {
      const int twin = mesh.twin[idx(h)];
      const auto other = twin < 0 ? place.end() : place.find(face_of(twin));
      if (other == place.end()) continue;
      join(local(h, static_cast<int>(i)), local(next(twin), other->second));
      join(local(next(h), static_cast<int>(i)), local(twin, other->second));
    }
  vertex.assign(root.size(), -1);
  std::vector<int> where;
  for (std::size_t c = 0; c < root.size(); ++c) {
    const int r = find(static_cast<int>(c));
    if (vertex[idx(r)] < 0) {
      vertex[idx(r)] = static_cast<int>(where.size());
      where.push_back(mesh.F(faces[c / 3], static_cast<Eigen::Index>(c % 3)));
    }
    vertex[c] = vertex[idx(r)];
  }
  MatrixX3d V(static_cast<Eigen::Index>(where.size()), 3);
  for (std::size_t v = 0; v < where.size(); ++v)
    V.row(static_cast<Eigen::Index>(v)) = mesh.V.row(where[v]);
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t c = 0; c < vertex.size(); ++c)
    F(static_cast<Eigen::Index>(c / 3), static_cast<Eigen::Index>(c % 3)) = vertex[c];
  return make_mesh(std::move(V), std::move(F));
}

double image_area(const std::vector<Vector2d>& corners) {
  double area = 0;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3)
    area += doubled_area(corners[c], corners[c + 1], corners[c + 2]) / 2;
  return area;
}

void scale_to(double area, std::vector<Vector2d>& corners) {
  const double own = image_area(corners);
  if (own <= 0 || area <= 0) return;
  for (Vector2d& p : corners) p *= std::sqrt(area / own);
}

double surface_area(const TriangleMesh& mesh, const std::vector<int>& faces) {
  double area = 0;
  for (const int f : faces) area += area_vector(mesh, f).norm();
  return area;
}

}  // namespace

Charts make_charts(const TriangleMesh& mesh, const ChartOptions& options) {
  return Clustering(mesh, options).run();
}

std::vector<Vector2d> chart_shadow(const TriangleMesh& mesh, const std::vector<int>& faces) {
  Vector3d normal = Vector3d::Zero();
  for (const int f : faces) normal += area_vector(mesh, f);
  normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : Vector3d::UnitZ();
  const Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Vector2d> corners;
  for (const int f : faces)
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = mesh.position(mesh.F(f, k));
      corners.emplace_back(p.dot(u), p.dot(v));
    }
  scale_to(surface_area(mesh, faces), corners);
  return corners;
}

std::vector<Vector2d> flatten_chart(const TriangleMesh& mesh, const std::vector<int>& faces) {
  const std::vector<Vector2d> shadow = chart_shadow(mesh, faces);
  std::vector<int> vertex;
  const Result<TriangleMesh> chart = chart_mesh(mesh, faces, vertex);
  if (!chart || faces.size() < 2) return shadow;
  MatrixX2d start(chart->vertex_count(), 2);
  for (std::size_t c = 0; c < vertex.size(); ++c) start.row(vertex[c]) = shadow[c].transpose();
  // The first rounds win nearly all; faces without area have no better image.
  const auto flat = parametrize(*chart,
                                start,
                                {.boundary = PatchBoundary::kFree,
                                 .max_rounds = 5,
                                 .tolerance = 1e-2,
                                 .stiffening_rounds = 0});
  if (!flat) return shadow;
  std::vector<Vector2d> corners;
  for (const int v : vertex) corners.emplace_back(flat->uv.row(v).transpose());
  scale_to(surface_area(mesh, faces), corners);
  return corners;
}

}  // namespace crosspatch
