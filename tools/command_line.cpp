#include "tools/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <sstream>

#include "tools/version.hpp"
#include "transfer/bake.hpp"
#include "transfer/write_mesh_files.hpp"

namespace crosspatch {
namespace {

constexpr int kMaxThreads = 1024;
constexpr int kMaxPictureSide = 16384;

void add_common(CLI::App& command, CommonArguments& common) {
  command
      .add_option("--json",
                  common.json,
                  "Write a report of the run: inputs, times, figures ('-' = standard output)")
      ->type_name("FILE");
  command
      .add_option(
          "--threads", common.threads, "Threads to work with; results do not depend on it [all]")
      ->check(CLI::Range(1, kMaxThreads))
      ->type_name("N");
  command.add_flag("-q,--quiet", common.quiet, "No progress lines");
}

/// "1200x900"
std::string parse_size(const std::string& text, RenderArguments& arguments) {
  std::istringstream stream(text);
  char by = 0;
  if (!(stream >> arguments.width >> by >> arguments.height) || by != 'x' || !stream.eof())
    return fmt::format("--size: '{}' is not of the form WIDTHxHEIGHT", text);
  for (const int side : {arguments.width, arguments.height})
    if (side < 16 || side > kMaxPictureSide)
      return fmt::format("--size: {} is outside [16, {}]", side, kMaxPictureSide);
  return "";
}

std::string parse_views(const std::string& text, RenderArguments& arguments) {
  arguments.views.clear();
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) {
    const Result<View> view = parse_view(name);
    if (!view) return "--views: " + view.error().message;
    arguments.views.push_back(*view);
  }
  return arguments.views.empty() ? "--views: none is named" : "";
}

template <class Parse>
void add_parsed(
    CLI::App& command, const char* name, const char* what, const char* type, Parse parse) {
  command
      .add_option_function<std::string>(
          name,
          [parse](const std::string& text) {
            if (const std::string problem = parse(text); !problem.empty())
              throw CLI::ValidationError(problem);
          },
          what)
      ->type_name(type);
}

CLI::App* add_inspect(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("inspect", "Say what a mesh file holds and what has to be repaired in it");
  command->add_option("MESH", arguments.mesh, "OBJ, PLY, OFF, STL, glTF or GLB")->required();
  add_common(*command, arguments.common);
  command->footer(
      "\nExamples:\n  crosspatch inspect cow.obj\n  crosspatch inspect cow.obj --json cow.json");
  return command;
}

void add_pair(CLI::App& command, PairArguments& pair) {
  command.add_option("SOURCE", pair.files.source, "Mesh to map from")->required();
  command.add_option("TARGET", pair.files.target, "Mesh to map to")->required();
  command
      .add_option("--landmarks",
                  pair.files.landmarks,
                  "Corresponding vertices 'source_vertex target_vertex' a line, counted from 0; "
                  "they are met exactly [found by the program]")
      ->type_name("FILE");
  add_common(command, pair.common);
}

CLI::App* add_match(CLI::App& app, MatchArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("match", "Find a few corresponding points of two surfaces");
  command
      ->add_option("-o,--output",
                   arguments.output,
                   "Lines 'kind,source_vertex,target_vertex,confidence' under a header")
      ->required()
      ->type_name("CSV");
  add_parsed(
      *command,
      "--method",
      "default: tips, chosen by the maps through them; paper: critical points of the feature "
      "graphs by spectral matching, as published [default]",
      "default|paper",
      [&arguments](const std::string& text) -> std::string {
        if (text != "default" && text != "paper")
          return fmt::format("--method: '{}' is none of default, paper", text);
        arguments.method = text == "paper" ? MatchChoice::kPaper : MatchChoice::kDefault;
        return "";
      });
  add_pair(*command, arguments.pair);
  command->footer(
      "\nExamples:\n"
      "  crosspatch match cow.obj camel.off --output matches.csv\n"
      "  crosspatch match cow.obj camel.off --method paper --output matches.csv");
  return command;
}

CLI::App* add_map(CLI::App& app, MapArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("map", "Map one surface onto another, one-to-one, as text files");
  command
      ->add_option("-o,--output",
                   arguments.output,
                   "For each vertex of SOURCE its point on TARGET: 'face b0 b1 b2'")
      ->required()
      ->type_name("FILE");
  command->add_option("--inverse", arguments.inverse, "The same from TARGET to SOURCE")
      ->type_name("FILE");
  command
      ->add_option("--overlay", arguments.overlay, "The exact map: the common subdivision of both")
      ->type_name("FILE");
  add_pair(*command, arguments.pair);
  command->footer(
      "\nExamples:\n"
      "  crosspatch map cow.obj camel.off --output map.txt\n"
      "  crosspatch map cow.obj camel.off --landmarks pairs.txt --output map.txt \\\n"
      "      --inverse inverse.txt --overlay overlay.txt --json report.json");
  return command;
}

CLI::App* add_transfer(CLI::App& app, TransferArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "transfer", "Carry the textures of one surface to another of a different shape");
  command
      ->add_option("-o,--output",
                   arguments.output,
                   "Textured TARGET to write: .glb, .gltf, .obj (with images beside it) or .ply "
                   "(colours at vertices)")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--mode",
                   arguments.mode,
                   "keep: the images as they are, TARGET cut along their seams; bake: TARGET as it "
                   "is, new images over its own texture coordinates, or over new ones where those "
                   "do not serve [keep]")
      ->transform(CLI::CheckedTransformer(std::map<std::string, TransferMode>{
          {"keep", TransferMode::kKeep}, {"bake", TransferMode::kBake}}))
      ->type_name("keep|bake");
  command->add_option("--size", arguments.size, "bake: texels a side of the new images [2048]")
      ->check(CLI::Range(kLeastBakeSize, kLargestBakeSize))
      ->type_name("TEXELS");
  command->add_option("--image", arguments.image_format, "bake: kind of the new images [png]")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ImageFormat>{
          {"png", ImageFormat::kPng}, {"jpeg", ImageFormat::kJpeg}, {"exr", ImageFormat::kExr}}))
      ->type_name("png|jpeg|exr");
  command->add_option("--bits", arguments.bits, "bake: bits a channel of PNG images [8]")
      ->check(CLI::IsMember({8, 16}))
      ->type_name("8|16");
  command
      ->add_option("--uv-tolerance",
                   arguments.uv_tolerance_texels,
                   "keep: texels that texture coordinates may stray from the map [0.5]")
      ->check(CLI::Range(0.0, 1e6))
      ->type_name("TEXELS");
  command
      ->add_option("--map",
                   arguments.pair.files.map,
                   "Use this map of the two files, an overlay that 'crosspatch map' wrote [found]")
      ->type_name("FILE");
  command
      ->add_option("--texture",
                   arguments.pair.files.texture,
                   "What the source wears: a PNG or JPEG over its texture coordinates, a painted "
                   "'checker' or 'uv' (over them too), or colours by 'position' [its own]")
      ->type_name("FILE|checker|uv|position");
  add_pair(*command, arguments.pair);
  command->footer(
      "\nExamples:\n"
      "  crosspatch transfer cow.obj camel.off --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.off --landmarks pairs.txt --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.obj --mode bake --size 4096 --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.off --texture hide.png --output camel.gltf\n"
      "  crosspatch render camel.glb --output camel.png");
  return command;
}

/// What is wrong with options that are each right.
std::string contradiction(const TransferArguments& a) {
  const std::optional<MeshFormat> format = mesh_format(a.output);
  if (!format) return fmt::format("--output: '{}' is no .glb, .gltf, .obj or .ply", a.output);
  if (a.image_format == ImageFormat::kExr && *format != MeshFormat::kObj)
    return "--image exr: only an .obj can refer to EXR images";
  if (a.image_format == ImageFormat::kJpeg && a.bits != 8) return "--bits 16: a JPEG has 8";
  if (!a.pair.files.map.empty() && !a.pair.files.landmarks.empty())
    return "--map and --landmarks: a given map needs no landmarks";
  return "";
}

void add_render(CLI::App& app, RenderArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("render", "Draw one mesh, or two with corresponding colours, as a PNG");
  command->add_option("MESH", arguments.mesh, "Mesh to draw")->required();
  command->add_option("MESH2", arguments.mesh2, "Mesh to draw below it");
  command->add_option("-o,--output", arguments.output, "Picture to write")
      ->required()
      ->type_name("PNG");
  command
      ->add_option("--map",
                   arguments.map,
                   "Map from MESH to MESH2 (map.txt): corresponding places get the same colour")
      ->type_name("FILE");
  command->add_option("--landmarks", arguments.landmarks, "Mark these vertex pairs with balls")
      ->type_name("FILE");
  command->add_flag(
      "--lines", arguments.lines, "Both meshes side by side, with lines between their landmarks");
  command
      ->add_option("--field", arguments.field, "Colour MESH by numbers, one a vertex or a triangle")
      ->type_name("FILE");
  add_parsed(
      *command,
      "--texture",
      "own: the file's colours and textures; position: coloured by place; checker: the same with a "
      "checker [own for one mesh, position for two]",
      "own|position|checker",
      [&arguments](const std::string& text) -> std::string {
        if (text == "own")
          arguments.colors = DrawnColors::kOwn;
        else if (text == "position")
          arguments.colors = DrawnColors::kPosition;
        else if (text == "checker")
          arguments.colors = DrawnColors::kChecker;
        else
          return fmt::format("--texture: '{}' is none of own, position, checker", text);
        return "";
      });
  add_parsed(*command,
             "--views",
             "front, back, left, right (= side), top, bottom, quarter, separated by commas "
             "[front,side,back,top]",
             "LIST",
             [&arguments](const std::string& text) { return parse_views(text, arguments); });
  add_parsed(*command,
             "--size",
             "Pixels of the picture [1200x900]",
             "WxH",
             [&arguments](const std::string& text) { return parse_size(text, arguments); });
  command->add_option("--up", arguments.up, "Axis that points up, or p for principal axes [y]")
      ->check(CLI::IsMember({"x", "y", "z", "p"}))
      ->type_name("x|y|z|p");
  add_common(*command, arguments.common);
  command->footer(
      "\nExamples:\n"
      "  crosspatch render cow.obj --output cow.png --views quarter --size 800x600\n"
      "  crosspatch render cow.obj camel.off --map map.txt --texture checker --output pair.png");
}

}  // namespace

const CommonArguments& common_arguments(const Command& command) {
  struct Common {
    const CommonArguments& operator()(const InspectArguments& a) const { return a.common; }
    const CommonArguments& operator()(const MatchArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const MapArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const TransferArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const RenderArguments& a) const { return a.common; }
  };
  return std::visit(Common{}, command);
}

tl::expected<Command, CommandLineStop> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Finds how one surface corresponds to another and carries textures across",
               "crosspatch");
  app.set_version_flag("--version", std::string("crosspatch ") + kVersion);
  app.require_subcommand(1);
  app.footer(
      "\ncrosspatch COMMAND --help tells more about a command.\n"
      "Exit codes: 0 done, 1 a quality gate failed, 2 usage, 3 bad input,\n"
      "4 no trustworthy correspondence, 5 out of memory or internal error.");
  InspectArguments inspect;
  MatchArguments match;
  MapArguments map;
  TransferArguments transfer;
  RenderArguments render;
  const CLI::App* inspect_command = add_inspect(app, inspect);
  const CLI::App* match_command = add_match(app, match);
  const CLI::App* map_command = add_map(app, map);
  const CLI::App* transfer_command = add_transfer(app, transfer);
  add_render(app, render);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    // The library tells of the missing subcommand before it tells of a word it does not know.
    const bool unknown = app.get_subcommands().empty() && argc > 1;
    return tl::unexpected(CommandLineStop{
        ExitCode::kUsage,
        fmt::format("{} (see crosspatch --help)",
                    unknown ? fmt::format("'{}' is no command", argv[1]) : error.what())});
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, usage;
    if (app.exit(error, out, usage) == 0)
      return tl::unexpected(CommandLineStop{ExitCode::kDone, out.str()});
    return tl::unexpected(
        CommandLineStop{ExitCode::kUsage, std::string(error.what()) + " (see crosspatch --help)"});
  }
  if (inspect_command->parsed()) return inspect;
  if (map_command->parsed()) return map;
  if (match_command->parsed()) {
    if (match.method == MatchChoice::kPaper && !match.pair.files.landmarks.empty())
      return tl::unexpected(
          CommandLineStop{ExitCode::kUsage, "--method paper takes no --landmarks"});
    return match;
  }
  if (transfer_command->parsed()) {
    if (const std::string wrong = contradiction(transfer); !wrong.empty())
      return tl::unexpected(CommandLineStop{ExitCode::kUsage, wrong});
    return transfer;
  }
  if (render.lines && (render.mesh2.empty() || render.landmarks.empty()))
    return tl::unexpected(CommandLineStop{ExitCode::kUsage, "--lines needs MESH2 and --landmarks"});
  if (!render.map.empty() && render.mesh2.empty())
    return tl::unexpected(CommandLineStop{ExitCode::kUsage, "--map needs MESH2, the map's target"});
  return render;
}

}  // namespace crosspatch
