#pragma once

#include <string>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch {

/// The parts a creature is painted and charted by.
enum class Part { kBody, kHead, kEar, kTail, kFrontLeg, kHindLeg };

/// A round cone: the ball of radius `radius_a` at `a` swept to the ball of radius `radius_b` at
/// `b`. It blends into its neighbours over the length `blend`.
struct Limb {
  Part part = Part::kBody;
  Vector3d a, b;
  double radius_a = 0;
  double radius_b = 0;
  double blend = 0.1;
};

/// A four-legged body. It stands on y = 0 and looks along +z; its left side is +x.
struct Creature {
  std::string name;
  std::vector<Limb> limbs;
  std::vector<Vector3d> eyes;
  double eye_radius = 0;
  Vector3d nose = Vector3d::Zero();
  double nose_radius = 0;
  Vector3d tail_tip = Vector3d::Zero();
  double sock_height = 0;  ///< up to where the feet are painted
};

/// "lira": slender, long-legged, with tall ears and a long raised tail.
Creature make_lira();
/// "bodo": stocky and short-legged, with a big drooping head and a stub of a tail.
Creature make_bodo();
/// "tola": tall, with an upright neck and a hanging tail.
Creature make_tola();

/// Approximate signed distance to the skin: negative inside, linear near the surface.
double skin_distance(const Creature& creature, const Vector3d& p);

/// The limb whose own surface is nearest to p.
int nearest_limb(const Creature& creature, const Vector3d& p);

/// The skin as a closed triangle mesh with edges of about `edge`: dual contouring of a grid (one
/// vertex a cell that the skin passes through), then smoothed within the surface. kInternal when
/// the skin is not one closed surface of genus 0, as with parts that touch.
Result<TriangleMesh> skin_mesh(const Creature& creature, double edge);

}  // namespace crosspatch
