#include "param/tutte.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "shapes.hpp"

namespace crosspatch {
namespace {

MatrixX2d circle(std::size_t n) {
  MatrixX2d p(static_cast<int>(n), 2);
  for (int i = 0; i < p.rows(); ++i) {
    const double t = 2 * std::numbers::pi * i / static_cast<double>(n);
    p.row(i) << std::cos(t), std::sin(t);
  }
  return p;
}

/// The boundary of a grid where it is: a square with many points on each straight side.
MatrixX2d own_positions(const TriangleMesh& mesh, const std::vector<int>& loop) {
  MatrixX2d p(static_cast<int>(loop.size()), 2);
  for (int i = 0; i < p.rows(); ++i)
    p.row(i) = mesh.V.row(loop[static_cast<std::size_t>(i)]).head<2>();
  return p;
}

/// A closed mesh without the faces around vertex 0.
TriangleMesh opened(const TriangleMesh& mesh) {
  std::vector<std::array<int, 3>> faces;
  for (int f = 0; f < mesh.face_count(); ++f)
    if ((mesh.F.row(f).array() != 0).all())
      faces.push_back({mesh.F(f, 0) - 1, mesh.F(f, 1) - 1, mesh.F(f, 2) - 1});
  MatrixX3i F(static_cast<int>(faces.size()), 3);
  for (int f = 0; f < F.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      F(f, k) = faces[static_cast<std::size_t>(f)][static_cast<std::size_t>(k)];
  return make_mesh(mesh.V.bottomRows(mesh.vertex_count() - 1), F).value();
}

TEST(Tutte, MeanValueWeightsReproduceAFlatDisc) {
  TriangleMesh mesh = shapes::grid(12);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.02, 0.02);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const bool inner =
        (mesh.V.row(v).head<2>().array() * (1 - mesh.V.row(v).head<2>().array())).minCoeff() > 1e-9;
    if (inner) mesh.V.row(v).head<2>() += Eigen::RowVector2d(shift(random), shift(random));
  }
  const SplitMesh split = split_chords(mesh);
  const std::vector<int> loop = boundary_loops(split.mesh)[0];
  const auto uv = tutte_embedding(
      split.mesh, loop, own_positions(split.mesh, loop), {.weights = TutteWeights::kMeanValue});
  ASSERT_TRUE(uv) << uv.error().message;
  // Linear precision holds up to the conditioning of the system times rounding.
  EXPECT_LT((*uv - split.mesh.V.leftCols<2>()).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Tutte, EveryWeightEmbedsOpenedSpheres) {
  for (const int level : {1, 2, 3, 4}) {
    const TriangleMesh mesh = opened(shapes::icosphere(level));
    const std::vector<int> loop = boundary_loops(mesh)[0];
    for (const TutteWeights weights :
         {TutteWeights::kSymmetric, TutteWeights::kMeanValue, TutteWeights::kUniform}) {
      const auto uv = tutte_embedding(mesh, loop, circle(loop.size()), {.weights = weights});
      ASSERT_TRUE(uv) << uv.error().message;
      EXPECT_TRUE(folded_faces(mesh, *uv).empty());
      for (const int v : loop) EXPECT_NEAR(uv->row(v).norm(), 1, 1e-15);
    }
  }
}

TEST(Tutte, SliversAreEmbedded) {
  // Squeezed a thousandfold, with every tenth inner vertex moved almost onto its neighbour.
  TriangleMesh mesh = shapes::grid(20);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const bool inner = v % 21 != 0 && v % 21 != 20 && v / 21 != 0 && v / 21 != 20;
    if (inner && v % 10 == 0) mesh.V.row(v) += (1 - 1e-9) * (mesh.V.row(v + 1) - mesh.V.row(v));
  }
  mesh.V.col(1) *= 1e-3;
  const SplitMesh split = split_chords(mesh);
  const std::vector<int> loop = boundary_loops(split.mesh)[0];
  const auto uv = tutte_embedding(split.mesh, loop, circle(loop.size()));
  ASSERT_TRUE(uv) << uv.error().message;
}

/// The lateral surface of a thin cylinder with a closed end: a limb.
TriangleMesh limb(int rings, int sides) {
  MatrixX3d V(rings * sides + 1, 3);
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      const double t = 2 * std::numbers::pi * j / sides;
      V.row(i * sides + j) << std::cos(t), std::sin(t), 2 * std::numbers::pi * i / sides;
    }
  V.row(rings * sides) << 0, 0, 2 * std::numbers::pi * rings / sides;
  std::vector<std::array<int, 3>> faces;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sides; ++j) {
      const int a = i * sides + j, b = i * sides + (j + 1) % sides;
      if (i + 1 == rings) {
        faces.push_back({a, b, rings * sides});
        continue;
      }
      faces.push_back({a, b, b + sides});
      faces.push_back({a, b + sides, a + sides});
    }
  MatrixX3i F(static_cast<int>(faces.size()), 3);
  for (int f = 0; f < F.rows(); ++f) {
    const auto& face = faces[static_cast<std::size_t>(f)];
    F.row(f) << face[0], face[1], face[2];
  }
  return make_mesh(V, F).value();
}

TEST(Tutte, LongLimbsAreEmbeddedByEveningOut) {
  // Rings shrink by about exp(-2 pi / sides) each: 120 of 12 sides end at exp(-60), below rounding.
  const TriangleMesh mesh = limb(120, 12);
  const std::vector<int> loop = boundary_loops(mesh)[0];
  // About a centre whose coordinates have no room for that.
  const MatrixX2d rim = circle(loop.size()).rowwise() + Eigen::RowVector2d(0.3, 0.2);
  const auto uv = tutte_embedding(mesh, loop, rim);
  ASSERT_TRUE(uv) << uv.error().message;
  EXPECT_TRUE(folded_faces(mesh, *uv).empty());
}

TEST(Tutte, EveningOutWidensTheSmallestTriangle) {
  const TriangleMesh mesh = limb(20, 12);
  const std::vector<int> loop = boundary_loops(mesh)[0];
  const auto smallest = [&](int rounds) {
    const MatrixX2d uv =
        tutte_embedding(mesh, loop, circle(loop.size()), {.evening_rounds = rounds}).value();
    MatrixX3d flat = MatrixX3d::Zero(uv.rows(), 3);
    flat.leftCols<2>() = uv;
    return face_areas(make_mesh(flat, mesh.F).value()).minCoeff();
  };
  EXPECT_GT(smallest(2), 100 * smallest(0));
}

TEST(Tutte, DegenerateTrianglesFallBackToUniformWeights) {
  TriangleMesh mesh = shapes::grid(6);
  mesh.V.row(24) = mesh.V.row(25);
  mesh.V.row(31) = mesh.V.row(25);
  const SplitMesh split = split_chords(mesh);
  const std::vector<int> loop = boundary_loops(split.mesh)[0];
  EXPECT_TRUE(tutte_embedding(split.mesh, loop, circle(loop.size())));
}

TEST(Tutte, ChordOnAStraightSideIsReportedAndSplittingCuresIt) {
  const TriangleMesh mesh = shapes::grid(2);
  const std::vector<int> loop = boundary_loops(mesh)[0];
  // All vertices on the straight sides of a triangle: the grid's chord at a corner lies on one.
  MatrixX2d p(8, 2);
  p << 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 3, 1, 2, 2, 1, 1;
  const auto folded = tutte_embedding(mesh, loop, p);
  ASSERT_FALSE(folded);
  EXPECT_EQ(folded.error().code, ErrorCode::kNumerical);
  const SplitMesh split = split_chords(mesh);
  const auto uv = tutte_embedding(split.mesh, loop, p);
  EXPECT_TRUE(uv) << uv.error().message;
}

TEST(Tutte, BadInputIsNamed) {
  const TriangleMesh mesh = shapes::grid(2);
  std::vector<int> loop = boundary_loops(mesh)[0];
  MatrixX2d p = circle(loop.size());
  p.row(2) *= 0.5;
  EXPECT_EQ(tutte_embedding(mesh, loop, p).error().message, "polygon: not convex at corner 2");
  p = circle(loop.size());
  std::reverse(loop.begin(), loop.end());
  EXPECT_EQ(tutte_embedding(mesh, loop, p).error().code, ErrorCode::kBadInput);
  EXPECT_EQ(tutte_embedding(shapes::icosphere(1), {}, p).error().message,
            "disc: Euler characteristic is 2, not 1");
}

TEST(SplitChords, LeavesNoInnerEdgeBetweenBoundaryVertices) {
  for (const int n : {1, 2, 3, 7}) {
    const TriangleMesh parent = shapes::grid(n);
    const SplitMesh split = split_chords(parent);
    ASSERT_TRUE(validate(split.mesh));
    EXPECT_EQ(euler_characteristic(split.mesh), 1);
    EXPECT_NEAR(total_area(split.mesh), total_area(parent), 1e-14);
    const int old = parent.vertex_count();
    std::vector<bool> boundary(static_cast<std::size_t>(split.mesh.vertex_count()), false);
    const std::vector<int> loop = boundary_loops(split.mesh)[0];
    for (const int v : loop) boundary[static_cast<std::size_t>(v)] = true;
    for (int h = 0; h < split.mesh.halfedge_count(); ++h)
      EXPECT_FALSE(split.mesh.twin[static_cast<std::size_t>(h)] >= 0 &&
                   boundary[static_cast<std::size_t>(split.mesh.from(h))] &&
                   boundary[static_cast<std::size_t>(split.mesh.to(h))]);
    EXPECT_EQ(static_cast<int>(split.parent_edge.size()), split.mesh.vertex_count() - old);
    // Each part lies inside its parent: its centre has the parent's plane and inner coordinates.
    for (int f = 0; f < split.mesh.face_count(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int v = split.mesh.F(f, k), g = split.parent_face[static_cast<std::size_t>(f)];
        const auto has = [&](int u) { return (parent.F.row(g).array() == u).any(); };
        const auto parents =
            v < old ? std::array{v, v} : split.parent_edge[static_cast<std::size_t>(v - old)];
        EXPECT_TRUE(has(parents[0]) && has(parents[1]));
      }
  }
}

}  // namespace
}  // namespace crosspatch
