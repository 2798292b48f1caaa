// Times the patch parametrization on square patches with bumps and prints CSV: one line per size
// and boundary, the median of the runs in CPU seconds.
#include "param/parametrize.hpp"

#include <cmath>
#include <cstdio>
#include <vector>

#include "param/tutte.hpp"
#include "tools/benchmarks/timing.hpp"

namespace {

using crosspatch::cpu_seconds;
using crosspatch::MatrixX2d;
using crosspatch::MatrixX3d;
using crosspatch::MatrixX3i;
using crosspatch::median;
using crosspatch::PatchBoundary;
using crosspatch::TriangleMesh;

/// The graph of 0.15 sin 7x sin 9y over an n x n grid on the unit square.
TriangleMesh bumpy_square(int n) {
  MatrixX3d V((n + 1) * (n + 1), 3);
  MatrixX3i F(2 * n * n, 3);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = double(i) / n, y = double(j) / n;
      V.row(j * (n + 1) + i) << x, y, 0.15 * std::sin(7 * x) * std::sin(9 * y);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, f = 2 * (j * n + i);
      F.row(f) << a, a + 1, a + n + 2;
      F.row(f + 1) << a, a + n + 2, a + n + 1;
    }
  return crosspatch::split_chords(crosspatch::make_mesh(V, F).value()).mesh;
}

bool report(int n, PatchBoundary boundary, int stiffening) {
  constexpr int kRuns = 3;
  const TriangleMesh mesh = bumpy_square(n);
  const std::vector<int> loop = crosspatch::boundary_loops(mesh)[0];
  MatrixX2d polygon(static_cast<int>(loop.size()), 2);
  for (int i = 0; i < polygon.rows(); ++i)
    polygon.row(i) = mesh.V.row(loop[static_cast<std::size_t>(i)]).head<2>();
  std::vector<double> tutte_seconds, seconds;
  crosspatch::PatchParametrization result;
  for (int run = 0; run < kRuns; ++run) {
    double start = cpu_seconds();
    const auto uv = crosspatch::tutte_embedding(mesh, loop, polygon);
    tutte_seconds.push_back(cpu_seconds() - start);
    if (!uv) return std::fprintf(stderr, "%s\n", uv.error().message.c_str()), false;
    start = cpu_seconds();
    const auto r =
        crosspatch::parametrize(mesh, *uv, {.boundary = boundary, .stiffening_rounds = stiffening});
    seconds.push_back(cpu_seconds() - start);
    if (!r) return std::fprintf(stderr, "%s\n", r.error().message.c_str()), false;
    result = *r;
  }
  std::printf("%d,%s,%d,%.4f,%.4f,%d,%d,%.6f,%.6f,%.4f,%.4f,%.2f\n",
              mesh.face_count(),
              boundary == PatchBoundary::kFixed     ? "fixed"
              : boundary == PatchBoundary::kSliding ? "sliding"
                                                    : "free",
              stiffening,
              median(tutte_seconds),
              median(seconds),
              result.rounds,
              result.converged ? 1 : 0,
              result.energy_before,
              result.energy_after,
              result.worst_stretch_before,
              result.worst_stretch_after,
              result.largest_stiffness);
  return true;
}

}  // namespace

int main() {
  std::printf(
      "triangles,boundary,stiffening_rounds,tutte_cpu_seconds,cpu_seconds,rounds,converged,energy_"
      "before,"
      "energy_after,worst_before,worst_after,largest_stiffness\n");
  bool good = true;
  for (const int n : {32, 70, 158})
    for (const PatchBoundary boundary :
         {PatchBoundary::kFixed, PatchBoundary::kSliding, PatchBoundary::kFree})
      for (const int stiffening : {0, 6}) good = report(n, boundary, stiffening) && good;
  return good ? 0 : 1;
}
