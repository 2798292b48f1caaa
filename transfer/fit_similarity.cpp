#include "transfer/fit_similarity.hpp"

#include <Eigen/SVD>
#include <cmath>

namespace crosspatch {

Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}

void PairMoments::add(double weight, const Vector3d& from, const Vector3d& to) {
  weight_ += weight;
  from_ += weight * from;
  to_ += weight * to;
  from_squared_ += weight * from.squaredNorm();
  to_squared_ += weight * to.squaredNorm();
  product_ += weight * to * from.transpose();
}

Similarity PairMoments::fit(const Similarity& guess, double share) const {
  if (!(weight_ > 0)) return guess;
  const Vector3d from = from_ / weight_, to = to_ / weight_;
  const double from_spread = from_squared_ / weight_ - from.squaredNorm();
  const double to_spread = to_squared_ / weight_ - to.squaredNorm();
  // Spreads below it, relative to the places, are rounding.
  constexpr double kNone = 1e-12;
  if (!(from_spread > kNone * from_squared_ / weight_) ||
      !(to_spread > kNone * to_squared_ / weight_))
    return {guess.scale, guess.turn, to - guess.scale * (guess.turn * from)};
  Similarity fitted;
  const Eigen::Matrix3d moments =
      (product_ / weight_ - to * from.transpose()) / std::sqrt(from_spread * to_spread);
  fitted.turn = nearest_turn(moments + share * guess.turn);
  fitted.scale = std::sqrt(to_spread / from_spread);
  fitted.move = to - fitted.scale * (fitted.turn * from);
  return fitted;
}

}  // namespace crosspatch
