#pragma once

#include <array>
#include <optional>
#include <vector>

#include "param/initial_map.hpp"
#include "param/sphere_optimizer.hpp"
#include "param/surface_map.hpp"

namespace crosspatch {

struct MapOptions {
  int coarse_iterations = 60;  ///< most steps per stage of the optimisation on the coarse level
  int fine_iterations = 40;    ///< the same on the full mesh
  /// Weight of the agreement of curvatures: see SphereProblem::field_weight. 0.3 to 1 do about
  /// equally well; without it maps of isometric bodies slide along and around limbs (mean error 3.8
  /// from 2.5 and 1.7 from 1.2 on two FAUST pairs, 3.8 from 2.1 on a SMAL pair).
  double field_weight = 0.6;
};

/// A point of a mesh by the vertices of its triangle.
struct PlaceOnMesh {
  std::array<int, 3> vertex;
  Vector3d bary;
};

/// The source's triangulation on the target's sphere, from the coarse level to the full mesh. The
/// stages are called in the order of their declaration.
class SphereMap {
 public:
  /// All arguments must outlive the map. Pinned landmarks stay exact; the others only decide the
  /// homotopy class and are released on the coarse level.
  SphereMap(const Shape& source,
            const Shape& target,
            const std::vector<Landmark>& landmarks,
            const MapOptions& options);
  SphereMap(const SphereMap&) = delete;
  SphereMap& operator=(const SphereMap&) = delete;

  /// The coarse level by way of the discs, unfolded. kNoCorrespondence where it stays turned over.
  Status start(const InitialMap& initial);
  /// A few steps on the coarse level, landmarks held. Returns its energy: mean distortion of both
  /// ways (isometry: 4) plus the weighted disagreement of curvatures.
  double optimize_roughly();
  /// Optimises the coarse level, lets go of the landmarks that are not pinned and optimises it
  /// again. That tells what the map costs; refine() goes on from where all landmarks were held.
  double optimize_coarse();
  /// Area-weighted mean logarithm of the distortion of the coarse map, of both directions: the
  /// inverse is looked at at the target's coarse vertices, because a protrusion that one face
  /// swallows is not seen from its corners.
  [[nodiscard]] double coarse_distortion() const;
  /// How well the chirality fields of both surfaces agree through the coarse map: their correlation
  /// over the coarse vertices, the mean over the fields, in [-1, 1]; 0 without fields.
  [[nodiscard]] double coarse_chirality() const;
  /// Images of source vertices under the coarse map, as places on the full target. Vertices that
  /// the level lacks go with the face that they lie in on the source's own embedding.
  [[nodiscard]] std::vector<PlaceOnMesh> coarse_images(const std::vector<int>& vertices) const;
  /// What the coarse map takes to vertices of the target: places in faces of the source's level.
  [[nodiscard]] std::vector<PlaceOnMesh> coarse_preimages(const std::vector<int>& vertices) const;
  /// Mean distance on the surface, measured straight through space, between the images of the
  /// coarse vertices under this coarse map and another one of the same two surfaces.
  [[nodiscard]] double coarse_distance(const SphereMap& other) const;
  /// Goes to the full mesh and optimises it, all landmarks held: a limb that is let go too early
  /// may slip off its counterpart, whose end one face swallows unseen (on a cow and a donkey 1 % of
  /// the area then has energies above 14000, from 300). Errors of start and refine_on_sphere.
  Status refine();
  /// Lets go of the landmarks that are not pinned and lets the target's vertices move under the
  /// same energy of the inverse map, and then the source's again: each side only sees what happens
  /// at its own vertices. Triangulations of one surface, whose vertices are those of the other or
  /// lie on it, come out as exact isometries.
  void settle();
  /// The common subdivision. Vertices of the source that all but meet one of the target are made to
  /// meet it, since no file in single precision holds what lies between; vertices in special
  /// position are moved by a billionth of their edges.
  Result<SurfaceMap> overlay();

 private:
  /// Puts the full mesh's vertices where they lie in the level's faces in the source's own
  /// embedding, and untangles what turns over by that.
  Status spread_out();
  /// Splits the vertices that are collapsed back, see RefineOptions::growth.
  Status split_back(double growth);
  /// Turns faces back, and where that does not help collapses vertices of the level.
  Status untangle(const SphereProblem& problem);
  /// Whether there may be an isometry, but for the pull of the barrier and of curvatures that
  /// differ between two triangulations of one surface.
  bool is_nearly_isometric();
  /// See overlay().
  void join_close_vertices();
  /// Lets go of the landmarks that only decided the homotopy class. True if there were any.
  bool release();
  double descend(int iterations);
  double descend(const SphereOptimizerOptions& options, double field_weight);
  /// A face that lies where the target is packed densely on the sphere may be as small as that.
  void hold_against_target(SphereProblem& problem);

  const Shape& source_;
  const Shape& target_;
  const MapOptions& options_;
  std::vector<Landmark> landmarks_;
  Refinement level_;
  MatrixX3d Y_;  ///< the target's embedding
  MeshLift lift_;
  MatrixX3d X_;  ///< places of the source's vertices
  std::vector<int> hint_;
  std::vector<int> pinned_;  ///< source vertices that may not move
  /// The coarse level when all landmarks were held for the last time.
  struct Held {
    Refinement level;
    MatrixX3d X;
    std::vector<int> pinned;
  };
  std::optional<Held> held_;
};

}  // namespace crosspatch
