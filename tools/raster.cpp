// A visibility buffer: first the nearest thing at each sample is found, then each sample is
// coloured once.
#include "tools/raster.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "tools/palette.hpp"

namespace crosspatch {
namespace {

using Eigen::Vector3f;
using std::size_t;

size_t at(int i) {
  return static_cast<size_t>(i);
}

constexpr int kNothing = -1;

/// The nearest thing at every sample. Owners count the faces of all surfaces first, then the rods.
struct Visibility {
  int width;
  int height;
  std::vector<float> depth;
  std::vector<int> owner;

  Visibility(int w, int h)
      : width(w),
        height(h),
        depth(at(w) * at(h), -std::numeric_limits<float>::infinity()),
        owner(at(w) * at(h), kNothing) {}

  void offer(int x, int y, double z, int who) {
    const size_t i = at(y) * at(width) + at(x);
    if (static_cast<float>(z) <= depth[i]) return;
    depth[i] = static_cast<float>(z);
    owner[i] = who;
  }
};

/// Where the camera puts points: x right, y down, in samples; z towards the viewer.
struct Projection {
  Eigen::Matrix3d turn;
  Vector3d shift;

  Projection(const Camera& camera, const RasterOptions& options) {
    const double per_unit = options.samples / camera.pixel_size;
    turn = Vector3d(per_unit, -per_unit, per_unit).asDiagonal() * camera.axes;
    shift =
        Vector3d(options.width * options.samples / 2.0, options.height * options.samples / 2.0, 0) -
        turn * camera.centre;
  }
  [[nodiscard]] Vector3d operator()(const Vector3d& p) const { return turn * p + shift; }
};

struct Triangle {
  Vector3d a, b, c;

  [[nodiscard]] double area2() const {
    return (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  }
  [[nodiscard]] Vector3d barycentric(double x, double y) const {
    const double u = (b.x() - x) * (c.y() - y) - (c.x() - x) * (b.y() - y);
    const double v = (c.x() - x) * (a.y() - y) - (a.x() - x) * (c.y() - y);
    const double area = area2();
    return {u / area, v / area, 1 - (u + v) / area};
  }
};

/// The sample indices whose centres lie in [low, high], cut to [0, size).
struct Span {
  int begin, end;
  Span(double low, double high, int size)
      : begin(static_cast<int>(std::ceil(std::clamp(low - 0.5, 0.0, double(size))))),
        end(static_cast<int>(std::floor(std::clamp(high - 0.5, -1.0, size - 1.0))) + 1) {}
};

void cover_triangle(const Triangle& t, int who, Visibility& seen) {
  const double area = t.area2();
  if (!(std::abs(area) > 0)) return;
  const auto [x_low, x_high] = std::minmax({t.a.x(), t.b.x(), t.c.x()});
  const auto [y_low, y_high] = std::minmax({t.a.y(), t.b.y(), t.c.y()});
  const Span rows(y_low, y_high, seen.height), columns(x_low, x_high, seen.width);
  if (columns.begin >= columns.end) return;
  for (int y = rows.begin; y < rows.end; ++y) {
    // Barycentric coordinates are affine along the row.
    const Vector3d first = t.barycentric(columns.begin + 0.5, y + 0.5);
    const Vector3d step(
        (t.b.y() - t.c.y()) / area, (t.c.y() - t.a.y()) / area, (t.a.y() - t.b.y()) / area);
    for (int x = columns.begin; x < columns.end; ++x) {
      const Vector3d bary = first + (x - columns.begin) * step;
      if (bary.minCoeff() < 0) continue;
      seen.offer(x, y, bary[0] * t.a.z() + bary[1] * t.b.z() + bary[2] * t.c.z(), who);
    }
  }
}

/// The nearest point of the rod's axis in the picture, and how far the sample is from it.
struct RodHit {
  double along, distance2;
  RodHit(const Vector3d& a, const Vector3d& b, double x, double y) {
    const Eigen::Vector2d p(x, y), d = (b - a).head<2>();
    const double length2 = d.squaredNorm();
    along = length2 > 0 ? std::clamp((p - a.head<2>()).dot(d) / length2, 0.0, 1.0) : 0;
    if (length2 == 0) along = a.z() >= b.z() ? 0 : 1;
    distance2 = (a.head<2>() + along * d - p).squaredNorm();
  }
};

void cover_rod(const Vector3d& a, const Vector3d& b, double radius, int who, Visibility& seen) {
  const Span rows(std::min(a.y(), b.y()) - radius, std::max(a.y(), b.y()) + radius, seen.height);
  const Span columns(std::min(a.x(), b.x()) - radius, std::max(a.x(), b.x()) + radius, seen.width);
  for (int y = rows.begin; y < rows.end; ++y)
    for (int x = columns.begin; x < columns.end; ++x) {
      const RodHit hit(a, b, x + 0.5, y + 0.5);
      const double rise2 = radius * radius - hit.distance2;
      if (rise2 < 0) continue;
      seen.offer(x, y, a.z() + hit.along * (b.z() - a.z()) + std::sqrt(rise2), who);
    }
}

/// A surface seen through the camera: its projected points and the texture level of each face.
struct ProjectedSurface {
  const Surface* surface;
  int first_owner;
  MatrixX3d points;
  std::vector<int> level;

  [[nodiscard]] Triangle triangle(int f) const {
    return {
        points.row(surface->F(f, 0)), points.row(surface->F(f, 1)), points.row(surface->F(f, 2))};
  }
};

/// The level at which a texel is about as large as a sample: each level quarters the texels.
int texture_level(const Texture& texture, const Surface& surface, int f, double sample_area2) {
  const Eigen::Vector2d size(texture.levels[0].width, texture.levels[0].height);
  const auto uv = [&](int k) -> Eigen::Vector2d {
    return surface.corner_uv.row(3 * f + k).transpose().cwiseProduct(size);
  };
  const Eigen::Vector2d s = uv(1) - uv(0), t = uv(2) - uv(0);
  const double texels = std::abs(s.x() * t.y() - s.y() * t.x()) / std::max(sample_area2, 1e-12);
  const int last = static_cast<int>(texture.levels.size()) - 1;
  if (!(texels > 1)) return 0;
  return std::min(last, static_cast<int>(std::lround(0.5 * std::log2(texels))));
}

ProjectedSurface project(const Scene& scene,
                         const Surface& surface,
                         const Projection& to_picture,
                         int first_owner) {
  ProjectedSurface result{&surface, first_owner, MatrixX3d(surface.V.rows(), 3), {}};
  for (int v = 0; v < surface.V.rows(); ++v)
    result.points.row(v) = to_picture(surface.V.row(v).transpose()).transpose();
  if (surface.face_texture.empty()) return result;
  result.level.assign(at(static_cast<int>(surface.F.rows())), 0);
  for (int f = 0; f < surface.F.rows(); ++f)
    if (const int t = surface.face_texture[at(f)]; t >= 0)
      result.level[at(f)] =
          texture_level(scene.textures[at(t)], surface, f, std::abs(result.triangle(f).area2()));
  return result;
}

int wrapped(int i, int size, bool repeat) {
  return repeat ? ((i % size) + size) % size : std::clamp(i, 0, size - 1);
}

/// Bilinear in linear light. (0, 0) is the upper left corner of the upper left texel.
Color sample(const Texture& texture, int level, const Eigen::Vector2d& uv) {
  if (!uv.allFinite()) return Color::Ones();
  const Bitmap& bitmap = texture.levels[at(level)];
  const auto reduced = [](double c, bool repeat) {
    return repeat ? c - std::floor(c) : std::clamp(c, 0.0, 1.0);
  };
  const double x = reduced(uv.x(), texture.repeat_s) * bitmap.width - 0.5;
  const double y = reduced(uv.y(), texture.repeat_t) * bitmap.height - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const auto texel = [&](int dx, int dy) {
    return pixel(bitmap,
                 wrapped(x0 + dx, bitmap.width, texture.repeat_s),
                 wrapped(y0 + dy, bitmap.height, texture.repeat_t));
  };
  const float s = static_cast<float>(x - x0), t = static_cast<float>(y - y0);
  return (1 - t) * ((1 - s) * texel(0, 0) + s * texel(1, 0)) +
         t * ((1 - s) * texel(0, 1) + s * texel(1, 1));
}

/// Light arriving at a surface with the given normal (x right, y up, z towards the viewer).
float light(const Vector3d& normal) {
  // Weights add up to 1 where the normal meets the key light, so white stays white there.
  static const Vector3d key_light = Vector3d(-0.45, 0.55, 0.7).normalized();
  return static_cast<float>(0.36 + 0.45 * std::max(0.0, normal.dot(key_light)) +
                            0.28 * std::max(0.0, normal.z()));
}

constexpr float kInnerSide = 0.5F;  // inner sides of a surface are shown at half brightness
constexpr float kDarkCell = 0.4F;   // brightness of the solid checker's dark cells

float solid_checker(const Vector3d& p) {
  const double cells = std::floor(p.x()) + std::floor(p.y()) + std::floor(p.z());
  return std::fmod(std::abs(cells), 2) < 0.5 ? 1 : kDarkCell;
}

/// The surface's own colour, before light falls on it.
Color paint(const Scene& scene, const ProjectedSurface& seen, int f, const Vector3d& bary) {
  const Surface& surface = *seen.surface;
  Color color = neutral_color();
  if (!surface.corner_color.empty()) {
    color.setZero();
    for (int k = 0; k < 3; ++k)
      color += static_cast<float>(bary[k]) * surface.corner_color[at(3 * f + k)];
  }
  if (!surface.face_texture.empty() && surface.face_texture[at(f)] >= 0) {
    const Eigen::Vector2d uv =
        surface.corner_uv.middleRows<3>(Eigen::Index{3} * f).transpose() * bary;
    const Texture& texture = scene.textures[at(surface.face_texture[at(f)])];
    color = color.cwiseProduct(sample(texture, seen.level[at(f)], uv));
  }
  if (surface.corner_solid.rows() > 0)
    color *=
        solid_checker(surface.corner_solid.middleRows<3>(Eigen::Index{3} * f).transpose() * bary);
  return color;
}

Color shade_face(const Scene& scene,
                 const ProjectedSurface& seen,
                 int f,
                 double x,
                 double y,
                 const Eigen::Matrix3d& axes) {
  const Triangle t = seen.triangle(f);
  const Vector3d bary = t.barycentric(x, y);
  const Eigen::Array3d up(1, -1, 1);  // the picture's y runs down
  Vector3d normal = ((t.b - t.a).array() * up).matrix().cross(((t.c - t.a).array() * up).matrix());
  const bool outside = normal.z() >= 0;
  if (seen.surface->corner_normal.rows() > 0)
    normal =
        axes * (seen.surface->corner_normal.middleRows<3>(Eigen::Index{3} * f).transpose() * bary);
  const double length = normal.norm();
  if (length > 0) normal /= outside ? length : -length;
  return paint(scene, seen, f, bary) * light(normal) * (outside ? 1.0F : kInnerSide);
}

Color shade_rod(const Rod& rod, const Projection& to_picture, double radius, double x, double y) {
  const Vector3d a = to_picture(rod.a), b = to_picture(rod.b);
  const RodHit hit(a, b, x, y);
  const Eigen::Vector2d axis = (a + hit.along * (b - a)).head<2>();
  const Vector3d normal(
      x - axis.x(), axis.y() - y, std::sqrt(std::max(0.0, radius * radius - hit.distance2)));
  return rod.color * light(normal / radius);
}

/// Averages the samples of each pixel in linear light.
template <class Shade>
Bitmap resolve(const Visibility& seen, const RasterOptions& options, Shade shade) {
  const int n = options.samples;
  Bitmap bitmap = make_bitmap(options.width, options.height, options.background);
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      Color sum = Color::Zero();
      bool empty = true;
      for (int j = n * y; j < n * (y + 1); ++j)
        for (int i = n * x; i < n * (x + 1); ++i) {
          const int who = seen.owner[at(j) * at(seen.width) + at(i)];
          empty = empty && who == kNothing;
          sum += who == kNothing ? options.background : shade(who, i + 0.5, j + 0.5);
        }
      if (!empty) set_pixel(bitmap, x, y, sum / static_cast<float>(n * n));
    }
  return bitmap;
}

/// One level of half the size; odd rows and columns at the end are dropped.
Bitmap half(const Bitmap& full) {
  Bitmap result =
      make_bitmap(std::max(1, full.width / 2), std::max(1, full.height / 2), Color::Zero());
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) {
      const int x1 = std::min(2 * x + 1, full.width - 1), y1 = std::min(2 * y + 1, full.height - 1);
      set_pixel(result,
                x,
                y,
                (pixel(full, 2 * x, 2 * y) + pixel(full, x1, 2 * y) + pixel(full, 2 * x, y1) +
                 pixel(full, x1, y1)) /
                    4);
    }
  return result;
}

}  // namespace

Texture make_texture(Bitmap bitmap) {
  Texture texture;
  texture.levels.push_back(std::move(bitmap));
  while (texture.levels.back().width > 1 && texture.levels.back().height > 1)
    texture.levels.push_back(half(texture.levels.back()));
  return texture;
}

Bitmap draw(const Scene& scene, const Camera& camera, const RasterOptions& options) {
  const Projection to_picture(camera, options);
  Visibility seen(options.width * options.samples, options.height * options.samples);
  std::vector<ProjectedSurface> surfaces;
  int owners = 0;
  for (const Surface& surface : scene.surfaces) {
    surfaces.push_back(project(scene, surface, to_picture, owners));
    for (int f = 0; f < surface.F.rows(); ++f)
      cover_triangle(surfaces.back().triangle(f), owners + f, seen);
    owners += static_cast<int>(surface.F.rows());
  }
  const int first_rod = owners;
  const double samples_per_unit = options.samples / camera.pixel_size;
  for (size_t i = 0; i < scene.rods.size(); ++i) {
    const Rod& rod = scene.rods[i];
    cover_rod(to_picture(rod.a),
              to_picture(rod.b),
              rod.radius * samples_per_unit,
              first_rod + static_cast<int>(i),
              seen);
  }
  return resolve(seen, options, [&](int who, double x, double y) -> Color {
    if (who >= first_rod) {
      const Rod& rod = scene.rods[at(who - first_rod)];
      return shade_rod(rod, to_picture, rod.radius * samples_per_unit, x, y);
    }
    const auto owner = std::upper_bound(
        surfaces.begin(), surfaces.end(), who, [](int face, const ProjectedSurface& s) {
          return face < s.first_owner;
        });
    const ProjectedSurface& surface = *std::prev(owner);
    return shade_face(scene, surface, who - surface.first_owner, x, y, camera.axes);
  });
}

}  // namespace crosspatch
