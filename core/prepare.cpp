#include "core/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/index.hpp"
#include "core/manifold_cut.hpp"
#include "core/weld.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// The soup's triangles between fanning and cutting.
struct Triangles {
  MatrixX3i T;                        // welded vertices
  std::vector<int> file_triangle;     // per row of T
  std::vector<int> triangle_corners;  // 3 per file triangle
  std::vector<int> welded;            // per file vertex
};

class Preparation {
 public:
  Preparation(const PolygonSoup& soup, const PrepareOptions& options)
      : soup_(soup), options_(options) {
    out_.repairs = soup.notes;
  }

  Result<PreparedMesh> run() {
    fan_and_weld();
    remove_unusable();
    const ManifoldCut cut = cut_to_manifold(soup_.positions, triangles_.T);
    report(cut);
    const std::vector<int> kept = largest_component(cut);
    double area = 0;
    for (const int t : kept) area += triangle_area(t);
    if (!(area > 0)) return fail(ErrorCode::kBadInput, "no triangle with area is left");
    if (!std::isfinite(area))
      return fail(ErrorCode::kBadInput, "coordinates too large: the area is not finite");
    return build(cut, kept);
  }

 private:
  void repaired(long long count, fmt::format_string<long long&> text) {
    if (count > 0) out_.repairs.push_back(fmt::format(text, count));
  }

  [[nodiscard]] double triangle_area(int t) const {
    const MatrixX3d& V = soup_.positions;
    const Eigen::RowVector3d a = V.row(triangles_.T(t, 0));
    return (V.row(triangles_.T(t, 1)) - a).cross(V.row(triangles_.T(t, 2)) - a).norm() / 2;
  }

  [[nodiscard]] int file_vertex(int corner) const { return soup_.corner_vertex[idx(corner)]; }

  /// Vertices with an edge that one polygon side only uses, or that no polygon uses.
  [[nodiscard]] std::vector<bool> on_boundary() const {
    std::vector<std::pair<int, int>> sides;
    std::vector<bool> boundary(idx(static_cast<int>(soup_.positions.rows())), true);
    const std::vector<int>& corners = triangles_.triangle_corners;
    for (size_t i = 0; i < corners.size(); ++i) {
      const int u = file_vertex(corners[i]);
      const int v = file_vertex(corners[i - i % 3 + (i + 1) % 3]);
      boundary[idx(u)] = false;
      sides.emplace_back(std::min(u, v), std::max(u, v));
    }
    std::sort(sides.begin(), sides.end());
    for (size_t i = 0, j = 0; i < sides.size(); i = j) {
      while (j < sides.size() && sides[j] == sides[i]) ++j;
      if (j - i == 1) boundary[idx(sides[i].first)] = boundary[idx(sides[i].second)] = true;
    }
    return boundary;
  }

  void fan_and_weld() {
    triangles_.triangle_corners = fan_triangle_corners(soup_);
    long long thin = 0, fanned = 0;
    for (int p = 0; p < soup_.polygon_count(); ++p) {
      const int corners = soup_.polygon_begin[idx(p) + 1] - soup_.polygon_begin[idx(p)];
      thin += corners < 3 ? 1 : 0;
      fanned += corners > 3 ? 1 : 0;
    }
    repaired(thin, "left out {} polygons of fewer than three corners");
    repaired(fanned, "cut {} polygons of more than three corners into fans of triangles");
    const double diagonal =
        (soup_.positions.colwise().maxCoeff() - soup_.positions.colwise().minCoeff()).norm();
    triangles_.welded = weld(soup_.positions, on_boundary(), options_.weld_distance * diagonal);
    std::vector<bool> used(triangles_.welded.size(), false);
    for (const int c : triangles_.triangle_corners) used[idx(file_vertex(c))] = true;
    const long long unused = std::count(used.begin(), used.end(), false);
    repaired(unused, "left out {} vertices that no triangle uses");
  }

  /// Fills T with the triangles of three different vertices, each set of vertices once.
  void remove_unusable() {
    const int count = static_cast<int>(triangles_.triangle_corners.size() / 3);
    std::vector<std::pair<std::array<int, 3>, int>> sorted;
    long long repeated = 0, copies = 0;
    for (int t = 0; t < count; ++t) {
      std::array<int, 3> v{};
      for (size_t k = 0; k < 3; ++k)
        v[k] = triangles_.welded[idx(file_vertex(triangles_.triangle_corners[3 * idx(t) + k]))];
      std::sort(v.begin(), v.end());
      if (v[0] == v[1] || v[1] == v[2])
        ++repeated;
      else
        sorted.emplace_back(v, t);
    }
    std::sort(sorted.begin(), sorted.end());
    for (size_t i = 0; i < sorted.size(); ++i) {
      if (i > 0 && sorted[i].first == sorted[i - 1].first)
        ++copies;
      else
        triangles_.file_triangle.push_back(sorted[i].second);
    }
    std::sort(triangles_.file_triangle.begin(), triangles_.file_triangle.end());
    triangles_.T.resize(static_cast<Eigen::Index>(triangles_.file_triangle.size()), 3);
    for (int t = 0; t < triangles_.T.rows(); ++t)
      for (int k = 0; k < 3; ++k)
        triangles_.T(t, k) = triangles_.welded[idx(file_vertex(corner(t, k)))];
    repaired(repeated, "left out {} triangles that repeat a vertex");
    repaired(copies, "left out {} copies of other triangles");
  }

  /// The soup's corner at corner k of triangle t of T.
  [[nodiscard]] int corner(int t, int k) const {
    return triangles_.triangle_corners[3 * idx(triangles_.file_triangle[idx(t)]) + idx(k)];
  }

  void report(const ManifoldCut& cut) {
    std::vector<std::pair<int, int>> fans;  // file vertex, the corner that names the fan
    std::vector<int> files_of_fan(cut.vertex.size(), 0), fans_of_file(triangles_.welded.size(), 0);
    for (int c = 0; c < static_cast<int>(cut.vertex.size()); ++c)
      if (!cut.dropped[idx(c / 3)])
        fans.emplace_back(file_vertex(corner(c / 3, c % 3)), cut.vertex[idx(c)]);
    std::sort(fans.begin(), fans.end());
    fans.erase(std::unique(fans.begin(), fans.end()), fans.end());
    long long welded = 0;
    for (const auto& [file, fan] : fans) {
      welded += files_of_fan[idx(fan)]++ > 0 ? 1 : 0;
      ++fans_of_file[idx(file)];
    }
    repaired(welded, "welded {} vertices to others at the same place");
    repaired(cut.crowded_edges, "cut {} edges where more than two triangles meet");
    repaired(std::count(cut.turned.begin(), cut.turned.end(), true),
             "turned {} triangles to agree with their neighbours");
    repaired(cut.one_sided_edges, "cut {} edges of a one-sided surface");
    repaired(std::count(cut.dropped.begin(), cut.dropped.end(), true),
             "left out {} triangles that no cut makes manifold");
    repaired(std::count_if(fans_of_file.begin(), fans_of_file.end(), [](int n) { return n > 1; }),
             "split {} vertices where several fans of triangles meet");
  }

  /// Triangles of the component of largest area; the first of equals.
  std::vector<int> largest_component(const ManifoldCut& cut) {
    const std::vector<int> component = glued_components(cut);
    std::vector<double> area;
    std::vector<int> size;
    for (int t = 0; t < static_cast<int>(component.size()); ++t) {
      const int c = component[idx(t)];
      if (c < 0) continue;
      if (c >= static_cast<int>(area.size())) {
        area.push_back(0);
        size.push_back(0);
      }
      area[idx(c)] += triangle_area(t);
      ++size[idx(c)];
    }
    if (area.empty()) return {};
    const int best = static_cast<int>(std::max_element(area.begin(), area.end()) - area.begin());
    std::vector<int> kept;
    for (int t = 0; t < static_cast<int>(component.size()); ++t)
      if (component[idx(t)] == best) kept.push_back(t);
    if (area.size() > 1) {
      const double all = std::accumulate(area.begin(), area.end(), 0.0);
      out_.repairs.push_back(
          fmt::format("left out {} of {} components ({:.3g} % of area, {} triangles)",
                      area.size() - 1,
                      area.size(),
                      all > 0 ? 100 * (all - area[idx(best)]) / all : 0,
                      std::accumulate(size.begin(), size.end(), 0) - size[idx(best)]));
    }
    return kept;
  }

  Result<PreparedMesh> build(const ManifoldCut& cut, const std::vector<int>& kept) {
    const std::vector<int> vertex = number_vertices(cut, kept);
    MatrixX3i F(static_cast<Eigen::Index>(kept.size()), 3);
    bool closed = true;
    out_.numbering.soup_corner.resize(3 * kept.size());
    for (int f = 0; f < F.rows(); ++f) {
      const int t = kept[idx(f)];
      for (int k = 0; k < 3; ++k) {
        const int source = cut.turned[idx(t)] ? (3 - k) % 3 : k;  // turned: 0, 2, 1
        F(f, k) = vertex[idx(cut.vertex[idx(3 * t + source)])];
        out_.numbering.soup_corner[idx(3 * f + k)] = corner(t, source);
        closed = closed && cut.mate[idx(3 * t + k)] >= 0;
      }
      out_.numbering.file_triangle.push_back(triangles_.file_triangle[idx(t)]);
    }
    if (closed && volume(F) < 0) {
      F.col(1).swap(F.col(2));
      for (size_t f = 0; f < kept.size(); ++f)
        std::swap(out_.numbering.soup_corner[3 * f + 1], out_.numbering.soup_corner[3 * f + 2]);
      out_.repairs.emplace_back("turned the closed surface, its volume was negative");
    }
    auto mesh = make_mesh(std::move(V_), std::move(F));
    if (!mesh) return fail(ErrorCode::kInternal, "repaired surface: " + mesh.error().message);
    out_.mesh = std::move(*mesh);
    out_.numbering.triangle_corners = std::move(triangles_.triangle_corners);
    return std::move(out_);
  }

  /// Mesh vertices in the order of the file vertices they come from, written to V_ and
  /// mesh_vertex; returns the mesh vertex of each corner that names a fan.
  std::vector<int> number_vertices(const ManifoldCut& cut, const std::vector<int>& kept) {
    std::vector<std::pair<int, int>> fans;  // file vertex, the corner that names the fan
    for (const int t : kept)
      for (int k = 0; k < 3; ++k)
        fans.emplace_back(file_vertex(corner(t, k)), cut.vertex[idx(3 * t + k)]);
    std::sort(fans.begin(), fans.end());
    std::vector<int> vertex(cut.vertex.size(), -1);
    std::vector<int>& mesh_vertex = out_.numbering.mesh_vertex;
    mesh_vertex.assign(triangles_.welded.size(), -1);
    std::vector<int> origin;
    for (const auto& [file, fan] : fans) {
      if (vertex[idx(fan)] < 0) {
        vertex[idx(fan)] = static_cast<int>(origin.size());
        origin.push_back(file);
      }
      for (const int v : {file, triangles_.welded[idx(file)]})
        if (mesh_vertex[idx(v)] < 0) mesh_vertex[idx(v)] = vertex[idx(fan)];
    }
    for (size_t v = 0; v < mesh_vertex.size(); ++v)
      if (mesh_vertex[v] < 0) mesh_vertex[v] = mesh_vertex[idx(triangles_.welded[v])];
    V_.resize(static_cast<Eigen::Index>(origin.size()), 3);
    for (size_t v = 0; v < origin.size(); ++v)
      V_.row(static_cast<Eigen::Index>(v)) = soup_.positions.row(origin[v]);
    return vertex;
  }

  /// Signed volume about the first vertex, which keeps rounding small far from the origin.
  [[nodiscard]] double volume(const MatrixX3i& F) const {
    const Eigen::RowVector3d o = V_.row(0);
    double sum = 0;
    for (int f = 0; f < F.rows(); ++f)
      sum += (V_.row(F(f, 0)) - o).dot((V_.row(F(f, 1)) - o).cross(V_.row(F(f, 2)) - o));
    return sum / 6;
  }

  const PolygonSoup& soup_;
  const PrepareOptions& options_;
  Triangles triangles_;
  MatrixX3d V_;
  PreparedMesh out_;
};

}  // namespace

Result<PreparedMesh> prepare(const PolygonSoup& soup, const PrepareOptions& options) {
  constexpr double kSmallestWeld = 1e-12, kLargestWeld = 0.1;  // rounding; a tenth of the shape
  if (Status s = validate(soup); !s) return tl::unexpected(s.error());
  if (options.weld_distance != 0 &&
      !(options.weld_distance >= kSmallestWeld && options.weld_distance <= kLargestWeld))
    return fail(ErrorCode::kBadInput,
                fmt::format("weld distance {}: must be 0 or within [{}, {}]",
                            options.weld_distance,
                            kSmallestWeld,
                            kLargestWeld));
  if (soup.positions.rows() == 0 || soup.polygon_count() == 0)
    return fail(ErrorCode::kBadInput, "no triangle with area is left");
  return Preparation(soup, options).run();
}

SurfacePoint to_file(const PreparedMesh& prepared, const SurfacePoint& p) {
  if (!p.valid()) return {};
  const FileNumbering& n = prepared.numbering;
  SurfacePoint out{n.file_triangle[idx(p.face)], Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      if (n.triangle_corners[idx(3 * out.face + j)] == n.soup_corner[idx(3 * p.face + k)])
        out.bary[j] = p.bary[k];
  return out;
}

SurfacePoint from_file(const PreparedMesh& prepared, const SurfacePoint& p) {
  const FileNumbering& n = prepared.numbering;
  const auto it = std::lower_bound(n.file_triangle.begin(), n.file_triangle.end(), p.face);
  if (!p.valid() || it == n.file_triangle.end() || *it != p.face) return {};
  SurfacePoint out{static_cast<int>(it - n.file_triangle.begin()), Vector3d::Zero()};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      if (n.triangle_corners[idx(3 * p.face + j)] == n.soup_corner[idx(3 * out.face + k)])
        out.bary[k] = p.bary[j];
  return out;
}

}  // namespace crosspatch
