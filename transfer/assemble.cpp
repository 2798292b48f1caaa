#include "transfer/assemble.hpp"

#include "core/index.hpp"

namespace crosspatch {

/// Unit normals per corner of the prepared mesh, 3 #F.
std::vector<Vector3d> corner_normals(const AttributedMesh& m) {
  const TriangleMesh& mesh = m.prepared.mesh;
  std::vector<Vector3d> normals(idx(mesh.halfedge_count()));
  const MatrixX3d smooth = vertex_normals(mesh);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    Vector3d n = Vector3d::Zero();
    if (!m.soup.corner_normals.empty())
      n = m.soup.corner_normals[idx(m.prepared.numbering.soup_corner[idx(h)])];
    if (!n.allFinite() || n.norm() < 1e-12) n = smooth.row(mesh.from(h)).transpose();
    normals[idx(h)] = n.normalized();
  }
  return normals;
}

namespace {

class Assembly {
 public:
  Assembly(const AttributedMesh& source,
           const AttributedMesh& target,
           const SourceAttributes& attributes)
      : attributes_(attributes), target_(target.prepared.mesh), normals_(corner_normals(target)) {
    mesh_.materials = source.soup.materials;
    mesh_.images = source.soup.images;
    mesh_.node_transform = target.soup.node_transform;
    mesh_.uv_sets.resize(idx(attributes.uv_sets));
  }

  TexturedMesh run(const OverlayMesh& overlay) {
    std::vector<int> row(overlay.points.size(), -1);
    std::vector<int> used;
    mesh_.triangles.resize(static_cast<Eigen::Index>(overlay.triangles.size()), 3);
    reserve(overlay.triangles.size());
    for (std::size_t t = 0; t < overlay.triangles.size(); ++t) {
      const OverlayMesh::Triangle& triangle = overlay.triangles[t];
      mesh_.target_face.push_back(triangle.target_face);
      mesh_.material.push_back(material_of(triangle));
      for (std::size_t k = 0; k < 3; ++k) {
        const int w = triangle.wedge[k];
        const int point = overlay.wedge_point[idx(w)];
        if (row[idx(point)] < 0) {
          row[idx(point)] = static_cast<int>(used.size());
          used.push_back(point);
        }
        mesh_.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(k)) =
            row[idx(point)];
        add_corner(overlay, triangle, w);
      }
    }
    mesh_.positions.resize(static_cast<Eigen::Index>(used.size()), 3);
    for (std::size_t i = 0; i < used.size(); ++i) {
      // Points behind those of the map are vertices that it does not reach.
      mesh_.map_point.push_back(used[i] < overlay.map_points ? used[i] : -1);
      mesh_.positions.row(static_cast<Eigen::Index>(i)) = place(overlay, used[i]).transpose();
    }
    return std::move(mesh_);
  }

 private:
  /// Grown bit by bit, these leave much of the heap in holes.
  void reserve(std::size_t triangles) {
    mesh_.target_face.reserve(triangles);
    mesh_.material.reserve(triangles);
    mesh_.normals.reserve(3 * triangles);
    for (auto& set : mesh_.uv_sets) set.reserve(3 * triangles);
    if (attributes_.colors) mesh_.colors.reserve(3 * triangles);
  }

  /// Interpolation would move a vertex of the target in its last digit.
  Vector3d place(const OverlayMesh& overlay, int point) const {
    const SurfacePoint& p = overlay.points[idx(point)];
    for (int k = 0; k < 3; ++k)
      if (p.bary[k] == 1) return target_.position(target_.F(p.face, k));
    return position(target_, p);
  }

  void add_corner(const OverlayMesh& overlay, const OverlayMesh::Triangle& triangle, int wedge) {
    const int face = triangle.target_face;
    const SurfacePoint p =
        in_face(target_, overlay.points[idx(overlay.wedge_point[idx(wedge)])], face);
    const Vector3d normal = p.bary[0] * normals_[idx(3 * face)] +
                            p.bary[1] * normals_[idx(3 * face + 1)] +
                            p.bary[2] * normals_[idx(3 * face + 2)];
    mesh_.normals.push_back(normal.norm() > 1e-12 ? Vector3d(normal.normalized())
                                                  : Vector3d(Vector3d::Zero()));
    const double* value = overlay.attributes.data() + idx(wedge * attributes_.width);
    for (int s = 0; s < attributes_.uv_sets; ++s)
      mesh_.uv_sets[idx(s)].emplace_back(value[idx(2 * s)], value[idx(2 * s + 1)]);
    if (!attributes_.colors) return;
    if (!triangle.mapped) {
      mesh_.colors.push_back({1, 1, 1, 1});  // the material's grey shows
      return;
    }
    const double* rgba = value + idx(2 * attributes_.uv_sets);
    mesh_.colors.push_back({static_cast<float>(rgba[0]),
                            static_cast<float>(rgba[1]),
                            static_cast<float>(rgba[2]),
                            static_cast<float>(rgba[3])});
  }

  int material_of(const OverlayMesh::Triangle& triangle) {
    if (triangle.mapped && triangle.material >= 0) return triangle.material;
    int& index = triangle.mapped ? plain_ : unmapped_;
    if (index < 0) {
      index = static_cast<int>(mesh_.materials.size());
      Material m;
      m.name = triangle.mapped ? "default" : kUnmappedMaterial;
      // Mid grey, so that missing parts are neither black nor taken for white fur.
      if (!triangle.mapped) m.base_color_factor = {0.5, 0.5, 0.5, 1};
      mesh_.materials.push_back(m);
    }
    return index;
  }

  const SourceAttributes& attributes_;
  const TriangleMesh& target_;
  std::vector<Vector3d> normals_;
  TexturedMesh mesh_;
  int plain_ = -1;
  int unmapped_ = -1;
};

}  // namespace

TexturedMesh assemble(const AttributedMesh& source,
                      const AttributedMesh& target,
                      const SourceAttributes& attributes,
                      const OverlayMesh& overlay) {
  return Assembly(source, target, attributes).run(overlay);
}

}  // namespace crosspatch
