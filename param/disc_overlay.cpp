// The rectangle lies in the plane z = 1; an apex at (0, 0, -1) joined to its rim closes it to a
// sphere under central projection, so that the exact overlay of spheres serves discs as well.
#include "param/disc_overlay.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/fill_holes.hpp"
#include "core/index.hpp"
#include "param/overlay.hpp"
#include "param/predicates.hpp"

namespace crosspatch {
namespace {

struct Closed {
  TriangleMesh mesh;
  MatrixX3d X;
};

Closed close_disc(const FlatDisc& disc) {
  const int n = disc.mesh.vertex_count(), rim = static_cast<int>(disc.loop.size());
  MatrixX3i F(disc.mesh.face_count() + rim, 3);
  F.topRows(disc.mesh.face_count()) = disc.mesh.F;
  for (int i = 0; i < rim; ++i)
    F.row(disc.mesh.face_count() + i) << disc.loop[idx((i + 1) % rim)], disc.loop[idx(i)], n;
  MatrixX3d X(n + 1, 3);
  X.topLeftCorner(n, 2) = disc.uv;
  X.col(2).head(n).setOnes();
  X.row(n) << 0, 0, -1;
  return {make_mesh(X, F).value(), X};
}

/// Moves an inner vertex a little, its triangles staying positive; false if it cannot move.
bool nudge(Closed& closed, int vertex, int attempt) {
  if (closed.X(vertex, 2) < 0) return false;
  const TriangleMesh& mesh = closed.mesh;
  double shortest = HUGE_VAL;
  for_each_outgoing(mesh, vertex, [&](int h) {
    shortest = std::min(shortest, (closed.X.row(mesh.to(h)) - closed.X.row(vertex)).norm());
  });
  const Vector3d before = closed.X.row(vertex);
  // Directions by the golden angle, so that attempts do not repeat one.
  const double angle = 2.399963 * attempt;
  for (double step = 1e-6 * shortest; step > 1e-13 * shortest; step /= 4) {
    closed.X.row(vertex) = before + step * Vector3d(std::cos(angle), std::sin(angle), 0);
    bool positive = true;
    for_each_outgoing(mesh, vertex, [&](int h) {
      positive = positive &&
                 orient_sphere(
                     closed.X.row(vertex), closed.X.row(mesh.to(h)), closed.X.row(mesh.tip(h))) > 0;
    });
    if (positive) return true;
  }
  closed.X.row(vertex) = before;
  return false;
}

bool on_rim(const FlatDisc& disc, int vertex) {
  return std::find(disc.loop.begin(), disc.loop.end(), vertex) != disc.loop.end() ||
         vertex == disc.mesh.vertex_count();
}

/// Puts the apex below a place of the rectangle that symmetric rims do not have in line with two of
/// their vertices; another place with each attempt.
void place_apex(Closed& closed, int attempt) {
  const double angle = 1 + 2.399963 * attempt;
  closed.X.bottomRows(1) << 0.1234567 * std::cos(angle), 0.1234567 * std::sin(angle), -1;
}

FilledMesh as_filled(const Closed& closed, const FlatDisc& disc) {
  return {closed.mesh, disc.mesh.vertex_count(), disc.mesh.face_count(), 1};
}

}  // namespace

Result<SurfaceMap> overlay_discs(const FlatDisc& disc_a, const FlatDisc& disc_b) {
  Closed a = close_disc(disc_a), b = close_disc(disc_b);
  constexpr int kAttempts = 500;
  std::string why;
  place_apex(a, 0);
  place_apex(b, 0);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    SpecialPosition special;
    const auto map = overlay_on_sphere(a.mesh, a.X, b.mesh, b.X, &special);
    if (map) return without_caps(*map, as_filled(a, disc_a), as_filled(b, disc_b));
    why = map.error().message;
    if (special.vertex < 0) break;
    if (on_rim(special.on_source ? disc_a : disc_b, special.vertex)) {
      place_apex(a, attempt + 1);
      place_apex(b, attempt + 1);
    } else if (!nudge(special.on_source ? a : b, special.vertex, attempt)) {
      break;
    }
  }
  return fail(ErrorCode::kNumerical, why);
}

SurfacePoint on_parent(const TriangleMesh& piece,
                       const std::vector<SurfacePoint>& origin,
                       const std::vector<int>& parent_face,
                       const TriangleMesh& parent,
                       const SurfacePoint& p) {
  for (int k = 0; k < 3; ++k)
    if (p.bary[k] == 1) return origin[idx(piece.F(p.face, k))];
  SurfacePoint q{parent_face[idx(p.face)], Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    q.bary += p.bary[k] * in_face(parent, origin[idx(piece.F(p.face, k))], q.face).bary;
  return q;
}

}  // namespace crosspatch
