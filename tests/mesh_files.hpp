#pragma once

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "core/mesh.hpp"

// Mesh and image files as text or bytes, for reader tests.
namespace crosspatch::files {

inline std::string obj(const MatrixX3d& V, const MatrixX3i& F) {
  std::string out;
  for (int v = 0; v < V.rows(); ++v) out += fmt::format("v {} {} {}\n", V(v, 0), V(v, 1), V(v, 2));
  for (int f = 0; f < F.rows(); ++f)
    out += fmt::format("f {} {} {}\n", F(f, 0) + 1, F(f, 1) + 1, F(f, 2) + 1);
  return out;
}

inline std::string off(const MatrixX3d& V, const MatrixX3i& F) {
  std::string out = fmt::format("OFF\n{} {} 0\n", V.rows(), F.rows());
  for (int v = 0; v < V.rows(); ++v) out += fmt::format("{} {} {}\n", V(v, 0), V(v, 1), V(v, 2));
  for (int f = 0; f < F.rows(); ++f) out += fmt::format("3 {} {} {}\n", F(f, 0), F(f, 1), F(f, 2));
  return out;
}

inline std::string ply_header(const std::string& format, long long vertices, long long faces) {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment made by a test\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format,
      vertices,
      faces);
}

inline std::string ply_ascii(const MatrixX3d& V, const MatrixX3i& F) {
  std::string out = ply_header("ascii", V.rows(), F.rows());
  for (int v = 0; v < V.rows(); ++v) out += fmt::format("{} {} {}\n", V(v, 0), V(v, 1), V(v, 2));
  for (int f = 0; f < F.rows(); ++f) out += fmt::format("3 {} {} {}\n", F(f, 0), F(f, 1), F(f, 2));
  return out;
}

/// `value`'s bytes, least significant first or last.
template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  std::string out(reinterpret_cast<const char*>(&value), sizeof value);
  return big_endian == (std::endian::native == std::endian::big)
             ? out
             : std::string(out.rbegin(), out.rend());
}

inline std::string ply_binary(const MatrixX3d& V, const MatrixX3i& F, bool big_endian) {
  std::string out =
      ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", V.rows(), F.rows());
  for (int v = 0; v < V.rows(); ++v)
    for (int k = 0; k < 3; ++k) out += bytes_of(V(v, k), big_endian);
  for (int f = 0; f < F.rows(); ++f) {
    out += '\3';
    for (int k = 0; k < 3; ++k) out += bytes_of(std::int32_t{F(f, k)}, big_endian);
  }
  return out;
}

inline std::string stl_ascii(const MatrixX3d& V, const MatrixX3i& F) {
  std::string out = "solid of a test\n";
  for (int f = 0; f < F.rows(); ++f) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (int k = 0; k < 3; ++k)
      out += fmt::format("  vertex {} {} {}\n", V(F(f, k), 0), V(F(f, k), 1), V(F(f, k), 2));
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid of a test\n";
}

inline std::string stl_binary(const MatrixX3d& V, const MatrixX3i& F) {
  std::string out(80, ' ');
  out += bytes_of(static_cast<std::uint32_t>(F.rows()));
  for (int f = 0; f < F.rows(); ++f) {
    out += std::string(12, '\0');
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) out += bytes_of(static_cast<float>(V(F(f, k), j)));
    out += std::string(2, '\0');
  }
  return out;
}

/// The first 33 bytes of a PNG of that size, which is all that header checks see.
inline std::string png_header(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1a\n", 8) + bytes_of(std::uint32_t{13}, true) + "IHDR" +
         bytes_of(width, true) + bytes_of(height, true) + std::string("\x08\x06\0\0\0", 5) + "crc!";
}

/// A JPEG that ends with its frame header.
inline std::string jpeg_header(std::uint16_t width, std::uint16_t height) {
  return std::string("\xff\xd8\xff\xe0\x00\x04xx\xff\xc0\x00\x0b\x08", 13) +
         bytes_of(height, true) + bytes_of(width, true) + std::string("\x01\x01\x11\x00", 4);
}

}  // namespace crosspatch::files
