#include "tools/samples/coat.hpp"

#include <algorithm>
#include <cmath>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// 0 below low, 1 above high, smooth between.
double step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Vector3d mix(const Vector3d& a, const Vector3d& b, double t) {
  return a + t * (b - a);
}

double fraction(double x) {
  return x - std::floor(x);
}

/// 1 inside a spot of a pattern of period `period`, 0 outside.
double spots(double u, double v, double period, bool round) {
  const double x = std::abs(fraction(u / period) - 0.5), y = std::abs(fraction(v / period) - 0.5);
  const double distance = round ? std::sqrt(x * x + y * y) : std::max(x, y);
  return 1 - step(0.22, 0.28, distance);
}

class Painter {
 public:
  Painter(const Creature& creature, const CoatColors& colors)
      : creature_(creature), colors_(colors) {
    low_ = 1e9;
    high_ = -1e9;
    for (const Limb& limb : creature.limbs)
      if (limb.part == Part::kBody) {
        low_ = std::min({low_, limb.a[1] - limb.radius_a, limb.b[1] - limb.radius_b});
        high_ = std::max({high_, limb.a[1] + limb.radius_a, limb.b[1] + limb.radius_b});
      }
  }

  /// sRGB at a point of the skin.
  Vector3d at(const Vector3d& p) const {
    const Part part = creature_.limbs[idx(nearest_limb(creature_, p))].part;
    Vector3d c = mix(colors_.belly, colors_.back, step(0.15, 0.5, (p[1] - low_) / (high_ - low_)));
    if (part == Part::kBody) c = body(p, c);
    if (part == Part::kEar) c = mix(c, colors_.stripe, 0.6);
    if (part == Part::kTail) {
      c = mix(colors_.back, colors_.stripe, fraction(p[2] / 0.16) < 0.4 ? 1 : 0);
      c = mix(colors_.tail_tip, c, step(0.16, 0.19, (p - creature_.tail_tip).norm()));
    }
    if (part == Part::kFrontLeg || part == Part::kHindLeg) {
      const Vector3d& sock = part == Part::kFrontLeg ? colors_.sock_front : colors_.sock_hind;
      c = mix(sock, c, step(creature_.sock_height, creature_.sock_height + 0.03, p[1]));
    }
    return face(p, c);
  }

 private:
  Vector3d body(const Vector3d& p, Vector3d c) const {
    const double height = (p[1] - low_) / (high_ - low_);
    // Stripes lean backwards; only above the flank's middle.
    if (fraction((p[2] + 0.4 * p[1]) / 0.19) < 0.38)
      c = mix(c, colors_.stripe, step(0.62, 0.66, height));
    const bool left = p[0] > 0;
    const double spot = spots(p[2], p[1], 0.15, left) * step(0.2, 0.24, height) *
                        (1 - step(0.56, 0.6, height)) * step(0.06, 0.08, std::abs(p[0]));
    return mix(c, left ? colors_.left_spot : colors_.right_spot, spot);
  }

  Vector3d face(const Vector3d& p, Vector3d c) const {
    const Vector3d white(245, 245, 240), black(20, 18, 22);
    for (const Vector3d& eye : creature_.eyes) {
      const double d = (p - eye).norm() / creature_.eye_radius;
      c = mix(white, c, step(1.0, 1.1, d));
      c = mix(black, c, step(0.55, 0.65, d));
    }
    if (creature_.nose_radius > 0)
      c = mix(black, c, step(0.95, 1.15, (p - creature_.nose).norm() / creature_.nose_radius));
    return c;
  }

  const Creature& creature_;
  const CoatColors& colors_;
  double low_, high_;  ///< of the body
};

/// The pixels of a triangle and the places on the skin they show.
void rasterize(const TriangleMesh& mesh,
               const Atlas& atlas,
               int f,
               const Painter& painter,
               CoatImage& image,
               std::vector<bool>& painted) {
  std::array<Vector2d, 3> q;
  for (int k = 0; k < 3; ++k) q[idx(k)] = atlas.pixel.row(3 * f + k).transpose();
  const auto area = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0];
  };
  const double whole = area(q[0], q[1], q[2]);
  if (std::abs(whole) < 1e-9) return;
  const Vector2d low = q[0].cwiseMin(q[1]).cwiseMin(q[2]);
  const Vector2d high = q[0].cwiseMax(q[1]).cwiseMax(q[2]);
  for (int y = static_cast<int>(low[1]); y <= static_cast<int>(high[1]); ++y)
    for (int x = static_cast<int>(low[0]); x <= static_cast<int>(high[0]); ++x) {
      const Vector2d p(x + 0.5, y + 0.5);
      const Vector3d b =
          Vector3d(area(p, q[1], q[2]), area(q[0], p, q[2]), area(q[0], q[1], p)) / whole;
      const int pixel = y * atlas.size + x;
      if (b.minCoeff() < 0 || painted[idx(pixel)]) continue;
      const Vector3d place = b[0] * mesh.position(mesh.F(f, 0)) +
                             b[1] * mesh.position(mesh.F(f, 1)) +
                             b[2] * mesh.position(mesh.F(f, 2));
      const Vector3d color = painter.at(place);
      // Steps of 5 keep the file small and are too fine to see.
      for (int i = 0; i < 3; ++i)
        image.rgb[idx(3 * pixel + i)] = static_cast<std::uint8_t>(5 * std::lround(color[i] / 5));
      painted[idx(pixel)] = true;
    }
}

/// Unpainted pixels beside painted ones take their colour, ring by ring.
void fill_gutters(CoatImage& image, std::vector<bool>& painted, int rings) {
  constexpr std::array<std::array<int, 2>, 8> kAround{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
  for (int ring = 0; ring < rings; ++ring) {
    const std::vector<bool> before = painted;
    for (int y = 0; y < image.size; ++y)
      for (int x = 0; x < image.size; ++x)
        for (const auto& [dx, dy] : kAround) {
          const int pixel = y * image.size + x, nx = x + dx, ny = y + dy;
          if (painted[idx(pixel)] || nx < 0 || ny < 0 || nx >= image.size || ny >= image.size)
            continue;
          const int other = ny * image.size + nx;
          if (!before[idx(other)]) continue;
          for (int i = 0; i < 3; ++i) image.rgb[idx(3 * pixel + i)] = image.rgb[idx(3 * other + i)];
          painted[idx(pixel)] = true;
        }
  }
}

}  // namespace

CoatColors lira_colors() {
  return {.back = {214, 122, 52},
          .belly = {250, 226, 190},
          .stripe = {92, 48, 30},
          .left_spot = {200, 30, 40},
          .right_spot = {30, 80, 190},
          .sock_front = {250, 250, 245},
          .sock_hind = {40, 36, 40},
          .tail_tip = {250, 250, 245}};
}

CoatColors bodo_colors() {
  return {.back = {74, 130, 110},
          .belly = {214, 228, 176},
          .stripe = {28, 62, 74},
          .left_spot = {240, 200, 40},
          .right_spot = {150, 60, 160},
          .sock_front = {230, 110, 90},
          .sock_hind = {50, 40, 90},
          .tail_tip = {245, 220, 90}};
}

CoatImage paint_coat(const Creature& creature,
                     const CoatColors& colors,
                     const TriangleMesh& mesh,
                     const Atlas& atlas) {
  CoatImage image;
  image.size = atlas.size;
  image.rgb.assign(idx(3 * atlas.size * atlas.size), 0);
  std::vector<bool> painted(idx(atlas.size * atlas.size), false);
  const Painter painter(creature, colors);
  for (int f = 0; f < mesh.face_count(); ++f) rasterize(mesh, atlas, f, painter, image, painted);
  fill_gutters(image, painted, kGutter);
  return image;
}

}  // namespace crosspatch
