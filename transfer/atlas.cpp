#include "transfer/atlas.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "core/index.hpp"
#include "transfer/charts.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch {
namespace {

using std::size_t;

struct FlatChart {
  std::vector<int> faces;
  std::vector<Vector2d> corners;  ///< three a face; lower left of the bounding box at the origin
  Vector2d extent{0, 0};
};

struct Segment {
  Vector2d a, b;
};

/// Whether two segments cross inside of both.
bool cross(const Segment& s, const Segment& t) {
  return doubled_area(s.a, s.b, t.a) * doubled_area(s.a, s.b, t.b) < 0 &&
         doubled_area(t.a, t.b, s.a) * doubled_area(t.a, t.b, s.b) < 0;
}

/// The sides of the faces that no two of them share, where they lie in the plane.
std::vector<Segment> outline(const TriangleMesh& mesh,
                             const std::vector<int>& faces,
                             const std::vector<Vector2d>& corners) {
  const std::set<int> inside(faces.begin(), faces.end());
  std::vector<Segment> sides;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const int twin = mesh.twin[idx(3 * faces[i]) + k];
      if (twin < 0 || !inside.contains(face_of(twin)))
        sides.push_back({corners[3 * i + k], corners[3 * i + (k + 1) % 3]});
    }
  return sides;
}

bool crosses_itself(std::vector<Segment> sides) {
  const auto left = [](const Segment& s) { return std::min(s.a[0], s.b[0]); };
  std::sort(sides.begin(), sides.end(), [&](const Segment& s, const Segment& t) {
    return left(s) < left(t);
  });
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const double right = std::max(sides[i].a[0], sides[i].b[0]);
    for (std::size_t j = i + 1; j < sides.size() && left(sides[j]) <= right; ++j)
      if (cross(sides[i], sides[j])) return true;
  }
  return false;
}

/// Whether a texel of an image of 256 texels a side belongs to two faces.
bool shares_texels(const std::vector<Vector2d>& corners) {
  constexpr int kSize = 256;
  Vector2d low = corners.front(), high = low;
  for (const Vector2d& p : corners) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double scale = std::max((high - low).maxCoeff(), std::numeric_limits<double>::min());
  Unwrap unwrap;
  for (const Vector2d& p : corners) unwrap.uv.emplace_back((p - low) / scale);
  return overlap(unwrap, {}, kSize) > 0;
}

bool has_turned_faces(const std::vector<Vector2d>& corners) {
  const auto area = [&](std::size_t c) {
    return doubled_area(corners[c], corners[c + 1], corners[c + 2]);
  };
  for (std::size_t c = 0; c < corners.size(); c += 3)
    if (!(area(c) * area(0) > 0)) return true;
  return false;
}

/// Whether a chart covers a place twice. In one piece, without turned faces, it does where its
/// outline crosses itself, however little; pieces that lie inside of others share texels.
bool overlaps_itself(const TriangleMesh& mesh,
                     const std::vector<int>& faces,
                     const std::vector<Vector2d>& corners) {
  return has_turned_faces(corners) || crosses_itself(outline(mesh, faces, corners)) ||
         shares_texels(corners);
}

/// Cuts faces in two across the longest extent of their centres.
std::array<std::vector<int>, 2> halves(const TriangleMesh& mesh, std::vector<int> faces) {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
  const auto centre = [&](int f) {
    return Vector3d(
        (mesh.position(mesh.F(f, 0)) + mesh.position(mesh.F(f, 1)) + mesh.position(mesh.F(f, 2))) /
        3);
  };
  for (const int f : faces) {
    low = low.cwiseMin(centre(f));
    high = high.cwiseMax(centre(f));
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::stable_sort(
      faces.begin(), faces.end(), [&](int a, int b) { return centre(a)[axis] < centre(b)[axis]; });
  const auto middle = faces.begin() + static_cast<std::ptrdiff_t>(faces.size() / 2);
  return {std::vector<int>(faces.begin(), middle), std::vector<int>(middle, faces.end())};
}

/// Lays faces flat without overlap, in as many charts as that takes.
void lay_out(const TriangleMesh& mesh, std::vector<int> faces, std::vector<FlatChart>& charts) {
  std::vector<Vector2d> corners = flatten_chart(mesh, faces);
  if (faces.size() > 1 && overlaps_itself(mesh, faces, corners)) {
    corners = chart_shadow(mesh, faces);
    if (overlaps_itself(mesh, faces, corners)) {
      for (std::vector<int>& part : halves(mesh, std::move(faces)))
        lay_out(mesh, std::move(part), charts);
      return;
    }
  }
  charts.push_back({std::move(faces), std::move(corners)});
}

/// Turns the chart to the smallest bounding box among those at whole degrees, higher than wide.
void upright(FlatChart& chart) {
  constexpr int kDegrees = 90;
  const auto turned = [&](int degrees) {
    return Eigen::Rotation2Dd(degrees * std::numbers::pi / 180).toRotationMatrix();
  };
  const auto box = [&](const Eigen::Matrix2d& turn, Vector2d& low) {
    low = turn * chart.corners.front();
    Vector2d high = low;
    for (const Vector2d& p : chart.corners) {
      low = low.cwiseMin(turn * p);
      high = high.cwiseMax(turn * p);
    }
    return Vector2d(high - low);
  };
  Vector2d low;
  double least = std::numeric_limits<double>::max();
  Eigen::Matrix2d best = Eigen::Matrix2d::Identity();
  for (int degrees = 0; degrees < kDegrees; degrees += 3) {
    const Eigen::Matrix2d turn = turned(degrees);
    if (const Vector2d extent = box(turn, low); extent.prod() < least) {
      least = extent.prod();
      best = turn;
    }
  }
  if (const Vector2d extent = box(best, low); extent[0] > extent[1]) best = turned(90) * best;
  chart.extent = box(best, low);
  for (Vector2d& p : chart.corners) p = best * p - low;
}

/// Cells of a square grid, a bit each, in rows of words.
class CellGrid {
 public:
  CellGrid(int width, int height)
      : width_(width), height_(height), words_(width / 64 + 2), bits_(idx(height * words_), 0) {}

  void set(int x, int y) { bits_[idx(y * words_ + x / 64)] |= std::uint64_t{1} << (x % 64); }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Whether `other`, moved by (x, y), meets a cell that is set here. Looks at row `first` of it
  /// first, and leaves there the row that meets one: the next place fails by the same row as a
  /// rule.
  [[nodiscard]] bool meets(const CellGrid& other, int x, int y, int& first) const {
    for (int i = 0, row = first; i < other.height_;
         ++i, row = row + 1 < other.height_ ? row + 1 : 0)
      for (int k = 0; k < other.words_ - 1; ++k)
        if ((other.bits_[idx(row * other.words_ + k)] & word(x + 64 * k, y + row)) != 0) {
          first = row;
          return true;
        }
    return false;
  }

  void add(const CellGrid& other, int x, int y) {
    for (int row = 0; row < other.height_; ++row)
      for (int column = 0; column < other.width_; ++column)
        if ((other.bits_[idx(row * other.words_ + column / 64)] >> (column % 64) & 1) != 0)
          set(x + column, y + row);
  }

 private:
  /// 64 cells of a row from column x on.
  [[nodiscard]] std::uint64_t word(int x, int y) const {
    const int first = x / 64, shift = x % 64;
    if (first >= words_) return 0;
    const std::uint64_t* row = &bits_[idx(y * words_)];
    const std::uint64_t high = shift > 0 && first + 1 < words_ ? row[first + 1] << (64 - shift) : 0;
    return row[first] >> shift | high;
  }

  int width_, height_, words_;
  std::vector<std::uint64_t> bits_;
};

/// The chart turned by `quarters` right angles, its bounding box at the origin.
FlatChart turned(FlatChart chart, int quarters) {
  for (int i = 0; i < quarters; ++i) {
    for (Vector2d& p : chart.corners) p = Vector2d(chart.extent[1] - p[1], p[0]);
    std::swap(chart.extent[0], chart.extent[1]);
  }
  return chart;
}

/// The cells that a chart touches, `padding` cells around it included.
CellGrid cells_of(const FlatChart& chart, double cells_per_unit, double padding) {
  const Vector2d extent = chart.extent * cells_per_unit + Vector2d::Constant(2 * padding);
  CellGrid grid(static_cast<int>(extent[0]) + 1, static_cast<int>(extent[1]) + 1);
  const auto place = [&](std::size_t c) {
    return Vector2d(chart.corners[c] * cells_per_unit + Vector2d::Constant(padding));
  };
  // The margin reaches from the centre of a cell to its corners.
  const double margin = padding + std::numbers::sqrt2 / 2;
  for (std::size_t c = 0; c < chart.corners.size(); c += 3)
    for_each_texel({place(c), place(c + 1), place(c + 2)},
                   margin,
                   {0, grid.height()},
                   grid.width(),
                   [&](int x, int y, const Vector3d&) { grid.set(x, y); });
  return grid;
}

struct Place {
  int x = 0, y = 0, quarters = 0;
};

/// The lowest free place of a shape among those whose top ends below `limit`, leftmost there.
std::optional<Place> lowest(const CellGrid& taken, const CellGrid& shape, int side, int limit) {
  int first = 0;
  for (int y = 0; y + shape.height() <= std::min(side, limit); ++y)
    for (int x = 0; x + shape.width() <= side; ++x)
      if (!taken.meets(shape, x, y, first)) return Place{x, y};
  return std::nullopt;
}

/// Where each chart's lower left cell goes on a square of `side` cells, or nothing if they do not
/// fit: each where its top ends lowest, turned as serves that best.
std::optional<std::vector<Place>> pack(const std::vector<FlatChart>& charts,
                                       double cells_per_unit,
                                       double padding,
                                       int side) {
  CellGrid taken(side, side);
  std::vector<Place> places;
  for (const FlatChart& chart : charts) {
    std::optional<Place> best;
    CellGrid best_shape(0, 0);
    int limit = side;
    for (int quarters = 0; quarters < 4; ++quarters) {
      CellGrid shape = cells_of(turned(chart, quarters), cells_per_unit, padding);
      const std::optional<Place> place = lowest(taken, shape, side, limit);
      if (!place) continue;
      best = Place{place->x, place->y, quarters};
      limit = place->y + shape.height() - 1;
      best_shape = std::move(shape);
    }
    if (!best) return std::nullopt;
    taken.add(best_shape, best->x, best->y);
    places.push_back(*best);
  }
  return places;
}

}  // namespace

Result<Atlas> make_atlas(const TriangleMesh& mesh, const AtlasOptions& options) {
  const Charts parts = make_charts(mesh);
  std::vector<std::vector<int>> faces(idx(parts.count));
  for (int f = 0; f < mesh.face_count(); ++f) faces[idx(parts.of_face[idx(f)])].push_back(f);
  std::vector<std::vector<FlatChart>> laid_out(faces.size());
  tbb::parallel_for(size_t{0}, faces.size(), [&](size_t i) {
    lay_out(mesh, faces[i], laid_out[i]);
    for (FlatChart& chart : laid_out[i]) upright(chart);
  });
  std::vector<FlatChart> charts;
  for (std::vector<FlatChart>& some : laid_out)
    std::move(some.begin(), some.end(), std::back_inserter(charts));
  std::stable_sort(charts.begin(), charts.end(), [](const FlatChart& a, const FlatChart& b) {
    return a.extent.prod() > b.extent.prod();
  });

  const int side = std::min(options.size, 512);
  const double padding = static_cast<double>(options.padding()) * side / options.size;
  double area = 0;
  for (const FlatChart& chart : charts)
    for (size_t c = 0; c < chart.corners.size(); c += 3)
      area += doubled_area(chart.corners[c], chart.corners[c + 1], chart.corners[c + 2]) / 2;
  // At this scale charts would cover four fifths of the square, which outlines and gaps forbid.
  double low = 0, high = 0.9 * side / std::sqrt(area);
  std::vector<Place> places;
  constexpr int kBisections = 7;
  for (int i = 0; i < kBisections || (places.empty() && i < 3 * kBisections); ++i) {
    const double scale = (low + high) / 2;
    auto found = pack(charts, scale, padding, side);
    if (found) places = std::move(*found);
    (found ? low : high) = scale;
  }
  if (places.empty())
    return fail(ErrorCode::kNumerical,
                fmt::format("atlas: {} charts do not fit {} x {} texels",
                            charts.size(),
                            options.size,
                            options.size));
  Atlas atlas;
  atlas.charts = static_cast<int>(charts.size());
  atlas.used = area * low * low / (static_cast<double>(side) * side);
  atlas.unwrap.uv.resize(idx(mesh.halfedge_count()));
  for (size_t i = 0; i < charts.size(); ++i) {
    const FlatChart chart = turned(std::move(charts[i]), places[i].quarters);
    for (size_t c = 0; c < chart.corners.size(); ++c) {
      const Vector2d cell =
          chart.corners[c] * low + Vector2d::Constant(padding) + Vector2d(places[i].x, places[i].y);
      const int corner = 3 * chart.faces[c / 3] + static_cast<int>(c % 3);
      // Rows count downwards: turned over, a chart would show its inside.
      atlas.unwrap.uv[idx(corner)] = {cell[0] / side, 1 - cell[1] / side};
    }
  }
  return atlas;
}

}  // namespace crosspatch
