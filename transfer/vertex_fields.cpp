#include "transfer/vertex_fields.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Weights below it are what rounding leaves.
constexpr double kNothing = 1e-12;

/// File vertex at each corner of a face of the prepared mesh.
std::array<int, 3> file_vertices(const AttributedMesh& mesh, int face) {
  std::array<int, 3> vertices;
  for (int k = 0; k < 3; ++k)
    vertices[idx(k)] =
        mesh.soup.corner_vertex[idx(mesh.prepared.numbering.soup_corner[idx(3 * face + k)])];
  return vertices;
}

double interpolated(const VertexField& field,
                    const std::array<int, 3>& vertices,
                    const SurfacePoint& p) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    if (p.bary[k] > kNothing) sum += p.bary[k] * field.values(vertices[idx(k)], 0);
  return sum;
}

double nearest(const VertexField& field,
               const std::array<int, 3>& vertices,
               const SurfacePoint& p) {
  int best = 0;
  for (int k = 1; k < 3; ++k)
    if (p.bary[k] > p.bary[best] ||
        (p.bary[k] == p.bary[best] && vertices[idx(k)] < vertices[idx(best)]))
      best = k;
  return field.values(vertices[idx(best)], 0);
}

/// A corner of a polygon of the map at a vertex of the target.
struct MapCorner {
  int polygon = -1;
  int before = -1, at = -1, after = -1;  ///< points of the map
};

/// The corners of the map's polygons at each vertex of the target.
std::vector<std::vector<MapCorner>> corners_at_vertices(const SurfaceMap& map, int vertices) {
  std::vector<int> vertex_of_point(idx(map.point_count()), -1);
  for (int v = 0; v < vertices; ++v)
    if (const int q = map.point_of_target_vertex[idx(v)]; q >= 0) vertex_of_point[idx(q)] = v;
  std::vector<std::vector<MapCorner>> corners(idx(vertices));
  for (int p = 0; p < map.polygon_count(); ++p) {
    const int begin = map.polygon_begin[idx(p)], end = map.polygon_begin[idx(p + 1)];
    for (int i = begin; i < end; ++i) {
      const int at = map.corner[idx(i)];
      if (vertex_of_point[idx(at)] < 0) continue;
      corners[idx(vertex_of_point[idx(at)])].push_back(
          {p,
           map.corner[idx(i > begin ? i - 1 : end - 1)],
           at,
           map.corner[idx(i + 1 < end ? i + 1 : begin)]});
    }
  }
  return corners;
}

Vector3d face_normal(const TriangleMesh& mesh, int f) {
  const Vector3d a = mesh.position(mesh.F(f, 0));
  return (mesh.position(mesh.F(f, 1)) - a)
      .cross(mesh.position(mesh.F(f, 2)) - a)
      .stableNormalized();
}

/// The least turn that takes one normal to the other; none where either is missing.
Vector3d turned(const Vector3d& vector, const Vector3d& from, const Vector3d& to) {
  if (from.isZero(0) || to.isZero(0)) return vector;
  return Eigen::Quaterniond::FromTwoVectors(from, to) * vector;
}

/// Pushes tangent vectors through the map.
class Differential {
 public:
  Differential(const AttributedMesh& source, const AttributedMesh& target, const SurfaceMap& map)
      : source_(source),
        target_(target.prepared.mesh),
        map_(map),
        source_normals_(vertex_normals(source.prepared.mesh)),
        target_normals_(vertex_normals(target_)),
        corners_(corners_at_vertices(map, target_.vertex_count())) {}

  /// The field at a vertex of the target; NaN where it is not given or the map is flat.
  [[nodiscard]] Vector3d at(int vertex, const VertexField& field) const {
    const Vector3d normal = target_normals_.row(vertex).transpose();
    Vector3d sum = Vector3d::Zero();
    double total = 0;
    for (const MapCorner& corner : corners_[idx(vertex)]) {
      const Push push = pushed(corner, field);
      if (!(push.angle > 0)) continue;
      sum +=
          push.angle *
          turned(push.vector, face_normal(target_, map_.target_face[idx(corner.polygon)]), normal);
      total += push.angle;
    }
    if (total > 0) return sum / total;
    return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }

 private:
  struct Push {
    Vector3d vector = Vector3d::Zero();
    double angle = 0;  ///< of the corner on the target; 0 where the map has no differential
  };

  /// The field in the plane of a source face.
  [[nodiscard]] Vector3d on_source(const SurfacePoint& p, const VertexField& field) const {
    const TriangleMesh& mesh = source_.prepared.mesh;
    const std::array<int, 3> vertices = file_vertices(source_, p.face);
    const Vector3d normal = face_normal(mesh, p.face);
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      if (p.bary[k] > kNothing)
        sum += p.bary[k] * turned(field.values.row(vertices[idx(k)]).transpose(),
                                  source_normals_.row(mesh.F(p.face, k)).transpose(),
                                  normal);
    return sum - sum.dot(normal) * normal;
  }

  /// The affine map of the corner's own triangle, the one that the target's edges span there.
  [[nodiscard]] Push pushed(const MapCorner& corner, const VertexField& field) const {
    const TriangleMesh& mesh = source_.prepared.mesh;
    const auto source = [&](int q) { return position(mesh, map_.source[idx(q)]); };
    const auto target = [&](int q) { return position(target_, map_.target[idx(q)]); };
    Eigen::Matrix<double, 3, 2> from, to;
    from << source(corner.after) - source(corner.at), source(corner.before) - source(corner.at);
    to << target(corner.after) - target(corner.at), target(corner.before) - target(corner.at);
    const Eigen::Matrix2d metric = from.transpose() * from;
    // Squared sine of the angle: below it the differential is rounding.
    constexpr double kFlat = 1e-16;
    if (!(metric.determinant() > kFlat * metric(0, 0) * metric(1, 1))) return {};
    const SurfacePoint p =
        in_face(mesh, map_.source[idx(corner.at)], map_.source_face[idx(corner.polygon)]);
    const Vector2d coordinates = metric.inverse() * (from.transpose() * on_source(p, field));
    return {to * coordinates,
            std::atan2(to.col(0).cross(to.col(1)).norm(), to.col(0).dot(to.col(1)))};
  }

  const AttributedMesh& source_;
  const TriangleMesh& target_;
  const SurfaceMap& map_;
  MatrixX3d source_normals_, target_normals_;
  std::vector<std::vector<MapCorner>> corners_;
};

}  // namespace

CarriedFields carry_fields(const AttributedMesh& source,
                           const AttributedMesh& target,
                           const SurfaceMap& map,
                           const std::vector<VertexField>& fields) {
  const std::vector<int>& mesh_vertex = target.prepared.numbering.mesh_vertex;
  const Differential differential(source, target, map);
  CarriedFields carried;
  for (const VertexField& field : fields)
    carried.fields.push_back(
        {field.kind,
         field.columns,
         Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(mesh_vertex.size()),
                                   field.values.cols(),
                                   field.kind == FieldKind::kLabel
                                       ? kNoLabel
                                       : std::numeric_limits<double>::quiet_NaN())});
  for (std::size_t v = 0; v < mesh_vertex.size(); ++v) {
    const int vertex = mesh_vertex[v];
    const int point = vertex < 0 ? -1 : map.point_of_target_vertex[idx(vertex)];
    if (point < 0) {
      ++carried.unmapped_vertices;
      continue;
    }
    const SurfacePoint& p = map.source[idx(point)];
    const std::array<int, 3> corners = file_vertices(source, p.face);
    const auto row = static_cast<Eigen::Index>(v);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      Eigen::MatrixXd& values = carried.fields[i].values;
      if (fields[i].kind == FieldKind::kNumber)
        values(row, 0) = interpolated(fields[i], corners, p);
      else if (fields[i].kind == FieldKind::kLabel)
        values(row, 0) = nearest(fields[i], corners, p);
      else
        values.row(row) = differential.at(vertex, fields[i]).transpose();
    }
  }
  return carried;
}

}  // namespace crosspatch
