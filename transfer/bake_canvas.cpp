#include "transfer/bake_canvas.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <optional>

#include "core/index.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

using Eigen::Array4f;

Array4f load(const BakeCanvas& canvas, std::size_t texel) {
  const std::uint16_t* p = &canvas.rgba[4 * texel];
  return {static_cast<float>(p[0]),
          static_cast<float>(p[1]),
          static_cast<float>(p[2]),
          static_cast<float>(p[3])};
}

void store(BakeCanvas& canvas, std::size_t texel, const Array4f& value) {
  for (int k = 0; k < 4; ++k)
    canvas.rgba[4 * texel + idx(k)] =
        static_cast<std::uint16_t>(std::clamp(value[k] + 0.5F, 0.0F, 65535.0F));
}

/// The bilinear value at `p` (texels), of those of the four texels around it that were painted
/// through the map.
std::optional<Array4f> painted_value(const BakeCanvas& canvas, const Vector2d& p) {
  const double x = p[0] - 0.5, y = p[1] - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  Array4f sum = Array4f::Zero();
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
  return Array4f(sum / static_cast<float>(weight));
}

Eigen::Matrix2d columns(const Vector2d& a, const Vector2d& b) {
  Eigen::Matrix2d m;
  m << a, b;
  return m;
}

/// Where the texels beyond half-edge h, outside of its face, lie on the surface: faces across are
/// unfolded one after the other into the plane of the face at h.
class AcrossSeam {
 public:
  AcrossSeam(const TriangleMesh& mesh, const Unwrap& unwrap, int size, int h)
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
  }

  [[nodiscard]] bool exists() const { return exists_; }

  /// The texel that shows the same place, or nothing where the surface ends before.
  [[nodiscard]] std::optional<Vector2d> operator()(const Vector2d& beyond) const {
    const Vector2d p = to_plane_ * (beyond - start_);
    constexpr int kMostFaces = 256;  // a gutter is narrow; finer meshes are not worth the walk
    int h = mesh_.twin[idx(halfedge_)];
    // The half-edge h runs from `from` to `to` in the plane, its face on the left.
    Vector2d from(length_, 0), to(0, 0);
    for (int i = 0; i < kMostFaces && h >= 0; ++i) {
      const Vector2d tip = third(from,
                                 to,
                                 mesh_.position(mesh_.from(h)),
                                 mesh_.position(mesh_.to(h)),
                                 mesh_.position(mesh_.tip(h)));
      const double area = doubled_area(from, to, tip);
      if (!(area > 0)) return std::nullopt;
      // Weights of the corners that h leaves and reaches; the third closes the sum.
      const double at_from = doubled_area(to, tip, p) / area;
      const double at_to = doubled_area(tip, from, p) / area;
      if (at_from >= 0 && at_to >= 0)
        return Vector2d(at_from * texel(h) + at_to * texel(next(h)) +
                        (1 - at_from - at_to) * texel(prev(h)));
      if (at_from < at_to) {
        h = mesh_.twin[idx(next(h))];
        from = tip;
      } else {
        h = mesh_.twin[idx(prev(h))];
        to = tip;
      }
    }
    return std::nullopt;
  }

 private:
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
  Vector2d start_{0, 0};
  Eigen::Matrix2d to_plane_ = Eigen::Matrix2d::Identity();
};

/// Mean of the known texels of a 2 x 2 block.
struct Mean {
  Array4f value = Array4f::Zero();
  bool known = false;
};

using Means = std::vector<Mean>;

}  // namespace

BakeCanvas make_canvas(int size) {
  const std::size_t texels = idx(size) * idx(size);
  return {
      size, std::vector<std::uint16_t>(4 * texels, 0), std::vector<std::uint8_t>(texels, kEmpty)};
}

void continue_across_seams(BakeCanvas& canvas,
                           const TriangleMesh& mesh,
                           const Unwrap& unwrap,
                           int reach) {
  const int size = canvas.size;
  std::vector<std::uint8_t> nearest(canvas.state.size(), 255);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin[idx(h)] < 0 || is_joined(mesh, unwrap, h)) continue;
    const AcrossSeam across(mesh, unwrap, size, h);
    if (!across.exists()) continue;
    const Vector2d a = unwrap.uv[idx(h)] * size, b = unwrap.uv[idx(next(h))] * size;
    const Vector2d tip = unwrap.uv[idx(prev(h))] * size;
    Vector2d out = Vector2d(-(b - a)[1], (b - a)[0]).normalized();
    if (out.dot(tip - a) > 0) out = -out;
    const auto paint = [&](int x, int y, const Vector3d&) {
      const std::size_t texel = canvas.texel(x, y);
      if (canvas.state[texel] == kFilled) return;
      const Vector2d p(x + 0.5, y + 0.5);
      const auto distance =
          static_cast<std::uint8_t>(std::clamp(out.dot(p - a) / reach, 0.0, 1.0) * 254);
      if (distance >= nearest[texel]) return;
      const std::optional<Vector2d> there = across(p);
      const auto value = there ? painted_value(canvas, *there) : std::nullopt;
      if (!value) return;
      nearest[texel] = distance;
      store(canvas, texel, *value);
      canvas.state[texel] = kContinued;
    };
    // A little wider than the seam: corners of the outline have gutters too.
    const Vector2d along = (b - a).normalized() * 0.5;
    const std::array<Vector2d, 4> strip{
        a - along, b + along, b + along + out * reach, a - along + out * reach};
    for_each_texel({strip[0], strip[1], strip[2]}, 1e-3, {0, size}, size, paint);
    for_each_texel({strip[0], strip[2], strip[3]}, 1e-3, {0, size}, size, paint);
  }
}

void push_pull(BakeCanvas& canvas) {
  if (std::all_of(
          canvas.state.begin(), canvas.state.end(), [](std::uint8_t s) { return s == kEmpty; }))
    return;
  std::vector<Means> levels;
  std::vector<int> sizes;
  const auto halve = [](int size, auto&& known, auto&& value) {
    const int half = (size + 1) / 2;
    Means means(idx(half) * idx(half));
    for (int y = 0; y < half; ++y)
      for (int x = 0; x < half; ++x) {
        Mean& mean = means[idx(y) * idx(half) + idx(x)];
        int count = 0;
        for (int j = 2 * y; j < std::min(size, 2 * y + 2); ++j)
          for (int i = 2 * x; i < std::min(size, 2 * x + 2); ++i) {
            const std::size_t texel = idx(j) * idx(size) + idx(i);
            if (!known(texel)) continue;
            mean.value += value(texel);
            ++count;
          }
        mean.known = count > 0;
        if (count > 0) mean.value /= static_cast<float>(count);
      }
    return means;
  };
  sizes.push_back((canvas.size + 1) / 2);
  levels.push_back(halve(
      canvas.size,
      [&](std::size_t t) { return canvas.state[t] != kEmpty; },
      [&](std::size_t t) { return load(canvas, t); }));
  while (sizes.back() > 1) {
    const Means& fine = levels.back();
    Means coarse = halve(
        sizes.back(),
        [&](std::size_t t) { return fine[t].known; },
        [&](std::size_t t) { return fine[t].value; });
    sizes.push_back((sizes.back() + 1) / 2);
    levels.push_back(std::move(coarse));
  }
  // The value of a coarse level at the centre of texel (x, y) of the level below it.
  const auto smooth = [&](std::size_t level, int x, int y) {
    const int size = sizes[level];
    const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
    const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
    const float s = static_cast<float>(u - i), t = static_cast<float>(v - j);
    const auto at = [&](int column, int row) {
      const int c = std::clamp(column, 0, size - 1), r = std::clamp(row, 0, size - 1);
      return levels[level][idx(r) * idx(size) + idx(c)].value;
    };
    return Array4f((at(i, j) * (1 - s) + at(i + 1, j) * s) * (1 - t) +
                   (at(i, j + 1) * (1 - s) + at(i + 1, j + 1) * s) * t);
  };
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    for (int y = 0; y < sizes[level]; ++y)
      for (int x = 0; x < sizes[level]; ++x) {
        Mean& mean = levels[level][idx(y) * idx(sizes[level]) + idx(x)];
        if (!mean.known) mean.value = smooth(level + 1, x, y);
      }
  for (int y = 0; y < canvas.size; ++y)
    for (int x = 0; x < canvas.size; ++x)
      if (canvas.state[canvas.texel(x, y)] == kEmpty)
        store(canvas, canvas.texel(x, y), smooth(0, x, y));
}

}  // namespace crosspatch
