// make_samples FOLDER [TIMES TEXELS]: writes the sample meshes and textures. The same bytes on
// every run. TIMES as many triangles, TEXELS a side of the textures.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include "core/index.hpp"
#include "tools/image_io.hpp"
#include "tools/samples/coat.hpp"
#include "tools/samples/letters.hpp"

namespace crosspatch {
namespace {

struct Sample {
  Creature creature;
  double edge = 0;  ///< about the mean edge length
  const CoatColors* coat = nullptr;
};

/// How fine the samples are made.
struct Detail {
  int times = 1;  ///< as many triangles as those in samples/
  int texels = 512;
};

/// Four decimals: a tenth of a millimetre on a creature two metres long.
std::string vertex_lines(const TriangleMesh& mesh) {
  std::string out;
  for (int v = 0; v < mesh.vertex_count(); ++v)
    out += fmt::format("v {:.4f} {:.4f} {:.4f}\n", mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2));
  return out;
}

std::string plain_obj(const TriangleMesh& mesh) {
  std::string out = "# made by crosspatch's make_samples\n" + vertex_lines(mesh);
  for (int f = 0; f < mesh.face_count(); ++f)
    out += fmt::format("f {} {} {}\n", mesh.F(f, 0) + 1, mesh.F(f, 1) + 1, mesh.F(f, 2) + 1);
  return out;
}

/// Corners that share vertex and chart share a `vt`; OBJ's v runs upwards.
std::string textured_obj(const std::string& name, const TriangleMesh& mesh, const Atlas& atlas) {
  std::string out = "# made by crosspatch's make_samples\nmtllib " + name + ".mtl\n";
  out += vertex_lines(mesh);
  std::map<std::pair<int, int>, int> number;
  std::vector<int> vt;
  for (int h = 0; h < mesh.halfedge_count(); ++h) {
    const auto [entry, fresh] = number.try_emplace({mesh.from(h), atlas.chart[idx(face_of(h))]},
                                                   static_cast<int>(number.size()) + 1);
    if (fresh)
      out += fmt::format(
          "vt {:.5f} {:.5f}\n", atlas.pixel(h, 0) / atlas.size, 1 - atlas.pixel(h, 1) / atlas.size);
    vt.push_back(entry->second);
  }
  out += "usemtl coat\n";
  for (int f = 0; f < mesh.face_count(); ++f) {
    out += "f";
    for (int k = 0; k < 3; ++k) out += fmt::format(" {}/{}", mesh.F(f, k) + 1, vt[idx(3 * f + k)]);
    out += "\n";
  }
  return out;
}

Status write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return fail(ErrorCode::kOutput, path + ": cannot be written");
  return {};
}

Status write_png(const std::string& path, const CoatImage& image) {
  const auto output = OIIO::ImageOutput::create(path);
  OIIO::ImageSpec spec(image.size, image.size, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("png:compressionLevel", 9);
  if (!output || !output->open(path, spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, image.rgb.data()) || !output->close())
    return fail(ErrorCode::kOutput, path + ": cannot be written");
  return {};
}

Status write_material(const std::string& folder, const std::string& stem, const std::string& name) {
  return write_text(folder + "/" + stem + ".mtl",
                    fmt::format("# made by crosspatch's make_samples\nnewmtl {}\nKd 1 1 1\n"
                                "map_Kd {}.png\n",
                                name,
                                stem));
}

Status write_letters(const std::string& folder) {
  const LetterBox box = make_letter_box();
  if (Status s = write_text(folder + "/letters.obj", box.obj); !s) return s;
  if (Status s = write_material(folder, "letters", "letters"); !s) return s;
  const auto png = encode_png(box.image);
  if (!png) return tl::unexpected(png.error());
  return write_text(folder + "/letters.png", std::string(png->begin(), png->end()));
}

Status write_sample(const std::string& folder, const Sample& sample, const Detail& detail) {
  const std::string& name = sample.creature.name;
  const std::string stem = folder + "/" + name;
  const auto mesh = skin_mesh(sample.creature, sample.edge / std::sqrt(detail.times));
  if (!mesh) return tl::unexpected(mesh.error());
  if (sample.coat == nullptr) return write_text(stem + ".obj", plain_obj(*mesh));
  const Atlas atlas = make_atlas(sample.creature, *mesh, detail.texels);
  if (Status s = write_text(stem + ".obj", textured_obj(name, *mesh, atlas)); !s) return s;
  if (Status s = write_material(folder, name, "coat"); !s) return s;
  return write_png(stem + ".png", paint_coat(sample.creature, *sample.coat, *mesh, atlas));
}

Status write_all(const std::string& folder, const Detail& detail) {
  const CoatColors lira = lira_colors(), bodo = bodo_colors();
  for (const Sample& sample : {Sample{make_lira(), 0.043, &lira},
                               Sample{make_bodo(), 0.050, &bodo},
                               Sample{make_tola(), 0.048, nullptr}})
    if (Status s = write_sample(folder, sample, detail); !s) return s;
  return write_letters(folder);
}

/// A whole number from 1 to `most`.
std::optional<int> parse_count(const char* text, int most) {
  int value = 0;
  const char* end = text + std::strlen(text);
  const auto parsed = std::from_chars(text, end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || value < 1 || value > most)
    return std::nullopt;
  return value;
}

}  // namespace
}  // namespace crosspatch

int main(int argc, char** argv) {
  constexpr int kMostTimes = 100, kMostTexels = 16384;
  const bool detailed = argc == 4;
  const auto times = detailed ? crosspatch::parse_count(argv[2], kMostTimes) : 1;
  const auto texels = detailed ? crosspatch::parse_count(argv[3], kMostTexels) : 512;
  if ((argc != 2 && !detailed) || !times || !texels) {
    fmt::print(stderr,
               "usage: make_samples FOLDER [TIMES TEXELS], up to {} and {}\n",
               kMostTimes,
               kMostTexels);
    return 2;
  }
  if (const crosspatch::Status s = crosspatch::write_all(argv[1], {*times, *texels}); !s) {
    fmt::print(stderr, "make_samples: {}\n", s.error().message);
    return 5;
  }
  return 0;
}
