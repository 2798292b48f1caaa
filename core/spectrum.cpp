#include "core/spectrum.hpp"

#include <Spectra/SymEigsShiftSolver.h>
#include <fmt/format.h>

#include <Eigen/CholmodSupport>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <functional>
#include <memory>

#include "core/blas.hpp"

namespace crosspatch {
namespace {

/// Shift below the spectrum, so that L - shift M is positive definite; eigenvalues of a surface of
/// area 1 start near 10.
constexpr double kShift = -1e-2;

/// Spectra's operator y = D (L - shift D^2)^-1 D x with D = sqrt(M): the symmetric form of the
/// generalized problem with a diagonal mass, which spares the products with M inside Lanczos.
class ShiftedInverse {
 public:
  using Scalar = double;
  using Solve = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

  ShiftedInverse(Eigen::VectorXd root_mass, Solve solve)
      : root_mass_(std::move(root_mass)), solve_(std::move(solve)) {}

  [[nodiscard]] Eigen::Index rows() const { return root_mass_.size(); }
  [[nodiscard]] Eigen::Index cols() const { return root_mass_.size(); }
  void set_shift(double) {}  // the factor is made for kShift before

  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Eigen::VectorXd> x(in, rows());
    Eigen::Map<Eigen::VectorXd>(out, rows()) =
        root_mass_.cwiseProduct(solve_(root_mass_.cwiseProduct(x)));
  }

 private:
  Eigen::VectorXd root_mass_;
  Solve solve_;
};

template <class Factor>
Result<ShiftedInverse::Solve> make_solver(const SparseMatrix& A) {
  auto factor = std::make_shared<Factor>();
  if constexpr (std::is_same_v<Factor, Eigen::CholmodSupernodalLLT<SparseMatrix>>)
    factor->cholmod().print = 0;
  factor->compute(A);
  if (factor->info() != Eigen::Success)
    return fail(ErrorCode::kNumerical,
                fmt::format("Laplacian: Cholesky factorization of {} unknowns failed", A.rows()));
  return [factor](const Eigen::VectorXd& b) -> Eigen::VectorXd { return factor->solve(b); };
}

/// Eigenpairs of D^-1 L D^-1 by a dense solver, for meshes of about as many vertices as pairs.
Status solve_dense(const Laplacian& laplacian, const Eigen::VectorXd& root_mass, Spectrum& out) {
  const Eigen::MatrixXd A = root_mass.cwiseInverse().asDiagonal() * Eigen::MatrixXd(laplacian.L) *
                            root_mass.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(A);
  if (solver.info() != Eigen::Success)
    return fail(ErrorCode::kNumerical, "spectrum: the dense eigensolver did not converge");
  out.values = solver.eigenvalues().head(out.values.size());
  out.functions = solver.eigenvectors().leftCols(out.values.size());
  return {};
}

Status solve_lanczos(const Laplacian& laplacian,
                     const Eigen::VectorXd& root_mass,
                     const SpectrumOptions& options,
                     Spectrum& out) {
  const int n = static_cast<int>(root_mass.size()), k = static_cast<int>(out.values.size());
  SparseMatrix A = laplacian.L;
  A.diagonal() -= kShift * out.mass;
  const auto solve = n > options.supernodal_from
                         ? make_solver<Eigen::CholmodSupernodalLLT<SparseMatrix>>(A)
                         : make_solver<Eigen::SimplicialLDLT<SparseMatrix>>(A);
  if (!solve) return tl::unexpected(solve.error());
  ShiftedInverse inverse(root_mass, *solve);
  const int subspace = std::min(n, 2 * k + 20);
  Spectra::SymEigsShiftSolver<ShiftedInverse> solver(inverse, k, subspace, kShift);
  solver.init();  // from Spectra's own fixed seed
  constexpr int kRestarts = 300;
  const auto converged = solver.compute(Spectra::SortRule::LargestMagn,
                                        kRestarts,
                                        options.tolerance,
                                        Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful)
    return fail(ErrorCode::kNumerical,
                fmt::format("spectrum: {} of {} eigenpairs converged", converged, k));
  out.values = solver.eigenvalues();
  out.functions = solver.eigenvectors();
  return {};
}

/// Invariant (4): eigenfunctions are known up to sign only.
void fix_sign(Eigen::Ref<Eigen::VectorXd> function) {
  const double bound = function.cwiseAbs().maxCoeff() * (1 - 1e-6);
  for (Eigen::Index i = 0; i < function.size(); ++i) {
    if (std::abs(function[i]) < bound) continue;
    if (function[i] < 0) function = -function;
    return;
  }
}

double largest_residual(const Laplacian& laplacian, const Spectrum& spectrum) {
  const Eigen::VectorXd inverse_root = spectrum.mass.cwiseSqrt().cwiseInverse();
  double largest = 0;
  for (int i = 0; i < spectrum.count(); ++i) {
    const Eigen::VectorXd r =
        laplacian.L * spectrum.functions.col(i) -
        spectrum.values[i] * spectrum.mass.cwiseProduct(spectrum.functions.col(i));
    largest = std::max(largest, inverse_root.cwiseProduct(r).norm() / (1 + spectrum.values[i]));
  }
  return largest;
}

}  // namespace

Result<Spectrum> compute_spectrum(const TriangleMesh& mesh, const SpectrumOptions& options) {
  const auto laplacian = compute_laplacian(mesh, options.laplacian);
  if (!laplacian) return tl::unexpected(laplacian.error());
  const SingleThreadedBlas pinned;
  const int k = std::min(options.count, mesh.vertex_count());
  Spectrum result{Eigen::VectorXd(k), {}, laplacian->mass / laplacian->mass.sum(), 0};
  const Eigen::VectorXd root_mass = result.mass.cwiseSqrt();
  const Status solved = mesh.vertex_count() < 3 * k + 30
                            ? solve_dense(*laplacian, root_mass, result)
                            : solve_lanczos(*laplacian, root_mass, options, result);
  if (!solved) return tl::unexpected(solved.error());
  for (int i = 0; i < k; ++i) {
    result.functions.col(i).array() /= root_mass.array();
    fix_sign(result.functions.col(i));
  }
  result.values[0] = std::max(0.0, result.values[0]);
  // A surface of area 1 would need a neck of about 1e-6 to come this low.
  constexpr double kConnected = 1e-7;
  if (k > 1 && !(result.values[1] > kConnected))
    return fail(ErrorCode::kBadInput,
                fmt::format("spectrum: second eigenvalue {} is not above {}: the surface is not "
                            "connected",
                            result.values[1],
                            kConnected));
  result.residual = largest_residual(*laplacian, result);
  return result;
}

Status validate(const Spectrum& spectrum) {
  const int k = spectrum.count();
  if (spectrum.functions.cols() != k || spectrum.functions.rows() != spectrum.mass.size())
    return fail(ErrorCode::kInternal, "spectrum: sizes differ");
  for (int i = 1; i < k; ++i)
    if (!(spectrum.values[i] >= spectrum.values[i - 1]))
      return fail(ErrorCode::kInternal, fmt::format("spectrum: value {} is out of order", i));
  if (std::abs(spectrum.mass.sum() - 1) > 1e-9)
    return fail(ErrorCode::kInternal,
                fmt::format("spectrum: mass sums to {}, not 1", spectrum.mass.sum()));
  const Eigen::MatrixXd gram =
      spectrum.functions.transpose() * spectrum.mass.asDiagonal() * spectrum.functions;
  const double error = (gram - Eigen::MatrixXd::Identity(k, k)).cwiseAbs().maxCoeff();
  constexpr double kOrthonormality = 1e-8;
  if (!(error < kOrthonormality))
    return fail(
        ErrorCode::kInternal,
        fmt::format("spectrum: orthonormality error {} is above {}", error, kOrthonormality));
  return {};
}

}  // namespace crosspatch
