#pragma once

#include <functional>

#include "core/index.hpp"
#include "transfer/bake_canvas.hpp"
#include "transfer/color_space.hpp"
#include "transfer/image_codec.hpp"
#include "transfer/surfaces.hpp"
#include "transfer/texel_raster.hpp"

namespace crosspatch::shapes {

/// A PNG file of `size` x `size` texels with 8-bit channels given by value(u, v), in [0, 1].
inline ImageFile png(int size,
                     int channels,
                     const std::function<Eigen::Array4d(double, double)>& value) {
  RasterImage image{size, size, channels, {}};
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Eigen::Array4d v = value((x + 0.5) / size, (y + 0.5) / size);
      for (int c = 0; c < channels; ++c)
        image.values.push_back(static_cast<std::uint16_t>(std::lround(v[c] * 255) * 257));
    }
  return image_file("texture", ImageFormat::kPng, *encode_image_file(image));
}

/// Gives the surface the UVs of `unwrap` and an image whose colour, linear, is look(place).
inline void paint(Surface& s,
                  const Unwrap& unwrap,
                  int size,
                  const std::function<Vector3d(const Vector3d&)>& look) {
  const TriangleMesh& mesh = s.prepared.mesh;
  BakeCanvas canvas = make_canvas(size, 3);
  for (int f = 0; f < mesh.face_count(); ++f)
    for_each_texel(
        in_texels(unwrap, f, size), 1e-4, {0, size}, size, [&](int x, int y, const Vector3d& b) {
          const Vector3d color = look(position(mesh, {f, b}));
          for (int k = 0; k < 3; ++k)
            canvas.values[3 * canvas.texel(x, y) + idx(k)] =
                static_cast<std::uint16_t>(std::lround(std::clamp(color[k], 0.0, 1.0) * 65535));
          canvas.state[canvas.texel(x, y)] = kFilled;
        });
  continue_across_seams(canvas, mesh, unwrap, 8);
  push_pull(canvas);
  RasterImage image{size, size, 3, {}};
  for (std::size_t i = 0; i < 3 * canvas.state.size(); ++i)
    image.values.push_back(to_stored(canvas.values[i], ColorSpace::kSrgb));
  texture(
      s, [](int, const Vector3d&) { return Vector2d::Zero(); }, size);
  s.soup.uv_sets.back() = unwrap.uv;
  s.soup.images = {image_file("painted", ImageFormat::kPng, *encode_image_file(image))};
}

}  // namespace crosspatch::shapes
