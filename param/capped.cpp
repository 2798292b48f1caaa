#include "param/capped.hpp"

#include <algorithm>

#include "core/index.hpp"
#include "core/union_find.hpp"

namespace crosspatch {
namespace {

std::vector<int> sorted(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  return values;
}

/// The boundary loops of the cut surface and the caps that close them.
std::vector<Cap> find_caps(const CutMesh& cut, const FilledMesh& filled) {
  std::vector<std::vector<int>> banks;
  for (const std::vector<int>& loop : cut.loops) banks.push_back(sorted(loop));
  std::vector<Cap> caps;
  for (std::vector<int>& rim : boundary_loops(cut.mesh)) {
    Cap cap;
    std::vector<int> original;
    for (const int v : rim) original.push_back(cut.vertex[idx(v)]);
    const auto bank = std::find(banks.begin(), banks.end(), sorted(original));
    if (bank != banks.end()) cap.handle = static_cast<int>(bank - banks.begin());
    cap.rim = std::move(rim);
    caps.push_back(std::move(cap));
  }
  UnionFind parts(filled.mesh.face_count());
  for (int h = 3 * filled.face_count; h < filled.mesh.halfedge_count(); ++h)
    if (const int other = face_of(filled.mesh.twin[idx(h)]); other >= filled.face_count)
      parts.join(face_of(h), other);
  for (Cap& cap : caps) {
    const int h = find_halfedge(filled.mesh, cap.rim[1], cap.rim[0]);
    for (int f = filled.face_count; f < filled.mesh.face_count(); ++f)
      if (parts.find(f) == parts.find(face_of(h))) cap.faces.push_back(f);
  }
  return caps;
}

}  // namespace

Result<CappedSurface> cap_surface(const TriangleMesh& mesh) {
  auto cut = cut_handles(mesh);
  if (!cut) return tl::unexpected(cut.error());
  auto filled = fill_holes(cut->mesh);
  if (!filled) return tl::unexpected(filled.error());
  CappedSurface capped{
      std::move(*cut), std::move(*filled), {}, static_cast<int>(boundary_loops(mesh).size())};
  capped.caps = find_caps(capped.cut, capped.filled);
  return capped;
}

}  // namespace crosspatch
