#pragma once

#include <vector>

#include "core/morse_smale.hpp"
#include "core/signatures.hpp"

namespace crosspatch {

/// An extremity: a maximum of the auto diffusion function (or, with persistence 0, a farthest
/// point).
struct Tip {
  int vertex = -1;
  double persistence = 0;  ///< on log ADF, as a fraction of its range; 1 for the highest maximum
  double log_adf = 0;      ///< value there
};

struct FeatureOptions {
  SpectrumOptions spectrum{};
  AutoDiffusionOptions adf{};
  HeatKernelOptions hks{};
  WaveKernelOptions wks{};
  /// Least persistence of a tip on log ADF. 0.02 lies on the plateau from about .015 to .1 on which
  /// the count of tips agrees over poses and related species (measured on FAUST, TOSCA, SHREC'07).
  double tip_persistence = 0.02;
  /// Least persistence of an extremity that is no tip: fingers and toes of scanned bodies have
  /// 0.004 and more.
  double extremity_persistence = 0.003;
  int max_extremities = 40;  ///< of more the most persistent are kept
  /// Of more tips the most persistent are kept.
  int max_tips = 24;
  /// Fewer tips are filled up, with persistence 0, by vertices farthest from those there are: ours,
  /// because maps through fewer points say little about a surface.
  int least_tips = 4;
};

/// What is computed once of each surface, in units of the surface scaled to area 1.
struct ShapeFeatures {
  Spectrum spectrum;
  Eigen::VectorXd log_adf;              ///< #V, natural logarithm of Eq. (1)
  Eigen::MatrixXd log_hks;              ///< #V x times
  Eigen::MatrixXd wks;                  ///< #V x energies
  Eigen::MatrixXd chirality;            ///< #V x 3, see chirality_fields
  std::vector<Tip> tips;                ///< by falling persistence
  Eigen::MatrixXd tip_distances;        ///< #V x tips, geodesic, divided by sqrt(area)
  std::vector<Tip> extremities;         ///< tips and lesser maxima, by falling persistence
  Eigen::MatrixXd extremity_distances;  ///< #V x extremities, likewise
};

/// Maxima of `log_adf` (#V) of at least `persistence`, by falling persistence (ties by vertex).
/// Errors of discrete_gradient.
Result<std::vector<Tip>> canonical_tips(const TriangleMesh& mesh,
                                        const Eigen::VectorXd& log_adf,
                                        double persistence = 0.02);

/// Computes all fields of ShapeFeatures. kBadInput for a mesh of fewer than 4 vertices; errors of
/// compute_spectrum.
Result<ShapeFeatures> compute_features(const TriangleMesh& mesh,
                                       const FeatureOptions& options = {});

/// The features with `landmarks` (vertices) as the first tips, in their order; of the tips found,
/// those stay that are farther than `clearance` (in sqrt(area)) from every landmark.
ShapeFeatures with_landmarks(const TriangleMesh& mesh,
                             ShapeFeatures features,
                             const std::vector<int>& landmarks,
                             double clearance = 0.08);

}  // namespace crosspatch
