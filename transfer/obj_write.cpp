#include "transfer/obj_write.hpp"

#include <fmt/format.h>

#include <iterator>
#include <map>
#include <set>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Numbers values in order of first use; OBJ counts from 1.
template <std::size_t N>
class Numbering {
 public:
  int operator()(const std::array<double, N>& value) {
    const auto [entry, fresh] = number_.try_emplace(value, static_cast<int>(values_.size()) + 1);
    if (fresh) values_.push_back(value);
    return entry->second;
  }
  [[nodiscard]] const std::vector<std::array<double, N>>& values() const { return values_; }

 private:
  std::map<std::array<double, N>, int> number_;
  std::vector<std::array<double, N>> values_;
};

template <class... Args>
void append(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

std::string material_name(const TexturedMesh& mesh, int m) {
  std::string name = mesh.materials[idx(m)].name;
  for (char& c : name)
    if (static_cast<unsigned char>(c) <= ' ' || c == '#') c = '_';
  // Names need not differ in glTF, in MTL they must.
  return fmt::format("{}_{}", name.empty() ? "material" : name, m);
}

void append_map(std::string& text,
                const char* keyword,
                const TextureRef& ref,
                const TexturedMesh& mesh,
                const std::string& stem) {
  if (ref.image < 0) return;
  append(text, "{} {}_{}\n", keyword, stem, mesh.images[idx(ref.image)].name);
}

std::string mtl(const TexturedMesh& mesh, const std::set<int>& used, const std::string& stem) {
  std::string text = "# crosspatch\n";
  for (const int i : used) {
    const Material& m = mesh.materials[idx(i)];
    append(text, "\nnewmtl {}\n", material_name(mesh, i));
    const auto& c = m.base_color_factor;
    append(text, "Kd {:.6g} {:.6g} {:.6g}\nd {:.6g}\n", c[0], c[1], c[2], c[3]);
    append(text,
           "Ke {:.6g} {:.6g} {:.6g}\nPr {:.6g}\nPm {:.6g}\n",
           m.emissive_factor[0],
           m.emissive_factor[1],
           m.emissive_factor[2],
           m.roughness_factor,
           m.metallic_factor);
    append_map(text, "map_Kd", m.base_color, mesh, stem);
    append_map(text, "map_Ke", m.emissive, mesh, stem);
    append_map(text, "norm", m.normal, mesh, stem);
    append_map(text, "map_Pr", m.metallic_roughness, mesh, stem);
  }
  return text;
}

}  // namespace

std::vector<NamedBytes> encode_obj(const TexturedMesh& mesh, const std::string& stem) {
  std::string text = fmt::format("# crosspatch\nmtllib {}.mtl\n", stem);
  const Eigen::Matrix3d linear = mesh.node_transform.topLeftCorner<3, 3>();
  const Vector3d shift = mesh.node_transform.topRightCorner<3, 1>();
  const Eigen::Matrix3d normal_matrix = linear.inverse().transpose();
  for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v) {
    const Vector3d p = linear * mesh.positions.row(v).transpose() + shift;
    append(text, "v {:.9g} {:.9g} {:.9g}\n", p[0], p[1], p[2]);
  }
  Numbering<2> uvs;
  Numbering<3> normals;
  std::string faces;
  std::map<int, std::vector<int>> of_material;
  for (int t = 0; t < mesh.triangle_count(); ++t) of_material[mesh.material[idx(t)]].push_back(t);
  std::set<int> used;
  for (const auto& [material, triangles] : of_material) {
    used.insert(material);
    append(faces, "usemtl {}\n", material_name(mesh, material));
    for (const int t : triangles) {
      faces += 'f';
      for (int k = 0; k < 3; ++k) {
        const std::size_t c = idx(3 * t + k);
        const Vector3d n = (normal_matrix * mesh.normals[c]).stableNormalized();
        append(faces, " {}/", mesh.triangles(t, k) + 1);
        if (!mesh.uv_sets.empty())
          append(faces, "{}", uvs({mesh.uv_sets[0][c][0], 1 - mesh.uv_sets[0][c][1]}));
        append(faces, "/{}", normals({n[0], n[1], n[2]}));
      }
      faces += '\n';
    }
  }
  for (const auto& uv : uvs.values()) append(text, "vt {:.9g} {:.9g}\n", uv[0], uv[1]);
  for (const auto& n : normals.values())
    append(text, "vn {:.9g} {:.9g} {:.9g}\n", n[0], n[1], n[2]);
  std::vector<NamedBytes> files{{stem + ".obj", text + faces},
                                {stem + ".mtl", mtl(mesh, used, stem)}};
  for (const ImageFile& image : mesh.images)
    files.push_back({stem + "_" + image.name, {image.bytes.begin(), image.bytes.end()}});
  return files;
}

}  // namespace crosspatch
