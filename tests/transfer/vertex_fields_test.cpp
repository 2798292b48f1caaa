#include "transfer/vertex_fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shapes.hpp"
#include "surfaces.hpp"

namespace crosspatch {
namespace {

using shapes::Surface;

/// Two jittered triangulations of the unit square, the second stretched by (2, 3) after the map.
struct Stretched {
  Surface source, target;
  SurfaceMap map;
  Stretched() {
    const TriangleMesh a = shapes::jittered_grid(shapes::grid(7), 7, 1);
    TriangleMesh b = shapes::jittered_grid(shapes::grid(6), 6, 2);
    map = shapes::planar_overlay(a, b);
    b.V.col(0) *= 2;
    b.V.col(1) *= 3;
    source = shapes::surface_of(a);
    target = shapes::surface_of(b);
  }
};

VertexField number(const Eigen::VectorXd& values) {
  return {FieldKind::kNumber, {"f"}, values};
}

TEST(CarryFields, LinearFieldsStayLinear) {
  const Stretched s;
  const MatrixX3d& V = s.source.prepared.mesh.V;
  const auto carried =
      carry_fields(s.source.view(), s.target.view(), s.map, {number(2 * V.col(0) - 5 * V.col(1))});
  EXPECT_EQ(carried.unmapped_vertices, 0);
  const MatrixX3d& W = s.target.prepared.mesh.V;
  const Eigen::VectorXd expected = 2 * W.col(0) / 2 - 5 * W.col(1) / 3;
  EXPECT_LT((carried.fields[0].values - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CarryFields, TangentVectorsArePushedForward) {
  const Stretched s;
  Eigen::MatrixXd values(s.source.prepared.mesh.vertex_count(), 3);
  values.rowwise() = Eigen::RowVector3d(1, 2, 7);  // 7 stands off the surface
  const auto carried = carry_fields(s.source.view(),
                                    s.target.view(),
                                    s.map,
                                    {{FieldKind::kTangent, {"t.x", "t.y", "t.z"}, values}});
  for (const auto& row : carried.fields[0].values.rowwise())
    EXPECT_LT((row - Eigen::RowVector3d(2, 6, 0)).norm(), 1e-7);
}

TEST(CarryFields, TheIdentityLeavesTangentVectorsAlone) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const Surface surface = shapes::surface_of(mesh);
  const MatrixX3d normals = vertex_normals(mesh);
  Eigen::MatrixXd values(mesh.vertex_count(), 3);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    values.row(v) = Vector3d(normals.row(v).transpose()).cross(Vector3d(1, 2, 3)).transpose();
  const auto carried = carry_fields(surface.view(),
                                    surface.view(),
                                    identity_map(mesh),
                                    {{FieldKind::kTangent, {"t.x", "t.y", "t.z"}, values}});
  EXPECT_LT((carried.fields[0].values - values).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(CarryFields, LabelsAreNeverMixed) {
  const Stretched s;
  const TriangleMesh &a = s.source.prepared.mesh, &b = s.target.prepared.mesh;
  Eigen::VectorXd labels(a.vertex_count());
  for (int v = 0; v < a.vertex_count(); ++v) labels[v] = v % 2 == 0 ? 10 : 1000;
  const auto carried = carry_fields(
      s.source.view(), s.target.view(), s.map, {{FieldKind::kLabel, {"label:l"}, labels}});
  for (int v = 0; v < b.vertex_count(); ++v) {
    const double label = carried.fields[0].values(v, 0);
    EXPECT_TRUE(label == 10 || label == 1000);
    const SurfacePoint& p = s.map.source[static_cast<std::size_t>(
        s.map.point_of_target_vertex[static_cast<std::size_t>(v)])];
    int corner = 0;
    p.bary.maxCoeff(&corner);
    EXPECT_EQ(label, labels[a.F(p.face, corner)]);
  }
}

TEST(CarryFields, WhatIsNotMappedHasNoValue) {
  const TriangleMesh mesh = shapes::grid(2);
  Surface target = shapes::surface_of(mesh);
  target.prepared.numbering.mesh_vertex.push_back(-1);  // of the file, in no triangle
  SurfaceMap map = identity_map(mesh);
  map.point_of_target_vertex[4] = -1;
  Eigen::VectorXd values = Eigen::VectorXd::Ones(mesh.vertex_count());
  values[0] = std::numeric_limits<double>::quiet_NaN();
  const auto carried = carry_fields(shapes::surface_of(mesh).view(),
                                    target.view(),
                                    map,
                                    {number(values), {FieldKind::kLabel, {"label:l"}, values * 0}});
  EXPECT_EQ(carried.unmapped_vertices, 2);
  for (const int v : {0, 4, 9}) EXPECT_TRUE(std::isnan(carried.fields[0].values(v, 0))) << v;
  EXPECT_EQ(carried.fields[0].values(1, 0), 1);
  EXPECT_EQ(carried.fields[1].values(4, 0), kNoLabel);
  EXPECT_EQ(carried.fields[1].values(9, 0), kNoLabel);
  EXPECT_EQ(carried.fields[1].values(5, 0), 0);
}

}  // namespace
}  // namespace crosspatch
