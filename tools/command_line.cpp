#include "tools/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>

#include "tools/attributes.hpp"
#include "tools/choose.hpp"
#include "tools/version.hpp"
#include "tools/viewer.hpp"
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
  command
      .add_option("--seed",
                  common.seed,
                  "Recorded in the report; nothing here is left to chance, the result is the same")
      ->capture_default_str()
      ->type_name("N");
  command.add_flag("-q,--quiet", common.quiet, "No progress lines");
  command.add_flag("-v,--verbose", common.verbose, "Every figure of the run on standard error");
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

/// Adds an option whose text goes to `parse`, which says what is wrong with it, or "".
template <class Parse>
CLI::Option* add_parsed(
    CLI::App& command, const char* name, const char* what, const char* type, Parse parse) {
  return command
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
  command.add_flag("--force",
                   pair.files.force,
                   "Go on with the best map even if it is distorted beyond trust [exit code 4]");
  command
      .add_option("--report",
                  pair.report,
                  "Write a page to look at the result, to judge it, and to place landmarks")
      ->type_name("HTML");
  add_common(command, pair.common);
}

/// What is wrong with the report that is asked for, and what it asks for itself.
std::string prepare_report(PairArguments& pair) {
  if (pair.report.empty()) return "";
  if (viewer_script().empty()) return "--report: this build has no viewer; see crosspatch doctor";
  pair.files.alternatives = std::max(1, pair.files.alternatives);
  return "";
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
      [&arguments](const std::string& text) {
        return choose(text,
                      {{"default", MatchChoice::kDefault}, {"paper", MatchChoice::kPaper}},
                      "--method",
                      arguments.method);
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
  command
      ->add_option(
          "--alternatives",
          arguments.pair.files.alternatives,
          "Write up to N other maps beside the chosen one, best first: FILE becomes FILE_2, "
          "FILE_3 ... in front of its extension")
      ->check(CLI::Range(0, 4))
      ->capture_default_str()
      ->type_name("N");
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
  add_parsed(
      *command,
      "--mode",
      "keep: the images as they are, TARGET cut along their seams; bake: TARGET as it is, new "
      "images over its own texture coordinates, or over new ones where those do not serve",
      "keep|bake",
      [&arguments](const std::string& text) {
        return choose(text,
                      {{"keep", TransferMode::kKeep}, {"bake", TransferMode::kBake}},
                      "--mode",
                      arguments.mode);
      })
      ->default_str("keep");
  command->add_option("--size", arguments.size, "bake: texels a side of the new images")
      ->check(CLI::Range(kLeastBakeSize, kLargestBakeSize))
      ->capture_default_str()
      ->type_name("TEXELS");
  add_parsed(
      *command,
      "--image",
      "bake: kind of the new images",
      "png|jpeg|exr",
      [&arguments](const std::string& text) {
        return choose(
            text,
            {{"png", ImageFormat::kPng}, {"jpeg", ImageFormat::kJpeg}, {"exr", ImageFormat::kExr}},
            "--image",
            arguments.image_format);
      })
      ->default_str("png");
  command->add_option("--bits", arguments.bits, "bake: bits a channel of PNG images")
      ->check(CLI::IsMember({8, 16}))
      ->capture_default_str()
      ->type_name("8|16");
  command->add_flag("--round-trip",
                    arguments.round_trip,
                    "bake: carry the result back to the source as well, and report how much of "
                    "the texture was lost");
  command
      ->add_option("--uv-tolerance",
                   arguments.uv_tolerance_texels,
                   "keep: texels that texture coordinates may stray from the map")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str()
      ->type_name("TEXELS");
  command
      ->add_option("--map",
                   arguments.pair.files.map,
                   "Use this map of the two files: an overlay that 'crosspatch map' wrote, or a "
                   "line a vertex of SOURCE with a vertex of TARGET, or 'face b0 b1 b2', by any "
                   "program; what is torn in it stays grey and is counted [found]")
      ->type_name("FILE");
  command
      ->add_option("--map-base",
                   arguments.pair.files.map_base,
                   "What vertices and triangles in the --map are counted from")
      ->check(CLI::IsMember({0, 1}))
      ->capture_default_str()
      ->type_name("0|1");
  command
      ->add_option("--texture",
                   arguments.pair.files.texture,
                   "What the source wears: a PNG or JPEG over its texture coordinates, a painted "
                   "'checker' or 'uv' (over them too), or colours by 'position' or by the map's "
                   "'distortion' [its own]")
      ->type_name("FILE|checker|uv|position|distortion");
  command->add_flag("--skin",
                    arguments.skin,
                    "Carry the skeleton of a glTF SOURCE, its animations and the weights (the four "
                    "largest) to a .glb or .gltf: each joint goes with the surface around it. The "
                    "bind pose is TARGET as it is; poses are not fitted to its proportions, feet "
                    "may slide");
  command->add_flag(
      "--morphs",
      arguments.morphs,
      "Carry the morph targets of a glTF SOURCE to a .glb or .gltf: displacements are "
      "turned and scaled with the surface");
  command
      ->add_option("--attributes",
                   arguments.attributes,
                   "Carry these over the map too, given on SOURCE: fields at its vertices (.csv "
                   "with a header and a row a vertex, or .ply with properties), or landmarks and "
                   "curves (.json); may be repeated")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command
      ->add_option("--attributes-output",
                   arguments.attributes_output,
                   "Where they go, one for each --attributes, in the numbering of TARGET's file: "
                   ".csv or .ply for fields, .json or .ply for landmarks and curves [beside the "
                   "output: OUTPUT_FILE]")
      ->allow_extra_args(false)
      ->type_name("FILE");
  add_pair(*command, arguments.pair);
  command->footer(
      "\nExamples:\n"
      "  crosspatch transfer cow.obj camel.off --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.off --landmarks pairs.txt --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.obj --mode bake --size 4096 --output camel.glb\n"
      "  crosspatch transfer cow.obj camel.off --texture hide.png --output camel.gltf\n"
      "  crosspatch transfer fox.glb camel.off --skin --morphs --output camel.glb\n"
      "  crosspatch transfer cow.ply camel.off --attributes cow.ply --attributes seams.json \\\n"
      "      --output camel.glb\n"
      "  crosspatch render camel.glb --output camel.png");
  return command;
}

/// The options of transfer, without their dashes, that this mode does not read.
std::vector<std::string> unread_options(TransferMode mode) {
  if (mode == TransferMode::kBake) return {"uv-tolerance"};
  return {"size", "image", "bits", "round-trip"};
}

/// What is wrong with options that are given, in a configuration or not, and would change nothing.
std::string unread_option(const CLI::App& command, TransferMode mode) {
  const char* const other = mode == TransferMode::kBake ? "keep" : "bake";
  for (const std::string& name : unread_options(mode))
    if (command.count("--" + name) > 0) return fmt::format("--{}: it needs --mode {}", name, other);
  return "";
}

/// What is wrong with options that are each right.
std::string contradiction(const TransferArguments& a) {
  const std::optional<MeshFormat> format = mesh_format(a.output);
  if (!format) return fmt::format("--output: '{}' is no .glb, .gltf, .obj or .ply", a.output);
  for (const auto& [given, name] : {std::pair(a.skin, "--skin"), std::pair(a.morphs, "--morphs")})
    if (given && *format != MeshFormat::kGlb && *format != MeshFormat::kGltf)
      return fmt::format("{}: only a .glb or .gltf can hold it, not '{}'", name, a.output);
  if (a.image_format == ImageFormat::kExr && *format != MeshFormat::kObj)
    return fmt::format(
        "--image exr: '{}' cannot refer to EXR images (glTF knows PNG and JPEG, PLY none): "
        "write an .obj",
        a.output);
  if (a.round_trip && a.image_format == ImageFormat::kExr)
    return "--round-trip: it reads PNG and JPEG, not EXR";
  if (a.image_format == ImageFormat::kJpeg && a.bits != 8) return "--bits 16: a JPEG has 8";
  if (a.pair.files.map_base != 0 && a.pair.files.map.empty())
    return "--map-base: no --map is given";
  if (!a.pair.files.map.empty() && !a.pair.files.landmarks.empty())
    return "--map and --landmarks: a given map needs no landmarks";
  if (!a.attributes_output.empty() && a.attributes_output.size() != a.attributes.size())
    return fmt::format("--attributes-output: given {} times, --attributes {} times",
                       a.attributes_output.size(),
                       a.attributes.size());
  for (const AttributeFiles& files : attribute_files(a.attributes, a.attributes_output, a.output))
    if (const std::string problem = attribute_files_problem(files); !problem.empty())
      return problem;
  return "";
}

CLI::App* add_doctor(CLI::App& app, DoctorArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("doctor", "Say what the program is made of and what it can take");
  add_common(*command, arguments.common);
  command->footer("\nExamples:\n  crosspatch doctor");
  return command;
}

void add_render(CLI::App& app, RenderArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "render", "Draw one mesh or two as a PNG, with a map in corresponding colours");
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
      "checker [own, with --map position]",
      "own|position|checker",
      [&arguments](const std::string& text) -> std::string {
        DrawnColors colors{};
        const std::string problem = choose(text,
                                           {{"own", DrawnColors::kOwn},
                                            {"position", DrawnColors::kPosition},
                                            {"checker", DrawnColors::kChecker}},
                                           "--texture",
                                           colors);
        if (problem.empty()) arguments.colors = colors;
        return problem;
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

bool quiet_and_verbose(const CLI::App& app) {
  const CLI::App* command = app.get_subcommands().front();
  const auto is_on = [&](const char* name) {
    return command->get_option(name)->count() > 0 && command->get_option(name)->as<bool>();
  };
  return is_on("--quiet") && is_on("--verbose");
}

std::string version_text() {
  std::string text = fmt::format("crosspatch {}", kVersion);
  const char* separator = "\nwith ";
  for (const LibraryVersion& library : kLibraries) {
    if (*library.version == 0) continue;
    text += fmt::format("{}{} {}", separator, library.name, library.version);
    separator = ", ";
  }
  return text;
}

/// The options of the command that was given, under its name.
std::string config_text(const CLI::App& app, const std::vector<std::string>& unread) {
  const auto is_read = [&](const std::string& line) {
    return std::none_of(unread.begin(), unread.end(), [&](const std::string& name) {
      return line.starts_with(name + '=');
    });
  };
  const CLI::App* command = app.get_subcommands().front();
  std::istringstream all(command->config_to_str(true, false));
  std::string text = fmt::format("[{}]\n", command->get_name());
  for (std::string line; std::getline(all, line);)
    if (!line.ends_with("=\"\"") && !line.ends_with("=[]") && is_read(line))
      text += line + '\n';  // not given, and without a default
  return text;
}

}  // namespace

const CommonArguments& common_arguments(const Command& command) {
  struct Common {
    const CommonArguments& operator()(const InspectArguments& a) const { return a.common; }
    const CommonArguments& operator()(const MatchArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const MapArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const TransferArguments& a) const { return a.pair.common; }
    const CommonArguments& operator()(const RenderArguments& a) const { return a.common; }
    const CommonArguments& operator()(const DoctorArguments& a) const { return a.common; }
  };
  return std::visit(Common{}, command);
}

tl::expected<Command, CommandLineStop> parse_command_line(int argc, const char* const* argv) {
  CLI::App app("Finds how one surface corresponds to another and carries textures across",
               "crosspatch");
  app.set_version_flag("--version", version_text());
  app.set_config(
         "--config",
         "",
         "Read options from a TOML file, those of a command under its name; the command line "
         "has the last word")
      ->type_name("FILE");
  app.allow_config_extras(CLI::config_extras_mode::error);
  bool print_config = false;
  app.add_flag("--print-config", print_config, "Print the options in force as such a file, and end")
      ->configurable(false);
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
  DoctorArguments doctor;
  const CLI::App* doctor_command = add_doctor(app, doctor);
  add_render(app, render);
  for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    command->fallthrough();  // --config may stand behind the command too
    command->configurable(false);
  }
  try {
    app.parse(argc, argv);
    if (quiet_and_verbose(app))
      return tl::unexpected(
          CommandLineStop{ExitCode::kUsage, "--quiet and --verbose contradict each other"});
    if (print_config) {
      const auto unread =
          transfer_command->parsed() ? unread_options(transfer.mode) : std::vector<std::string>{};
      return tl::unexpected(CommandLineStop{ExitCode::kDone, config_text(app, unread)});
    }
  } catch (const CLI::RequiredError& error) {
    // The library tells of the missing subcommand before it tells of a word it does not know.
    const bool unknown = app.get_subcommands().empty() && argc > 1;
    return tl::unexpected(CommandLineStop{
        ExitCode::kUsage,
        fmt::format("{} (see crosspatch --help)",
                    unknown ? fmt::format("'{}' is no command", argv[1]) : error.what())});
  } catch (const CLI::ConfigError& error) {
    return tl::unexpected(
        CommandLineStop{ExitCode::kUsage, fmt::format("--config: {}", error.what())});
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, usage;
    if (app.exit(error, out, usage) == 0)
      return tl::unexpected(CommandLineStop{ExitCode::kDone, out.str()});
    return tl::unexpected(
        CommandLineStop{ExitCode::kUsage, std::string(error.what()) + " (see crosspatch --help)"});
  }
  if (inspect_command->parsed()) return inspect;
  if (doctor_command->parsed()) return doctor;
  for (PairArguments* pair : {&match.pair, &map.pair, &transfer.pair})
    if (const std::string wrong = prepare_report(*pair); !wrong.empty())
      return tl::unexpected(CommandLineStop{ExitCode::kUsage, wrong});
  if (map_command->parsed()) return map;
  if (match_command->parsed()) {
    if (match.method == MatchChoice::kPaper && !match.pair.report.empty())
      return tl::unexpected(
          CommandLineStop{ExitCode::kUsage, "--method paper makes no map: it takes no --report"});
    if (match.method == MatchChoice::kPaper && !match.pair.files.landmarks.empty())
      return tl::unexpected(
          CommandLineStop{ExitCode::kUsage, "--method paper takes no --landmarks"});
    return match;
  }
  if (transfer_command->parsed()) {
    if (const std::string wrong = unread_option(*transfer_command, transfer.mode); !wrong.empty())
      return tl::unexpected(CommandLineStop{ExitCode::kUsage, wrong});
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
