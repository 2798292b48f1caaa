#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace crosspatch {

/// A pair of the data set that benchmarks run on, a row of its `pairs.csv`.
struct DataPair {
  std::string id;
  std::string set;  ///< the id up to the names of the two: "faust5k", "s07_human", ...
  std::string source;
  std::string target;
  std::string truth_kind;      ///< "landmarks", "dense" and others
  std::string truth;           ///< file of the true correspondence; empty = none
  std::string mirrored_truth;  ///< the same with left and right exchanged; empty = none
};

/// $CROSSPATCH_DATA, else ../shared/data of the working directory.
std::filesystem::path default_data_folder();

/// All rows of `pairs.csv` in the folder, with paths that lead there. kBadInput if it cannot be
/// read or a row lacks a cell.
Result<std::vector<DataPair>> read_data_pairs(const std::filesystem::path& folder);

/// The pairs of a set; of more than `limit` (0 = all) so many, spread evenly over it.
std::vector<DataPair> pairs_of_set(const std::vector<DataPair>& pairs,
                                   const std::string& set,
                                   int limit);

}  // namespace crosspatch
