// Arcs that merge run along one tree towards the extremum they share. A walk around the tree,
// counter-clockwise from its root, meets their saddles in an order; seen by a traveller towards the
// root, arcs of lower place in it run further left. This file turns places into sequences of
// crossed edges.
#include "param/arc_strands.hpp"

#include <algorithm>
#include <utility>

#include "core/index.hpp"

namespace crosspatch {
namespace {

using std::size_t;
using Kind = StrandStop::Kind;

class Strands {
 public:
  Strands(const QuadLayout& layout, const DiscreteGradient& gradient)
      : layout_(layout),
        gradient_(gradient),
        mesh_(gradient.surface),
        forests_(forests(gradient)),
        place_(idx(layout.arc_count()), -1),
        centre_(idx(mesh_.vertex_count()), -1) {
    number_places();
    choose_centres();
  }

  [[nodiscard]] std::vector<StrandStop> descend(int arc) const;
  [[nodiscard]] std::vector<StrandStop> ascend(int arc) const;

 private:
  [[nodiscard]] int twin(int h) const { return mesh_.twin[idx(h)]; }
  [[nodiscard]] int lower(int h) const { return std::min(h, twin(h)); }
  /// The half-edge of the saddle's edge whose start (even arcs) or face (odd arcs) the arc takes.
  [[nodiscard]] int first_halfedge(int arc) const {
    const int h = layout_.nodes[idx(arc / 4)].cell;
    return arc % 4 == 1 || arc % 4 == 2 ? h : twin(h);
  }
  void number_places();
  void choose_centres();

  /// A stop on the edge of h, `rank` places from the start of h on, within the zone beside it.
  [[nodiscard]] StrandStop beside_start(int h, int rank) const {
    return h < twin(h) ? StrandStop{Kind::kEdge, h, 0, rank}
                       : StrandStop{Kind::kEdge, twin(h), 2, -rank};
  }
  /// The same in the middle zone.
  [[nodiscard]] StrandStop in_middle(int h, int rank) const {
    return {Kind::kEdge, lower(h), 1, h < twin(h) ? rank : -rank};
  }
  void pass_vertex(int place, int in, int out, std::vector<StrandStop>& stops) const;
  void follow_edge(int place, int out, std::vector<StrandStop>& stops) const;

  const QuadLayout& layout_;
  const DiscreteGradient& gradient_;
  const TriangleMesh& mesh_;
  GradientForests forests_;
  std::vector<int> place_;  ///< per arc: its place in the walk around its extremum's tree
  std::vector<int>
      centre_;  ///< per vertex: place of the descending arc that goes through it, or -1
};

void Strands::number_places() {
  for (size_t n = idx(layout_.saddle_count()); n < layout_.nodes.size(); ++n) {
    int place = 0;
    for (int d = layout_.first_dart[n]; place_[idx(d / 2)] < 0; d = layout_.sigma[idx(d)])
      place_[idx(d / 2)] = place++;
  }
}

void Strands::choose_centres() {
  for (int arc = 0; arc < layout_.arc_count(); arc += 2) {
    int v = mesh_.from(first_halfedge(arc));
    while (forests_.down[idx(v)] >= 0 && centre_[idx(v)] < 0) {
      centre_[idx(v)] = place_[idx(arc)];
      v = mesh_.to(forests_.down[idx(v)]);
    }
  }
}

/// Leads the arc past the start of `in` and `out`, from the former to the latter.
void Strands::pass_vertex(int place, int in, int out, std::vector<StrandStop>& stops) const {
  const int v = mesh_.from(in), centre = centre_[idx(v)];
  if (place == centre) {
    stops.push_back({Kind::kVertex, v, 0, 0});
    return;
  }
  // Left of the centre the vertex lies on the right, and the spokes come clockwise.
  const bool left = place < centre;
  const auto turn = [&](int h) { return left ? next(twin(h)) : twin(prev(h)); };
  for (int h = turn(in); h != out; h = turn(h))
    stops.push_back(beside_start(h, std::abs(place - centre)));
}

/// Adds the crossing of `out` where the arc is on different sides of the edge's two ends.
void Strands::follow_edge(int place, int out, std::vector<StrandStop>& stops) const {
  const int own = centre_[idx(mesh_.from(out))], other = centre_[idx(mesh_.to(out))];
  if (forests_.down[idx(mesh_.to(out))] < 0 || own == other) return;
  // The edge leaves the centre of its start towards that of its end, over all arcs between.
  const bool crosses = other < own ? place < own : place > own;
  if (crosses) stops.push_back(in_middle(out, std::abs(place - own)));
}

std::vector<StrandStop> Strands::descend(int arc) const {
  int in = first_halfedge(arc);
  std::vector<StrandStop> stops{{Kind::kEdge, lower(in), 1, 0}};
  int v = mesh_.from(in);
  for (int out = forests_.down[idx(v)]; out >= 0; out = forests_.down[idx(v)]) {
    pass_vertex(place_[idx(arc)], in, out, stops);
    follow_edge(place_[idx(arc)], out, stops);
    in = twin(out);
    v = mesh_.to(out);
  }
  stops.push_back({Kind::kVertex, v, 0, 0});
  return stops;
}

std::vector<StrandStop> Strands::ascend(int arc) const {
  const int h = first_halfedge(arc);
  std::vector<StrandStop> stops{{Kind::kEdge, lower(h), 1, 0}};
  int f = face_of(h);
  for (int step = forests_.up[idx(f)]; step >= 0; step = forests_.up[idx(f)]) {
    // Seen from the parent face, places rise from the start of its half-edge to the end.
    stops.push_back(in_middle(twin(step), place_[idx(arc)]));
    f = face_of(twin(step));
  }
  stops.push_back({Kind::kFace, f, 0, 0});
  return stops;
}

/// Removes detours that leave a face and come back over the same edge, or over an edge of the
/// vertex where they end. Nested detours vanish together, so orders on edges stay as they are.
std::vector<StrandStop> tightened(const std::vector<StrandStop>& stops, const TriangleMesh& mesh) {
  const auto touches = [&](const StrandStop& edge, const StrandStop& vertex) {
    return edge.kind == Kind::kEdge && vertex.kind == Kind::kVertex &&
           (mesh.from(edge.cell) == vertex.cell || mesh.to(edge.cell) == vertex.cell);
  };
  std::vector<StrandStop> kept{stops.front()};  // the saddle, always
  for (size_t i = 1; i < stops.size(); ++i) {
    const StrandStop& stop = stops[i];
    while (kept.size() > 1 && touches(kept.back(), stop)) kept.pop_back();
    if (touches(stop, kept.back())) continue;
    if (kept.size() > 1 && stop.kind == Kind::kEdge && kept.back().kind == Kind::kEdge &&
        kept.back().cell == stop.cell)
      kept.pop_back();
    else
      kept.push_back(stop);
  }
  return kept;
}

}  // namespace

std::vector<std::vector<StrandStop>> arc_strands(const QuadLayout& layout,
                                                 const DiscreteGradient& gradient) {
  const Strands strands(layout, gradient);
  std::vector<std::vector<StrandStop>> result;
  for (int arc = 0; arc < layout.arc_count(); ++arc)
    result.push_back(
        tightened(arc % 2 == 0 ? strands.descend(arc) : strands.ascend(arc), gradient.surface));
  return result;
}

}  // namespace crosspatch
