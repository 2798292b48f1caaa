#include "malformed.hpp"

#include "gltf_files.hpp"
#include "shapes.hpp"

namespace crosspatch::files {
namespace {

using nlohmann::json;

const std::string kTriangleObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string kTriangleOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";

std::string cut(const std::string& bytes, double share) {
  return bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size())));
}

void add_obj(std::vector<Malformed>& out) {
  const TriangleMesh ball = shapes::icosphere(1);
  out.insert(
      out.end(),
      {{"obj empty", "a.obj", "", "holds no polygons"},
       {"obj zeros", "a.obj", std::string(4096, '\0'), "holds no polygons"},
       {"obj of text", "a.obj", "this is no mesh\n<html></html>\n", "holds no polygons"},
       {"obj points only", "a.obj", "v 0 0 0\nv 1 0 0\n", "holds no polygons"},
       {"obj NaN", "a.obj", "v nan 0 0\n" + kTriangleObj, "line 1: vertex: 'nan'"},
       {"obj inf", "a.obj", "v 0 inf 0\n" + kTriangleObj, "line 1: vertex: 'inf'"},
       {"obj 1.#QNAN", "a.obj", "v 0 0 1.#QNAN\n" + kTriangleObj, "is not a finite number"},
       {"obj overflow", "a.obj", "v 1e999 0 0\n" + kTriangleObj, "is not a finite number"},
       {"obj two coordinates", "a.obj", "v 1 0\n" + kTriangleObj, "line 1: vertex: ''"},
       {"obj index 0", "a.obj", kTriangleObj + "f 0 1 2\n", "line 5: vertex index '0'"},
       {"obj index too large", "a.obj", kTriangleObj + "f 1 2 4\n", "vertex index 4"},
       {"obj index huge", "a.obj", kTriangleObj + "f 1 2 99999999999999999999\n", "vertex index"},
       {"obj index 2^31", "a.obj", kTriangleObj + "f 1 2 2147483648\n", "vertex index"},
       {"obj index too negative", "a.obj", kTriangleObj + "f -1 -2 -4\n", "vertex index '-4'"},
       {"obj index of text", "a.obj", kTriangleObj + "f one two three\n", "vertex index 'one'"},
       {"obj texture index",
        "a.obj",
        "vt 0 0\n" + kTriangleObj + "f 1/2 2/1 3/1\n",
        "texture coordinate index 2: the file has 1"},
       {"obj texture NaN", "a.obj", "vt nan 0\n" + kTriangleObj, "texture coordinate: 'nan'"},
       {"obj normal index",
        "a.obj",
        "vn 0 0 1\n" + kTriangleObj + "f 1//9 2//1 3//1\n",
        "normal index 9"},
       {"obj all faces degenerate",
        "a.obj",
        "v 0 0 0\nv 1 0 0\nf 1 1 2\nf 2 2 2\n",
        "no triangle with area"},
       {"obj faces without area",
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
        "no triangle with area"},
       {"obj coordinates too large",
        "a.obj",
        "v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n",
        "area is not finite"},
       {"obj cut inside a face", "a.obj", cut(obj(ball.V, ball.F), 0.8), "left out", true},
       {"obj two-cornered face", "a.obj", kTriangleObj + "f 1 2\n", "fewer than three", true},
       {"obj library outside",
        "a.obj",
        "mtllib ../../../../etc/passwd\n" + kTriangleObj,
        "leaves the file's folder",
        true},
       {"obj absolute library", "a.obj", "mtllib /etc/passwd\n" + kTriangleObj, "relative", true},
       {"obj library is itself",
        "a.obj",
        "mtllib a.obj\nusemtl x\n" + kTriangleObj + "f 1 2 9",
        "vertex index 9"},
       {"obj library is a folder", "a.obj", "mtllib .\n" + kTriangleObj, "not a regular", true},
       {"obj fin", "a.obj", obj(ball.V, ball.F) + "v 0 0 3\nf 1 13 43\n", "more than two", true},
       {"obj unknown extension", "a.fbx", kTriangleObj, "extension '.fbx' is none of"}});
}

void add_off(std::vector<Malformed>& out) {
  const TriangleMesh ball = shapes::icosphere(1);
  const std::string sound = off(ball.V, ball.F);
  out.insert(
      out.end(),
      {{"off empty", "a.off", "", "where OFF is expected"},
       {"off zeros", "a.off", std::string(4096, '\0'), "where OFF is expected"},
       {"off without counts", "a.off", "OFF\n", "two counts"},
       {"off negative count", "a.off", "OFF\n-1 1 0\n", "two counts of 0 or more"},
       {"off huge count", "a.off", "OFF\n4000000000 1 0\n0 0 0\n", "4000000000 vertices"},
       {"off overflowing count", "a.off", "OFF\n99999999999999999999 1 0\n", "two counts"},
       {"off count of 3 MB digits",
        "a.off",
        "OFF\n" + std::string(3'000'000, '9') + " 1 0\n",
        "two counts"},
       {"off huge polygon", "a.off", kTriangleOff + "2000000000 0 1 2\n", "corners do not fit"},
       {"off negative polygon", "a.off", kTriangleOff + "-3 0 1 2\n", "corners do not fit"},
       {"off index too large", "a.off", kTriangleOff + "3 0 1 3\n", "vertex '3' is outside [0, 3)"},
       {"off negative index", "a.off", kTriangleOff + "3 0 1 -1\n", "vertex '-1' is outside"},
       {"off NaN", "a.off", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", "line 4: vertex"},
       {"off polygon missing", "a.off", kTriangleOff, "0 of 1 polygons"},
       {"off cut in the vertices", "a.off", cut(sound, 0.3), "line"},
       {"off cut in the polygons", "a.off", cut(sound, 0.9), "line"},
       {"off binary", "a.off", "OFF BINARY\n" + std::string(64, '\1'), "binary OFF is not read"},
       {"off no polygon", "a.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "holds no polygons"}});
}

void add_ply(std::vector<Malformed>& out) {
  const TriangleMesh ball = shapes::icosphere(1);
  const std::string ascii = ply_ascii(ball.V, ball.F), binary = ply_binary(ball.V, ball.F, false);
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  const auto header = [](long long v, long long f) { return ply_header("ascii", v, f); };
  out.insert(
      out.end(),
      {{"ply empty", "a.ply", "", "first line is not 'ply'"},
       {"ply zeros", "a.ply", std::string(4096, '\0'), "first line is not 'ply'"},
       {"ply cut in the header",
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\n",
        "no 'end_header'"},
       {"ply of one line", "a.ply", "ply", "no 'end_header'"},
       {"ply without format", "a.ply", "ply\nelement vertex 3\nend_header\n", "no format"},
       {"ply unknown format", "a.ply", "ply\nformat morse 1.0\nend_header\n", "unknown format"},
       {"ply unknown word",
        "a.ply",
        "ply\nformat ascii 1.0\nvertices 3\nend_header\n",
        "unknown word 'vertices'"},
       {"ply huge count", "a.ply", header(4'000'000'000, 1) + points, "4000000000 declared"},
       {"ply negative count", "a.ply", header(-3, 1) + points, "count '-3'"},
       {"ply overflowing count",
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nproperty float x\n"
        "end_header\n",
        "count '99999999999999999999'"},
       {"ply huge list", "a.ply", header(3, 1) + points + "2000000000 0 1 2\n", "list length"},
       {"ply negative list", "a.ply", header(3, 1) + points + "-3 0 1 2\n", "list length -3"},
       {"ply fractional list", "a.ply", header(3, 1) + points + "2.5 0 1 2\n", "list length 2.5"},
       {"ply NaN list", "a.ply", header(3, 1) + points + "nan 0 1 2\n", "list length"},
       {"ply index too large", "a.ply", header(3, 1) + points + "3 0 1 3\n", "outside [0, 3)"},
       {"ply negative index", "a.ply", header(3, 1) + points + "3 0 1 -1\n", "is no index"},
       {"ply NaN", "a.ply", header(3, 1) + "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", "no finite number"},
       {"ply inf", "a.ply", header(3, 1) + "0 0 0\n-inf 0 0\n0 1 0\n3 0 1 2\n", "no finite"},
       {"ply cut in the vertices", "a.ply", cut(ascii, 0.3), "or the file ends"},
       {"ply cut in the polygons", "a.ply", cut(ascii, 0.99), "or the file ends"},
       {"binary ply cut", "a.ply", cut(binary, 0.5), "bytes left"},
       {"binary ply cut at the end", "a.ply", cut(binary, 0.999), "or the file ends"},
       {"ply without z",
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "end_header\n0 0\n",
        "lacks one of x, y, z"},
       {"ply element without properties",
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 4000000000\nend_header\n",
        "has no properties"},
       {"ply float list count",
        "a.ply",
        "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\n"
        "end_header\n",
        "cannot count a list"},
       {"ply two vertex elements",
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
        "float z\nelement vertex 1\nproperty float x\nend_header\n0 0 0\n0\n",
        "comes twice"},
       {"ply image outside",
        "a.ply",
        "ply\nformat ascii 1.0\ncomment TextureFile ../x.png\n" + header(3, 1).substr(21) + points +
            "3 0 1 2\n",
        "leaves the file's folder",
        true}});
}

void add_stl(std::vector<Malformed>& out) {
  const TriangleMesh ball = shapes::icosphere(1);
  const std::string ascii = stl_ascii(ball.V, ball.F);
  std::string more = stl_binary(ball.V, ball.F), huge = more, nan = more;
  more.replace(80, 4, bytes_of(std::uint32_t{81}));
  huge.replace(80, 4, bytes_of(std::uint32_t{0xffffffff}));
  nan.replace(84 + 12, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
  out.insert(
      out.end(),
      {{"stl empty", "a.stl", "", "neither ASCII STL nor binary STL"},
       {"stl zeros", "a.stl", std::string(4096, '\0'), "holds no polygons"},
       {"stl header only", "a.stl", std::string(84, '\0'), "holds no polygons"},
       {"stl one facet too many", "a.stl", more, "81 facets declared"},
       {"stl huge count", "a.stl", huge, "4294967295 facets, at most"},
       {"stl binary NaN", "a.stl", nan, "facet 0 (counted from 0)"},
       {"stl ascii cut",
        "a.stl",
        ascii.substr(0, ascii.find("endfacet") + 9),
        "without 'endsolid'",
        true},
       {"stl ascii NaN",
        "a.stl",
        "solid\nfacet normal 0 0 1\nouter loop\nvertex nan 0 0\nendloop\nendfacet\n",
        "line 4: vertex: 'nan'"},
       {"stl two corners",
        "a.stl",
        "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid\n",
        "one loop of three vertices"},
       {"stl without facets", "a.stl", "solid nothing\nendsolid nothing\n", "holds no polygons"},
       {"stl of text", "a.stl", "solid\nonce upon a time\n", "'once' is no word"}});
}

/// A sound GLB whose JSON `change` has spoilt.
template <class Change>
Malformed spoilt(const std::string& name, const std::string& says, Change change) {
  const TriangleMesh mesh = shapes::tetrahedron();
  Gltf file = gltf(mesh.V, mesh.F);
  change(file);
  return {name, "a.glb", file.glb(), says};
}

void add_gltf_json(std::vector<Malformed>& out) {
  const auto add = [&](const std::string& name, const std::string& says, auto change) {
    out.push_back(spoilt(name, says, [&](Gltf& g) { change(g.json); }));
  };
  add("accessor past its view", "do not fit", [](json& j) { j["accessors"][0]["count"] = 99; });
  add("accessor count 4e9", "0 or more", [](json& j) { j["accessors"][0]["count"] = 4e9; });
  add("accessor count 4000000000", "are read", [](json& j) {
    j["accessors"][0]["count"] = 4000000000u;
  });
  add("accessor count negative", "0 or more", [](json& j) { j["accessors"][0]["count"] = -4; });
  add("accessor offset overflow", "do not fit", [](json& j) {
    j["accessors"][0]["byteOffset"] = 0xfffffffffffffff0u;
  });
  add("accessor of unknown type", "", [](json& j) { j["accessors"][0]["type"] = "VEC9"; });
  add("accessor of unknown component", "", [](json& j) { j["accessors"][0]["componentType"] = 1; });
  add("positions of two components", "POSITION has 2 components", [](json& j) {
    j["accessors"][0]["type"] = "VEC2";
  });
  add("view of missing buffer", "index 7 into buffers", [](json& j) {
    j["bufferViews"][0]["buffer"] = 7;
  });
  add("view past its buffer", "outside the buffer's", [](json& j) {
    j["bufferViews"][0]["byteLength"] = 1 << 30;
  });
  add("view offset overflow", "outside the buffer's", [](json& j) {
    j["bufferViews"][0]["byteOffset"] = 0xfffffffffffffff0u;
  });
  add("view stride too small", "byteStride 4", [](json& j) {
    j["bufferViews"][0]["byteStride"] = 4;
  });
  add("missing accessor", "index 99 into accessors", [](json& j) {
    j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99;
  });
  add("missing indices", "index 99 into accessors", [](json& j) {
    j["meshes"][0]["primitives"][0]["indices"] = 99;
  });
  add("missing view", "index 99 into bufferViews", [](json& j) {
    j["accessors"][0]["bufferView"] = 99;
  });
  add("missing mesh", "index 9 into meshes", [](json& j) { j["nodes"][0]["mesh"] = 9; });
  add("missing scene", "index 5 into scenes", [](json& j) { j["scene"] = 5; });
  add("scene without its node", "index 99 into nodes", [](json& j) {
    j["scenes"][0]["nodes"] = {99};
  });
  add("missing material", "index 4 into materials", [](json& j) {
    j["meshes"][0]["primitives"][0]["material"] = 4;
  });
  add("missing image", "index 3 into images", [](json& j) { j["textures"][0]["source"] = 3; });
  add("missing sampler", "index 3 into samplers", [](json& j) { j["textures"][0]["sampler"] = 3; });
  add("missing texture", "index 3 into textures", [](json& j) {
    j["materials"][0]["emissiveTexture"] = {{"index", 3}};
  });
  add("image in missing view", "index 9 into bufferViews", [](json& j) {
    j["images"][0]["bufferView"] = 9;
  });
  add("node in a cycle", "its own ancestor", [](json& j) { j["nodes"][0]["children"] = {0}; });
  add("two nodes in a cycle", "its own ancestor", [](json& j) {
    j["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
  });
  add("every node has a parent", "shows no mesh", [](json& j) {
    j["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
    j.erase("scenes");
    j.erase("scene");
  });
  add("node of no size", "no inverse", [](json& j) { j["nodes"][0]["scale"] = {0, 0, 0}; });
  add("buffer larger than the chunk", "the binary chunk has", [](json& j) {
    j["buffers"][0]["byteLength"] = 1 << 20;
  });
  add("negative buffer", "0 or more", [](json& j) { j["buffers"][0]["byteLength"] = -1; });
  add("buffer elsewhere", "", [](json& j) { j["buffers"][0]["uri"] = "../../../etc/passwd"; });
  add("buffer of absolute name", "", [](json& j) { j["buffers"][0]["uri"] = "/etc/passwd"; });
  add("buffer is a folder", "", [](json& j) { j["buffers"][0]["uri"] = "."; });
  add("buffer from the net", "", [](json& j) {
    j["buffers"][0]["uri"] = "http://localhost/a.bin";
  });
  add("buffer of bad base64", "", [](json& j) {
    j["buffers"][0]["uri"] = "data:application/octet-stream;base64,!!!!";
  });
  add("version 1", "asset.version", [](json& j) { j["asset"]["version"] = "1.0"; });
  add("no asset", "asset.version", [](json& j) { j.erase("asset"); });
  add("needs Draco", "needs extension", [](json& j) {
    j["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  });
  add("sections of the wrong kind", "no array", [](json& j) { j["meshes"] = {{"a", 1}}; });
  add("entries of the wrong kind", "no object", [](json& j) { j["nodes"] = {1, "two", nullptr}; });
  add("two corners left over", "no whole triangles", [](json& j) {
    j["accessors"][2]["count"] = 11;
  });
  add("nothing at all", "asset.version", [](json& j) { j = json::object(); });
  add("only points", "holds no triangles", [](json& j) {
    j["meshes"][0]["primitives"][0]["mode"] = 0;
  });
}

void add_gltf_content(std::vector<Malformed>& out) {
  out.push_back(spoilt("sparse index out of range", "sparse index 200", [](Gltf& g) {
    const int at = g.add_view("\xc8"), values = g.add_view(floats({1, 2, 3}));
    g.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", at}, {"componentType", kUnsignedByte}}},
        {"values", {{"bufferView", values}}}};
  }));
  out.push_back(spoilt("sparse part too long", "do not fit", [](Gltf& g) {
    const int at = g.add_view("\1"), values = g.add_view(floats({1, 2, 3}));
    g.json["accessors"][0]["sparse"] = {
        {"count", 3},
        {"indices", {{"bufferView", at}, {"componentType", kUnsignedByte}}},
        {"values", {{"bufferView", values}}}};
  }));
  out.push_back(spoilt("zeros out of nothing", "are read", [](Gltf& g) {
    g.json["accessors"][0].erase("bufferView");
    g.json["accessors"][0]["count"] = 50'000'000;
  }));
  out.push_back(spoilt("NaN position", "not finite", [](Gltf& g) {
    g.binary.replace(0, 4, bytes_of(std::numeric_limits<float>::quiet_NaN()));
  }));
  out.push_back(spoilt("index out of range", "index 77 is outside [0, 4)", [](Gltf& g) {
    const std::size_t at = g.json["bufferViews"][2]["byteOffset"];
    g.binary.replace(at, 4, bytes_of(std::uint32_t{77}));
  }));
  const auto with_image = [](const std::string& bytes) {
    return [bytes](Gltf& g) {
      const int view = g.add_view(bytes);
      g.json["images"][0] = {{"bufferView", view}, {"mimeType", "image/png"}};
    };
  };
  out.push_back(spoilt("PNG bomb", "30000 x 30000", with_image(png_header(30000, 30000))));
  out.push_back(spoilt("JPEG bomb", "65535 x 65535", with_image(jpeg_header(65535, 65535))));
  out.push_back(spoilt("PNG of no size", "0 x 10", with_image(png_header(0, 10))));
  out.push_back(spoilt("PNG cut short", "cut short", with_image(png_header(9, 9).substr(0, 20))));
  out.push_back(spoilt("image of text", "neither PNG nor JPEG", with_image("no image")));
}

void add_gltf_containers(std::vector<Malformed>& out) {
  const TriangleMesh mesh = shapes::tetrahedron();
  const Gltf file = gltf(mesh.V, mesh.F);
  const std::string sound = file.glb();
  const auto word = [&](std::size_t at, std::uint32_t value) {
    std::string bytes = sound;
    return bytes.replace(at, 4, bytes_of(value));
  };
  Gltf deep = file;
  std::string text = deep.json.dump();
  text.pop_back();
  text += ",\"extras\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}";
  std::string many = R"({"asset":{"version":"2.0"},"nodes":[{})";
  for (int i = 0; i < 300'000; ++i) many += ",{}";
  Gltf headless = file;
  headless.binary.clear();
  out.insert(out.end(),
             {{"gltf empty", "a.gltf", "", "no JSON object"},
              {"gltf of zeros", "a.gltf", std::string(1000, '\0'), "no JSON object"},
              {"gltf deep", "a.gltf", text, "nested deeper than 100"},
              {"gltf deep and unclosed", "a.gltf", std::string(5'000'000, '['), "nested deeper"},
              {"gltf of many nodes", "a.gltf", many + "]}", "more than 200000 objects"},
              {"gltf cut", "a.gltf", cut(file.json.dump(), 0.5), "no JSON object"},
              {"gltf without buffer", "a.gltf", file.json.dump(), "the binary chunk has 0"},
              {"gltf list", "a.gltf", "[1,2,3]", "no JSON object"},
              {"gltf not UTF-8", "a.gltf", "{\"\xff\xfe\": 1}", "no JSON object"},
              {"glb magic only", "a.glb", "glTF", "header cut short"},
              {"glb zeros", "a.glb", std::string(1000, '\0'), "no JSON object"},
              {"glb version 1", "a.glb", word(4, 1), "version 1: must be 2"},
              {"glb longer than the file", "a.glb", word(8, 0x7fffffff), "GLB says 2147483647"},
              {"glb of length 0", "a.glb", word(8, 0), "GLB says 0"},
              {"glb JSON too long", "a.glb", word(12, 0x7fffffff), "a JSON chunk of 2147483647"},
              {"glb JSON length -1", "a.glb", word(12, 0xffffffff), "a JSON chunk of 4294967295"},
              {"glb without JSON", "a.glb", word(16, 0x004e4942), "first chunk is not JSON"},
              {"glb cut", "a.glb", cut(sound, 0.7), "GLB says"},
              {"glb without BIN", "a.glb", headless.glb(), "the binary chunk has 0"},
              {"glb named obj", "a.obj", word(4, 3), "version 3"}});
}

}  // namespace

std::vector<Malformed> malformed_files() {
  std::vector<Malformed> out;
  add_obj(out);
  add_off(out);
  add_ply(out);
  add_stl(out);
  add_gltf_json(out);
  add_gltf_content(out);
  add_gltf_containers(out);
  return out;
}

std::vector<std::pair<std::string, std::string>> sound_files() {
  const TriangleMesh ball = shapes::icosphere(1);
  Gltf file = gltf(ball.V, ball.F);
  const std::string glb = file.glb();
  return {{"a.obj", obj(ball.V, ball.F)},
          {"a.off", off(ball.V, ball.F)},
          {"a.ply", ply_ascii(ball.V, ball.F)},
          {"b.ply", ply_binary(ball.V, ball.F, false)},
          {"c.ply", ply_binary(ball.V, ball.F, true)},
          {"a.stl", stl_ascii(ball.V, ball.F)},
          {"b.stl", stl_binary(ball.V, ball.F)},
          {"a.glb", glb}};
}

}  // namespace crosspatch::files
