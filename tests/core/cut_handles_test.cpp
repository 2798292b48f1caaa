#include "core/cut_handles.hpp"

#include <gtest/gtest.h>

#include "core/index.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

double length(const TriangleMesh& mesh, const std::vector<int>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += (mesh.position(loop[i]) - mesh.position(loop[(i + 1) % loop.size()])).norm();
  return sum;
}

TEST(CutHandles, LeavesSpheresAndDiscsAlone) {
  for (const TriangleMesh& mesh : {shapes::icosphere(2), shapes::grid(4)}) {
    const auto cut = cut_handles(mesh);
    ASSERT_TRUE(cut) << cut.error().message;
    EXPECT_TRUE(cut->loops.empty());
    EXPECT_EQ(cut->mesh.F, mesh.F);
  }
}

TEST(CutHandles, CutsATorusAroundItsTube) {
  const TriangleMesh torus = shapes::torus(3, 1, 40, 20);
  const auto cut = cut_handles(torus);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_TRUE(validate(cut->mesh));
  EXPECT_EQ(genus(cut->mesh), 0);
  EXPECT_EQ(boundary_loops(cut->mesh).size(), 2u);
  ASSERT_EQ(cut->loops.size(), 1u);
  // Around the tube it is 2 pi, through the hole at least 4 pi; edges make 20-gons of circles.
  EXPECT_LT(length(torus, cut->loops[0]), 6.3);
  EXPECT_GT(length(torus, cut->loops[0]), 6.2);
  // Faces stay what and where they were.
  ASSERT_EQ(cut->mesh.face_count(), torus.face_count());
  for (int f = 0; f < torus.face_count(); ++f)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(cut->vertex[idx(cut->mesh.F(f, k))], torus.F(f, k));
}

TEST(CutHandles, CutsEveryHandle) {
  const TriangleMesh mesh = shapes::double_torus();
  ASSERT_EQ(genus(mesh), 2);
  const auto cut = cut_handles(mesh);
  ASSERT_TRUE(cut) << cut.error().message;
  EXPECT_EQ(genus(cut->mesh), 0);
  EXPECT_EQ(boundary_loops(cut->mesh).size(), 4u);
  EXPECT_EQ(cut->loops.size(), 2u);
}

}  // namespace
}  // namespace crosspatch
