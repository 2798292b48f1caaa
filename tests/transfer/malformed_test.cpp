#include "malformed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/prepare.hpp"
#include "temp_folder.hpp"
#include "transfer/read_mesh_file.hpp"

namespace crosspatch {
namespace {

Result<PreparedMesh> load(const std::filesystem::path& path) {
  const auto soup = read_mesh_file(path);
  if (!soup) return tl::unexpected(soup.error());
  return prepare(*soup);
}

/// An error is one printable line of bad input; a mesh is valid.
void expect_sound_answer(const Result<PreparedMesh>& answer, const std::string& what) {
  if (answer) {
    EXPECT_TRUE(validate(answer->mesh)) << what;
  } else {
    const Error& error = answer.error();
    EXPECT_EQ(error.code, ErrorCode::kBadInput) << what << ": " << error.message;
    EXPECT_FALSE(error.message.empty()) << what;
    EXPECT_EQ(error.message.find('\n'), std::string::npos) << what;
    EXPECT_LT(error.message.size(), 400u) << what;
  }
}

TEST(Malformed, EveryFileIsRefusedOrRepairedInWords) {
  const auto cases = files::malformed_files();
  EXPECT_GE(cases.size(), 60u);
  for (const files::Malformed& bad : cases) {
    const TempFolder folder;
    const auto answer = load(folder.write(bad.file, bad.bytes));
    expect_sound_answer(answer, bad.name);
    EXPECT_EQ(answer.has_value(), bad.repaired)
        << bad.name << (answer ? "" : ": " + answer.error().message);
    if (answer)
      EXPECT_THAT(answer->repairs, testing::Contains(testing::HasSubstr(bad.says))) << bad.name;
    else
      EXPECT_THAT(answer.error().message, testing::HasSubstr(bad.says)) << bad.name;
    int files_left = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
      files_left += entry.is_regular_file() ? 1 : 0;
    EXPECT_EQ(files_left, 1) << bad.name << ": a file was written";
  }
}

TEST(Malformed, CaseNamesAreDifferent) {
  std::set<std::string> names;
  for (const files::Malformed& bad : files::malformed_files())
    EXPECT_TRUE(names.insert(bad.name).second) << bad.name;
}

TEST(Malformed, NoCutOfASoundFileIsTrusted) {
  const TempFolder folder;
  for (const auto& [name, bytes] : files::sound_files())
    for (int part = 0; part < 40; ++part) {
      const std::size_t length = bytes.size() * static_cast<std::size_t>(part) / 40;
      expect_sound_answer(load(folder.write(name, bytes.substr(0, length))),
                          name + " cut to " + std::to_string(length));
    }
}

TEST(Malformed, RandomChangesNeverBreakTheReaders) {
  const TempFolder folder;
  for (const auto& [name, bytes] : files::sound_files())
    for (unsigned seed = 0; seed < 60; ++seed) {
      std::mt19937 random(seed);
      std::string changed = bytes;
      for (unsigned change = 0; change < 1 + seed % 8; ++change) {
        const std::size_t at = random() % changed.size();
        // Digits and separators keep text formats readable for longer than any byte would.
        changed[at] =
            seed % 2 == 0 ? static_cast<char>(random()) : "0123456789-. \n\",:[]{}"[random() % 22];
      }
      expect_sound_answer(load(folder.write(name, changed)),
                          name + " with seed " + std::to_string(seed));
    }
}

TEST(Malformed, WhatIsNoFileIsRefused) {
  const TempFolder folder;
  EXPECT_FALSE(load(folder.path()));
  EXPECT_FALSE(load(folder.path() / "gone.obj"));
  EXPECT_FALSE(load("/dev/zero"));
  std::filesystem::create_directory(folder.path() / "folder.glb");
  EXPECT_FALSE(load(folder.path() / "folder.glb"));
}

}  // namespace
}  // namespace crosspatch
