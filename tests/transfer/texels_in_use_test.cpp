#include "transfer/texels_in_use.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Triangles that only have texture coordinates, three each, in the one image of their material.
TexturedMesh triangles(const std::vector<Vector2d>& uv) {
  TexturedMesh mesh;
  mesh.triangles.resize(static_cast<Eigen::Index>(uv.size() / 3), 3);
  mesh.material.assign(uv.size() / 3, 0);
  mesh.uv_sets = {uv};
  mesh.materials.resize(1);
  mesh.materials[0].base_color.image = 0;
  return mesh;
}

std::vector<bool> in_use(const TexturedMesh& mesh) {
  return texels_in_use(mesh, Channel::kBaseColor, 0, {8, 4});
}

TEST(TexelsInUse, AreThoseWhoseCentresLieInsideOfAnIsland) {
  // The square of columns 2 to 5 and rows 1 and 2, with sides 0.4 texels outside of their centres.
  const Vector2d a(2.1 / 8, 1.1 / 4), b(5.9 / 8, 1.1 / 4), c(5.9 / 8, 2.9 / 4), d(2.1 / 8, 2.9 / 4);
  const std::vector<bool> used = in_use(triangles({a, b, c, a, c, d}));
  ASSERT_EQ(used.size(), 32U);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(used[idx(8 * y + x)], x >= 2 && x <= 5 && (y == 1 || y == 2)) << x << ' ' << y;
}

TEST(TexelsInUse, SmallIslandsKeepATexelAndSliversBesideLargeOnesDoNot) {
  const Vector2d p(6.3 / 8, 1.3 / 4);
  std::vector<bool> used = in_use(triangles({p, p, p}));
  EXPECT_EQ(std::count(used.begin(), used.end(), true), 1);
  EXPECT_TRUE(used[8 * 1 + 6]);
  // The left half up to just before the centres of column 4, and a sliver along that side.
  const Vector2d a(0, 0), b(4.3 / 8, 0), c(4.3 / 8, 1), d(0, 1), e(4.4 / 8, 0.5);
  used = in_use(triangles({a, b, c, a, c, d, b, e, c}));
  EXPECT_EQ(std::count(used.begin(), used.end(), true), 16);
}

TEST(TexelsInUse, RepeatedPatternsHaveNoOutside) {
  EXPECT_TRUE(in_use(triangles({Vector2d(0, 0), Vector2d(1.2, 0), Vector2d(0, 1)})).empty());
}

}  // namespace
}  // namespace crosspatch
