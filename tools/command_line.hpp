#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tools/exit_code.hpp"
#include "tools/pair_files.hpp"
#include "tools/view.hpp"
#include "transfer/image_codec.hpp"

namespace crosspatch {

/// What every subcommand understands.
struct CommonArguments {
  std::string json;            ///< file for the run's report; empty = none
  std::optional<int> threads;  ///< at least 1; unset = as many as the machine has
  bool quiet = false;
  bool verbose = false;  ///< more about each stage
  int seed = 0;          ///< recorded; nothing in the program is left to chance
};

/// crosspatch inspect MESH
struct InspectArguments {
  CommonArguments common;
  std::string mesh;
};

/// What drawn meshes are coloured by.
enum class DrawnColors {
  kOwn,       ///< the file's colours and textures
  kPosition,  ///< place; with a map, that of the image on the second mesh
  kChecker,   ///< the same with a checker
};

/// crosspatch render MESH [MESH2]
struct RenderArguments {
  CommonArguments common;
  std::string mesh;
  std::string mesh2;                  ///< empty = one mesh
  std::string output;                 ///< PNG
  std::string map;                    ///< map file from the first mesh to the second; empty = none
  std::string landmarks;              ///< file of corresponding vertices to mark; empty = none
  bool lines = false;                 ///< meshes side by side, lines between landmarks
  std::string field;                  ///< file of numbers, one a vertex or a triangle; empty = none
  std::optional<DrawnColors> colors;  ///< unset = kOwn for one mesh, kPosition for two
  std::vector<View> views{View::kFront, View::kRight, View::kBack, View::kTop};
  int width = 1200;  ///< pixels
  int height = 900;  ///< pixels
  char up = 'y';     ///< 'x', 'y', 'z', or 'p' for principal axes
};

/// What all commands over a pair of surfaces take.
struct PairArguments {
  CommonArguments common;
  PairFiles files;
  std::string report;  ///< page to write; empty = none
};

/// How matches are found.
enum class MatchChoice {
  kDefault,  ///< candidates judged by their maps
  kPaper,    ///< spectral matching of feature graphs
};

/// crosspatch match SOURCE TARGET
struct MatchArguments {
  PairArguments pair;
  std::string output;  ///< CSV
  MatchChoice method = MatchChoice::kDefault;
};

/// crosspatch map SOURCE TARGET
struct MapArguments {
  PairArguments pair;
  std::string output;   ///< where each source vertex lies on the target
  std::string inverse;  ///< the other way; empty = none
  std::string overlay;  ///< the common subdivision; empty = none
};

/// How a texture is carried.
enum class TransferMode {
  kKeep,  ///< images as they are, the target cut along their seams
  kBake,  ///< the target as it is, new images
};

/// crosspatch transfer SOURCE TARGET
struct TransferArguments {
  PairArguments pair;
  std::string output;  ///< GLB, glTF, OBJ or PLY
  TransferMode mode = TransferMode::kKeep;
  double uv_tolerance_texels = 0.5;  ///< kKeep: see CarryTextureOptions
  int size = 2048;                   ///< kBake: texels a side
  ImageFormat image_format = ImageFormat::kPng;
  int bits = 8;                                ///< kBake: of a channel
  bool round_trip = false;                     ///< kBake: bake back and compare
  bool skin = false;                           ///< carry skeleton and weights
  bool morphs = false;                         ///< carry morph targets
  std::vector<std::string> attributes;         ///< files of what else to carry
  std::vector<std::string> attributes_output;  ///< their outputs; empty = beside `output`
};

/// crosspatch doctor
struct DoctorArguments {
  CommonArguments common;
};

using Command = std::variant<InspectArguments,
                             MatchArguments,
                             MapArguments,
                             TransferArguments,
                             RenderArguments,
                             DoctorArguments>;

/// What the command shares with all others.
const CommonArguments& common_arguments(const Command& command);

/// Why there is no command to run: help or the version was asked for (kDone, `text` belongs on
/// standard output), or the arguments are wrong (kUsage, `text` is one line).
struct CommandLineStop {
  ExitCode code = ExitCode::kUsage;
  std::string text;
};

/// Reads the program's arguments.
tl::expected<Command, CommandLineStop> parse_command_line(int argc, const char* const* argv);

}  // namespace crosspatch
