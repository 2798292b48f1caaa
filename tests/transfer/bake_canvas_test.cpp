#include "transfer/bake_canvas.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "shapes.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

constexpr int kSize = 256, kReach = 8;

/// A flat square cut in two along a zigzag, its halves laid apart: the left one at 0.4 times its
/// size, the right one 0.5 further right.
struct CutSquare {
  TriangleMesh mesh = shapes::grid(12);
  std::vector<bool> is_left;
  Unwrap unwrap;

  CutSquare() {
    for (int f = 0; f < mesh.face_count(); ++f) {
      Vector2d centre = Vector2d::Zero();
      for (int k = 0; k < 3; ++k) centre += mesh.position(mesh.F(f, k)).head<2>() / 3;
      is_left.push_back(centre[0] + 0.15 * std::sin(25 * centre[1]) < 0.5);
      for (int k = 0; k < 3; ++k)
        unwrap.uv.push_back(in_image(mesh.position(mesh.F(f, k)).head<2>(), is_left.back()));
    }
  }

  static Vector2d in_image(const Vector2d& place, bool left) {
    return 0.4 * place + Vector2d(left ? 0.05 : 0.55, 0.3);
  }

  static Vector2d on_square(const Vector2d& uv, bool left) {
    return (uv - Vector2d(left ? 0.05 : 0.55, 0.3)) / 0.4;
  }
};

Vector3d colour(const Vector2d& p) {
  return {0.2 + 0.6 * p[0], 0.8 - 0.5 * p[1], 0.3 + 0.2 * (p[0] + p[1])};
}

double distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

BakeCanvas painted(const CutSquare& square, int channels) {
  BakeCanvas canvas = make_canvas(kSize, channels);
  for (int f = 0; f < square.mesh.face_count(); ++f)
    for_each_texel(in_texels(square.unwrap, f, kSize),
                   1e-4,
                   {0, kSize},
                   kSize,
                   [&](int x, int y, const Vector3d&) {
                     const Vector2d uv = Vector2d(x + 0.5, y + 0.5) / kSize;
                     const Vector3d c = colour(CutSquare::on_square(uv, square.is_left[idx(f)]));
                     const std::size_t texel = canvas.texel(x, y);
                     std::uint16_t* p = &canvas.values[idx(channels) * texel];
                     for (int k = 0; k < 3; ++k)
                       p[k] = static_cast<std::uint16_t>(std::lround(c[k] * 65535));
                     if (channels == 4) p[3] = 65535;
                     canvas.state[texel] = kFilled;
                   });
  return canvas;
}

TEST(BakeCanvas, GuttersShowWhatLiesAcrossASeamAroundAllItsCorners) {
  const CutSquare square;
  for (const int channels : {3, 4}) {
    BakeCanvas canvas = painted(square, channels);
    continue_across_seams(canvas, square.mesh, square.unwrap, kReach);
    int looked_at = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const std::size_t texel = canvas.texel(x, y);
        if (canvas.state[texel] == kFilled) continue;
        const Vector2d p(x + 0.5, y + 0.5);
        const bool left = x < kSize / 2;
        double nearest = kSize;
        for (int h = 0; h < square.mesh.halfedge_count(); ++h) {
          const int twin = square.mesh.twin[idx(h)];
          if (twin < 0 || square.is_left[idx(h / 3)] != left ||
              square.is_left[idx(twin / 3)] == left)
            continue;
          nearest = std::min(
              nearest,
              distance(
                  p, square.unwrap.uv[idx(h)] * kSize, square.unwrap.uv[idx(next(h))] * kSize));
        }
        const Vector2d place = CutSquare::on_square(p / kSize, left);
        // Texels that lie on the square, away from its own border, whose texels are read.
        if (nearest > kReach - 0.1 || place.minCoeff() < 0.02 || place.maxCoeff() > 0.98) continue;
        ++looked_at;
        ASSERT_EQ(canvas.state[texel], kContinued) << x << ' ' << y;
        const Vector3d c = colour(place);
        // Linear colours are read exactly; where texels of the other half are missing, up to half a
        // texel beside: 0.6 / (0.4 * 256) / 2.
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(canvas.values[idx(channels) * texel + idx(k)] / 65535.0, c[k], 0.003);
      }
    EXPECT_GT(looked_at, 1000);  // two sides of a seam of some 100 texels, 8 wide
  }
}

TEST(BakeCanvas, GuttersOfFacesSeenEdgeOnAreNotContinued) {
  // The left half pressed together, a texel of it is `pressed` times as long as before; the mean
  // one is longer too, by a factor of at most the root of 2.
  for (const auto& [pressed, continued] : {std::pair(8, true), std::pair(32, false)}) {
    CutSquare square;
    for (int h = 0; h < square.mesh.halfedge_count(); ++h)
      if (square.is_left[idx(face_of(h))]) square.unwrap.uv[idx(h)][0] /= pressed;
    BakeCanvas canvas = painted(square, 3);
    continue_across_seams(canvas, square.mesh, square.unwrap, kReach);
    int left = 0, right = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        if (canvas.state[canvas.texel(x, y)] == kContinued) ++(x < kSize / 2 ? left : right);
    EXPECT_EQ(left > 0, continued) << pressed;
    EXPECT_GT(right, 100) << pressed;
  }
}

TEST(BakeCanvas, WhatIsLeftIsFilledSmoothlyAndWhatIsPaintedStays) {
  const CutSquare square;
  BakeCanvas canvas = painted(square, 3);
  const BakeCanvas before = canvas;
  push_pull(canvas);
  std::uint16_t low = 65535, high = 0;
  for (std::size_t texel = 0; texel < canvas.state.size(); ++texel)
    for (std::size_t k = 0; k < 3; ++k)
      if (before.state[texel] == kFilled) {
        EXPECT_EQ(canvas.values[3 * texel + k], before.values[3 * texel + k]);
        low = std::min(low, canvas.values[3 * texel + k]);
        high = std::max(high, canvas.values[3 * texel + k]);
      }
  // Means of means: nothing is darker or lighter than all that was painted, but for rounding.
  const auto [least, most] = std::minmax_element(canvas.values.begin(), canvas.values.end() - 1);
  EXPECT_GE(*least + 1, low);
  EXPECT_LE(*most, high + 1);
}

}  // namespace
}  // namespace crosspatch
