#include "param/piece.hpp"

#include <array>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {

using std::size_t;

namespace {

std::vector<PiecePolygon> as_polygons(const Piece& piece) {
  std::vector<PiecePolygon> polygons;
  for (int f = 0; f < piece.mesh.face_count(); ++f)
    polygons.push_back(
        {{piece.mesh.F(f, 0), piece.mesh.F(f, 1), piece.mesh.F(f, 2)}, piece.parent_face[idx(f)]});
  return polygons;
}

}  // namespace

std::vector<int> with_points(const std::vector<int>& corners, const SidePoints& between) {
  std::vector<int> all;
  for (size_t i = 0; i < corners.size(); ++i) {
    const int u = corners[i], v = corners[(i + 1) % corners.size()];
    all.push_back(u);
    if (const auto at = between.find({u, v}); at != between.end())
      all.insert(all.end(), at->second.begin(), at->second.end());
    else if (const auto back = between.find({v, u}); back != between.end())
      all.insert(all.end(), back->second.rbegin(), back->second.rend());
  }
  return all;
}

Result<Piece> triangulate(const TriangleMesh& parent,
                          const std::vector<PiecePolygon>& polygons,
                          std::vector<SurfacePoint> origin,
                          std::vector<int> point) {
  Piece piece;
  std::vector<std::array<int, 3>> faces;
  for (const PiecePolygon& p : polygons) {
    const size_t n = p.corners.size();
    if (n == 3) {
      faces.push_back({p.corners[0], p.corners[1], p.corners[2]});
      piece.parent_face.push_back(p.face);
      continue;
    }
    SurfacePoint middle{p.face, Vector3d::Zero()};
    for (const int v : p.corners)
      middle.bary += in_face(parent, origin[idx(v)], p.face).bary / static_cast<double>(n);
    for (size_t i = 0; i < n; ++i) {
      faces.push_back({p.corners[i], p.corners[(i + 1) % n], static_cast<int>(origin.size())});
      piece.parent_face.push_back(p.face);
    }
    origin.push_back(middle);
    point.push_back(-1);
  }
  MatrixX3d V(static_cast<Eigen::Index>(origin.size()), 3);
  for (size_t i = 0; i < origin.size(); ++i)
    V.row(static_cast<Eigen::Index>(i)) = position(parent, origin[i]).transpose();
  MatrixX3i F(static_cast<Eigen::Index>(faces.size()), 3);
  for (size_t i = 0; i < faces.size(); ++i)
    F.row(static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
  auto mesh = make_mesh(std::move(V), std::move(F));
  if (!mesh) return tl::unexpected(mesh.error());
  piece.mesh = std::move(*mesh);
  piece.origin = std::move(origin);
  piece.point = std::move(point);
  return piece;
}

Result<Piece> with_points(const TriangleMesh& parent,
                          const Piece& piece,
                          const SidePoints& between,
                          const std::vector<SurfacePoint>& added) {
  std::vector<PiecePolygon> polygons = as_polygons(piece);
  for (PiecePolygon& p : polygons) p.corners = with_points(p.corners, between);
  std::vector<SurfacePoint> origin = piece.origin;
  origin.insert(origin.end(), added.begin(), added.end());
  std::vector<int> point = piece.point;
  point.resize(origin.size(), -1);
  return triangulate(parent, polygons, std::move(origin), std::move(point));
}

SurfacePoint on_edge(const TriangleMesh& parent, const Piece& piece, int h, double share) {
  const int face = piece.parent_face[idx(face_of(h))];
  const auto end = [&](int v) { return in_face(parent, piece.origin[idx(v)], face).bary; };
  return {face, (1 - share) * end(piece.mesh.from(h)) + share * end(piece.mesh.to(h))};
}

Result<Piece> without_chords(const TriangleMesh& parent, const Piece& piece) {
  const TriangleMesh& mesh = piece.mesh;
  std::vector<bool> rim(idx(mesh.vertex_count()), false);
  for (int h = 0; h < mesh.halfedge_count(); ++h)
    if (mesh.twin[idx(h)] < 0) rim[idx(mesh.from(h))] = true;
  SidePoints between;
  std::vector<SurfacePoint> added;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    if (h > mesh.twin[idx(h)] || !rim[idx(mesh.from(h))] || !rim[idx(mesh.to(h))]) continue;
    between[{mesh.from(h), mesh.to(h)}] = {mesh.vertex_count() + static_cast<int>(added.size())};
    added.push_back(on_edge(parent, piece, h, 0.5));
  }
  return with_points(parent, piece, between, added);
}

}  // namespace crosspatch
