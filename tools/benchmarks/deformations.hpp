#pragma once

#include <string>

#include "core/mesh.hpp"

namespace crosspatch {

/// Kinds of changes that keep the connectivity, so that vertex i goes to vertex i.
enum class Deformation {
  kBend,        ///< bent along its longer horizontal or upright axis, nearly isometric
  kAffine,      ///< stretched along one axis and sheared
  kLocalScale,  ///< one end swollen
  kNoise,       ///< every vertex moved along its normal
  kShotNoise,   ///< one vertex in a hundred moved far along its normal
};

constexpr Deformation kDeformations[] = {Deformation::kBend,
                                         Deformation::kAffine,
                                         Deformation::kLocalScale,
                                         Deformation::kNoise,
                                         Deformation::kShotNoise};

std::string name(Deformation deformation);

/// The mesh deformed with a strength from 0 (unchanged) to 5. A strength of 5 bends by two thirds
/// of a turn, stretches to twice the length, swells to twice the width, moves vertices by half a
/// mean edge (standard deviation), or one in a hundred by two and a half. The same on every run.
TriangleMesh deform(TriangleMesh mesh, Deformation deformation, double strength);

/// A sequence that departs from the mesh evenly, `step` from 0 to 1, in shape as well as in pose:
/// bent, stretched and swollen at once.
TriangleMesh morph(TriangleMesh mesh, double step);

}  // namespace crosspatch
