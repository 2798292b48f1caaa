#include "transfer/bake_canvas.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <optional>

#include "core/index.hpp"
#include "transfer/four_values.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

FourFloats load(const BakeCanvas& canvas, std::size_t texel) {
  return load_four(&canvas.values[idx(canvas.channels) * texel]);
}

void store(BakeCanvas& canvas, std::size_t texel, const FourFloats& value) {
  store_values(value, canvas.channels, &canvas.values[idx(canvas.channels) * texel]);
}

/// The bilinear value at `p` (texels), of those of the four texels around it that were painted
/// through the map.
std::optional<FourFloats> painted_value(const BakeCanvas& canvas, const Vector2d& p) {
  const double x = p[0] - 0.5, y = p[1] - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  FourFloats sum{0, 0, 0, 0};
  double weight = 0;
  for (int v = j; v < j + 2; ++v)
    for (int u = i; u < i + 2; ++u) {
      if (u < 0 || v < 0 || u >= canvas.size || v >= canvas.size) continue;
      const std::size_t texel = canvas.texel(u, v);
      const double w = (1 - std::abs(x - u)) * (1 - std::abs(y - v));
      if (canvas.state[texel] != kFilled) continue;
      sum += load(canvas, texel) * static_cast<float>(w);
      weight += w;
    }
  constexpr double kSure = 1e-3;
  if (weight < kSure) return std::nullopt;
  return sum / static_cast<float>(weight);
}

Eigen::Matrix2d columns(const Vector2d& a, const Vector2d& b) {
  Eigen::Matrix2d m;
  m << a, b;
  return m;
}

/// Length on the surface of a texel's side, if all texels were alike.
double mean_texel(const TriangleMesh& mesh, const Unwrap& unwrap, int size) {
  double area = 0, texels = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vector3d a = mesh.position(mesh.F(f, 0));
    area += (mesh.position(mesh.F(f, 1)) - a).cross(mesh.position(mesh.F(f, 2)) - a).norm();
    const auto [p, q, r] = in_texels(unwrap, f, size);
    texels += std::abs(doubled_area(p, q, r));
  }
  return texels > 0 ? std::sqrt(area / texels) : 0;
}

/// Where the texels beyond half-edge h, outside of its face, lie on the surface: faces across are
/// unfolded one after the other into the plane of the face at h. It exists where a texel of that
/// face is no longer than `longest` on the surface.
class AcrossSeam {
 public:
  AcrossSeam(const TriangleMesh& mesh, const Unwrap& unwrap, int size, int h, double longest)
      : mesh_(mesh), unwrap_(unwrap), size_(size), halfedge_(h) {
    // In the plane: the seam along x, the face at h above it.
    const Vector3d a = mesh.position(mesh.from(h)), b = mesh.position(mesh.to(h));
    length_ = (b - a).norm();
    start_ = texel(h);
    const Eigen::Matrix2d texels = columns(texel(next(h)) - start_, texel(prev(h)) - start_);
    exists_ = length_ > 0 && std::abs(texels.determinant()) > 0;
    if (!exists_) return;
    const Vector2d tip = third({0, 0}, {length_, 0}, a, b, mesh.position(mesh.tip(h)));
    to_plane_ = columns({length_, 0}, tip) * texels.inverse();
    exists_ = to_plane_.norm() <= longest;
  }

  [[nodiscard]] bool exists() const { return exists_; }

  /// The texel that shows the same place, or nothing where the surface ends before.
  [[nodiscard]] std::optional<Vector2d> operator()(const Vector2d& beyond) {
    const Vector2d p = to_plane_ * (beyond - start_);
    constexpr int kMostFaces = 256;  // a gutter is narrow; finer meshes are not worth the walk
    if (faces_.empty()) unfold(mesh_.twin[idx(halfedge_)], {length_, 0}, {0, 0});
    int face = 0;
    for (int i = 0; i < kMostFaces && face >= 0; ++i) {
      const Unfolded& f = faces_[idx(face)];
      if (!(f.area > 0)) return std::nullopt;
      // Weights of the corners that h leaves and reaches; the third closes the sum.
      const double at_from = doubled_area(f.to, f.tip, p) / f.area;
      const double at_to = doubled_area(f.tip, f.from, p) / f.area;
      if (at_from >= 0 && at_to >= 0)
        return Vector2d(at_from * texel(f.h) + at_to * texel(next(f.h)) +
                        (1 - at_from - at_to) * texel(prev(f.h)));
      face = neighbour(face, at_from < at_to ? 0 : 1);
    }
    return std::nullopt;
  }

 private:
  static constexpr int kUnknown = -2, kNone = -1;

  /// A face in the plane: on the left of its half-edge h, which runs from `from` to `to`.
  struct Unfolded {
    int h = kNone;
    Vector2d from, to, tip;
    double area = 0;
    std::array<int, 2> beyond{kUnknown, kUnknown};  ///< over the sides to and from the tip
  };

  int unfold(int h, const Vector2d& from, const Vector2d& to) {
    if (h < 0) return kNone;
    const Vector2d tip = third(from,
                               to,
                               mesh_.position(mesh_.from(h)),
                               mesh_.position(mesh_.to(h)),
                               mesh_.position(mesh_.tip(h)));
    faces_.push_back({h, from, to, tip, doubled_area(from, to, tip)});
    return static_cast<int>(faces_.size()) - 1;
  }

  /// The face over side 0 (from `to` to the tip) or 1 (from the tip to `from`), or kNone.
  int neighbour(int face, std::size_t side) {
    if (faces_[idx(face)].beyond[side] == kUnknown) {
      const Unfolded f = faces_[idx(face)];
      const int found = side == 0 ? unfold(mesh_.twin[idx(next(f.h))], f.tip, f.to)
                                  : unfold(mesh_.twin[idx(prev(f.h))], f.from, f.tip);
      faces_[idx(face)].beyond[side] = found;
    }
    return faces_[idx(face)].beyond[side];
  }

  [[nodiscard]] Vector2d texel(int corner) const { return unwrap_.uv[idx(corner)] * size_; }

  /// The corner c of the triangle (a, b, c) laid flat on the left of the segment from p to q.
  static Vector2d third(const Vector2d& p,
                        const Vector2d& q,
                        const Vector3d& a,
                        const Vector3d& b,
                        const Vector3d& c) {
    const double length = (b - a).norm();
    if (!(length > 0)) return p;
    const double along = (c - a).dot(b - a) / length;
    const double height = (b - a).cross(c - a).norm() / length;
    const Vector2d x = (q - p).normalized();
    return p + along * x + height * Vector2d(-x[1], x[0]);
  }

  const TriangleMesh& mesh_;
  const Unwrap& unwrap_;
  int size_;
  int halfedge_;
  double length_ = 0;
  bool exists_ = false;
  std::vector<Unfolded> faces_;  ///< those that were asked for, the one across the seam first
  Vector2d start_{0, 0};
  Eigen::Matrix2d to_plane_ = Eigen::Matrix2d::Identity();
};

/// The side of a half-edge in the image, and the way along it; nothing where it has no length.
std::optional<Vector2d> direction(const Unwrap& unwrap, int h) {
  const Vector2d side = unwrap.uv[idx(next(h))] - unwrap.uv[idx(h)];
  const double length = side.norm();
  if (!(length > 0)) return std::nullopt;
  return side / length;
}

/// How far beyond the end of a side that runs `along`, in shares of the reach, there are texels
/// whose nearest place on a chart's outline is that end, up to the bisector of the corner there.
/// `other` is the direction of the outline's other side at that end, away from it.
double beyond_corner(const Vector2d& along,
                     const Vector2d& out,
                     const std::optional<Vector2d>& other) {
  if (!other) return 1;
  if (other->dot(out) >= 0) return 0;  // the outline turns outwards: nearer to the other side
  return std::sqrt(std::max(0.0, 1 - along.dot(*other)) / 2);  // sine of half the turn
}

/// Directions of the outline's sides after and before h, both away from h; nothing where a side has
/// no length or is no seam, so that no gutter of its own goes around the corner.
std::optional<Vector2d> side_after(const TriangleMesh& mesh, const Unwrap& unwrap, int h) {
  int side = next(h);
  while (is_joined(mesh, unwrap, side)) side = next(mesh.twin[idx(side)]);
  if (mesh.twin[idx(side)] < 0) return std::nullopt;
  return direction(unwrap, side);
}

std::optional<Vector2d> side_before(const TriangleMesh& mesh, const Unwrap& unwrap, int h) {
  int side = prev(h);
  while (is_joined(mesh, unwrap, side)) side = prev(mesh.twin[idx(side)]);
  if (mesh.twin[idx(side)] < 0) return std::nullopt;
  const std::optional<Vector2d> along = direction(unwrap, side);
  if (!along) return std::nullopt;
  return Vector2d(-*along);
}

/// Calls visit(h, texel, p, distance) for the texels that were not painted through the map and
/// whose centres p lie beside a seam h, outside of its face, up to `reach` texels from it; the
/// distance is in 254ths of that. Some that are nearer to another seam are among them.
template <class Visit>
void for_each_gutter_texel(const BakeCanvas& canvas,
                           const TriangleMesh& mesh,
                           const Unwrap& unwrap,
                           int reach,
                           Visit visit) {
  const int size = canvas.size;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin[idx(h)] < 0 || is_joined(mesh, unwrap, h)) continue;
    const Vector2d a = unwrap.uv[idx(h)] * size, b = unwrap.uv[idx(next(h))] * size;
    const Vector2d tip = unwrap.uv[idx(prev(h))] * size;
    const double length = (b - a).norm();
    if (!(length > 0)) continue;
    const Vector2d along = (b - a) / length;
    Vector2d out(-along[1], along[0]);
    if (out.dot(tip - a) > 0) out = -out;
    const auto look = [&](const TexelSpan& span) {
      const Vector2d left = Vector2d(span.left + 0.5, span.y + 0.5) - a;
      double place = along.dot(left), away = out.dot(left);
      std::size_t texel = canvas.texel(span.left, span.y);
      for (int x = span.left; x <= span.right; ++x, ++texel, place += along[0], away += out[0]) {
        if (canvas.state[texel] == kFilled) continue;
        const double beside = place - std::clamp(place, 0.0, length);
        const double square = away * away + beside * beside;
        if (square <= reach * reach)
          visit(h,
                texel,
                Vector2d(x + 0.5, span.y + 0.5),
                static_cast<std::uint8_t>(std::sqrt(square) * (254.0 / reach)));
      }
    };
    // Wider than the seam where the outline turns: gutters would gape.
    const double before = reach * beyond_corner(-along, out, side_before(mesh, unwrap, h));
    const double after = reach * beyond_corner(along, out, side_after(mesh, unwrap, h));
    const Vector2d from = a - along * before, to = b + along * after;
    const std::array<Vector2d, 4> strip{from, to, to + out * reach, from + out * reach};
    for_each_span({strip[0], strip[1], strip[2]}, 1e-3, {0, size}, size, look);
    for_each_span({strip[0], strip[2], strip[3]}, 1e-3, {0, size}, size, look);
  }
}

/// Means of the texels that are not empty in blocks of 2 x 2.
BakeCanvas halved(const BakeCanvas& fine) {
  BakeCanvas coarse = make_canvas((fine.size + 1) / 2, fine.channels);
  for (int y = 0; y < coarse.size; ++y) {
    const int rows = std::min(2, fine.size - 2 * y);
    for (int x = 0; x < coarse.size; ++x) {
      const int columns = std::min(2, fine.size - 2 * x);
      FourFloats sum{0, 0, 0, 0};
      int count = 0;
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
          const std::size_t texel = fine.texel(2 * x + i, 2 * y + j);
          if (fine.state[texel] == kEmpty) continue;
          sum += load(fine, texel);
          ++count;
        }
      if (count == 0) continue;
      const std::size_t texel = coarse.texel(x, y);
      store(coarse, texel, sum / static_cast<float>(count));
      coarse.state[texel] = kFilled;
    }
  }
  return coarse;
}

/// The value of a canvas at the centre of texel (x, y) of one with twice the side.
FourFloats smooth(const BakeCanvas& coarse, int x, int y) {
  // Centres lie a quarter of a coarse texel beside the centre of theirs.
  const int i = (x - 1) >> 1, j = (y - 1) >> 1;
  const float s = x % 2 == 0 ? 0.75F : 0.25F, t = y % 2 == 0 ? 0.75F : 0.25F;
  const auto at = [&](int column, int row) {
    return load(
        coarse,
        coarse.texel(std::clamp(column, 0, coarse.size - 1), std::clamp(row, 0, coarse.size - 1)));
  };
  return (at(i, j) * (1 - s) + at(i + 1, j) * s) * (1 - t) +
         (at(i, j + 1) * (1 - s) + at(i + 1, j + 1) * s) * t;
}

}  // namespace

BakeCanvas make_canvas(int size, int channels) {
  const std::size_t texels = idx(size) * idx(size);
  return {size,
          channels,
          std::vector<std::uint16_t>(idx(channels) * texels + 1, 0),
          std::vector<std::uint8_t>(texels, kEmpty)};
}

void continue_across_seams(BakeCanvas& canvas,
                           const TriangleMesh& mesh,
                           const Unwrap& unwrap,
                           int reach) {
  // Which seam is nearest first, as to unfold the surface takes longer than to measure.
  constexpr std::uint8_t kFar = 255;
  std::vector<std::uint8_t> nearest(canvas.state.size(), kFar);
  for_each_gutter_texel(
      canvas, mesh, unwrap, reach, [&](int, std::size_t texel, const Vector2d&, std::uint8_t d) {
        nearest[texel] = std::min(nearest[texel], d);
      });
  // A texel of a face that is seen edge-on is a strip across many others: the one beyond the seam
  // would be of some far place, and bilinear look-ups blend it into the face. Measured: with
  // samples/bodo's coat on lira's own texture coordinates seams are off by 0.1, 0.1, 0.1 and 0.4 of
  // 255 at mips 0 to 3, without a limit by 0.2, 3.9, 7.9 and 17.
  constexpr double kEdgeOn = 16;
  const double longest = kEdgeOn * mean_texel(mesh, unwrap, canvas.size);
  std::optional<AcrossSeam> across;
  int halfedge = -1;
  for_each_gutter_texel(canvas,
                        mesh,
                        unwrap,
                        reach,
                        [&](int h, std::size_t texel, const Vector2d& p, std::uint8_t distance) {
                          if (distance > nearest[texel] || canvas.state[texel] != kEmpty) return;
                          if (h != halfedge)
                            across.emplace(mesh, unwrap, canvas.size, halfedge = h, longest);
                          if (!across->exists()) return;
                          const std::optional<Vector2d> there = (*across)(p);
                          const auto value = there ? painted_value(canvas, *there) : std::nullopt;
                          if (!value) return;
                          store(canvas, texel, *value);
                          canvas.state[texel] = kContinued;
                        });
}

void push_pull(BakeCanvas& canvas) {
  const auto is_empty = [](std::uint8_t s) { return s == kEmpty; };
  if (std::none_of(canvas.state.begin(), canvas.state.end(), is_empty) ||
      std::all_of(canvas.state.begin(), canvas.state.end(), is_empty))
    return;
  BakeCanvas coarse = halved(canvas);
  push_pull(coarse);
  for (int y = 0; y < canvas.size; ++y)
    for (int x = 0; x < canvas.size; ++x)
      if (const std::size_t texel = canvas.texel(x, y); canvas.state[texel] == kEmpty)
        store(canvas, texel, smooth(coarse, x, y));
}

}  // namespace crosspatch
