#include <algorithm>
#include <compare>
#include <limits>
#include <optional>
#include <unordered_map>

#include "core/index.hpp"
#include "transfer/overlay_mesh.hpp"
#include "transfer/triangulate.hpp"

namespace crosspatch {
namespace {

using Triangle = OverlayMesh::Triangle;

/// Where the exact attributes are known: at a wedge (a == b), or linear along an exact side a < b.
struct Sample {
  int a;
  int b;
  auto operator<=>(const Sample&) const = default;
};

/// The part of a segment inside a triangle, from its ends' weights there; none if that is no longer
/// than rounding.
std::optional<std::array<double, 2>> part_inside(const Vector3d& from, const Vector3d& to) {
  constexpr double kRounding = 1e-9;
  double begin = 0, end = 1;
  for (int k = 0; k < 3; ++k) {
    const double step = to[k] - from[k];
    if (step > 0) begin = std::max(begin, -from[k] / step);
    if (step < 0) end = std::min(end, -from[k] / step);
    if (step == 0 && from[k] < 0) return std::nullopt;
  }
  if (!(end - begin > kRounding)) return std::nullopt;
  return std::array{begin, end};
}

/// The triangles around a point between two sides that must stay, counter-clockwise: triangle i
/// holds the point, rim[i] and rim[i + 1].
struct Sector {
  std::vector<int> triangles;
  std::vector<int> rim;
  bool closed = false;       ///< rim.front() == rim.back(), all the way around
  std::uint8_t closing = 0;  ///< marks of the new side rim.back() -> rim.front(), if not closed
};

/// What takes the place of a sector.
struct Patch {
  std::vector<Triangle> triangles;
  std::vector<std::vector<Sample>> samples;
  AttributeError error;
};

class Thinner {
 public:
  Thinner(OverlayMesh& mesh,
          const SourceAttributes& attributes,
          const TriangleMesh& target,
          const ThinningOptions& options)
      : mesh_(mesh), attributes_(attributes), target_(target), options_(options) {
    incident_.resize(mesh.points.size());
    samples_.resize(mesh.triangles.size());
    errors_.resize(mesh.triangles.size());
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) enlist(t);
  }

  AttributeError run() {
    bool changed = true;
    // A later pass only sees what its predecessor freed; few points are left after the third.
    for (int pass = 0; pass < 6 && changed; ++pass) {
      changed = false;
      for (int point = 0; point < static_cast<int>(incident_.size()); ++point)
        if (!mesh_.target_vertex[idx(point)] && !incident_[idx(point)].empty())
          changed = remove(point) || changed;
    }
    AttributeError worst;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!mesh_.triangles[t].alive) continue;
      worst.uv_texels = std::max(worst.uv_texels, errors_[t].uv_texels);
      worst.color = std::max(worst.color, errors_[t].color);
    }
    std::erase_if(mesh_.triangles, [](const Triangle& t) { return !t.alive; });
    return worst;
  }

 private:
  int point_of(int wedge) const { return mesh_.wedge_point[idx(wedge)]; }

  void enlist(int t) {
    for (const int w : mesh_.triangles[idx(t)].wedge) incident_[idx(point_of(w))].push_back(t);
  }

  void retire(int t) {
    mesh_.triangles[idx(t)].alive = false;
    for (const int w : mesh_.triangles[idx(t)].wedge) std::erase(incident_[idx(point_of(w))], t);
    samples_[idx(t)].clear();
  }

  std::size_t corner_at(int t, int point) const {
    std::size_t k = 0;
    while (point_of(mesh_.triangles[idx(t)].wedge[k]) != point) ++k;
    return k;
  }

  /// The star of `point`, cut at sides along the target's edges; none where the point must stay.
  std::optional<std::vector<Sector>> sectors(int point) const {
    const std::vector<int>& star = incident_[idx(point)];
    // Hubs are not worth the cubic ear clipping.
    constexpr std::size_t kLargestStar = 48;
    if (star.size() > kLargestStar) return std::nullopt;
    std::unordered_map<int, int> leaving;  // by point: the triangle whose spoke point -> it
    std::vector<int> starts;
    for (const int t : star) {
      const Triangle& triangle = mesh_.triangles[idx(t)];
      const std::size_t k = corner_at(t, point);
      const std::uint8_t out = triangle.side[k];
      if ((out & kTargetEdge) != 0) starts.push_back(t);
      if ((out & kTargetEdge) == 0 && (out & kSeam) != 0) return std::nullopt;
      if (!leaving.emplace(point_of(triangle.wedge[(k + 1) % 3]), t).second) return std::nullopt;
    }
    if (starts.size() > 2) return std::nullopt;
    std::vector<Sector> result;
    std::size_t reached = 0;
    for (const int first : starts.empty() ? std::vector<int>{star.front()} : starts) {
      auto sector = walk(point, first, leaving);
      if (!sector || sector->closed != starts.empty()) return std::nullopt;
      reached += sector->triangles.size();
      result.push_back(std::move(*sector));
    }
    if (reached != star.size() || !starts_agree(result)) return std::nullopt;
    return result;
  }

  /// Both halves must close with the same new side.
  bool starts_agree(const std::vector<Sector>& s) const {
    if (s.size() != 2) return true;
    return s[0].closing == s[1].closing &&
           point_of(s[0].rim.front()) == point_of(s[1].rim.back()) &&
           point_of(s[0].rim.back()) == point_of(s[1].rim.front());
  }

  std::optional<Sector> walk(int point,
                             int first,
                             const std::unordered_map<int, int>& leaving) const {
    Sector sector;
    const std::size_t k0 = corner_at(first, point);
    const std::uint8_t first_mark = mesh_.triangles[idx(first)].side[k0];
    sector.rim.push_back(mesh_.triangles[idx(first)].wedge[(k0 + 1) % 3]);
    for (int t = first;;) {
      const Triangle& triangle = mesh_.triangles[idx(t)];
      const std::size_t k = corner_at(t, point);
      if (triangle.wedge[(k + 1) % 3] != sector.rim.back() ||
          triangle.wedge[k] != mesh_.triangles[idx(first)].wedge[k0] ||
          triangle.target_face != mesh_.triangles[idx(first)].target_face)
        return std::nullopt;
      sector.triangles.push_back(t);
      sector.rim.push_back(triangle.wedge[(k + 2) % 3]);
      const std::uint8_t in = triangle.side[(k + 2) % 3];
      if ((in & kTargetEdge) != 0) {
        if ((in & kSeam) != (first_mark & kSeam)) return std::nullopt;
        sector.closing = static_cast<std::uint8_t>(in & ~kExact);
        return sector;
      }
      const auto following = leaving.find(point_of(sector.rim.back()));
      if (following == leaving.end()) return std::nullopt;
      t = following->second;
      if (t != first) continue;
      sector.closed = true;
      if (sector.rim.front() != sector.rim.back()) return std::nullopt;
      return sector;
    }
  }

  Vector3d bary(int wedge, int face) const {
    return in_face(target_, mesh_.points[idx(point_of(wedge))], face).bary;
  }

  /// Cuts the sector's polygon anew without its point; none where that cannot be had within the
  /// tolerances.
  std::optional<Patch> fill(int point, const Sector& sector) const {
    const Triangle& pattern = mesh_.triangles[idx(sector.triangles.front())];
    const int face = pattern.target_face;
    std::vector<int> loop = sector.rim;
    std::vector<std::uint8_t> marks;
    for (const int t : sector.triangles)
      marks.push_back(mesh_.triangles[idx(t)].side[(corner_at(t, point) + 1) % 3]);
    if (sector.closed)
      loop.pop_back();
    else
      marks.push_back(sector.closing);
    if (loop.size() < 3) return std::nullopt;
    std::vector<Vector3d> corners;
    corners.reserve(loop.size());
    for (const int w : loop) corners.push_back(bary(w, face));
    const auto cut = triangulate(corners,
                                 lay_flat(target_.position(target_.F(face, 0)),
                                          target_.position(target_.F(face, 1)),
                                          target_.position(target_.F(face, 2))));
    if (cut.empty()) return std::nullopt;
    Patch patch;
    const int n = static_cast<int>(loop.size());
    for (const auto& c : cut) {
      Triangle triangle = pattern;
      for (std::size_t k = 0; k < 3; ++k) {
        triangle.wedge[k] = loop[idx(c[k])];
        triangle.side[k] = c[(k + 1) % 3] == (c[k] + 1) % n ? marks[idx(c[k])] : std::uint8_t{0};
      }
      patch.triangles.push_back(triangle);
    }
    patch.samples.resize(patch.triangles.size());
    if (!distribute(gather(point, sector), face, patch)) return std::nullopt;
    return patch;
  }

  /// What the sector's triangles were measured at, its removed point and its removed sides.
  std::vector<Sample> gather(int point, const Sector& sector) const {
    std::vector<Sample> all;
    for (const int t : sector.triangles) {
      const auto& own = samples_[idx(t)];
      all.insert(all.end(), own.begin(), own.end());
      const Triangle& triangle = mesh_.triangles[idx(t)];
      const std::size_t k = corner_at(t, point);
      const auto [a, b] = std::minmax(triangle.wedge[k], triangle.wedge[(k + 1) % 3]);
      if ((triangle.side[k] & kExact) != 0) all.push_back({a, b});
    }
    const Triangle& first = mesh_.triangles[idx(sector.triangles.front())];
    const int wedge = first.wedge[corner_at(sector.triangles.front(), point)];
    all.push_back({wedge, wedge});
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// Hands each sample to the new triangles that hold a part of it; false if one is out of
  /// tolerance. The error is linear along such a part, so that its ends tell the largest.
  bool distribute(const std::vector<Sample>& all, int face, Patch& patch) const {
    std::vector<std::array<Vector3d, 3>> corners;
    for (const Triangle& t : patch.triangles)
      corners.push_back({bary(t.wedge[0], face), bary(t.wedge[1], face), bary(t.wedge[2], face)});
    const auto weights = [&](std::size_t i, const Vector3d& p) -> Vector3d {
      const auto& [a, b, c] = corners[i];
      return Vector3d(signed_area(p, b, c), signed_area(a, p, c), signed_area(a, b, p)) /
             signed_area(a, b, c);
    };
    for (const Sample& s : all) {
      const Vector3d from = bary(s.a, face), to = bary(s.b, face);
      bool held = false;
      for (std::size_t i = 0; i < corners.size() && s.a != s.b; ++i) {
        const Vector3d first = weights(i, from), last = weights(i, to);
        const auto part = part_inside(first, last);
        if (!part) continue;
        held = true;
        for (const double t : *part)
          if (!agrees(s, t, (1 - t) * first + t * last, patch.triangles[i], patch.error))
            return false;
        patch.samples[i].push_back(s);
      }
      if (held) continue;
      // A point, or a side that rounding keeps out of every triangle.
      std::size_t holder = 0;
      Vector3d nearest = Vector3d::Constant(-std::numeric_limits<double>::infinity());
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3d w = weights(i, (from + to) / 2);
        if (w.minCoeff() <= nearest.minCoeff()) continue;
        nearest = w;
        holder = i;
      }
      if (!agrees(s, 0.5, nearest, patch.triangles[holder], patch.error)) return false;
      patch.samples[holder].push_back(s);
    }
    return true;
  }

  /// Whether a triangle's attributes at the point of these weights are those at `t` along the
  /// sample, within the tolerances; `worst` grows to the error.
  bool agrees(const Sample& s,
              double t,
              const Vector3d& weights,
              const Triangle& triangle,
              AttributeError& worst) const {
    const std::size_t width = idx(attributes_.width);
    std::vector<double> exact(width), linear(width);
    for (std::size_t i = 0; i < width; ++i) {
      const auto value = [&](int wedge) { return mesh_.attributes[idx(wedge) * width + i]; };
      exact[i] = (1 - t) * value(s.a) + t * value(s.b);
      linear[i] = weights[0] * value(triangle.wedge[0]) + weights[1] * value(triangle.wedge[1]) +
                  weights[2] * value(triangle.wedge[2]);
    }
    const AttributeError e =
        difference(attributes_, triangle.material, exact.data(), linear.data());
    if (e.uv_texels > options_.uv_tolerance_texels || e.color > options_.color_tolerance)
      return false;
    worst.uv_texels = std::max(worst.uv_texels, e.uv_texels);
    worst.color = std::max(worst.color, e.color);
    return true;
  }

  bool remove(int point) {
    const auto star = sectors(point);
    if (!star) return false;
    std::vector<Patch> patches;
    for (const Sector& sector : *star) {
      auto patch = fill(point, sector);
      if (!patch) return false;
      patches.push_back(std::move(*patch));
    }
    for (const Sector& sector : *star)
      for (const int t : sector.triangles) retire(t);
    for (Patch& patch : patches)
      for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
        mesh_.triangles.push_back(patch.triangles[i]);
        samples_.push_back(std::move(patch.samples[i]));
        errors_.push_back(patch.error);
        enlist(static_cast<int>(mesh_.triangles.size()) - 1);
      }
    return true;
  }

  OverlayMesh& mesh_;
  const SourceAttributes& attributes_;
  const TriangleMesh& target_;
  const ThinningOptions& options_;
  std::vector<std::vector<int>> incident_;    ///< living triangles at each point
  std::vector<std::vector<Sample>> samples_;  ///< per triangle
  std::vector<AttributeError> errors_;        ///< per triangle: largest error of its patch
};

}  // namespace

AttributeError thin_out(OverlayMesh& mesh,
                        const SourceAttributes& attributes,
                        const TriangleMesh& target,
                        const ThinningOptions& options) {
  return Thinner(mesh, attributes, target, options).run();
}

}  // namespace crosspatch
