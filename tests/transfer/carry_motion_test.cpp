#include "transfer/carry_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "core/index.hpp"
#include "shapes.hpp"
#include "temp_folder.hpp"
#include "transfer/bake.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/gltf_motion.hpp"
#include "transfer/gltf_write.hpp"
#include "transfer/rig.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

using shapes::Surface;

constexpr MotionParts kAll{.skin = true, .morphs = true};

Motion motion_of(const TriangleMesh& mesh) {
  const TempFolder folder;
  auto read = read_gltf_motion(folder.write("a.glb", rig::file(mesh.V, mesh.F).glb()), kAll);
  EXPECT_TRUE(read) << read.error().message;
  return read->motion;
}

/// A source that moves, a target, and the target as it is written.
struct Moved {
  Surface source, target;
  Motion motion;
  SurfaceMap map;
  TexturedMesh mesh;
};

Moved moved(const TriangleMesh& source, const TriangleMesh& target, const SurfaceMap& map) {
  Moved m{shapes::surface_of(source), shapes::surface_of(target), motion_of(source), map, {}};
  shapes::texture(
      m.source, [](int, const Vector3d& p) { return Vector2d(p[0], p[1]); }, 64);
  m.source.soup.images.clear();  // it is a header only
  m.source.soup.materials[0].base_color.image = -1;
  m.mesh = carry_texture(m.source.view(), m.target.view(), map)->mesh;
  auto carried = carry_motion(m.motion, m.source.view(), m.target.view(), map, m.mesh);
  EXPECT_TRUE(carried) << carried.error().message;
  m.mesh.motion = carried->motion;
  EXPECT_TRUE(validate(m.mesh)) << validate(m.mesh).error().message;
  return m;
}

/// The same flat sheet in two triangulations.
Moved remeshed_sheet() {
  const TriangleMesh a = shapes::jittered_grid(shapes::grid(7), 7, 1);
  const TriangleMesh b = shapes::jittered_grid(shapes::grid(11), 11, 2);
  return moved(a, b, shapes::planar_overlay(a, b));
}

const Eigen::Matrix3d kTurn =
    Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
constexpr double kScale = 3.7;
const Vector3d kMove(5, -1, 2);

Vector3d similar(const Vector3d& x) {
  return kMove + kScale * (kTurn * x);
}

/// A ball and its turned, scaled and moved copy.
Moved similar_ball() {
  const TriangleMesh ball = shapes::icosphere(2);
  TriangleMesh copy = ball;
  for (int v = 0; v < ball.vertex_count(); ++v)
    copy.V.row(v) = similar(ball.position(v)).transpose();
  return moved(ball, copy, identity_map(ball));
}

Vector3d place(const TexturedMesh& mesh, int row) {
  return mesh.positions.row(row).transpose();
}

TEST(CarryMotion, WeightsAreThoseOfThePlaceOnAnotherMeshOfTheSameSurface) {
  const Moved m = remeshed_sheet();
  const auto& weights = m.mesh.motion.skin->weights;
  // The knee's weight is x, which triangles reproduce; weights are written in steps of 2^-20, and
  // the file has single precision.
  for (int row = 0; row < m.mesh.positions.rows(); ++row)
    EXPECT_NEAR(weights.coeff(row, 1), m.mesh.positions(row, 0), 2e-6) << row;
}

TEST(CarryMotion, TheSameSurfaceMovesAsTheSource) {
  const Moved m = remeshed_sheet();
  const Animation& there = m.motion.animations[0];
  const Animation& here = m.mesh.motion.animations[0];
  for (const std::size_t key : {std::size_t{0}, std::size_t{1}}) {
    const auto source = rig::pose(m.motion, there, key);
    const auto target = rig::pose(m.mesh.motion, here, key);
    double farthest = 0;
    for (int row = 0; row < m.mesh.positions.rows(); ++row) {
      const Vector3d x = place(m.mesh, row);
      const Vector3d exact = (1 - x[0]) * (source[0] * x.homogeneous()).head<3>() +
                             x[0] * (source[1] * x.homogeneous()).head<3>();
      // Joints stand on multiples of 2^-20, matrices have single precision.
      EXPECT_NEAR((rig::moved(*m.mesh.motion.skin, target, row, x) - exact).norm(), 0, 1e-5);
      farthest = std::max(farthest, (exact - x).norm());
    }
    EXPECT_GT(farthest, key == 1 ? 0.3 : -1);
  }
}

TEST(CarryMotion, ASimilarCopyMovesSimilarly) {
  const Moved m = similar_ball();
  const auto source = rig::pose(m.motion, m.motion.animations[0], 1);
  const auto target = rig::pose(m.mesh.motion, m.mesh.motion.animations[0], 1);
  for (std::size_t j = 0; j < 2; ++j)
    for (const Vector3d& x : {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(-1, 2, 3)}) {
      const Vector3d exact = similar((source[j] * x.homogeneous()).head<3>());
      // As above, on coordinates up to 16.
      EXPECT_NEAR(((target[j] * similar(x).homogeneous()).head<3>() - exact).norm(), 0, 2e-4);
    }
}

TEST(CarryMotion, MorphTargetsOfASimilarCopyAreTurnedAndScaled) {
  const Moved m = similar_ball();
  ASSERT_EQ(m.mesh.motion.morphs.size(), 2u);
  EXPECT_EQ(m.mesh.motion.morphs[0].name, "puffed");
  EXPECT_EQ(m.mesh.motion.morphs[0].weight, 0.25);
  for (int row = 0; row < m.mesh.positions.rows(); ++row) {
    const Vector3d x = kTurn.transpose() * (place(m.mesh, row) - kMove) / kScale;
    const Vector3d puffed = kScale * (kTurn * Vector3d(0, 0, 0.1 * x[0]));
    const Vector3d bent = kScale * (kTurn * Vector3d(0, 0.2 * x[0] * x[0], 0));
    EXPECT_TRUE(m.mesh.motion.morphs[0].displacements.row(row).transpose().isApprox(puffed, 1e-5) ||
                puffed.norm() < 1e-6);
    EXPECT_TRUE(m.mesh.motion.morphs[1].displacements.row(row).transpose().isApprox(bent, 1e-5) ||
                bent.norm() < 1e-6);
    EXPECT_NEAR((m.mesh.motion.morphs[1].normal_displacements.row(row).transpose() -
                 kTurn * Vector3d(0.1, 0, 0))
                    .norm(),
                0,
                1e-6);
  }
}

/// A renderer's arithmetic: everything in single precision, products of local transforms from the
/// root on, weights added up in any order.
TEST(CarryMotion, TheBindPoseMovesNoVertexByABit) {
  for (const Moved& m : {remeshed_sheet(), similar_ball()}) {
    const Skin& skin = *m.mesh.motion.skin;
    std::vector<Eigen::Matrix4f> world;
    for (const SkeletonNode& node : skin.nodes) {
      const Eigen::Matrix4f local = node.local.cast<float>();
      world.push_back(node.parent < 0 ? local : Eigen::Matrix4f(world[idx(node.parent)] * local));
    }
    for (int row = 0; row < m.mesh.positions.rows(); ++row) {
      const Eigen::Vector3f x = m.mesh.positions.row(row).transpose().cast<float>();
      Eigen::Matrix4f blended = Eigen::Matrix4f::Zero();
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, row); w;
           ++w) {
        const std::size_t node = idx(skin.joints[idx(w.col())]);
        Eigen::Matrix4f back = Eigen::Matrix4f::Identity();
        back.topRightCorner<3, 1>() = -skin.nodes[node].bind.topRightCorner<3, 1>().cast<float>();
        blended += static_cast<float>(w.value()) * (world[node] * back);
      }
      const Eigen::Vector4f moved = blended * x.homogeneous();
      EXPECT_EQ(std::memcmp(moved.data(), x.data(), sizeof(float) * 3), 0) << row;
    }
  }
}

TEST(CarryMotion, BakedMeshesMoveToo) {
  const Moved m = remeshed_sheet();
  const auto baked = bake_texture(m.source.view(), m.target.view(), m.map, {.size = 16});
  ASSERT_TRUE(baked) << baked.error().message;
  const auto carried = carry_motion(m.motion, m.source.view(), m.target.view(), m.map, baked->mesh);
  ASSERT_TRUE(carried) << carried.error().message;
  for (int v = 0; v < m.target.prepared.mesh.vertex_count(); ++v)
    EXPECT_NEAR(carried->motion.skin->weights.coeff(v, 1), m.target.prepared.mesh.V(v, 0), 2e-6);
}

TEST(CarryMotion, FourLargestWeightsAreKept) {
  const TriangleMesh ball = shapes::icosphere(1);
  const Surface s = shapes::surface_of(ball);
  Motion motion;
  Skin skin;
  for (int j = 0; j < 6; ++j) {
    skin.nodes.push_back({"", j - 1, {}, {}});
    skin.nodes.back().bind.setIdentity();
    skin.nodes.back().local.setIdentity();
    skin.joints.push_back(j);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < ball.vertex_count(); ++v)
    for (int j = 0; j < 6; ++j) entries.emplace_back(v, j, j + 1);
  skin.weights.resize(ball.vertex_count(), 6);
  skin.weights.setFromTriplets(entries.begin(), entries.end());
  motion.skin = skin;
  TexturedMesh mesh = carry_texture(s.view(), s.view(), identity_map(ball))->mesh;
  const auto carried = carry_motion(motion, s.view(), s.view(), identity_map(ball), mesh);
  ASSERT_TRUE(carried);
  const auto& weights = carried->motion.skin->weights;
  // 6 + 5 + 4 + 3 of 21 stay.
  EXPECT_NEAR(carried->dropped_weight, 3.0 / 21, 1e-12);
  for (int j = 0; j < 6; ++j)
    EXPECT_NEAR(weights.coeff(0, j), j < 2 ? 0 : (j + 1) / 18.0, 4e-6) << j;
  mesh.motion = carried->motion;
  EXPECT_TRUE(validate(mesh));
}

TEST(CarryMotion, WhatHasNoCounterpartGoesWithItsNeighbours) {
  Moved m = remeshed_sheet();
  const int lost = 5;
  m.mesh.map_point[lost] = -1;
  const auto carried = carry_motion(m.motion, m.source.view(), m.target.view(), m.map, m.mesh);
  ASSERT_TRUE(carried);
  EXPECT_EQ(carried->unmapped_positions, 1);
  bool of_a_neighbour = false;
  for (int t = 0; t < m.mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k)
      if (m.mesh.triangles(t, k) == lost)
        for (int i = 0; i < 3; ++i) {
          const int row = m.mesh.triangles(t, i);
          if (row != lost && carried->motion.skin->weights.coeff(row, 1) ==
                                 carried->motion.skin->weights.coeff(lost, 1))
            of_a_neighbour = true;
        }
  EXPECT_TRUE(of_a_neighbour);
}

TEST(CarryMotion, WhatIsWrittenReadsBackEqual) {
  const Moved m = similar_ball();
  const TempFolder folder;
  const auto bytes = encode_glb(m.mesh);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const auto back = read_gltf_motion(folder.write("a.glb", *bytes), kAll);
  ASSERT_TRUE(back) << back.error().message;
  const Motion &wrote = m.mesh.motion, &read = back->motion;
  ASSERT_EQ(read.skin->nodes.size(), wrote.skin->nodes.size());
  for (std::size_t n = 0; n < wrote.skin->nodes.size(); ++n) {
    EXPECT_EQ(read.skin->nodes[n].name, wrote.skin->nodes[n].name);
    EXPECT_EQ(read.skin->nodes[n].parent, wrote.skin->nodes[n].parent);
    EXPECT_EQ(read.skin->nodes[n].bind, wrote.skin->nodes[n].bind);
    EXPECT_EQ(read.skin->nodes[n].local, wrote.skin->nodes[n].local);
  }
  EXPECT_EQ(read.skin->joints, wrote.skin->joints);
  // Without seams the file's vertices are the positions, in the order of their first use.
  ASSERT_EQ(read.skin->weights.rows(), m.mesh.positions.rows());
  std::vector<int> order;
  std::vector<bool> seen(idx(m.mesh.positions.rows()), false);
  for (int c = 0; c < 3 * m.mesh.triangle_count(); ++c) {
    const int row = m.mesh.triangles(c / 3, c % 3);
    if (!seen[idx(row)]) order.push_back(row);
    seen[idx(row)] = true;
  }
  for (std::size_t v = 0; v < order.size(); ++v) {
    const auto row = static_cast<Eigen::Index>(v);
    for (int j = 0; j < 2; ++j)
      EXPECT_EQ(read.skin->weights.coeff(row, j), wrote.skin->weights.coeff(order[v], j));
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(read.morphs[i].displacements.row(row).cast<float>(),
                wrote.morphs[i].displacements.row(order[v]).cast<float>());
  }
  EXPECT_EQ(read.morphs[1].name, "bent");
  ASSERT_EQ(read.animations.size(), 1u);
  EXPECT_EQ(read.animations[0].name, "kick");
  ASSERT_EQ(read.animations[0].tracks.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Track &a = read.animations[0].tracks[i], &b = wrote.animations[0].tracks[i];
    EXPECT_EQ(std::tie(a.node, a.path, a.interpolation, a.times),
              std::tie(b.node, b.path, b.interpolation, b.times));
    ASSERT_EQ(a.values.size(), b.values.size());
    for (std::size_t k = 0; k < a.values.size(); ++k) EXPECT_NEAR(a.values[k], b.values[k], 1e-6);
  }
}

TEST(CarryMotion, TheMeshsOwnTransformStandsAboveTheSkeleton) {
  Moved m = similar_ball();
  m.mesh.node_transform.topLeftCorner<3, 3>() *= 0.01;
  const auto bytes = encode_glb(m.mesh);
  ASSERT_TRUE(bytes);
  std::uint32_t length = 0;  // of GLB's first chunk
  std::memcpy(&length, &(*bytes)[12], sizeof length);
  const auto json = nlohmann::json::parse(bytes->substr(20, length));
  EXPECT_FALSE(json["nodes"][0].contains("matrix"));
  const auto& top = json["nodes"][json["skins"][0]["skeleton"].get<std::size_t>()];
  EXPECT_EQ(top["matrix"][0], 0.01);
  EXPECT_EQ(top["children"], nlohmann::json({1}));
}

}  // namespace
}  // namespace crosspatch
