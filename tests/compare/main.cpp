// The comparison of the methods with each other, and with other programs; see --help.

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "compare/comparison.h"
#include "compare/external.h"
#include "compare/page.h"
#include "compare/patch_file.h"
#include "compare/tables.h"

namespace {

using namespace applique;
using namespace applique::compare;

constexpr int wrong_usage = 1;

constexpr const char* epilogue = R"(A case is SURFACE/REGION/FEATURES: "bust-nose/disc/5".
Another program's texture coordinates, on the patch of our solution:
  applique_compare --export bump/disc/5 -o patch.glb
  blender -b -P tests/compare/unwrap_in_blender.py -- patch.glb unwrapped.glb
  applique_compare --external Blender=unwrapped.glb -o build/compare)";

struct Arguments {
  std::string output = "build/compare";
  std::string data = APPLIQUE_TEST_DATA;
  std::string only;
  std::optional<std::string> exported;
  std::vector<std::string> externals;
  std::string device;
};

Result<void> export_case(const Arguments& arguments, const std::vector<SiteSource>& sources) {
  const Comparison comparison = make_cases(sources, *arguments.exported);
  const Case* found = comparison.find(*arguments.exported);
  if (found == nullptr)
    return fail(ErrorCode::option_invalid,
                fmt::format("--export {}: there is no such case; its form is SURFACE/REGION/FEATURES",
                            *arguments.exported));
  if (!found->input) return tl::unexpected(found->input.error());
  const Site& site = comparison.sites[found->site];
  APPLIQUE_TRY(const DecalMap map, solve_decal(site.mesh, *found->input));
  return write_patch(arguments.output, *arguments.exported, site, map, found->input->region.frame());
}

/// Puts the row behind those of its case.
void insert_row(Comparison& comparison, Row row) {
  auto behind = comparison.rows.begin();
  for (auto at = behind; at != comparison.rows.end(); ++at)
    if (at->name == row.name) behind = std::next(at);
  comparison.rows.insert(behind, std::move(row));
}

Result<void> add_externals(const Arguments& arguments, Comparison& comparison) {
  for (const std::string& external : arguments.externals) {
    const std::size_t equals = external.find('=');
    if (equals == 0 || equals == std::string::npos)
      return fail(ErrorCode::option_invalid,
                  fmt::format("--external {}: its form is NAME=FILE.glb", external));
    APPLIQUE_TRY(Row row,
                 measure_external(comparison, external.substr(0, equals), external.substr(equals + 1)));
    if (!is_pictured(row.name)) row.map.reset();
    insert_row(comparison, std::move(row));
  }
  return {};
}

Result<void> compare_methods(const Arguments& arguments, const std::vector<SiteSource>& sources) {
  const std::vector<Contender> methods = contenders();
  Comparison comparison = make_cases(sources, arguments.only);
  if (sources.size() == own_sites().size())
    comparison.notes.emplace_back(
        "On our own surfaces alone: no folder of third-party models was given (--data, or "
        "APPLIQUE_TEST_DATA).");
  fmt::print(stderr, "{} surfaces, {} cases by {} methods\n", comparison.sites.size(),
             comparison.cases.size(), methods.size());
  solve_cases(comparison, methods, is_pictured);
  APPLIQUE_CHECK(add_externals(arguments, comparison));
  DeviceRequest request;
  request.selector = arguments.device;
  const Result<Device> device = Device::create(request);
  if (!device) comparison.notes.push_back("Without pictures of the surfaces: " + device.error().message);
  fmt::print(stderr, "drawing\n");
  APPLIQUE_CHECK(write_page(arguments.output, comparison, sources, device ? &*device : nullptr));
  fmt::print("{}", to_markdown(summary_table(comparison.rows)));
  return {};
}

Result<void> run(const Arguments& arguments) {
  std::vector<SiteSource> sources = own_sites();
  for (SiteSource& source : model_sites(arguments.data)) sources.push_back(std::move(source));
  return arguments.exported ? export_case(arguments, sources) : compare_methods(arguments, sources);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares the ways to stick an image on a surface, and writes a page about it.",
               "applique_compare");
  app.footer(epilogue);
  Arguments arguments;
  app.add_option(
         "-o,--output", arguments.output,
         "The folder to write table.csv, table.md, index.html and pictures into; with --export, the GLB")
      ->capture_default_str();
  app.add_option("--data", arguments.data, "The folder of third-party models; left out where there is none")
      ->capture_default_str();
  auto* only = app.add_option("--only", arguments.only, "Only the cases whose name contains this");
  app.add_option("--export", arguments.exported, "Write the patch of this case, and nothing else")
      ->excludes(only);
  app.add_option("--external", arguments.externals,
                 "NAME=FILE.glb: a row of this name from the file's texture coordinates; may be repeated");
  app.add_option("--device", arguments.device, "The Vulkan device, by index or by a part of its name");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_usage;
  }
  if (const Result<void> done = run(arguments); !done) {
    fmt::print(stderr, "applique_compare: {}\n", done.error().message);
    return exit_status(done.error().code);
  }
  return 0;
}
