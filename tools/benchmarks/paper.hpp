#pragma once

#include <string>

#include "tools/benchmarks/picture.hpp"

namespace crosspatch {

struct PaperArguments {
  int figure = 8;
  std::string data = default_data_folder().string();
  std::string samples = "samples";
  std::string output;  ///< folder for pictures; empty = none
  int limit = 4;       ///< pairs of a set at most; 0 = all
  int threads = 1;
};

/// How a figure varies the matcher.
struct Variant {
  std::string name;
  SpectralMatchingOptions options;
};

/// The columns that describe a matching: matched,within_10,within_25.
std::string columns(const JudgedMatching& judged);

/// The node of `shape` of the kind of node `i` of `null` nearest to its place (vertex numbers are
/// shared), or -1 if none is within 0.1 sqrt(area).
int same_node(const SparseShape& null, const SparseShape& shape, int i);

/// Writes the sheet of a figure, where pictures are wanted.
Status finish_sheet(const PaperArguments& arguments, const PictureSheet& sheet, int columns_wide);

/// Fig. 11: one shape against a sequence that departs from it, and what becomes of the matrix M,
/// taken over the true partners of those nodes that all steps have.
Status figure_11(const PaperArguments& arguments);

}  // namespace crosspatch
