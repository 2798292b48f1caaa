#pragma once

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "gltf_files.hpp"
#include "transfer/motion.hpp"

// Meshes with a hip and a knee, and what they do.
namespace crosspatch::rig {

using Frame = Eigen::Matrix4d;

inline Frame frame(const Vector3d& place, double angle, const Vector3d& axis) {
  return (Eigen::Translation3d(place) * Eigen::AngleAxisd(angle, axis.normalized())).matrix();
}

inline std::vector<double> numbers(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

/// Bind frames in the coordinates of the mesh.
struct Bones {
  Frame hip = frame({0.2, 0.5, 0}, 0.7, {1, 2, 3});
  Frame knee = frame({0.6, 0.5, 0}, -0.4, {0, 1, 1});
};

/// Frames to a joint's parent as a node's properties.
inline nlohmann::json node(const std::string& name, const Frame& local) {
  const Placement p = placement(local);
  return {{"name", name},
          {"translation", {p.translation[0], p.translation[1], p.translation[2]}},
          {"rotation", numbers(p.rotation)}};
}

/// A file whose mesh follows the hip with weight 1 - x and the knee with x (clamped to [0, 1]),
/// with one animation of each kind of track and two morph targets. Node 0 shows the mesh, 1 stands
/// above the hip, 2 is the hip, 3 the knee.
inline files::Gltf file(const MatrixX3d& V, const MatrixX3i& F) {
  using namespace files;
  const Bones bones;
  Gltf g = gltf(V, F);
  const std::size_t count = static_cast<std::size_t>(V.rows());
  std::string joints, weights, puffed, bent, normals;
  for (int v = 0; v < V.rows(); ++v) {
    const double x = std::clamp(V(v, 0), 0.0, 1.0);
    joints += std::string("\0\1\0\0", 4);
    weights += floats({1 - x, x, 0, 0});
    puffed += floats({0, 0, 0.1 * V(v, 0)});
    bent += floats({0, 0.2 * V(v, 0) * V(v, 0), 0});
    normals += floats({0.1, 0, 0});
  }
  auto& primitive = g.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["JOINTS_0"] = g.add_accessor(joints, kUnsignedByte, "VEC4", count);
  primitive["attributes"]["WEIGHTS_0"] = g.add_accessor(weights, kFloat, "VEC4", count);
  primitive["targets"] = {{{"POSITION", g.add_accessor(puffed, kFloat, "VEC3", count)}},
                          {{"POSITION", g.add_accessor(bent, kFloat, "VEC3", count)},
                           {"NORMAL", g.add_accessor(normals, kFloat, "VEC3", count)}}};
  g.json["meshes"][0]["weights"] = {0.25, 0};
  g.json["meshes"][0]["extras"] = {{"targetNames", {"puffed", "bent"}}};
  std::string inverse;
  for (const Frame& bind : {bones.hip, bones.knee}) {
    const Frame back = bind.inverse();
    inverse += floats({back.data(), back.data() + 16});
  }
  g.json["skins"] = {
      {{"joints", {2, 3}}, {"inverseBindMatrices", g.add_accessor(inverse, kFloat, "MAT4", 2)}}};
  const Frame above = frame({0, 1, 0}, 0.3, {1, 0, 0});
  g.json["nodes"] = {{{"mesh", 0}, {"skin", 0}},
                     node("above", above),
                     node("hip", above.inverse() * bones.hip),
                     node("knee", bones.hip.inverse() * bones.knee)};
  g.json["nodes"][1]["children"] = {2};
  g.json["nodes"][2]["children"] = {3};
  g.json["scenes"][0]["nodes"] = {0, 1};

  const Placement knee = placement(bones.hip.inverse() * bones.knee);
  const auto turned = [&](double angle) {
    return numbers(knee.rotation * Eigen::AngleAxisd(angle, Vector3d::UnitX()));
  };
  std::vector<double> turns = turned(0.0), second = turned(0.8);
  turns.insert(turns.end(), second.begin(), second.end());
  const Vector3d hip = placement(above.inverse() * bones.hip).translation;
  const int times = g.add_accessor(floats({0, 1}), kFloat, "SCALAR", 2);
  g.json["accessors"][static_cast<std::size_t>(times)]["min"] = {0};
  g.json["accessors"][static_cast<std::size_t>(times)]["max"] = {1};
  const int rotation = g.add_accessor(floats(turns), kFloat, "VEC4", 2);
  const int move = g.add_accessor(
      floats({hip[0], hip[1], hip[2], hip[0] + 0.1, hip[1], hip[2] - 0.2}), kFloat, "VEC3", 2);
  const int grow = g.add_accessor(
      floats({0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 1.5, 1.5, 1.5, 0, 0, 0}), kFloat, "VEC3", 6);
  const int blend = g.add_accessor(floats({0, 0, 1, 0.5}), kFloat, "SCALAR", 4);
  const auto channel = [](int sampler, int node, const char* path) {
    return nlohmann::json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
  };
  g.json["animations"] = {{{"name", "kick"},
                           {"samplers",
                            {{{"input", times}, {"output", rotation}},
                             {{"input", times}, {"output", move}, {"interpolation", "STEP"}},
                             {{"input", times}, {"output", grow}, {"interpolation", "CUBICSPLINE"}},
                             {{"input", times}, {"output", blend}}}},
                           {"channels",
                            {channel(0, 3, "rotation"),
                             channel(1, 2, "translation"),
                             channel(2, 3, "scale"),
                             channel(3, 0, "weights")}}}};
  return g;
}

/// What the joints' frames do from the bind pose to key `key` of an animation: M_j per joint, in
/// the coordinates of the mesh.
inline std::vector<Frame> pose(const Motion& motion, const Animation& animation, std::size_t key) {
  const Skin& skin = *motion.skin;
  std::vector<Frame> world;
  for (std::size_t n = 0; n < skin.nodes.size(); ++n) {
    const SkeletonNode& node = skin.nodes[n];
    Placement p = placement(node.local);
    for (const Track& track : animation.tracks) {
      if (track.node != static_cast<int>(n)) continue;
      const int groups = groups_of_key(track);
      const std::size_t at = std::min(key, track.times.size() - 1);
      const double* v = &track.values[static_cast<std::size_t>(track.width * groups) * at +
                                      static_cast<std::size_t>(track.width * (groups / 2))];
      if (track.path == TrackPath::kRotation)
        p.rotation = Eigen::Quaterniond(v[3], v[0], v[1], v[2]);
      if (track.path == TrackPath::kTranslation) p.translation = Vector3d(v);
      if (track.path == TrackPath::kScale) p.scale = Vector3d(v);
    }
    Eigen::Affine3d local =
        Eigen::Translation3d(p.translation) * p.rotation * Eigen::Scaling(p.scale);
    const Frame outer = node.parent < 0 ? Frame(node.bind * node.local.inverse())
                                        : world[static_cast<std::size_t>(node.parent)];
    world.push_back(outer * local.matrix());
  }
  std::vector<Frame> moves;
  for (const int j : skin.joints)
    moves.push_back(world[static_cast<std::size_t>(j)] *
                    skin.nodes[static_cast<std::size_t>(j)].bind.inverse());
  return moves;
}

/// Where vertex v at x goes.
inline Vector3d moved(const Skin& skin, const std::vector<Frame>& moves, int v, const Vector3d& x) {
  Vector3d sum = Vector3d::Zero();
  double total = 0;
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, v); w; ++w) {
    sum += w.value() * (moves[static_cast<std::size_t>(w.col())] * x.homogeneous()).head<3>();
    total += w.value();
  }
  return sum / total;
}

}  // namespace crosspatch::rig
