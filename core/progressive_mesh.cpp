#include "core/progressive_mesh.hpp"

#include <fmt/format.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModProgMeshT.hh>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace crosspatch {
namespace {

using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using OmMesh = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

OmMesh to_openmesh(const MatrixX3d& V, const MatrixX3i& F) {
  OmMesh om;
  for (int v = 0; v < V.rows(); ++v) om.add_vertex({V(v, 0), V(v, 1), V(v, 2)});
  for (int f = 0; f < F.rows(); ++f)
    om.add_face(om.vertex_handle(static_cast<unsigned>(F(f, 0))),
                om.vertex_handle(static_cast<unsigned>(F(f, 1))),
                om.vertex_handle(static_cast<unsigned>(F(f, 2))));
  om.request_vertex_status();
  om.request_edge_status();
  om.request_halfedge_status();
  om.request_face_status();
  om.request_face_normals();
  om.update_face_normals();
  return om;
}

/// Prefers collapses that leave short edges and faces near equilateral, so that every level is an
/// even, isotropic sampling: maps are optimised on it, and slivers would stop them.
template <class MeshT>
class ModIsotropicT : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  DECIMATING_MODULE(ModIsotropicT, MeshT, Isotropic);

  explicit ModIsotropicT(MeshT& mesh) : Base(mesh, false) {}

  /// The largest squared edge over quality of the faces that would be left around ci.v1.
  float collapse_priority(const CollapseInfo& ci) override {
    double worst = 0;
    for (const auto f : Base::mesh().vf_range(ci.v0)) {
      Vector3d corner[3];
      bool lost = false;
      int k = 0;
      for (const auto v : Base::mesh().fv_range(f)) {
        lost = lost || v == ci.v1;
        const auto p = v == ci.v0 ? ci.p1 : Base::mesh().point(v);
        corner[k++] = {p[0], p[1], p[2]};
      }
      if (lost) continue;
      const Vector3d u = corner[1] - corner[0], v = corner[2] - corner[0], w = v - u;
      const double longest = std::max({u.squaredNorm(), v.squaredNorm(), w.squaredNorm()});
      const double quality = 2 * std::sqrt(3.0) * u.cross(v).norm() /
                             (u.squaredNorm() + v.squaredNorm() + w.squaredNorm());
      constexpr double kLeastQuality = 1e-3;
      worst = std::max(worst, longest / std::max(quality, kLeastQuality));
    }
    // Stars of many faces have thin kernels.
    constexpr double kManyEdges = 9;
    const double edges = Base::mesh().valence(ci.v0) + Base::mesh().valence(ci.v1) - 4.0;
    return static_cast<float>(worst * std::pow(std::max(1.0, edges / kManyEdges), 4));
  }
};

using CollapseList = std::vector<std::pair<int, int>>;

/// The collapses (removed, kept) that bring the mesh down to `vertices`, cheapest first; vertices
/// in `locked` stay.
CollapseList decimate(const MatrixX3d& V,
                      const MatrixX3i& F,
                      int vertices,
                      const std::vector<int>& locked,
                      bool keep_normals) {
  OmMesh om = to_openmesh(V, F);
  for (int v : locked) om.status(om.vertex_handle(static_cast<unsigned>(v))).set_locked(true);
  OpenMesh::Decimater::DecimaterT<OmMesh> decimater(om);
  ModIsotropicT<OmMesh>::Handle isotropic;
  OpenMesh::Decimater::ModProgMeshT<OmMesh>::Handle history;
  OpenMesh::Decimater::ModNormalFlippingT<OmMesh>::Handle turning;
  decimater.add(isotropic);
  decimater.add(history);
  if (keep_normals) {
    decimater.add(turning);
    decimater.module(turning).set_max_normal_deviation(90);
  }
  CollapseList collapses;
  if (!decimater.initialize()) return collapses;
  decimater.decimate_to(at(vertices));
  for (const auto& info : decimater.module(history).infolist())
    collapses.emplace_back(info.v0.idx(), info.v1.idx());
  return collapses;
}

/// The faces left by the collapses, over the vertices left; `vertex` gives their numbers before.
MatrixX3i collapsed_faces(const MatrixX3i& F,
                          int vertices,
                          const CollapseList& collapses,
                          std::vector<int>& vertex) {
  std::vector<int> into(at(vertices));
  std::iota(into.begin(), into.end(), 0);
  for (auto it = collapses.rbegin(); it != collapses.rend(); ++it)
    into[at(it->first)] = into[at(it->second)];
  std::vector<int> compact(at(vertices), -1);
  for (int v = 0; v < vertices; ++v)
    if (into[at(v)] == v) {
      compact[at(v)] = static_cast<int>(vertex.size());
      vertex.push_back(v);
    }
  MatrixX3i left(F.rows(), 3);
  int rows = 0;
  for (int f = 0; f < F.rows(); ++f) {
    const int a = into[at(F(f, 0))], b = into[at(F(f, 1))], c = into[at(F(f, 2))];
    if (a != b && b != c && c != a)
      left.row(rows++) << compact[at(a)], compact[at(b)], compact[at(c)];
  }
  left.conservativeResize(rows, 3);
  return left;
}

}  // namespace

Result<ProgressiveMesh> make_progressive_mesh(const TriangleMesh& mesh,
                                              const ProgressiveOptions& options) {
  CollapseList collapses;
  // What the rule on normals leaves over is collapsed without it; landmarks go only below the
  // levels that stand for the shape.
  const auto collapse_to = [&](int vertices, bool keep_landmarks, bool keep_normals) {
    std::vector<int> vertex, locked;
    const MatrixX3i F = collapsed_faces(mesh.F, mesh.vertex_count(), collapses, vertex);
    if (static_cast<int>(vertex.size()) <= vertices) return;
    for (int v : options.protected_vertices)
      if (keep_landmarks)
        locked.push_back(
            static_cast<int>(std::lower_bound(vertex.begin(), vertex.end(), v) - vertex.begin()));
    const MatrixX3d V = mesh.V(vertex, Eigen::all);
    for (const auto& [removed, kept] : decimate(V, F, vertices, locked, keep_normals))
      collapses.emplace_back(vertex[at(removed)], vertex[at(kept)]);
  };
  collapse_to(options.shape_vertices, true, true);
  collapse_to(options.shape_vertices, true, false);
  collapse_to(4, false, false);
  const int left = mesh.vertex_count() - static_cast<int>(collapses.size());
  if (left != 4)
    return fail(
        ErrorCode::kNumerical,
        fmt::format("progressive mesh: {} vertices cannot be collapsed further, 4 expected", left));
  ProgressiveMesh full;
  full.vertex_count = mesh.vertex_count();
  full.coarsest = mesh.F;
  full.alive.assign(at(mesh.face_count()), true);
  Refinement walk(std::move(full));
  for (const auto& [removed, kept] : collapses) walk.collapse(removed, kept);
  return std::move(walk).progressive();
}

Refinement::Refinement(ProgressiveMesh progressive)
    : progressive_(std::move(progressive)),
      next_(progressive_.collapse_count()),
      F_(progressive_.coarsest),
      alive_(progressive_.alive),
      faces_(at(progressive_.vertex_count)) {
  for (int f = 0; f < F_.rows(); ++f)
    if (alive_[at(f)])
      for (int k = 0; k < 3; ++k) faces_[at(F_(f, k))].push_back(f);
}

int Refinement::split() {
  const ProgressiveMesh& p = progressive_;
  const size_t i = at(--next_);
  const int removed = p.removed[i], kept = p.kept[i];
  for (int j = p.begin[i]; j < p.begin[i + 1]; ++j) {
    const int f = p.turned[at(j)];
    for (int k = 0; k < 3; ++k)
      if (F_(f, k) == kept) F_(f, k) = removed;
    std::erase(faces_[at(kept)], f);
    faces_[at(removed)].push_back(f);
  }
  for (int f : p.lost[i]) {
    alive_[at(f)] = true;
    for (int k = 0; k < 3; ++k) faces_[at(F_(f, k))].push_back(f);
  }
  return removed;
}

void Refinement::collapse(int v, int kept) {
  ProgressiveMesh& p = progressive_;
  p.removed.resize(at(next_));
  p.kept.resize(at(next_));
  p.lost.resize(at(next_));
  p.begin.resize(at(next_) + 1);
  p.turned.resize(at(p.begin.back()));
  std::array<int, 2> lost{-1, -1};
  int n = 0;
  for (int f : faces_[at(v)]) {
    auto row = F_.row(f);
    if (row[0] == kept || row[1] == kept || row[2] == kept) {
      lost[at(n++)] = f;
      alive_[at(f)] = false;
      for (int k = 0; k < 3; ++k)
        if (row[k] != v) std::erase(faces_[at(row[k])], f);
    } else {
      for (int k = 0; k < 3; ++k)
        if (row[k] == v) row[k] = kept;
      faces_[at(kept)].push_back(f);
      p.turned.push_back(f);
    }
  }
  faces_[at(v)].clear();
  p.removed.push_back(v);
  p.kept.push_back(kept);
  p.lost.push_back(lost);
  p.begin.push_back(static_cast<int>(p.turned.size()));
  ++next_;
}

std::vector<int> Refinement::neighbours(int v) const {
  std::vector<int> ring;
  for (int f : faces_[at(v)])
    for (int k = 0; k < 3; ++k)
      if (F_(f, k) != v) ring.push_back(F_(f, k));
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return ring;
}

bool Refinement::can_collapse(int v, int kept) const {
  if (vertex_count() <= 4) return false;
  const std::vector<int> a = neighbours(v), b = neighbours(kept);
  std::vector<int> common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
  return common.size() == 2 && std::binary_search(a.begin(), a.end(), kept);
}

ProgressiveMesh Refinement::progressive() && {
  progressive_.coarsest = std::move(F_);
  progressive_.alive = std::move(alive_);
  return std::move(progressive_);
}

MatrixX3i Refinement::compact_faces() const {
  MatrixX3i faces(std::count(alive_.begin(), alive_.end(), true), 3);
  int row = 0;
  for (int f = 0; f < F_.rows(); ++f)
    if (alive_[at(f)]) faces.row(row++) = F_.row(f);
  return faces;
}

Result<MeshLevel> mesh_level(const TriangleMesh& mesh,
                             const ProgressiveMesh& progressive,
                             int vertices) {
  Refinement refinement(progressive);
  while (!refinement.done() && refinement.vertex_count() < vertices) refinement.split();
  return mesh_level(mesh, refinement);
}

Result<MeshLevel> mesh_level(const TriangleMesh& mesh, const Refinement& refinement) {
  MatrixX3i F = refinement.compact_faces();
  std::vector<int> level_vertex(at(mesh.vertex_count()), -1);
  MeshLevel level;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    if (!refinement.faces(v).empty()) {
      level_vertex[at(v)] = static_cast<int>(level.vertex.size());
      level.vertex.push_back(v);
    }
  MatrixX3d V(static_cast<Eigen::Index>(level.vertex.size()), 3);
  for (int i = 0; i < V.rows(); ++i) V.row(i) = mesh.V.row(level.vertex[at(i)]);
  F = F.unaryExpr([&](int v) { return level_vertex[at(v)]; }).eval();
  auto made = make_mesh(std::move(V), std::move(F));
  if (!made) return tl::unexpected(made.error());
  level.mesh = std::move(*made);
  return level;
}

}  // namespace crosspatch
