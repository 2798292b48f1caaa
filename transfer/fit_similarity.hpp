#pragma once

#include "core/types.hpp"

namespace crosspatch {

/// x' = move + scale turn x.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector3d move = Vector3d::Zero();

  [[nodiscard]] Vector3d operator()(const Vector3d& x) const { return move + scale * (turn * x); }
};

/// Weighted pairs of points, gathered one by one.
class PairMoments {
 public:
  void add(double weight, const Vector3d& from, const Vector3d& to);

  /// The similarity that carries `from` to `to` best: Umeyama 1991, but with the ratio of the
  /// spreads as scale, so that the inverse fits the inverse.
  [[nodiscard]] Similarity fit() const { return fit({}, 0); }

  /// The same of points that may lie in a plane or a line: `guess` turns what they leave open, and
  /// counts for a little elsewhere; without points it is the result.
  [[nodiscard]] Similarity fit(const Similarity& guess) const { return fit(guess, kGuess); }

  [[nodiscard]] double weight() const { return weight_; }

 private:
  /// Ours: rings around limbs are nearly flat and nearly round, and what they leave open should not
  /// be rounding.
  static constexpr double kGuess = 0.05;
  [[nodiscard]] Similarity fit(const Similarity& guess, double share) const;

  double weight_ = 0;
  Vector3d from_ = Vector3d::Zero(), to_ = Vector3d::Zero();
  double from_squared_ = 0, to_squared_ = 0;
  Eigen::Matrix3d product_ = Eigen::Matrix3d::Zero();  ///< to from^T
};

/// The turn nearest to a matrix: its polar factor.
Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& matrix);

}  // namespace crosspatch
