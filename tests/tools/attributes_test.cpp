// The text formats of attributes.
#include "tools/attributes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "shapes.hpp"
#include "tools/drawing_text.hpp"
#include "tools/field_text.hpp"
#include "transfer/surfaces.hpp"

namespace crosspatch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FieldsCsv, NamesTellTheKind) {
  const auto fields = parse_fields_csv(
      "\xef\xbb\xbfheat,label:part,tangent:hair.y,tangent:hair.x,tangent:hair.z,\"a, b\"\r\n"
      "1.5,3,2,1,0,7\r\n"
      ",,5,4,nan,-1e-3\r\n",
      2);
  ASSERT_TRUE(fields) << fields.error().message;
  ASSERT_EQ(fields->size(), 4u);
  EXPECT_EQ((*fields)[0].kind, FieldKind::kNumber);
  EXPECT_EQ((*fields)[0].values(0, 0), 1.5);
  EXPECT_TRUE(std::isnan((*fields)[0].values(1, 0)));
  EXPECT_EQ((*fields)[1].kind, FieldKind::kLabel);
  EXPECT_EQ((*fields)[1].values(0, 0), 3);
  EXPECT_EQ((*fields)[1].values(1, 0), kNoLabel);
  EXPECT_EQ((*fields)[2].kind, FieldKind::kTangent);
  EXPECT_THAT((*fields)[2].columns,
              ElementsAre("tangent:hair.x", "tangent:hair.y", "tangent:hair.z"));
  EXPECT_EQ((*fields)[2].values.row(0), Eigen::RowVector3d(1, 2, 0));
  EXPECT_THAT((*fields)[3].columns, ElementsAre("a, b"));
  // Written and read again they are the same.
  const std::string text = fields_csv(*fields);
  const auto again = parse_fields_csv(text, 2);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(fields_csv(*again), text);
}

TEST(FieldsCsv, OneColumnMayHaveEmptyRows) {
  const auto fields = parse_fields_csv("f\n1\n\n3\n", 3);
  ASSERT_TRUE(fields) << fields.error().message;
  EXPECT_TRUE(std::isnan((*fields)[0].values(1, 0)));
  EXPECT_EQ(fields_csv(*fields), "f\n1\n\n3\n");
  const auto last = parse_fields_csv("f\n1\n\n\n\n", 2);
  ASSERT_TRUE(last) << last.error().message;
}

TEST(FieldsCsv, IsRefusedWithItsLine) {
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"", "is empty, a header is needed"},
           {"a,b\n1,2\n", "1 rows for 2 vertices"},
           {"a,b\n1,2\n3\n", "line 3: 1 cells under a header of 2"},
           {"a\n1\nx\n", "line 3: column 'a': 'x' is no number"},
           {"a\n1\ninf\n", "line 3: column 'a': 'inf' is not finite"},
           {"a\n1\n1e999\n", "line 3: column 'a': '1e999' is not finite"},
           {"label:a\n1\n2.5\n", "line 3: column 'label:a': '2.5' is no whole number of 32 bits"},
           {"label:a\n1\n3000000000\n", "'3000000000' is no whole number of 32 bits"},
           {"a,a\n1,2\n3,4\n", "column 'a' comes twice"},
           {"a,\n1,2\n3,4\n", "a column has no name"},
           {"\"a\n1\n2\n", "line 1: a quote is left open"},
           {"tangent:a.x,tangent:a.y\n1,2\n3,4\n", "column 'tangent:a.x': a tangent field has"},
           {"tangent:a\n1\n2\n", "column 'tangent:a': a tangent field has"}}) {
    const auto fields = parse_fields_csv(text, 2);
    ASSERT_FALSE(fields) << text;
    EXPECT_THAT(fields.error().message, HasSubstr(message));
    EXPECT_EQ(fields.error().code, ErrorCode::kBadInput);
  }
}

TEST(FieldsPly, ReadBackWhatIsWritten) {
  const shapes::Surface surface = shapes::surface_of(shapes::tetrahedron());
  auto fields = parse_fields_csv(
      "heat,label:part,tangent:h_x,tangent:h_y,tangent:h_z\n1,2,3,4,5\n,,,,\n.1,7,0,0,1\n0,0,0,0,"
      "0\n",
      4);
  ASSERT_TRUE(fields) << fields.error().message;
  const std::string text = fields_ply(*fields, surface.soup);
  const auto again = parse_fields_ply(text, 4);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(fields_csv(*again), fields_csv(*fields));
}

TEST(FieldsPly, BinaryPropertiesAreReadAndTheMeshLeftOut) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement first 1\nproperty list uchar char skipped\n"
      "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar part\nproperty float heat\nend_header\n";
  bytes += std::string("\x02zz", 3);
  for (int v = 0; v < 2; ++v) {
    bytes += std::string(12, '\0') + '\x80' + static_cast<char>(200 + v);
    const float heat = 0.5F + static_cast<float>(v);
    bytes.append(reinterpret_cast<const char*>(&heat), sizeof heat);
  }
  const auto fields = parse_fields_ply(bytes, 2);
  ASSERT_TRUE(fields) << fields.error().message;
  EXPECT_EQ(fields_csv(*fields), "part,heat\n200,0.5\n201,1.5\n");
  EXPECT_EQ((*fields)[0].kind, FieldKind::kLabel);
  EXPECT_EQ(parse_fields_ply(bytes, 3).error().message, "2 vertices, the source has 3");
  EXPECT_THAT(parse_fields_ply(bytes.substr(0, bytes.size() - 1), 2).error().message,
              HasSubstr("'vertex' 1 (counted from 0): 'heat': no finite number"));
  EXPECT_FALSE(parse_fields_ply("ply\nformat ascii 1.0\nend_header\n", 0));
  EXPECT_EQ(parse_fields_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty int label:a\n"
                             "property float x\nend_header\n7 0\n",
                             1)
                ->front()
                .columns.front(),
            "label:a");
}

TEST(DrawingText, ReadsBackWhatIsWritten) {
  const shapes::Surface surface = shapes::surface_of(shapes::icosphere(1));
  const auto drawing = parse_drawing(
      R"({"landmarks": [{"name": "nose", "point": 3}, {"point": [7, 0.25, 0.25, 0.5]},
                        {"name": "gone", "point": null}],
          "curves": [{"name": "belt", "closed": true, "points": [1, 2, [3, 1, 0, 0]], "x": 1}]})",
      surface.prepared);
  ASSERT_TRUE(drawing) << drawing.error().message;
  ASSERT_EQ(drawing->landmarks.size(), 3u);
  EXPECT_EQ(drawing->landmarks[0].name, "nose");
  EXPECT_EQ(position(surface.prepared.mesh, drawing->landmarks[0].point),
            surface.prepared.mesh.position(3));
  EXPECT_FALSE(drawing->landmarks[2].point.valid());
  EXPECT_TRUE(drawing->curves[0].closed);
  const std::string text = drawing_json(*drawing, surface.prepared);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["landmarks"][1]["point"], nlohmann::json({7, 0.25, 0.25, 0.5}));
  EXPECT_EQ(json["curves"][0]["positions"].size(), 3u);
  const auto again = parse_drawing(text, surface.prepared);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(drawing_json(*again, surface.prepared), text);
  // As PLY: two landmarks with a place, three points and edges of the belt.
  const std::string ply = drawing_ply(*drawing, surface.prepared);
  EXPECT_THAT(ply, HasSubstr("element vertex 5\n"));
  EXPECT_THAT(ply, HasSubstr("element edge 3\n"));
  EXPECT_TRUE(ply.ends_with("\n2 3\n3 4\n4 2\n"));
}

TEST(DrawingText, IsRefusedWithItsEntry) {
  const shapes::Surface surface = shapes::surface_of(shapes::tetrahedron());
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"{", "is no JSON"},
           {"[]", "is no JSON object"},
           {"{}", "has neither \"landmarks\" nor \"curves\""},
           {R"({"landmarks": 1})", "\"landmarks\" is no list"},
           {R"({"landmarks": [1]})", "landmark 0 (counted from 0): is no object"},
           {R"({"landmarks": [{"name": "a"}]})", "has no \"point\""},
           {R"({"landmarks": [{"name": 1, "point": 1}]})", "\"name\" is no string"},
           {R"({"landmarks": [{"point": 4}]})", "vertex 4 is outside [0, 4)"},
           {R"({"landmarks": [{"point": -1}]})", "vertex -1 is outside [0, 4)"},
           {R"({"landmarks": [{"point": 1.5}]})", "a point is a vertex, [face, b0, b1, b2] or"},
           {R"({"landmarks": [{"point": [1, 1, 0]}]})", "a point is a vertex"},
           {R"({"landmarks": [{"point": [4, 1, 0, 0]}]})", "triangle 4 is outside [0, 4)"},
           {R"({"landmarks": [{"point": [1, 1, 1, 0]}]})", "coordinates sum to 2, not 1"},
           {R"({"landmarks": [{"point": [1, 2, -1, 0]}]})", "coordinate -1 is negative"},
           {R"({"curves": [{"points": [0]}]})", "curve 0 (counted from 0): has 1 points, 2 are"},
           {R"({"curves": [{"closed": true, "points": [0, 1]}]})", "has 2 points, 3 are needed"},
           {R"({"curves": [{"closed": 1, "points": [0, 1]}]})", "neither true nor false"},
           {R"({"curves": [{}]})", "has no list \"points\""},
           {R"({"curves": [{"points": [0, 9]}]})", "point 1: vertex 9 is outside [0, 4)"}}) {
    const auto drawing = parse_drawing(text, surface.prepared);
    ASSERT_FALSE(drawing) << text;
    EXPECT_THAT(drawing.error().message, HasSubstr(message));
    EXPECT_EQ(drawing.error().code, ErrorCode::kBadInput);
  }
}

TEST(AttributeFiles, OutputsLieBesideTheMeshUnlessNamed) {
  const auto files = attribute_files({"in/heat.csv", "marks.json"}, {}, "out/camel.glb");
  EXPECT_EQ(files[0].output, "out/camel_heat.csv");
  EXPECT_EQ(files[1].output, "out/camel_marks.json");
  EXPECT_EQ(attribute_files({"heat.csv"}, {"x.ply"}, "a.glb")[0].output, "x.ply");
  EXPECT_EQ(attribute_files_problem({"a.csv", "b.PLY"}), "");
  EXPECT_EQ(attribute_files_problem({"a.json", "b.ply"}), "");
  EXPECT_THAT(attribute_files_problem({"a.txt", "b.csv"}), HasSubstr("'a.txt' is no .csv"));
  EXPECT_THAT(attribute_files_problem({"a.json", "b.csv"}), HasSubstr("'b.csv' is no .json"));
  EXPECT_THAT(attribute_files_problem({"a.csv", "b.json"}), HasSubstr("'b.json' is no .csv"));
}

}  // namespace
}  // namespace crosspatch
