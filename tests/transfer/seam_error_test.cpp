#include "transfer/seam_error.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "core/index.hpp"

namespace crosspatch {
namespace {

constexpr int kSize = 128;
constexpr int kBlack = 0, kDark = 80, kBright = 200;

/// Two squares side by side, the seam between them: the left one fills columns 8 to 40 of the
/// image, the right one columns 72 to 104, so that the seam lies at 40 and at 72, rows 16 to 112.
struct TwoCharts {
  TriangleMesh mesh;
  Unwrap unwrap;

  TwoCharts() {
    MatrixX3d V(6, 3);
    V << 0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 3, 0, 1, 3, 0, 2, 3, 0;
    MatrixX3i F(4, 3);
    F << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
    mesh = make_mesh(V, F).value();
    for (int h = 0; h < mesh.halfedge_count(); ++h) {
      const Vector3d p = mesh.position(mesh.from(h));
      const bool right = face_of(h) >= 2;
      unwrap.uv.push_back(Vector2d(8 + 32 * p[0] + (right ? 32 : 0), 16 + 32 * p[1]) / kSize);
    }
  }

  /// Seam errors of the image whose grey at a texel is `value(chart, columns right of the seam)`.
  [[nodiscard]] std::array<double, kSeamLevels> error(
      const std::function<int(int, double)>& value) const {
    RasterImage image{kSize, kSize, 3, {}};
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        for (int k = 0; k < 3; ++k)
          image.values.push_back(static_cast<std::uint16_t>(
              257 * (x < kSize / 2 - 8 ? value(0, x + 0.5 - 40) : value(1, x + 0.5 - 72))));
    return seam_error(image, mesh, unwrap);
  }
};

constexpr double kStep = 1.0 / 16;  // of the histogram

TEST(SeamError, AColourEdgeOfTheSourceIsNone) {
  const TwoCharts charts;
  // At the seam, or a texel beside it; the charts' gutters go on with nothing but their own colour.
  for (const double edge : {0.0, -1.0, 1.0}) {
    const auto e = charts.error([&](int chart, double x) {
      const double inside = chart == 0 ? std::min(x, -0.5) : std::max(x, 0.5);
      return inside < edge ? kDark : kBright;
    });
    EXPECT_LE(e[0], kStep) << edge;
    EXPECT_LE(e[1], kStep) << edge;
  }
}

TEST(SeamError, AGutterOfTheWrongColourIsCounted) {
  const TwoCharts charts;
  // The same colour all over, but for the left chart's gutter. At the seam a look-up reads half of
  // it in linear light: far below what the seam should be.
  const auto e =
      charts.error([](int chart, double x) { return chart == 0 && x > 0 ? kBlack : kBright; });
  for (const double error : e) EXPECT_GT(error, 40);
}

TEST(SeamError, AWrongGutterBesideAColourEdgeIsCountedBeyondItsContrast) {
  const TwoCharts charts;
  const auto right = charts.error([](int chart, double) { return chart == 0 ? kDark : kBright; });
  EXPECT_LE(right[0], kStep);
  const auto wrong = charts.error(
      [](int chart, double x) { return chart == 0 ? (x > 0 ? kBlack : kDark) : kBright; });
  EXPECT_GT(wrong[0], 10);
  EXPECT_LT(wrong[0], kDark);
}

TEST(SeamError, OtherChartsAreNoPartOfTheContrast) {
  const TwoCharts charts;
  // The right chart's gutter is black, and so is all of the left chart but for what is near.
  const auto e = charts.error([](int chart, double x) {
    if (chart == 0) return x > -30 ? kBright : kBlack;
    return x > 0 ? kBright : kBlack;
  });
  EXPECT_GT(e[0], 40);
  EXPECT_GT(e[2], 40);
}

}  // namespace
}  // namespace crosspatch
