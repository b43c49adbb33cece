// The same decals as our preview, three.js and Blender show them: numbers, and a sheet of pictures.

#include <cstdio>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "viewers/agreement.h"

namespace {

using namespace applique;

Result<void> compare(const ViewerTools& tools, const std::filesystem::path& folder) {
  APPLIQUE_TRY(const auto decals, compare_viewers(tools, folder));
  fmt::print("{:18} {:>16} {:>16}\n", "overlap, detail", "three.js", "Blender");
  for (const ViewedDecal& decal : decals)
    fmt::print("{:18} {:>8.4f} {:>7.4f} {:>8.4f} {:>7.4f}\n", decal.name, decal.with_three.overlap,
               decal.with_three.correlation, decal.with_blender.overlap, decal.with_blender.correlation);
  APPLIQUE_TRY(const auto png, encode_png(sheet_of(decals)));
  std::ofstream(folder / "sheet.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Our preview beside other viewers");
  std::filesystem::path output;
  ViewerTools tools = {APPLIQUE_COMMAND, APPLIQUE_ASSETS_COMMAND, APPLIQUE_NODE_MODULES, "chromium",
                       "blender",        APPLIQUE_VIEWER_SCRIPTS};
  app.add_option("-o,--output", output, "The folder to write into")->required();
  app.add_option("--chromium", tools.chromium, "The browser")->capture_default_str();
  app.add_option("--blender", tools.blender, "Blender")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (const std::string missing = missing_tools(tools); !missing.empty()) {
    fmt::print(stderr, "not installed: {} (./dev viewers installs them)\n", missing);
    return 1;
  }
  if (const auto done = compare(tools, output); !done) {
    fmt::print(stderr, "{}\n", done.error().message);
    return 1;
  }
  return 0;
}
