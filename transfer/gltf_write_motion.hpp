#pragma once

#include <vector>

#include "transfer/textured_mesh.hpp"

namespace tinygltf {
class Model;
struct Primitive;
}  // namespace tinygltf

namespace crosspatch {

/// Adds joints, weights and displaced places to a primitive whose vertices are these rows of the
/// mesh's positions.
void write_moving_vertices(tinygltf::Model& model,
                           const Motion& motion,
                           const std::vector<int>& rows,
                           tinygltf::Primitive& primitive);

/// Adds what moves mesh 0 that node 0 shows: names and weights of morph targets, the skeleton as
/// further nodes below one that has the mesh's own transform (a skinned mesh ignores its node's),
/// and the animations. Returns the nodes that stand in the scene beside node 0.
std::vector<int> write_motion(tinygltf::Model& model, const TexturedMesh& mesh);

}  // namespace crosspatch
