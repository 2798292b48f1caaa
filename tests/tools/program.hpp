#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "core/mesh.hpp"

namespace crosspatch::test {

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What a run of the program left behind.
struct Outcome {
  int exit_code = -1;  ///< 128 + signal when a signal ended it
  std::string out;
  std::string err;

  /// The lines on standard error that tell of errors.
  [[nodiscard]] std::vector<std::string> errors() const {
    std::vector<std::string> lines;
    std::istringstream stream(err);
    for (std::string line; std::getline(stream, line);)
      if (line.starts_with("crosspatch: error: ")) lines.push_back(line);
    return lines;
  }
};

/// A folder of its own, removed at the end, in which the built program is run.
class Program : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::temp_directory_path() /
             (std::string("crosspatch_") + info->name() + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder / "out");
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  /// Runs `crosspatch ARGUMENTS` through the shell, in the folder.
  Outcome run(const std::string& arguments) const {
    const std::string command = "cd '" + folder.string() + "' && '" CROSSPATCH_PROGRAM "' " +
                                arguments + " >stdout.txt 2>stderr.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            read_text(folder / "stdout.txt"),
            read_text(folder / "stderr.txt")};
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  void write_off(const std::string& name, const TriangleMesh& mesh) const {
    std::ofstream file(folder / name);
    file.precision(17);
    file << "OFF\n" << mesh.vertex_count() << ' ' << mesh.face_count() << " 0\n";
    for (const auto& p : mesh.V.rowwise()) file << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    for (const auto& f : mesh.F.rowwise())
      file << "3 " << f[0] << ' ' << f[1] << ' ' << f[2] << '\n';
  }

  /// Everything in the folder `out`, where the tests let the program write.
  std::vector<std::string> written() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "out"))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  /// The run ends with the code, one error line that holds `part`, and nothing written.
  void expect_error(const std::string& arguments, int code, const std::string& part) const {
    const Outcome done = run(arguments);
    EXPECT_EQ(done.exit_code, code) << arguments << "\n" << done.err;
    ASSERT_EQ(done.errors().size(), 1u) << arguments << "\n" << done.err;
    EXPECT_NE(done.errors()[0].find(part), std::string::npos) << done.errors()[0];
    EXPECT_TRUE(done.err.ends_with(done.errors()[0] + "\n")) << "the error line is the last one";
    EXPECT_EQ(done.out, "");
    EXPECT_TRUE(written().empty()) << arguments;
  }

  std::filesystem::path folder;
};

}  // namespace crosspatch::test
