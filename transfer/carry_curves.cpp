#include "transfer/carry_curves.hpp"

#include <algorithm>

#include "core/index.hpp"
#include "param/map_pieces.hpp"
#include "param/surface_path.hpp"

namespace crosspatch {
namespace {

bool share_a_face(const TriangleMesh& mesh, const SurfacePoint& p, const SurfacePoint& q) {
  const std::vector<int> a = faces_at(mesh, p), b = faces_at(mesh, q);
  return std::any_of(
      a.begin(), a.end(), [&](int f) { return std::find(b.begin(), b.end(), f) != b.end(); });
}

/// Draws the image of one curve.
class Pen {
 public:
  Pen(const SurfaceCurve& curve, const TriangleMesh& target) : curve_(curve), target_(target) {}

  void draw(const ImageChord& chord) {
    if (!down_) parts_.emplace_back();
    std::vector<SurfacePoint>& part = parts_.back();
    if (!down_ || !share_a_face(target_, part.back(), chord.to)) part.push_back(chord.from);
    part.push_back(chord.to);
    down_ = true;
  }

  /// Nothing is mapped here.
  void lift() {
    // Gaps that follow each other are one.
    if (down_ || (parts_.empty() && gaps_ == 0)) ++gaps_;
    began_with_gap_ = began_with_gap_ || parts_.empty();
    down_ = false;
  }

  /// Hands the curve's image over and says how many gaps it has.
  int finish(std::vector<SurfaceCurve>& curves) {
    if (parts_.empty() && gaps_ == 0) gaps_ = 1;  // all its points are the same
    const bool whole = curve_.closed && gaps_ == 0;
    if (curve_.closed && !whole && down_ && parts_.size() > 1 && !began_with_gap_) join_ends();
    for (std::vector<SurfacePoint>& part : parts_) {
      if (whole) part.pop_back();
      curves.push_back({curve_.name, whole, std::move(part)});
    }
    return gaps_;
  }

 private:
  /// The last part of a closed curve runs on into the first.
  void join_ends() {
    std::vector<SurfacePoint> last = std::move(parts_.back());
    parts_.pop_back();
    last.insert(last.end(), parts_.front().begin() + 1, parts_.front().end());
    parts_.front() = std::move(last);
  }

  const SurfaceCurve& curve_;
  const TriangleMesh& target_;
  std::vector<std::vector<SurfacePoint>> parts_;
  bool down_ = false;
  bool began_with_gap_ = false;
  int gaps_ = 0;
};

}  // namespace

CarriedDrawing carry_drawing(const Drawing& drawing,
                             const TriangleMesh& source,
                             const TriangleMesh& target,
                             const SurfaceMap& map) {
  // Of a segment: what rounding leaves open between chords.
  constexpr double kOpen = 1e-6;
  const MapPieces pieces(map, source, target);
  SurfacePaths paths(source);
  CarriedDrawing carried;
  for (const MarkedPoint& mark : drawing.landmarks) {
    carried.drawing.landmarks.push_back({mark.name, pieces.image(mark.point)});
    if (!carried.drawing.landmarks.back().point.valid()) ++carried.unmapped_landmarks;
  }
  for (const SurfaceCurve& curve : drawing.curves) {
    Pen pen(curve, target);
    const std::size_t n = curve.points.size();
    for (std::size_t i = 0; i + 1 < n + (curve.closed ? 1 : 0); ++i) {
      const SurfacePoint &from = curve.points[i], &to = curve.points[(i + 1) % n];
      if (!from.valid() || !to.valid()) {
        pen.lift();
        continue;
      }
      if (!share_a_face(source, from, to)) ++carried.paths;
      for (const FaceSegment& segment : paths.path(from, to)) {
        double reached = 0;
        for (const ImageChord& chord : pieces.image(segment.face, segment.from, segment.to)) {
          if (chord.begin - reached > kOpen) pen.lift();
          pen.draw(chord);
          reached = chord.end;
        }
        if (1 - reached > kOpen) pen.lift();
      }
    }
    carried.gaps += pen.finish(carried.drawing.curves);
  }
  return carried;
}

}  // namespace crosspatch
