#include "core/assignment.hpp"

#include <limits>

#include "core/index.hpp"

namespace crosspatch {
namespace {

/// Dual prices and the partial assignment of a cost matrix with no more rows than columns.
struct Prices {
  Eigen::VectorXd row, column;
  std::vector<int> row_of;  ///< per column, -1 = free
};

/// Assigns row `start` too: grows the tree of cheapest alternating paths until a free column is
/// reached, keeping all reduced costs cost - row - column non-negative.
void augment(const Eigen::MatrixXd& cost, int start, Prices& prices) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto columns = static_cast<int>(cost.cols());
  Eigen::VectorXd slack = Eigen::VectorXd::Constant(columns, kInfinity);
  std::vector<int> from(idx(columns), -1);  // the column before in the tree, -1 = start
  std::vector<bool> in_tree(idx(columns), false);
  int row = start, last = -1;
  while (true) {
    int nearest = -1;
    for (int j = 0; j < columns; ++j) {
      if (in_tree[idx(j)]) continue;
      const double reduced = cost(row, j) - prices.row[row] - prices.column[j];
      if (reduced < slack[j]) {
        slack[j] = reduced;
        from[idx(j)] = last;
      }
      if (nearest < 0 || slack[j] < slack[nearest]) nearest = j;
    }
    const double delta = slack[nearest];
    prices.row[start] += delta;
    for (int j = 0; j < columns; ++j) {
      if (!in_tree[idx(j)]) {
        slack[j] -= delta;
        continue;
      }
      prices.row[prices.row_of[idx(j)]] += delta;
      prices.column[j] -= delta;
    }
    in_tree[idx(nearest)] = true;
    last = nearest;
    if (prices.row_of[idx(nearest)] < 0) break;
    row = prices.row_of[idx(nearest)];
  }
  for (int j = last; j >= 0; j = from[idx(j)])
    prices.row_of[idx(j)] = from[idx(j)] < 0 ? start : prices.row_of[idx(from[idx(j)])];
}

}  // namespace

std::vector<int> least_cost_assignment(const Eigen::MatrixXd& cost) {
  const bool wide = cost.rows() <= cost.cols();
  const Eigen::MatrixXd C = wide ? cost : Eigen::MatrixXd(cost.transpose());
  Prices prices{Eigen::VectorXd::Zero(C.rows()),
                Eigen::VectorXd::Zero(C.cols()),
                std::vector<int>(idx(C.cols()), -1)};
  for (int i = 0; i < C.rows(); ++i) augment(C, i, prices);
  if (!wide) return prices.row_of;
  std::vector<int> column_of(idx(C.rows()), -1);
  for (int j = 0; j < C.cols(); ++j)
    if (prices.row_of[idx(j)] >= 0) column_of[idx(prices.row_of[idx(j)])] = j;
  return column_of;
}

}  // namespace crosspatch
