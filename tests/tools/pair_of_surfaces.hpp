#pragma once

#include <fstream>
#include <string>

#include "program.hpp"
#include "shapes.hpp"

namespace crosspatch::test {

/// Two bent ellipsoids with the same triangles, the first with UVs, and landmarks that pair
/// vertices 0 to 3 with themselves.
class PairOfSurfaces : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write_obj("source.obj", egg(1.6));
    write_off("target.off", egg(1.4));
    write("pairs.txt", "0 0\n1 1\n2 2\n3 3\n");
  }

  static TriangleMesh egg(double length) {
    TriangleMesh mesh = shapes::icosphere(3);
    for (auto p : mesh.V.rowwise())
      p = Eigen::RowVector3d(
          length * p.x() + 0.2 * p.y() * p.y(), p.y(), 0.8 * p.z() - 0.1 * p.x());
    return mesh;
  }

  void write_obj(const std::string& name, const TriangleMesh& mesh) const {
    std::ofstream file(folder / name);
    for (const auto& p : mesh.V.rowwise())
      file << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << "\nvt " << (p.x() + 1) / 2 << ' '
           << (p.y() + 1) / 2 << '\n';
    for (const auto& f : mesh.F.rowwise()) {
      file << 'f';
      for (const int v : f) file << ' ' << v + 1 << '/' << v + 1;
      file << '\n';
    }
  }
};

}  // namespace crosspatch::test
