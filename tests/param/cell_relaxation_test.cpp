#include "param/cell_relaxation.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "param/map_quality.hpp"
#include "param/overlay.hpp"
#include "param/sphere_orientation.hpp"
#include "param/vertex_colours.hpp"
#include "shapes.hpp"

namespace crosspatch {
namespace {

/// Two spheres of different triangles, the vertices of the first scattered on the sphere.
struct Spheres {
  TriangleMesh mesh = normalized(shapes::icosphere(3)), other = normalized(shapes::icosphere(2));
  MatrixX3d X = shapes::icosphere(3).V, Y;

  Spheres() {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.7, Vector3d(0.3, 0.5, 0.8).normalized()).toRotationMatrix();
    Y = shapes::icosphere(2).V * turn.transpose();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> noise(-0.045, 0.045);  // edges are 0.14 long
    for (int v = 0; v < X.rows(); ++v)
      X.row(v) += Eigen::RowVector3d(noise(random), noise(random), noise(random));
    X.rowwise().normalize();
  }

  [[nodiscard]] double energy() const {
    const auto map = overlay_on_sphere(mesh, X, other, Y);
    EXPECT_TRUE(map) << (map ? "" : map.error().message);
    return map ? measure_map(*map, mesh, other).mean : 0;
  }
};

TEST(CellRelaxation, GainsWhatTheCommonSubdivisionLoses) {
  Spheres s;
  const double before = s.energy();
  const double gain = relax_cells(s.mesh, s.other, s.Y, {}, s.X);
  EXPECT_GT(gain, 0.01);  // far above the tolerance below
  // Cells that have no area on one surface count here and not there.
  EXPECT_NEAR(s.energy(), before - gain, 1e-5);
  for (int f = 0; f < s.mesh.face_count(); ++f)
    EXPECT_GT(sphere_orientation(s.X.row(s.mesh.F(f, 0)).transpose(),
                                 s.X.row(s.mesh.F(f, 1)).transpose(),
                                 s.X.row(s.mesh.F(f, 2)).transpose()),
              0);
}

TEST(CellRelaxation, BothMeshesInTurnGainMoreThanOne) {
  Spheres s, alone;
  const double of_one = relax_cells(alone.mesh, alone.other, alone.Y, {}, alone.X);
  const double before = s.energy();
  const std::vector<int> none;
  const double gain = relax_cells({s.mesh, none, s.X}, {s.other, none, s.Y}, 3, 0);
  EXPECT_GT(gain, of_one);
  EXPECT_NEAR(s.energy(), before - gain, 1e-5);
}

TEST(CellRelaxation, AnIsometryStaysAndSoDoPinnedVertices) {
  Spheres s;
  MatrixX3d same = s.Y;
  EXPECT_EQ(relax_cells(s.other, s.other, s.Y, {}, same), 0);
  EXPECT_EQ(same, s.Y);
  std::vector<int> all;
  for (int v = 0; v < s.mesh.vertex_count(); ++v)
    if (v != 17) all.push_back(v);
  const MatrixX3d before = s.X;
  relax_cells(s.mesh, s.other, s.Y, all, s.X);
  for (const int v : all) EXPECT_EQ(s.X.row(v), before.row(v));
}

TEST(CellRelaxation, IsTheSameForAnyNumberOfThreads) {
  Spheres one, two;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    relax_cells(one.mesh, one.other, one.Y, {}, one.X);
  }
  relax_cells(two.mesh, two.other, two.Y, {}, two.X);
  EXPECT_EQ(one.X, two.X);
}

TEST(VertexColours, HoldEveryFreeVertexOnceAndNoFaceTwice) {
  const TriangleMesh mesh = shapes::icosphere(2);
  std::vector<bool> is_free(static_cast<std::size_t>(mesh.vertex_count()), true);
  is_free[5] = false;
  std::vector<int> colour(is_free.size(), -1);
  const auto colours = vertex_colours(mesh.F, is_free);
  for (std::size_t c = 0; c < colours.size(); ++c)
    for (const int v : colours[c]) {
      EXPECT_EQ(colour[static_cast<std::size_t>(v)], -1);
      colour[static_cast<std::size_t>(v)] = static_cast<int>(c);
    }
  for (std::size_t v = 0; v < colour.size(); ++v) EXPECT_EQ(colour[v] >= 0, is_free[v]);
  for (int h = 0; h < 3 * mesh.face_count(); ++h) {
    const int a = colour[static_cast<std::size_t>(mesh.from(h))],
              b = colour[static_cast<std::size_t>(mesh.to(h))];
    EXPECT_TRUE(a < 0 || a != b);
  }
}

}  // namespace
}  // namespace crosspatch
