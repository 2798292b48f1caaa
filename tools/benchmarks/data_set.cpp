#include "tools/benchmarks/data_set.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <regex>
#include <sstream>

#include "tools/input.hpp"

namespace crosspatch {
namespace {

using std::size_t;

/// Cells up to the last that is used here; the notes behind them may hold commas.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  return cells;
}

std::string set_of(const std::string& id) {
  static const std::regex pattern("^(s07_[a-z]+|[A-Za-z0-9]+(_r)?)_.*");
  std::smatch match;
  return std::regex_match(id, match, pattern) ? match[1].str() : id;
}

}  // namespace

std::filesystem::path default_data_folder() {
  const char* named = std::getenv("CROSSPATCH_DATA");
  return named != nullptr ? named : "../shared/data";
}

Result<std::vector<DataPair>> read_data_pairs(const std::filesystem::path& folder) {
  const std::string path = (folder / "pairs.csv").string();
  const Result<std::string> text = read_input_text(path);
  if (!text) return tl::unexpected(text.error());
  std::vector<DataPair> pairs;
  std::istringstream lines(*text);
  std::string line;
  std::getline(lines, line);  // the header
  for (int number = 2; std::getline(lines, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() < 6)
      return fail(ErrorCode::kBadInput,
                  fmt::format("{}: line {}: {} cells, 6 are needed", path, number, cells.size()));
    const auto file = [&](const std::string& cell) {
      return cell.empty() ? "" : (folder / cell).string();
    };
    pairs.push_back({cells[0],
                     set_of(cells[0]),
                     file(cells[1]),
                     file(cells[2]),
                     cells[3],
                     file(cells[4]),
                     file(cells[5])});
  }
  return pairs;
}

std::vector<DataPair> pairs_of_set(const std::vector<DataPair>& pairs,
                                   const std::string& set,
                                   int limit) {
  std::vector<DataPair> all, chosen;
  for (const DataPair& pair : pairs)
    if (pair.set == set) all.push_back(pair);
  const int count = static_cast<int>(all.size());
  if (limit <= 0 || limit >= count) return all;
  for (int i = 0; i < limit; ++i)
    chosen.push_back(all[static_cast<size_t>(
        limit > 1 ? std::lround(static_cast<double>(i) * (count - 1) / (limit - 1)) : 0)]);
  return chosen;
}

}  // namespace crosspatch
