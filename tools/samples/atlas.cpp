#include "tools/samples/atlas.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/index.hpp"

namespace crosspatch {
namespace {

Vector3d centroid(const TriangleMesh& mesh, int f) {
  return (mesh.position(mesh.F(f, 0)) + mesh.position(mesh.F(f, 1)) + mesh.position(mesh.F(f, 2))) /
         3;
}

Vector3d area_vector(const TriangleMesh& mesh, int f) {
  return (mesh.position(mesh.F(f, 1)) - mesh.position(mesh.F(f, 0)))
      .cross(mesh.position(mesh.F(f, 2)) - mesh.position(mesh.F(f, 0)));
}

/// A face between two or three neighbours of one label takes it: borders become smoother.
void smooth_labels(const TriangleMesh& mesh, std::vector<int>& label, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const std::vector<int> before = label;
    for (int f = 0; f < mesh.face_count(); ++f) {
      std::array<int, 3> n{};
      for (int k = 0; k < 3; ++k) n[idx(k)] = before[idx(face_of(mesh.twin[idx(3 * f + k)]))];
      if (n[0] == n[1] || n[0] == n[2]) label[idx(f)] = n[0];
      if (n[1] == n[2]) label[idx(f)] = n[1];
    }
  }
}

/// Numbers the connected pieces of equal label.
std::vector<int> pieces(const TriangleMesh& mesh, const std::vector<int>& label) {
  std::vector<int> piece(label.size(), -1);
  int count = 0;
  for (int seed = 0; seed < mesh.face_count(); ++seed) {
    if (piece[idx(seed)] >= 0) continue;
    std::vector<int> stack{seed};
    piece[idx(seed)] = count;
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const int g = face_of(mesh.twin[idx(3 * f + k)]);
        if (piece[idx(g)] >= 0 || label[idx(g)] != label[idx(f)]) continue;
        piece[idx(g)] = count;
        stack.push_back(g);
      }
    }
    ++count;
  }
  return piece;
}

/// Pieces below `least` faces join the neighbour they share most edges with.
std::vector<int> merge_small(const TriangleMesh& mesh, std::vector<int> piece, int least) {
  for (;;) {
    std::vector<int> size(idx(*std::max_element(piece.begin(), piece.end()) + 1), 0);
    for (const int p : piece) ++size[idx(p)];
    const auto smallest = std::min_element(size.begin(), size.end());
    if (*smallest >= least) return piece;
    const int small = static_cast<int>(smallest - size.begin());
    std::map<int, int> shared;
    for (int h = 0; h < mesh.halfedge_count(); ++h) {
      const int other = piece[idx(face_of(mesh.twin[idx(h)]))];
      if (piece[idx(face_of(h))] == small && other != small) ++shared[other];
    }
    const int into =
        std::max_element(shared.begin(), shared.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        })->first;
    std::replace(piece.begin(), piece.end(), small, into);
    piece = pieces(mesh, piece);
  }
}

std::vector<int> charts_of(const Creature& creature, const TriangleMesh& mesh) {
  std::vector<int> label;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Part part = creature.limbs[idx(nearest_limb(creature, centroid(mesh, f)))].part;
    label.push_back(2 * static_cast<int>(part) + (area_vector(mesh, f)[0] >= 0 ? 1 : 0));
  }
  smooth_labels(mesh, label, 6);
  return merge_small(mesh, pieces(mesh, label), 24);
}

struct Box {
  Vector2d low = Vector2d::Constant(1e9);
  Vector2d high = Vector2d::Constant(-1e9);
  Vector2d place = Vector2d::Zero();  ///< of the chart's low corner, pixels
};

/// Shelf packing, tallest first; false if the boxes do not fit.
bool pack(std::vector<Box>& boxes, const std::vector<int>& order, double scale, int size) {
  double x = kGutter, y = kGutter, shelf = 0;
  for (const int i : order) {
    const Vector2d extent = scale * (boxes[idx(i)].high - boxes[idx(i)].low);
    if (x + extent[0] + kGutter > size) {
      x = kGutter;
      y += shelf + 2 * kGutter;
      shelf = 0;
    }
    if (x + extent[0] + kGutter > size || y + extent[1] + kGutter > size) return false;
    boxes[idx(i)].place = Vector2d(x, y);
    x += extent[0] + 2 * kGutter;
    shelf = std::max(shelf, extent[1]);
  }
  return true;
}

}  // namespace

Atlas make_atlas(const Creature& creature, const TriangleMesh& mesh, int size) {
  Atlas atlas;
  atlas.size = size;
  atlas.chart = charts_of(creature, mesh);
  const auto count = idx(*std::max_element(atlas.chart.begin(), atlas.chart.end()) + 1);
  std::vector<Box> boxes(count);
  std::vector<double> side(count, 0.0);
  for (int f = 0; f < mesh.face_count(); ++f)
    side[idx(atlas.chart[idx(f)])] += area_vector(mesh, f)[0];
  // Seen from outside: z runs to the right on the right half (-x), to the left on the left half.
  const auto seen = [&](int h) {
    const Vector3d p = mesh.position(mesh.from(h));
    return Vector2d(side[idx(atlas.chart[idx(face_of(h))])] > 0 ? -p[2] : p[2], -p[1]);
  };
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    Box& box = boxes[idx(atlas.chart[idx(face_of(h))])];
    box.low = box.low.cwiseMin(seen(h));
    box.high = box.high.cwiseMax(seen(h));
  }
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return boxes[idx(a)].high[1] - boxes[idx(a)].low[1] >
           boxes[idx(b)].high[1] - boxes[idx(b)].low[1];
  });
  double scale = size;
  while (!pack(boxes, order, scale, size)) scale *= 0.98;
  atlas.pixel.resize(mesh.halfedge_count(), 2);
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const Box& box = boxes[idx(atlas.chart[idx(face_of(h))])];
    atlas.pixel.row(h) = (box.place + scale * (seen(h) - box.low)).transpose();
  }
  return atlas;
}

}  // namespace crosspatch
