// The glTF parser dereferences some indices while it reads (image -> buffer view -> buffer, and
// primitive -> accessor -> buffer view), recurses over nested values and ignores lengths, so all of
// this is checked on the JSON beforehand.
#include "transfer/gltf_checks.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace crosspatch {
namespace {

using nlohmann::json;

/// Extensions that may be required: what they add is read, or changes no position, UV or image.
constexpr std::array<std::string_view, 3> kKnownExtensions{
    "KHR_texture_transform", "KHR_mesh_quantization", "KHR_lights_punctual"};

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// Depth and counts in one pass over the bytes, without recursion.
Status scan_json(std::string_view text, const ReadLimits& limits) {
  if (text.size() > limits.max_json_bytes)
    return fail(
        ErrorCode::kBadInput,
        fmt::format("{} bytes of JSON, at most {} are read", text.size(), limits.max_json_bytes));
  int depth = 0;
  std::int64_t objects = 0, values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
      continue;
    }
    in_string = c == '"';
    if (c == '{' || c == '[') {
      ++depth;
      ++objects;
    }
    if (c == '}' || c == ']') --depth;
    if (c == ',') ++values;
    if (depth > limits.max_json_depth)
      return fail(ErrorCode::kBadInput,
                  fmt::format("JSON nested deeper than {}", limits.max_json_depth));
    if (objects > limits.max_json_objects || values > limits.max_json_values)
      return fail(ErrorCode::kBadInput,
                  fmt::format("JSON with more than {} objects or {} values",
                              limits.max_json_objects,
                              limits.max_json_values));
  }
  return {};
}

/// A walk over the sections that stops at the first complaint.
class Checker {
 public:
  Checker(const json& root, std::size_t binary_size) : root_(root), binary_size_(binary_size) {}

  Status run() {
    check_asset();
    check_sections();
    if (!problem_.empty()) return fail(ErrorCode::kBadInput, problem_);
    check_buffers();
    check_accessors();
    check_meshes();
    check_nodes();
    check_animations();
    check_materials();
    if (!problem_.empty()) return fail(ErrorCode::kBadInput, problem_);
    return {};
  }

 private:
  void complain(std::string what) {
    if (problem_.empty()) problem_ = std::move(what);
  }

  static const json& member(const json& object, const char* key) {
    static const json nothing;
    if (!object.is_object()) return nothing;
    const auto it = object.find(key);
    return it == object.end() ? nothing : *it;
  }

  [[nodiscard]] std::size_t size_of(const char* section) const {
    const json& array = member(root_, section);
    return array.is_array() ? array.size() : 0;
  }

  /// Calls visit(object, "section i") for every entry.
  template <class Visit>
  void for_each(const char* section, Visit visit) {
    std::size_t i = 0;
    for (const json& object : member(root_, section))
      visit(object, fmt::format("{} {}", section, i++));
  }

  /// A number of bytes or elements: 0 where absent, complains where negative or no integer.
  std::uint64_t count(const json& object, const char* key, const std::string& where) {
    const json& value = member(object, key);
    if (value.is_null()) return 0;
    if (value.is_number_unsigned()) return value.get<std::uint64_t>();
    complain(fmt::format("{}: {} must be an integer of 0 or more", where, key));
    return 0;
  }

  void index(const json& value, const char* section, const std::string& where) {
    if (value.is_null()) return;
    const std::size_t size = size_of(section);
    if (value.is_number_unsigned() && value.get<std::uint64_t>() < size) return;
    const std::string shown = value.is_number() ? value.dump() : std::string(value.type_name());
    complain(fmt::format("{}: index {} into {} is outside [0, {})", where, shown, section, size));
  }

  void indices(const json& array, const char* section, const std::string& where) {
    if (!array.is_null() && !array.is_array())
      return complain(fmt::format("{}: a list of {} is no array", where, section));
    for (const json& value : array) index(value, section, where);
  }

  void check_asset() {
    const json& version = member(member(root_, "asset"), "version");
    if (!version.is_string() || !version.get_ref<const std::string&>().starts_with("2."))
      complain("asset.version: must be 2.x");
    for (const char* key : {"extensionsRequired", "extensionsUsed"})
      if (!member(root_, key).is_null() && !member(root_, key).is_array())
        complain(fmt::format("{}: no array", key));
    if (!problem_.empty()) return;
    for (const json& name : member(root_, "extensionsRequired")) {
      const std::string text = name.is_string() ? name.get<std::string>() : "?";
      const bool known = std::find(kKnownExtensions.begin(), kKnownExtensions.end(), text) !=
                             kKnownExtensions.end() ||
                         text.starts_with("KHR_materials_");
      if (!known) complain(fmt::format("the file needs extension {}", in_quotes(text)));
    }
  }

  void check_sections() {
    for (const char* section : {"accessors",
                                "animations",
                                "buffers",
                                "bufferViews",
                                "cameras",
                                "images",
                                "materials",
                                "meshes",
                                "nodes",
                                "samplers",
                                "scenes",
                                "skins",
                                "textures"}) {
      const json& array = member(root_, section);
      if (!array.is_null() && !array.is_array())
        complain(fmt::format("{}: no array", section));
      else
        for (const json& object : array)
          if (!object.is_object()) complain(fmt::format("{}: an entry is no object", section));
    }
    index(member(root_, "scene"), "scenes", "scene");
  }

  void check_buffers() {
    std::vector<std::uint64_t> sizes;
    for_each("buffers", [&](const json& buffer, const std::string& where) {
      sizes.push_back(count(buffer, "byteLength", where));
      const json& uri = member(buffer, "uri");
      if (uri.is_null() && sizes.back() > binary_size_)
        complain(fmt::format(
            "{}: {} bytes, the binary chunk has {}", where, sizes.back(), binary_size_));
      if (!uri.is_null() && !uri.is_string()) complain(where + ": uri is no text");
    });
    for_each("bufferViews", [&](const json& view, const std::string& where) {
      const json& buffer = member(view, "buffer");
      if (buffer.is_null()) complain(where + ": names no buffer");
      index(buffer, "buffers", where);
      const std::uint64_t offset = count(view, "byteOffset", where);
      const std::uint64_t length = count(view, "byteLength", where);
      if (!problem_.empty()) return;
      const std::uint64_t size = sizes[buffer.get<std::size_t>()];
      if (offset > size || length > size - offset)
        complain(fmt::format(
            "{}: bytes {} to +{} are outside the buffer's {}", where, offset, length, size));
    });
    for_each("images", [&](const json& image, const std::string& where) {
      index(member(image, "bufferView"), "bufferViews", where);
    });
  }

  void check_accessors() {
    for_each("accessors", [&](const json& accessor, const std::string& where) {
      index(member(accessor, "bufferView"), "bufferViews", where);
      count(accessor, "byteOffset", where);
      count(accessor, "count", where);
      const json& sparse = member(accessor, "sparse");
      if (sparse.is_null()) return;
      count(sparse, "count", where);
      for (const char* part : {"indices", "values"}) {
        const json& list = member(sparse, part);
        if (member(list, "bufferView").is_null())
          complain(fmt::format("{}: sparse {} name no buffer view", where, part));
        index(member(list, "bufferView"), "bufferViews", where);
        count(list, "byteOffset", where);
      }
    });
  }

  void check_meshes() {
    const auto attributes = [&](const json& list, const std::string& where) {
      if (!list.is_object()) return complain(where + ": attributes are no object");
      for (const json& value : list) index(value, "accessors", where);
    };
    for_each("meshes", [&](const json& mesh, const std::string& where) {
      const json& primitives = member(mesh, "primitives");
      if (!primitives.is_array()) return complain(where + ": has no primitives");
      for (const json& primitive : primitives) {
        attributes(member(primitive, "attributes"), where);
        index(member(primitive, "indices"), "accessors", where);
        index(member(primitive, "material"), "materials", where);
        count(primitive, "mode", where);
        const json& targets = member(primitive, "targets");
        if (!targets.is_null() && !targets.is_array())
          return complain(where + ": targets are no array");
        for (const json& target : targets) attributes(target, where);
      }
    });
  }

  void check_nodes() {
    for_each("nodes", [&](const json& node, const std::string& where) {
      index(member(node, "mesh"), "meshes", where);
      index(member(node, "skin"), "skins", where);
      index(member(node, "camera"), "cameras", where);
      indices(member(node, "children"), "nodes", where);
    });
    for_each("scenes", [&](const json& scene, const std::string& where) {
      indices(member(scene, "nodes"), "nodes", where);
    });
    for_each("skins", [&](const json& skin, const std::string& where) {
      indices(member(skin, "joints"), "nodes", where);
      index(member(skin, "skeleton"), "nodes", where);
      index(member(skin, "inverseBindMatrices"), "accessors", where);
    });
  }

  void check_animations() {
    for_each("animations", [&](const json& animation, const std::string& where) {
      const json& samplers = member(animation, "samplers");
      const json& channels = member(animation, "channels");
      if (!samplers.is_array() || !channels.is_array())
        return complain(where + ": has no samplers or no channels");
      for (const json& sampler : samplers)
        for (const char* part : {"input", "output"}) {
          if (member(sampler, part).is_null())
            complain(fmt::format("{}: a sampler has no {}", where, part));
          index(member(sampler, part), "accessors", where);
        }
      for (const json& channel : channels) {
        const json& sampler = member(channel, "sampler");
        if (!sampler.is_number_unsigned() || sampler.get<std::uint64_t>() >= samplers.size())
          complain(fmt::format("{}: a channel names no sampler of its {}", where, samplers.size()));
        index(member(member(channel, "target"), "node"), "nodes", where);
      }
    });
  }

  void check_materials() {
    for_each("textures", [&](const json& texture, const std::string& where) {
      index(member(texture, "source"), "images", where);
      index(member(texture, "sampler"), "samplers", where);
    });
    for_each("materials", [&](const json& material, const std::string& where) {
      const json& metallic = member(material, "pbrMetallicRoughness");
      for (const json* texture : {&member(material, "normalTexture"),
                                  &member(material, "occlusionTexture"),
                                  &member(material, "emissiveTexture"),
                                  &member(metallic, "baseColorTexture"),
                                  &member(metallic, "metallicRoughnessTexture")}) {
        if (texture->is_null()) continue;
        if (member(*texture, "index").is_null()) complain(where + ": a texture has no index");
        index(member(*texture, "index"), "textures", where);
        count(*texture, "texCoord", where);
      }
    });
  }

  const json& root_;
  std::size_t binary_size_;
  std::string problem_;
};

}  // namespace

Result<GltfChunks> split_gltf(std::string_view bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  if (!bytes.starts_with("glTF")) return GltfChunks{bytes, false, {}};
  if (bytes.size() < kHeader + kChunkHeader)
    return fail(ErrorCode::kBadInput, fmt::format("GLB header cut short: {} bytes", bytes.size()));
  if (little_endian(bytes, 4) != 2)
    return fail(ErrorCode::kBadInput,
                fmt::format("GLB version {}: must be 2", little_endian(bytes, 4)));
  const std::size_t total = little_endian(bytes, 8), length = little_endian(bytes, 12);
  if (total > bytes.size() || total < kHeader + kChunkHeader)
    return fail(ErrorCode::kBadInput,
                fmt::format("GLB says {} bytes, the file has {}", total, bytes.size()));
  if (little_endian(bytes, 16) != kJson)
    return fail(ErrorCode::kBadInput, "GLB: the first chunk is not JSON");
  if (length > total - kHeader - kChunkHeader)
    return fail(ErrorCode::kBadInput,
                fmt::format("GLB: a JSON chunk of {} bytes does not fit in {}", length, total));
  GltfChunks chunks{bytes.substr(kHeader + kChunkHeader, length), true, {}};
  const std::size_t at = kHeader + kChunkHeader + length;
  if (at + kChunkHeader > total) return chunks;
  const std::size_t binary = little_endian(bytes, at);
  if (binary > total - at - kChunkHeader)
    return fail(ErrorCode::kBadInput,
                fmt::format("GLB: a second chunk of {} bytes does not fit in {}", binary, total));
  if (little_endian(bytes, at + 4) == kBinary)
    chunks.binary = bytes.substr(at + kChunkHeader, binary);
  return chunks;
}

Status check_gltf_json(const GltfChunks& chunks, const ReadLimits& limits) {
  if (Status s = scan_json(chunks.json, limits); !s) return s;
  const json root = json::parse(chunks.json, nullptr, false);
  if (root.is_discarded() || !root.is_object())
    return fail(ErrorCode::kBadInput, "the JSON part is no JSON object");
  return Checker(root, chunks.binary.size()).run();
}

}  // namespace crosspatch
