#include "param/cap_regions.hpp"

#include <algorithm>
#include <limits>
#include <queue>

#include "core/assignment.hpp"
#include "core/index.hpp"

namespace crosspatch {
namespace {

using std::size_t;

constexpr double kFar = std::numeric_limits<double>::infinity();

std::vector<int> cap_of_face(const CappedSurface& surface) {
  std::vector<int> cap(idx(surface.filled.mesh.face_count()), -1);
  for (size_t i = 0; i < surface.caps.size(); ++i)
    for (const int f : surface.caps[i].faces) cap[idx(f)] = static_cast<int>(i);
  return cap;
}

/// The two caps of each handle; empty if some handle does not have two.
std::vector<std::array<int, 2>> banks(const CappedSurface& surface) {
  std::vector<std::vector<int>> found(surface.cut.loops.size());
  for (size_t i = 0; i < surface.caps.size(); ++i)
    if (surface.caps[i].handle >= 0)
      found[idx(surface.caps[i].handle)].push_back(static_cast<int>(i));
  std::vector<std::array<int, 2>> pairs;
  for (const std::vector<int>& caps : found) {
    if (caps.size() != 2) return {};
    pairs.push_back({caps[0], caps[1]});
  }
  return pairs;
}

/// The polygons of a map with their neighbours.
struct Cells {
  const SurfaceMap& map;
  std::vector<int> neighbour;  ///< per corner: the polygon across the side that begins there
  std::vector<std::vector<int>> at_point;  ///< per point: its polygons
  MatrixX3d middle;                        ///< on the source, in space

  [[nodiscard]] int count() const { return map.polygon_count(); }
  [[nodiscard]] int begin(int p) const { return map.polygon_begin[idx(p)]; }
  [[nodiscard]] int end(int p) const { return map.polygon_begin[idx(p) + 1]; }
};

Cells make_cells(const SurfaceMap& map, const TriangleMesh& source) {
  Cells cells{
      map, std::vector<int>(map.corner.size(), -1), {}, MatrixX3d::Zero(map.polygon_count(), 3)};
  cells.at_point.resize(map.source.size());
  std::vector<std::pair<std::pair<int, int>, int>> sides;  // by lower point: corner
  std::vector<int> polygon(map.corner.size());
  for (int p = 0; p < cells.count(); ++p)
    for (int i = cells.begin(p); i < cells.end(p); ++i) {
      const int q = map.corner[idx(i)];
      const int r = map.corner[idx(i + 1 < cells.end(p) ? i + 1 : cells.begin(p))];
      polygon[idx(i)] = p;
      sides.push_back({std::minmax(q, r), i});
      cells.at_point[idx(q)].push_back(p);
      cells.middle.row(p) += position(source, map.source[idx(q)]).transpose() /
                             static_cast<double>(cells.end(p) - cells.begin(p));
    }
  std::sort(sides.begin(), sides.end());
  for (size_t k = 0; k + 1 < sides.size(); ++k)
    if (sides[k].first == sides[k + 1].first) {
      cells.neighbour[idx(sides[k].second)] = polygon[idx(sides[k + 1].second)];
      cells.neighbour[idx(sides[k + 1].second)] = polygon[idx(sides[k].second)];
    }
  return cells;
}

struct Flood {
  std::vector<double> distance;
  std::vector<int> before;
};

/// Shortest ways from middle to middle of cells that are `open` (of a cell).
template <class Open>
Flood spread(const Cells& cells, const std::vector<int>& from, Open open, double most = kFar) {
  Flood flood{std::vector<double>(idx(cells.count()), kFar),
              std::vector<int>(idx(cells.count()), -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const int p : from) {
    flood.distance[idx(p)] = 0;
    queue.emplace(0, p);
  }
  while (!queue.empty()) {
    const auto [d, p] = queue.top();
    queue.pop();
    if (d > flood.distance[idx(p)] || d > most) continue;
    for (int i = cells.begin(p); i < cells.end(p); ++i) {
      const int g = cells.neighbour[idx(i)];
      if (!open(g)) continue;
      const double there = d + (cells.middle.row(p) - cells.middle.row(g)).norm();
      if (there >= flood.distance[idx(g)]) continue;
      flood.distance[idx(g)] = there;
      flood.before[idx(g)] = p;
      queue.emplace(there, g);
    }
  }
  return flood;
}

/// Distance of cap i of the source from cap j of the target: the mean over the polygons on j. Banks
/// of a cut lie in one place in space, so that ways are measured on the cut surface.
Eigen::MatrixXd cap_distances(const Cells& cells,
                              const CappedSurface& source,
                              const CappedSurface& target) {
  const std::vector<int> source_cap = cap_of_face(source), target_cap = cap_of_face(target);
  std::vector<std::vector<int>> on_source(source.caps.size()), on_target(target.caps.size());
  for (int p = 0; p < cells.count(); ++p) {
    if (const int i = source_cap[idx(cells.map.source_face[idx(p)])]; i >= 0)
      on_source[idx(i)].push_back(p);
    if (const int j = target_cap[idx(cells.map.target_face[idx(p)])]; j >= 0)
      on_target[idx(j)].push_back(p);
  }
  Eigen::MatrixXd distance = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(source.caps.size()),
                                                   static_cast<Eigen::Index>(target.caps.size()));
  for (Eigen::Index i = 0; i < distance.rows(); ++i) {
    const Flood flood = spread(cells, on_source[idx(i)], [](int) { return true; });
    for (Eigen::Index j = 0; j < distance.cols(); ++j)
      for (const int p : on_target[idx(j)])
        distance(i, j) += flood.distance[idx(p)] / static_cast<double>(on_target[idx(j)].size());
  }
  return distance;
}

/// Grows the regions of all caps side by side.
class Grower {
 private:
  static constexpr int kFree = -1, kBlocked = -2;

  [[nodiscard]] auto open_to(int region) const {
    return [this, region](int p) { return owner_[idx(p)] == kFree || owner_[idx(p)] == region; };
  }

 public:
  Grower(const Cells& cells, const std::vector<int>& blocked_points)
      : cells_(cells), owner_(idx(cells.count()), kFree) {
    for (const int q : blocked_points)
      for (const int p : cells.at_point[idx(q)]) owner_[idx(p)] = kBlocked;
  }

  /// Gives a cell to a region; false if it is not to be had.
  bool claim(int cell, int region) {
    int& owner = owner_[idx(cell)];
    if (owner != kFree && owner != region) return false;
    owner = region;
    return true;
  }

  [[nodiscard]] std::vector<int> cells_of(int region) const {
    std::vector<int> list;
    for (int p = 0; p < cells_.count(); ++p)
      if (owner_[idx(p)] == region) list.push_back(p);
    return list;
  }

  void give_up(int region) { std::replace(owner_.begin(), owner_.end(), region, int{kFree}); }

  /// Joins the parts of a region by shortest ways over free cells. False if one is cut off.
  bool connect(int region) {
    const std::vector<int> all = cells_of(region);
    while (true) {
      std::vector<bool> part(owner_.size(), false);
      std::vector<int> stack{all.front()};
      part[idx(all.front())] = true;
      while (!stack.empty()) {
        const int p = stack.back();
        stack.pop_back();
        for (int i = cells_.begin(p); i < cells_.end(p); ++i) {
          const int g = cells_.neighbour[idx(i)];
          if (owner_[idx(g)] != region || part[idx(g)]) continue;
          part[idx(g)] = true;
          stack.push_back(g);
        }
      }
      std::vector<int> reached, cut_off;
      for (const int p : cells_of(region)) (part[idx(p)] ? reached : cut_off).push_back(p);
      if (cut_off.empty()) return true;
      const Flood flood = spread(cells_, reached, open_to(region));
      const int nearest = *std::min_element(cut_off.begin(), cut_off.end(), [&](int p, int q) {
        return flood.distance[idx(p)] < flood.distance[idx(q)];
      });
      if (flood.distance[idx(nearest)] == kFar) return false;
      for (int p = nearest; p >= 0; p = flood.before[idx(p)]) owner_[idx(p)] = region;
    }
  }

  void widen(int region, double width) {
    const Flood flood = spread(cells_, cells_of(region), open_to(region), width);
    for (int p = 0; p < cells_.count(); ++p)
      if (owner_[idx(p)] == kFree && flood.distance[idx(p)] <= width) owner_[idx(p)] = region;
  }

  /// Makes a region a disc by adding what it encloses or pinches. False if that is not free.
  bool make_disc(int region) {
    while (true) {
      if (!fill_enclosed(region)) return false;
      // Where the boundary comes twice by a point, the region is pinched there.
      std::vector<int> ends(cells_.at_point.size(), 0);
      for (const int p : cells_of(region))
        for (int i = cells_.begin(p); i < cells_.end(p); ++i)
          if (owner_[idx(cells_.neighbour[idx(i)])] != region)
            ++ends[idx(cells_.map.corner[idx(i)])];
      bool pinched = false;
      for (size_t q = 0; q < ends.size(); ++q) {
        if (ends[q] < 2) continue;
        pinched = true;
        for (const int p : cells_.at_point[q])
          if (!claim(p, region)) return false;
      }
      if (!pinched) return true;
    }
  }

 private:
  /// Everything but the largest part of what a region leaves over becomes the region's.
  bool fill_enclosed(int region) {
    std::vector<int> part(owner_.size(), -1);
    std::vector<int> sizes;
    for (int start = 0; start < cells_.count(); ++start) {
      if (owner_[idx(start)] == region || part[idx(start)] >= 0) continue;
      const int number = static_cast<int>(sizes.size());
      std::vector<int> stack{start};
      part[idx(start)] = number;
      sizes.push_back(0);
      while (!stack.empty()) {
        const int p = stack.back();
        stack.pop_back();
        ++sizes.back();
        for (int i = cells_.begin(p); i < cells_.end(p); ++i) {
          const int g = cells_.neighbour[idx(i)];
          if (owner_[idx(g)] == region || part[idx(g)] >= 0) continue;
          part[idx(g)] = number;
          stack.push_back(g);
        }
      }
    }
    if (sizes.empty()) return false;
    const int outside =
        static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    for (int p = 0; p < cells_.count(); ++p)
      if (part[idx(p)] >= 0 && part[idx(p)] != outside && !claim(p, region)) return false;
    return true;
  }

  const Cells& cells_;
  std::vector<int> owner_;
};

/// Polygons on or touching a cap of the source or its partner: per cap of the source.
std::vector<std::vector<int>> seeds(const Cells& cells,
                                    const CappedSurface& source,
                                    const CappedSurface& target,
                                    const std::vector<int>& partner) {
  std::vector<int> source_cap_of(target.caps.size(), -1);
  for (size_t i = 0; i < partner.size(); ++i)
    if (partner[i] >= 0) source_cap_of[idx(partner[i])] = static_cast<int>(i);
  const std::vector<int> source_cap = cap_of_face(source), target_cap = cap_of_face(target);
  std::vector<std::vector<int>> list(source.caps.size());
  const auto add_around = [&](int p, int region) {
    for (int i = cells.begin(p); i < cells.end(p); ++i)
      for (const int q : cells.at_point[idx(cells.map.corner[idx(i)])])
        list[idx(region)].push_back(q);
  };
  for (int p = 0; p < cells.count(); ++p) {
    if (const int i = source_cap[idx(cells.map.source_face[idx(p)])]; i >= 0) add_around(p, i);
    const int j = target_cap[idx(cells.map.target_face[idx(p)])];
    if (j >= 0 && source_cap_of[idx(j)] >= 0) add_around(p, source_cap_of[idx(j)]);
  }
  for (std::vector<int>& polygons : list) {
    std::sort(polygons.begin(), polygons.end());
    polygons.erase(std::unique(polygons.begin(), polygons.end()), polygons.end());
  }
  return list;
}

double rim_length(const CappedSurface& surface, const Cap& cap) {
  double length = 0;
  for (size_t i = 0; i < cap.rim.size(); ++i)
    length += (surface.cut.mesh.position(cap.rim[i]) -
               surface.cut.mesh.position(cap.rim[(i + 1) % cap.rim.size()]))
                  .norm();
  return length;
}

}  // namespace

std::vector<int> match_caps(const SurfaceMap& closed,
                            const CappedSurface& source,
                            const CappedSurface& target) {
  std::vector<int> partner(source.caps.size(), -1);
  const auto a = banks(source), b = banks(target);
  const bool handles_agree = source.cut.loops.size() == target.cut.loops.size() &&
                             a.size() == source.cut.loops.size() && b.size() == a.size();
  const auto holes = [](const CappedSurface& surface) {
    std::vector<int> list;
    for (size_t i = 0; i < surface.caps.size(); ++i)
      if (surface.caps[i].handle < 0) list.push_back(static_cast<int>(i));
    return list;
  };
  const std::vector<int> from = holes(source), to = holes(target);
  const bool join_handles = handles_agree && !a.empty();
  const bool join_holes = from.size() == to.size() && !from.empty();
  if (!join_handles && !join_holes) return partner;
  const Eigen::MatrixXd distance =
      cap_distances(make_cells(closed, source.filled.mesh), source, target);
  if (join_handles) {
    const auto n = static_cast<Eigen::Index>(a.size());
    Eigen::MatrixXd cost(n, n);
    const auto way = [&](size_t i, size_t j, bool crossed) {
      return distance(a[i][0], b[j][crossed ? 1 : 0]) + distance(a[i][1], b[j][crossed ? 0 : 1]);
    };
    for (size_t i = 0; i < a.size(); ++i)
      for (size_t j = 0; j < b.size(); ++j)
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            std::min(way(i, j, false), way(i, j, true));
    const std::vector<int> assigned = least_cost_assignment(cost);
    for (size_t i = 0; i < a.size(); ++i) {
      const size_t j = idx(assigned[i]);
      const bool crossed = way(i, j, true) < way(i, j, false);
      partner[idx(a[i][0])] = b[j][crossed ? 1 : 0];
      partner[idx(a[i][1])] = b[j][crossed ? 0 : 1];
    }
  }
  if (join_holes) {
    const auto n = static_cast<Eigen::Index>(from.size());
    Eigen::MatrixXd cost(n, n);
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
      for (Eigen::Index j = 0; j < cost.cols(); ++j)
        cost(i, j) = distance(from[idx(i)], to[idx(j)]);
    const std::vector<int> assigned = least_cost_assignment(cost);
    for (size_t i = 0; i < from.size(); ++i) partner[idx(from[i])] = to[idx(assigned[i])];
  }
  return partner;
}

std::vector<std::vector<int>> cap_regions(const SurfaceMap& closed,
                                          const CappedSurface& source,
                                          const CappedSurface& target,
                                          const std::vector<int>& partner,
                                          const std::vector<int>& kept,
                                          double width) {
  const Cells cells = make_cells(closed, source.filled.mesh);
  const auto list = seeds(cells, source, target, partner);
  std::vector<int> blocked;
  for (const int v : kept) blocked.push_back(closed.point_of_source_vertex[idx(v)]);
  Grower grower(cells, blocked);
  std::vector<bool> lost(source.caps.size(), false);
  for (size_t i = 0; i < list.size(); ++i)
    for (const int p : list[i])
      if (!grower.claim(p, static_cast<int>(i))) lost[i] = true;
  const auto for_each_left = [&](auto grow) {
    for (size_t i = 0; i < list.size(); ++i) {
      if (!lost[i]) lost[i] = !grow(i, static_cast<int>(i));
      if (lost[i]) grower.give_up(static_cast<int>(i));
    }
  };
  for_each_left([&](size_t i, int region) { return partner[i] >= 0 && grower.connect(region); });
  for_each_left([&](size_t i, int region) {
    grower.widen(region, width * rim_length(source, source.caps[i]));
    return grower.make_disc(region);
  });
  std::vector<std::vector<int>> regions;
  for (size_t i = 0; i < list.size(); ++i)
    regions.push_back(lost[i] ? std::vector<int>{} : grower.cells_of(static_cast<int>(i)));
  return regions;
}

}  // namespace crosspatch
