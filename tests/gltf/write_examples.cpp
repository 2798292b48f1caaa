// write_examples FOLDER: files with every glTF feature we write, for validate.mjs and view.mjs.

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <numbers>

#include "core/index.hpp"
#include "shapes.hpp"
#include "transfer/carry_motion.hpp"
#include "transfer/carry_texture.hpp"
#include "transfer/gltf_motion.hpp"
#include "transfer/gltf_write.hpp"
#include "transfer/rig.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

ImageFile sample_image() {
  std::ifstream file(CROSSPATCH_ROOT "/samples/lira.png", std::ios::binary);
  return {"lira.png", "image/png", {std::istreambuf_iterator<char>(file), {}}};
}

/// Longitude and latitude with a seam where the longitude jumps.
shapes::Surface globe(int levels) {
  shapes::Surface s = shapes::surface_of(shapes::icosphere(levels));
  const TriangleMesh& mesh = s.prepared.mesh;
  shapes::texture(
      s,
      [&mesh](int f, const Vector3d& p) {
        const auto longitude = [](const Vector3d& q) {
          return std::atan2(q[0], q[2]) / (2 * std::numbers::pi);
        };
        const double middle = longitude(mesh.position(mesh.F(f, 0)) + mesh.position(mesh.F(f, 1)) +
                                        mesh.position(mesh.F(f, 2)));
        const double u = longitude(p);
        return Vector2d(0.5 + u + std::round(middle - u), 0.5 - p[1] / 2);
      },
      512);
  s.soup.images = {sample_image()};
  return s;
}

/// Every kind of texture, several materials, colours, a transform of the texture and of the node.
shapes::Surface everything() {
  shapes::Surface s = globe(3);
  s.soup.uv_sets.push_back(s.soup.uv_sets[0]);
  for (int h = 0; h < s.prepared.mesh.halfedge_count(); ++h)
    s.soup.corner_colors.push_back({1, float(0.5 + 0.5 * (h % 2)), 1, 1});
  Material& skin = s.soup.materials[0];
  skin.base_color.wrap_s = 33071;
  skin.base_color.min_filter = 9987;
  skin.base_color.mag_filter = 9729;
  skin.base_color.transform = TextureTransform{{0.1, 0.2}, 0.3, {1.5, 2}};
  skin.normal.image = skin.occlusion.image = skin.emissive.image = 0;
  skin.metallic_roughness.image = 0;
  skin.occlusion.uv_set = 1;
  skin.emissive_factor = {0.1, 0.1, 0.1};
  Material horn;
  horn.name = "horn";
  horn.base_color_factor = {0.8, 0.7, 0.2, 0.5};
  horn.alpha_mode = "BLEND";
  horn.double_sided = true;
  Material leaf;
  leaf.name = "leaf";
  leaf.base_color.image = 0;
  leaf.alpha_mode = "MASK";
  leaf.alpha_cutoff = 0.25;
  s.soup.materials.push_back(horn);
  s.soup.materials.push_back(leaf);
  const int faces = s.prepared.mesh.face_count();
  for (int f = faces / 2; f < faces; ++f) s.soup.polygon_material[idx(f)] = f % 40 < 20 ? 1 : 2;
  s.soup.node_transform.topLeftCorner<3, 3>() *= 0.01;
  s.soup.node_transform(1, 3) = 5;
  return s;
}

int write(const std::string& path, const shapes::Surface& s) {
  const auto carried = carry_texture(s.view(), s.view(), identity_map(s.prepared.mesh));
  const auto bytes = carried ? encode_glb(carried->mesh) : tl::unexpected(carried.error());
  if (!bytes) {
    std::fprintf(stderr, "%s: %s\n", path.c_str(), bytes.error().message.c_str());
    return 1;
  }
  std::ofstream file(path, std::ios::binary);
  file << *bytes;
  return file.good() ? 0 : 1;
}

/// A copy of a globe, turned and larger, that bends at a knee and has morph targets.
int write_moving(const std::string& path) {
  shapes::Surface source = globe(3), target = globe(3);
  TriangleMesh& copy = target.prepared.mesh;
  copy.V = (3 * copy.V * rig::frame({0, 0, 0}, 0.5, {1, 2, 0}).topLeftCorner<3, 3>()).eval();
  target.soup.node_transform(1, 3) = 5;
  const std::string file = path + ".source.glb";
  std::ofstream(file, std::ios::binary)
      << rig::file(source.prepared.mesh.V, source.prepared.mesh.F).glb();
  const auto motion = read_gltf_motion(file, {.skin = true, .morphs = true});
  std::remove(file.c_str());
  const SurfaceMap map = identity_map(source.prepared.mesh);
  auto carried = carry_texture(source.view(), target.view(), map);
  if (!motion || !carried) return 1;
  auto moved = carry_motion(motion->motion, source.view(), target.view(), map, carried->mesh);
  if (!moved) return 1;
  carried->mesh.motion = std::move(moved->motion);
  const auto bytes = encode_glb(carried->mesh);
  if (!bytes) return 1;
  std::ofstream out(path, std::ios::binary);
  out << *bytes;
  return out.good() ? 0 : 1;
}

/// Half of the faces have no UVs for their texture.
shapes::Surface torn() {
  shapes::Surface s = globe(2);
  for (int h = 0; h < s.prepared.mesh.halfedge_count() / 2; ++h)
    s.soup.uv_sets[0][idx(h)] = Vector2d::Constant(std::nan(""));
  return s;
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  using namespace crosspatch;
  if (argc != 2) return 2;
  const std::string folder = std::string(argv[1]) + "/";
  return write(folder + "globe.glb", globe(3)) + write(folder + "everything.glb", everything()) +
         write(folder + "torn.glb", torn()) + write_moving(folder + "moving.glb") +
         write(folder + "plain.glb", shapes::surface_of(shapes::torus(2, 1, 30, 20))) +
         write(folder + "wide.glb", shapes::surface_of(shapes::icosphere(7)));
}
