#include "transfer/gltf_read.hpp"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/image_header.hpp"
#include "core/index.hpp"
#include "transfer/gltf_accessor.hpp"
#include "transfer/gltf_load.hpp"
#include "transfer/gltf_materials.hpp"
#include "transfer/gltf_nodes.hpp"

namespace crosspatch {
namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

using Triangle = std::array<std::uint32_t, 3>;

/// glTF 2.0, section 3.7.2.1.
Result<std::vector<Triangle>> triangles_of(const std::vector<std::uint32_t>& order, int mode) {
  std::vector<Triangle> out;
  const std::size_t n = order.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (n % 3 != 0)
      return fail(ErrorCode::kBadInput, fmt::format("{} corners are no whole triangles", n));
    for (std::size_t i = 0; i < n; i += 3) out.push_back({order[i], order[i + 1], order[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < n; ++i)
      out.push_back({order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]});
  } else {  // a fan
    for (std::size_t i = 0; i + 2 < n; ++i) out.push_back({order[i + 1], order[i + 2], order[0]});
  }
  return out;
}

class SoupBuilder {
 public:
  SoupBuilder(const tinygltf::Model& model, const ReadLimits& limits)
      : model_(model), limits_(limits) {}

  Status add_instances(const std::vector<MeshInstance>& instances) {
    if (instances.empty()) return fail(ErrorCode::kBadInput, "the scene shows no mesh");
    if (!to_first(instances, instances.front()).allFinite())
      return fail(ErrorCode::kBadInput, "the first mesh node's transform has no inverse");
    soup_.node_transform = instances.front().world;
    for (const MeshInstance& instance : instances) {
      soup_.skinned = soup_.skinned || instance.skin >= 0;
      const Eigen::Matrix4d relative = to_first(instances, instance);
      int p = 0;
      for (const auto& primitive : model_.meshes[idx(instance.mesh)].primitives) {
        if (Status s = add_primitive(primitive, relative); !s)
          return fail(s.error().code,
                      fmt::format("mesh {} primitive {}: {}", instance.mesh, p, s.error().message));
        ++p;
      }
    }
    return {};
  }

  PolygonSoup finish() {
    soup_.positions = Eigen::Map<const MatrixX3d>(
        positions_.data(), static_cast<Eigen::Index>(positions_.size() / 3), 3);
    for (auto& set : soup_.uv_sets) set.resize(idx(soup_.corner_count()), {kUnset, kUnset});
    pad_corners();
    soup_.animations = static_cast<int>(model_.animations.size());
    if (soup_.skinned) soup_.notes.emplace_back("has a skin: the mesh is read in its bind pose");
    if (soup_.morph_targets > 0)
      soup_.notes.push_back(
          fmt::format("has {} morph targets: the mesh is read without", soup_.morph_targets));
    if (soup_.animations > 0)
      soup_.notes.push_back(fmt::format("has {} animations", soup_.animations));
    if (passed_over_ > 0)
      soup_.notes.push_back(
          fmt::format("{} primitives of points or lines passed over", passed_over_));
    return std::move(soup_);
  }

  PolygonSoup& soup() { return soup_; }

 private:
  /// An attribute with one element a vertex; empty where the primitive lacks it.
  Result<GltfValues> attribute(const tinygltf::Primitive& primitive,
                               const std::string& name,
                               std::size_t count) {
    const auto it = primitive.attributes.find(name);
    if (it == primitive.attributes.end()) return GltfValues{};
    auto values = read_accessor(model_, it->second, limits_.max_vertices);
    if (values && values->count() != count)
      return fail(ErrorCode::kBadInput,
                  fmt::format("{} has {} elements for {} vertices", name, values->count(), count));
    return values;
  }

  static Status expect_components(const GltfValues& values, int least, int most, const char* name) {
    if (values.values.empty() || (values.components >= least && values.components <= most))
      return {};
    return fail(ErrorCode::kBadInput, fmt::format("{} has {} components", name, values.components));
  }

  Result<std::vector<std::uint32_t>> corner_order(const tinygltf::Primitive& primitive,
                                                  std::size_t vertices) {
    std::vector<std::uint32_t> order;
    if (primitive.indices < 0) {
      for (std::size_t i = 0; i < vertices; ++i) order.push_back(static_cast<std::uint32_t>(i));
      return order;
    }
    const auto indices = read_accessor(model_, primitive.indices, 3 * limits_.max_triangles);
    if (!indices) return tl::unexpected(indices.error());
    if (Status s = expect_components(*indices, 1, 1, "indices"); !s)
      return tl::unexpected(s.error());
    for (const double i : indices->values) {
      if (!(i >= 0 && i < static_cast<double>(vertices)) || i != std::floor(i))
        return fail(ErrorCode::kBadInput, fmt::format("index {} is outside [0, {})", i, vertices));
      order.push_back(static_cast<std::uint32_t>(i));
    }
    return order;
  }

  Status add_primitive(const tinygltf::Primitive& primitive, const Eigen::Matrix4d& transform) {
    if (!has_triangles(primitive)) {
      ++passed_over_;
      return {};
    }
    soup_.morph_targets = std::max(soup_.morph_targets, static_cast<int>(primitive.targets.size()));
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    const auto points =
        read_accessor(model_, primitive.attributes.at("POSITION"), limits_.max_vertices);
    if (!points) return tl::unexpected(points.error());
    if (Status s = expect_components(*points, 3, 3, "POSITION"); !s) return s;
    const auto order = corner_order(primitive, points->count());
    if (!order) return tl::unexpected(order.error());
    auto triangles = triangles_of(*order, mode);
    if (!triangles) return tl::unexpected(triangles.error());
    if (static_cast<std::int64_t>(positions_.size() / 3 + points->count()) > limits_.max_vertices ||
        static_cast<std::int64_t>(idx(soup_.polygon_count()) + triangles->size()) >
            limits_.max_triangles)
      return fail(ErrorCode::kBadInput,
                  fmt::format("more than {} vertices or {} triangles",
                              limits_.max_vertices,
                              limits_.max_triangles));
    // A mirroring transform turns the triangles inside out.
    if (transform.topLeftCorner<3, 3>().determinant() < 0)
      for (Triangle& t : *triangles) std::swap(t[1], t[2]);
    return append(primitive, *points, *triangles, transform);
  }

  Status append(const tinygltf::Primitive& primitive,
                const GltfValues& points,
                const std::vector<Triangle>& triangles,
                const Eigen::Matrix4d& transform) {
    const int first_vertex = static_cast<int>(positions_.size() / 3);
    const std::size_t first_corner = idx(soup_.corner_count());
    for (std::size_t v = 0; v < points.count(); ++v) {
      const Vector3d p = (transform * Vector3d(&points.values[3 * v]).homogeneous()).head<3>();
      positions_.insert(positions_.end(), p.begin(), p.end());
    }
    for (const Triangle& t : triangles) {
      for (const std::uint32_t v : t)
        soup_.corner_vertex.push_back(first_vertex + static_cast<int>(v));
      soup_.polygon_begin.push_back(soup_.corner_count());
      soup_.polygon_material.push_back(primitive.material);
    }
    if (Status s = append_uv(primitive, points.count(), triangles, first_corner); !s) return s;
    if (Status s = append_normals(primitive, points.count(), triangles, first_corner, transform);
        !s)
      return s;
    return append_colors(primitive, points.count(), triangles, first_corner);
  }

  Status append_uv(const tinygltf::Primitive& primitive,
                   std::size_t count,
                   const std::vector<Triangle>& triangles,
                   std::size_t first_corner) {
    for (std::size_t n = 0;; ++n) {
      const std::string name = fmt::format("TEXCOORD_{}", n);
      const auto uv = attribute(primitive, name, count);
      if (!uv) return tl::unexpected(uv.error());
      if (uv->values.empty()) return {};
      if (Status s = expect_components(*uv, 2, 2, name.c_str()); !s) return s;
      if (n == soup_.uv_sets.size()) soup_.uv_sets.emplace_back();
      auto& set = soup_.uv_sets[n];
      set.resize(first_corner, {kUnset, kUnset});
      for (const Triangle& t : triangles)
        for (const std::uint32_t v : t) {
          const Vector2d at(&uv->values[2 * std::size_t{v}]);
          set.push_back(at.allFinite() ? at : Vector2d(kUnset, kUnset));
        }
    }
  }

  Status append_normals(const tinygltf::Primitive& primitive,
                        std::size_t count,
                        const std::vector<Triangle>& triangles,
                        std::size_t first_corner,
                        const Eigen::Matrix4d& transform) {
    const auto normals = attribute(primitive, "NORMAL", count);
    if (!normals) return tl::unexpected(normals.error());
    if (normals->values.empty()) return {};
    if (Status s = expect_components(*normals, 3, 3, "NORMAL"); !s) return s;
    const Eigen::Matrix3d turn = transform.topLeftCorner<3, 3>().inverse().transpose();
    const bool turns = turn.allFinite() && !turn.isIdentity(0);
    soup_.corner_normals.resize(first_corner, {kUnset, kUnset, kUnset});
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) {
        const Vector3d n(&normals->values[3 * std::size_t{v}]);
        soup_.corner_normals.push_back(turns ? Vector3d((turn * n).stableNormalized()) : n);
      }
    return {};
  }

  Status append_colors(const tinygltf::Primitive& primitive,
                       std::size_t count,
                       const std::vector<Triangle>& triangles,
                       std::size_t first_corner) {
    const auto colors = attribute(primitive, "COLOR_0", count);
    if (!colors) return tl::unexpected(colors.error());
    if (colors->values.empty()) return {};
    if (Status s = expect_components(*colors, 3, 4, "COLOR_0"); !s) return s;
    soup_.corner_colors.resize(first_corner, {1, 1, 1, 1});
    const std::size_t components = idx(colors->components);
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t) {
        std::array<float, 4> rgba{1, 1, 1, 1};
        for (std::size_t k = 0; k < components; ++k)
          rgba[k] = static_cast<float>(colors->values[components * v + k]);
        soup_.corner_colors.push_back(rgba);
      }
    return {};
  }

  /// Fills up attributes that the last primitives lack.
  void pad_corners() {
    const std::size_t corners = idx(soup_.corner_count());
    if (!soup_.corner_normals.empty())
      soup_.corner_normals.resize(corners, {kUnset, kUnset, kUnset});
    if (!soup_.corner_colors.empty()) soup_.corner_colors.resize(corners, {1, 1, 1, 1});
  }

  const tinygltf::Model& model_;
  const ReadLimits& limits_;
  PolygonSoup soup_;
  std::vector<double> positions_;  // three a vertex
  int passed_over_ = 0;
};

std::string image_name(const tinygltf::Image& image, int index) {
  if (!image.name.empty()) return image.name;
  if (!image.uri.empty() && !image.uri.starts_with("data:"))
    return std::filesystem::path(image.uri).filename().string();
  return fmt::format("image{}", index);
}

Result<PolygonSoup> read(const std::filesystem::path& path, const ReadLimits& limits) {
  const auto bytes = read_file_bytes(path, limits.max_file_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  tinygltf::Model model;
  std::map<int, std::vector<unsigned char>> encoded;
  SoupBuilder builder(model, limits);
  if (Status s = load_gltf({reinterpret_cast<const char*>(bytes->data()), bytes->size()},
                           path.parent_path(),
                           limits,
                           model,
                           encoded,
                           builder.soup().notes);
      !s)
    return tl::unexpected(s.error());
  const auto instances = mesh_instances(model);
  if (!instances) return tl::unexpected(instances.error());
  if (Status s = builder.add_instances(*instances); !s) return tl::unexpected(s.error());
  PolygonSoup soup = builder.finish();
  std::map<int, int> image_of;
  for (auto& [index, data] : encoded) {
    auto image =
        make_image_file(image_name(model.images[idx(index)], index), std::move(data), limits);
    if (!image) return tl::unexpected(image.error());
    image_of[index] = static_cast<int>(soup.images.size());
    soup.images.push_back(std::move(*image));
  }
  soup.materials = gltf_materials(model, image_of);
  return soup;
}

}  // namespace

Result<PolygonSoup> read_gltf(const std::filesystem::path& path, const ReadLimits& limits) {
  const std::string name = in_quotes(path.filename().string());
  try {
    Result<PolygonSoup> soup = read(path, limits);
    if (soup && soup->polygon_count() == 0)
      soup = fail(ErrorCode::kBadInput, "the file holds no triangles");
    if (soup)
      if (Status valid = validate(*soup); !valid) soup = tl::unexpected(valid.error());
    if (!soup)
      return fail(soup.error().code, fmt::format("file {}: {}", name, soup.error().message));
    return soup;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kInternal, fmt::format("file {}: not enough memory", name));
  } catch (const std::exception& e) {
    return fail(ErrorCode::kBadInput, fmt::format("file {}: {}", name, e.what()));
  }
}

}  // namespace crosspatch
