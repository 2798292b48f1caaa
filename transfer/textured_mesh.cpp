#include "transfer/textured_mesh.hpp"

#include <fmt/format.h>

namespace crosspatch {
namespace {

Status check_sizes(const TexturedMesh& mesh) {
  const auto triangles = static_cast<std::size_t>(mesh.triangle_count());
  const auto complain = [&](const char* name, std::size_t size, std::size_t wanted) {
    return fail(ErrorCode::kInternal,
                fmt::format("textured mesh: {} has {} entries, wanted {}", name, size, wanted));
  };
  if (mesh.material.size() != triangles)
    return complain("material", mesh.material.size(), triangles);
  if (mesh.target_face.size() != triangles)
    return complain("target_face", mesh.target_face.size(), triangles);
  if (mesh.normals.size() != 3 * triangles)
    return complain("normals", mesh.normals.size(), 3 * triangles);
  if (!mesh.colors.empty() && mesh.colors.size() != 3 * triangles)
    return complain("colors", mesh.colors.size(), 3 * triangles);
  for (const auto& set : mesh.uv_sets)
    if (set.size() != 3 * triangles) return complain("uv set", set.size(), 3 * triangles);
  return {};
}

Status check_materials(const TexturedMesh& mesh) {
  for (const int m : mesh.material)
    if (m < 0 || m >= static_cast<int>(mesh.materials.size()))
      return fail(
          ErrorCode::kInternal,
          fmt::format(
              "textured mesh: material {} of {}", m, static_cast<int>(mesh.materials.size())));
  for (const Material& m : mesh.materials)
    for (const TextureRef* t :
         {&m.base_color, &m.metallic_roughness, &m.normal, &m.occlusion, &m.emissive}) {
      if (t->image == -1) continue;
      if (t->image < 0 || t->image >= static_cast<int>(mesh.images.size()))
        return fail(ErrorCode::kInternal,
                    fmt::format("material \"{}\": image {} does not exist", m.name, t->image));
      if (t->uv_set < 0 || t->uv_set >= static_cast<int>(mesh.uv_sets.size()))
        return fail(ErrorCode::kInternal,
                    fmt::format("material \"{}\": UV set {} does not exist", m.name, t->uv_set));
    }
  return {};
}

Status check_skin(const TexturedMesh& mesh) {
  if (!mesh.motion.skin) return {};
  const Skin& skin = *mesh.motion.skin;
  for (const SkeletonNode& node : skin.nodes)
    if (!node.bind.topLeftCorner<3, 3>().isIdentity(0))
      return fail(ErrorCode::kInternal,
                  fmt::format("textured mesh: joint \"{}\" is turned in the bind pose", node.name));
  constexpr double kUnits = 1 << 20;  // sums of such fractions are exact
  for (Eigen::Index v = 0; v < skin.weights.rows(); ++v) {
    int count = 0;
    double sum = 0;
    bool exact = true;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator w(skin.weights, v); w; ++w) {
      ++count;
      sum += w.value();
      exact = exact && w.value() * kUnits == std::floor(w.value() * kUnits);
    }
    if (count < 1 || count > 4 || sum != 1 || !exact)
      return fail(ErrorCode::kInternal,
                  fmt::format("textured mesh: vertex {} has {} weights of sum {}", v, count, sum));
  }
  return {};
}

}  // namespace

Status validate(const TexturedMesh& mesh) {
  if (Status s = validate(mesh.motion, static_cast<int>(mesh.positions.rows())); !s) return s;
  if (Status s = check_skin(mesh); !s) return s;
  if (Status s = check_sizes(mesh); !s) return s;
  if (Status s = check_materials(mesh); !s) return s;
  if (mesh.triangle_count() > 0 &&
      (mesh.triangles.minCoeff() < 0 || mesh.triangles.maxCoeff() >= mesh.positions.rows()))
    return fail(ErrorCode::kInternal, "textured mesh: a triangle names a missing position");
  if (!mesh.positions.allFinite())
    return fail(ErrorCode::kInternal, "textured mesh: a position is not finite");
  for (const auto& set : mesh.uv_sets)
    for (const Vector2d& uv : set)
      if (!uv.allFinite()) return fail(ErrorCode::kInternal, "textured mesh: a UV is not finite");
  for (const Vector3d& n : mesh.normals)
    if (!n.isZero(0) && std::abs(n.norm() - 1) > 1e-9)
      return fail(ErrorCode::kInternal,
                  fmt::format("textured mesh: a normal has length {}", n.norm()));
  return {};
}

}  // namespace crosspatch
