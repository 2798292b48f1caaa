#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/prepare.hpp"
#include "tools/progress.hpp"

namespace crosspatch {

/// What an input file holds and what became of it.
struct InputSummary {
  std::string role;  ///< "mesh", "source", "target"
  std::string path;
  std::map<std::string, double> counts;  ///< vertices, polygons, triangles, ...; area in file units
  std::vector<std::string> notes;        ///< what the reader passed over
  std::vector<std::string> repairs;      ///< what was changed to make a mesh of it
};

/// Summary of a soup, and of the mesh made of it where there is one.
InputSummary summarize(const std::string& role, const std::string& path, const PolygonSoup& soup);
InputSummary summarize(const std::string& role,
                       const std::string& path,
                       const PolygonSoup& soup,
                       const PreparedMesh& prepared);

/// What a run tells about itself, beside its results.
struct RunReport {
  std::string command{};
  std::vector<InputSummary> inputs{};
  std::vector<std::string> other_inputs{};       ///< further files read: landmarks, maps
  std::map<std::string, std::string> options{};  ///< as they were in force
  std::vector<StageRecord> stages{};
  std::map<std::string, double> quality{};
  std::vector<std::string> warnings{};
  std::vector<std::string> outputs{};
  int exit_code = 0;
};

/// The version of the layout of report_json. It grows when a field changes its meaning or goes;
/// new fields do not change it.
constexpr int kReportVersion = 1;

/// The report as JSON text. Inputs are listed with size and SHA-256, read anew from disk: null for
/// a file that cannot be read any more.
std::string report_json(const RunReport& report);

/// An input's summary for people: one thing a line.
std::string summary_text(const InputSummary& summary);

}  // namespace crosspatch
