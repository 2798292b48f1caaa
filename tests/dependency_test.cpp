// The arrow core <- param <- transfer <- tools, and where each third-party library may be named.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file;    ///< relative to the root
  std::string header;  ///< as written between the quotes or brackets
};

const std::vector<std::string> kLayers{"core", "param", "transfer", "tools"};

std::vector<Include> includes_of(const std::string& layer) {
  const fs::path root(CROSSPATCH_ROOT);
  const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(root / layer)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".cpp" && extension != ".hpp" && extension != ".in") continue;
    std::ifstream file(entry.path());
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_search(line, match, pattern))
        found.push_back({fs::relative(entry.path(), root).string(), match[1]});
  }
  return found;
}

/// Place in the arrow of a header of ours, or -1 for a library's.
int layer_of(const std::string& header) {
  for (std::size_t i = 0; i < kLayers.size(); ++i)
    if (header.starts_with(kLayers[i] + "/")) return static_cast<int>(i);
  return -1;
}

TEST(Dependencies, PointOneWay) {
  for (std::size_t i = 0; i < kLayers.size(); ++i) {
    const auto includes = includes_of(kLayers[i]);
    EXPECT_FALSE(includes.empty()) << kLayers[i] << ": no includes were found";
    for (const Include& include : includes) {
      EXPECT_LE(layer_of(include.header), static_cast<int>(i))
          << include.file << " includes " << include.header;
      EXPECT_FALSE(include.header.starts_with("tests/") || include.header.starts_with("../"))
          << include.file << " includes " << include.header;
    }
  }
}

TEST(Dependencies, LibrariesStayInTheirLayers) {
  struct Rule {
    std::string prefix;
    std::vector<std::string> layers;
    bool sources_only;  ///< not in headers, so that users of a layer need not have the library
  };
  const std::array<Rule, 6> rules{{{"OpenMesh/", {"core"}, true},
                                   {"Spectra/", {"core"}, true},
                                   {"ceres/", {"param"}, true},
                                   {"tiny_gltf.h", {"transfer"}, true},
                                   {"OpenImageIO/", {"transfer", "tools"}, true},
                                   {"CLI/", {"tools"}, true}}};
  for (const std::string& layer : kLayers)
    for (const Include& include : includes_of(layer))
      for (const Rule& rule : rules) {
        if (!include.header.starts_with(rule.prefix)) continue;
        EXPECT_NE(std::find(rule.layers.begin(), rule.layers.end(), layer), rule.layers.end())
            << include.file << " includes " << include.header;
        EXPECT_TRUE(!rule.sources_only || include.file.ends_with(".cpp"))
            << include.file << " includes " << include.header;
      }
}

TEST(Dependencies, SamplesHoldNoCode) {
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(CROSSPATCH_ROOT) / "samples")) {
    const std::string extension = entry.path().extension().string();
    EXPECT_FALSE(extension == ".cpp" || extension == ".hpp" || extension == ".py")
        << entry.path().string();
  }
}

}  // namespace
