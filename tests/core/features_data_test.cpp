#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "core/candidates.hpp"
#include "core/prepare.hpp"
#include "core/read_soup.hpp"
#include "data_folder.hpp"

namespace crosspatch {
namespace {

class FeaturesData : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = data_folder();
    if (!folder) GTEST_SKIP() << "no data folder: set CROSSPATCH_DATA";
    folder_ = *folder;
  }

  struct Shape {
    TriangleMesh mesh;
    ShapeFeatures features;
    std::vector<int> mesh_vertex;  ///< per file vertex
  };

  const Shape& shape(const std::string& file) {
    const auto [it, fresh] = shapes_.try_emplace(file);
    if (fresh) {
      const PreparedMesh prepared = prepare(read_soup(folder_ / file).value()).value();
      it->second = {
          prepared.mesh, compute_features(prepared.mesh).value(), prepared.numbering.mesh_vertex};
    }
    return it->second;
  }

  /// "minima/saddles/maxima" of log ADF at persistence 0.02.
  std::string canonical_counts(const std::string& file) {
    const Shape& s = shape(file);
    const auto complex =
        morse_smale_complex(s.mesh, s.features.log_adf, {.scale = FieldScale::kLinear}).value();
    EXPECT_TRUE(validate(complex, euler_characteristic(s.mesh))) << file;
    return std::to_string(complex.count(NodeKind::kMinimum)) + "/" +
           std::to_string(complex.count(NodeKind::kSaddle)) + "/" +
           std::to_string(complex.count(NodeKind::kMaximum));
  }

  /// Source tip -> target tip by the pairs of vertices in file `gt`, -1 where no target tip is
  /// within 0.25 sqrt(area) of the place.
  std::vector<int> true_partners(const Shape& a, const Shape& b, const std::string& gt) {
    std::vector<std::pair<int, int>> pairs;
    std::ifstream in(folder_ / gt);
    for (int s = 0, t = 0; in >> s >> t;)
      pairs.emplace_back(a.mesh_vertex[static_cast<size_t>(s)],
                         b.mesh_vertex[static_cast<size_t>(t)]);
    std::vector<int> partners;
    for (Eigen::Index i = 0; i < a.features.tip_distances.cols(); ++i) {
      const auto nearest = std::min_element(pairs.begin(), pairs.end(), [&](auto& p, auto& q) {
        return a.features.tip_distances(p.first, i) < a.features.tip_distances(q.first, i);
      });
      Eigen::Index tip = 0;
      const double distance = b.features.tip_distances.row(nearest->second).minCoeff(&tip);
      partners.push_back(distance < 0.25 ? static_cast<int>(tip) : -1);
    }
    return partners;
  }

  std::filesystem::path folder_;
  std::map<std::string, Shape> shapes_;
};

TEST_F(FeaturesData, HumansHaveFiveTipsAndCatsSix) {
  for (const char* name : {"000", "004", "009", "013", "018"})
    EXPECT_EQ(canonical_counts("faust5k/tr_reg_" + std::string(name) + ".off"), "1/4/5") << name;
  for (int i = 0; i <= 10; i += 2)
    EXPECT_EQ(canonical_counts("tosca5k/cat" + std::to_string(i) + ".off"), "1/5/6") << i;
  for (const char* name : {"gorilla_01", "man_01", "woman_01"})
    EXPECT_EQ(canonical_counts("toscaNI5k/8_" + std::string(name) + ".off"), "1/4/5") << name;
}

TEST_F(FeaturesData, TheTruthIsAmongTheProposals) {
  std::ifstream in(folder_ / "pairs.csv");
  std::map<std::string, int> tried, found;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const std::string set = cells[1].substr(0, cells[1].find('/'));
    if (cells.size() < 5 || cells[3] != "dense" || (set != "faust5k" && set != "tosca5k") ||
        tried[set] == 8)
      continue;
    const Shape &a = shape(cells[1]), &b = shape(cells[2]);
    const std::vector<int> truth = true_partners(a, b, cells[4]);
    const auto list = propose(tip_descriptors(a.features), tip_descriptors(b.features));
    ++tried[set];
    found[set] += std::any_of(list.begin(), list.end(), [&](const TipAssignment& assignment) {
      return std::all_of(assignment.pairs.begin(), assignment.pairs.end(), [&](const auto& pair) {
        return truth[static_cast<size_t>(pair.first)] == pair.second;
      });
    });
  }
  EXPECT_EQ(tried["faust5k"], 8);
  EXPECT_EQ(tried["tosca5k"], 8);
  EXPECT_EQ(found, tried);
}

}  // namespace
}  // namespace crosspatch
