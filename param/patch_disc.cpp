#include "param/patch_disc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/index.hpp"
#include "param/face_subdivision.hpp"
#include "param/surface_map.hpp"
#include "param/tutte.hpp"

namespace crosspatch {
namespace {

using std::size_t;

MatrixX3i face_matrix(const std::vector<std::array<int, 3>>& faces) {
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (size_t f = 0; f < faces.size(); ++f)
    F.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return F;
}

/// Splits the chords of the disc; new vertices get their place on the drawn mesh.
void split_disc_chords(PatchDisc& disc, const TriangleMesh& drawn) {
  SplitMesh split = split_chords(disc.mesh);
  const size_t old = disc.origin.size();
  disc.origin.resize(idx(split.mesh.vertex_count()));
  disc.vertex.resize(disc.origin.size(), -1);
  std::vector<int> parents;
  for (int f = 0; f < split.mesh.face_count(); ++f) {
    const int parent = disc.parent_face[idx(split.parent_face[idx(f)])];
    parents.push_back(parent);
    for (int k = 0; k < 3; ++k) {
      const int v = split.mesh.F(f, k);
      if (idx(v) < old) continue;
      const auto& [a, b] = split.parent_edge[idx(v) - old];
      disc.origin[idx(v)] = {parent,
                             (in_face(drawn, disc.origin[idx(a)], parent).bary +
                              in_face(drawn, disc.origin[idx(b)], parent).bary) /
                                 2};
    }
  }
  disc.mesh = std::move(split.mesh);
  disc.parent_face = std::move(parents);
}

}  // namespace

std::vector<double> arc_fractions(const TriangleMesh& mesh, const std::vector<int>& path) {
  constexpr double kUnit = 0x1p40;
  std::vector<double> s{0};
  for (size_t i = 1; i < path.size(); ++i)
    s.push_back(s.back() + (mesh.V.row(path[i]) - mesh.V.row(path[i - 1])).norm());
  const double length = s.back();
  const auto n = static_cast<double>(path.size() - 1);
  for (size_t i = 0; i < s.size(); ++i) {
    const double share = length > 0 ? s[i] / length : static_cast<double>(i) / n;
    s[i] = std::round(share * kUnit);
  }
  for (size_t i = 1; i < s.size(); ++i) s[i] = std::max(s[i], s[i - 1] + 1);
  s.back() = kUnit;
  for (size_t i = s.size() - 1; i-- > 0;) s[i] = std::min(s[i], s[i + 1] - 1);
  for (double& share : s) share /= kUnit;
  return s;
}

PatchCutter::PatchCutter(const DrawnLayout& drawn)
    : drawn_(drawn),
      dart_(darts_on_halfedges(drawn.mesh, drawn.path).value()),
      faces_(idx(drawn.layout.face_count)),
      place_(idx(drawn.mesh.face_count())) {
  for (int f = 0; f < drawn.mesh.face_count(); ++f) {
    std::vector<int>& list = faces_[idx(drawn.patch[idx(f)])];
    place_[idx(f)] = static_cast<int>(list.size());
    list.push_back(f);
  }
  for (const std::vector<int>& path : drawn.path) own_.push_back(arc_fractions(drawn.mesh, path));
}

/// Per corner of the patch's faces, in their order: the vertex of the disc, numbered as found.
std::vector<int> PatchCutter::corner_classes(int face, int& count) const {
  const std::vector<int>& faces = faces_[idx(face)];
  std::vector<int> parent(3 * faces.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int c) {
    while (parent[idx(c)] != c) c = parent[idx(c)] = parent[idx(parent[idx(c)])];
    return c;
  };
  const auto corner = [&](int h) { return 3 * place_[idx(face_of(h))] + h % 3; };
  for (const int f : faces)
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int t = drawn_.mesh.twin[idx(h)];
      if (dart_[idx(h)] < 0 && h < t) {
        parent[idx(root(corner(h)))] = root(corner(next(t)));
        parent[idx(root(corner(next(h))))] = root(corner(t));
      }
    }
  std::vector<int> name(parent.size(), -1), classes(parent.size());
  count = 0;
  for (int c = 0; c < static_cast<int>(parent.size()); ++c) {
    int& n = name[idx(root(c))];
    if (n < 0) n = count++;
    classes[idx(c)] = n;
  }
  return classes;
}

Result<PatchDisc> PatchCutter::cut(int face,
                                   const std::vector<std::vector<double>>& fractions) const {
  PatchDisc disc;
  int count = 0;
  const std::vector<int> classes = corner_classes(face, count);
  disc.origin.resize(idx(count));
  disc.vertex.resize(idx(count));
  const auto corner = [&](int h) { return classes[3 * idx(place_[idx(face_of(h))]) + idx(h % 3)]; };
  for (const int f : faces_[idx(face)])
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      disc.origin[idx(corner(h))] = {f, Vector3d::Unit(h % 3)};
      disc.vertex[idx(corner(h))] = drawn_.mesh.from(h);
    }
  // Along the sides: the loop, and the vertices to be added on each half-edge.
  std::map<int, std::vector<FacePoint>> added;
  const std::vector<int> darts = darts_of_face(drawn_.layout, face);
  for (size_t k = 0; k < darts.size(); ++k) {
    const int arc = darts[k] / 2;
    const bool forward = darts[k] % 2 == 0;
    const std::vector<int>& path = drawn_.path[idx(arc)];
    const std::vector<double>& own = own_[idx(arc)];
    for (size_t i = 0; i + 1 < path.size(); ++i) {
      const size_t from = forward ? i : path.size() - 1 - i, to = forward ? i + 1 : from - 1;
      const int h = find_halfedge(drawn_.mesh, path[from], path[to]);
      const auto append = [&](int vertex, double share) {
        disc.loop.push_back(vertex);
        disc.side.push_back(static_cast<int>(k));
        disc.share.push_back(share);
      };
      append(corner(h), own[from]);
      const double low = std::min(own[from], own[to]), high = std::max(own[from], own[to]);
      std::vector<double> inside;
      for (const double s : fractions[idx(arc)])
        if (s > low && s < high) inside.push_back(s);
      if (!forward) std::reverse(inside.begin(), inside.end());
      for (const double s : inside) {
        const double t = (s - own[from]) / (own[to] - own[from]);
        Vector3d bary = Vector3d::Zero();
        bary[h % 3] = 1 - t;
        bary[(h + 1) % 3] = t;
        added[h].push_back({static_cast<int>(disc.origin.size()), bary});
        append(static_cast<int>(disc.origin.size()), s);
        disc.origin.push_back({face_of(h), bary});
        disc.vertex.push_back(-1);
      }
    }
  }
  std::vector<std::array<int, 3>> triangles;
  for (const int f : faces_[idx(face)]) {
    std::vector<FacePoint> boundary;
    Eigen::Matrix3d corners;
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      corners.row(h % 3) = drawn_.mesh.V.row(drawn_.mesh.from(h));
      boundary.push_back({corner(h), Vector3d::Unit(h % 3)});
      if (const auto at = added.find(h); at != added.end())
        boundary.insert(boundary.end(), at->second.begin(), at->second.end());
    }
    const FaceSubdivision cut = subdivide_face(corners, boundary, {}, std::nullopt);
    triangles.insert(triangles.end(), cut.triangles.begin(), cut.triangles.end());
    disc.parent_face.insert(disc.parent_face.end(), cut.triangles.size(), f);
  }
  MatrixX3d V(static_cast<Eigen::Index>(disc.origin.size()), 3);
  for (int v = 0; v < V.rows(); ++v) V.row(v) = position(drawn_.mesh, disc.origin[idx(v)]);
  auto mesh = make_mesh(std::move(V), face_matrix(triangles));
  if (!mesh || euler_characteristic(*mesh) != 1)
    return fail(ErrorCode::kInternal,
                fmt::format("patch {}: {}", face, mesh ? "not a disc" : mesh.error().message));
  disc.mesh = std::move(*mesh);
  split_disc_chords(disc, drawn_.mesh);
  return disc;
}

}  // namespace crosspatch
