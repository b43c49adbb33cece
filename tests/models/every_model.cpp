#include "models/every_model.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "applique/image/image.h"

#include "gltf/test_models.h"
#include "models/largest_piece.h"

namespace applique {
namespace {

using nlohmann::json;

constexpr int image_size = 256;
constexpr int longest_seconds = 300;

/// Four colours, told apart at a glance: which way is up, which way is left.
Image make_chequers() {
  Image image = make_image(image_size, image_size, {0, 0, 0, 0xffff});
  image.channels = 3;
  constexpr std::array<std::array<std::uint16_t, 3>, 4> colours = {{{0xe000, 0x3000, 0x2000},
                                                                    {0x3000, 0xb000, 0x4000},
                                                                    {0x2000, 0x5000, 0xd000},
                                                                    {0xf000, 0xe000, 0xd000}}};
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size; ++x) {
      const std::size_t quarter = (2 * y >= image_size ? 2 : 0) + (2 * x >= image_size ? 1 : 0);
      const bool dark = (x / 16 + y / 16) % 2 == 0;
      for (std::size_t c = 0; c < 3; ++c)
        image.pixel(x, y)[c] = static_cast<std::uint16_t>(colours[quarter][c] / (dark ? 2 : 1));
    }
  return image;
}

/// Runs a command that may crash or hang; what it says on stderr goes to `said`.
int run(const std::string& command, const std::filesystem::path& log, std::string& said) {
  const int status = std::system(
      fmt::format("timeout -k 5 {} {} >/dev/null 2>'{}'", longest_seconds, command, log.string()).c_str());
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  said = text.str();
  std::filesystem::remove(log);
  constexpr int timed_out = 124;
  constexpr int signalled = 128;  // a shell adds the signal's number
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return code == timed_out || code > signalled ? -1 : code;
}

/// The program's sentence: the last line, without what precedes "error: ".
std::string sentence_of(std::string said) {
  while (!said.empty() && said.back() == '\n') said.pop_back();
  said = said.substr(said.find_last_of('\n') + 1);
  const std::size_t at = said.find("error: ");
  return at == std::string::npos ? said : said.substr(at + 7);
}

void read_report(const std::filesystem::path& path, ModelRow& row) {
  const json report = json::parse(std::ifstream(path));
  const json& decal = report["decals"][0];
  row.coverage = decal["coverage_status"];
  row.l2 = decal["stretch"]["l2"].is_null() ? 0 : decal["stretch"]["l2"].get<double>();
  row.residual_px = decal["features"][0]["residual_px"];
  row.seconds = report["seconds"]["total"];
  for (const json* list : {&report["warnings"], &decal["warnings"]})
    for (const json& warning : *list) row.warnings.push_back(warning["code"]);
}

ModelRow bake_model(const std::string& command, const std::filesystem::path& model,
                    const std::filesystem::path& image, const std::filesystem::path& stem,
                    const DecalWish& wish) {
  const auto beside = [&](const char* suffix) { return stem.string() + suffix; };
  ModelRow row;
  std::string said;
  row.inspect_status = run(fmt::format("'{}' inspect '{}'", command, model.string()), beside(".log"), said);
  row.bake_status = row.inspect_status;
  row.sentence = sentence_of(said);
  if (row.inspect_status != 0) return row;
  const auto loaded = load_model(model);
  if (!loaded) {
    row.bake_status = exit_status(loaded.error().code);
    row.sentence = loaded.error().message;
    return row;
  }
  for (const ModelPart& part : loaded->parts) row.triangles += part.triangles.size();
  DecalPlace place = find_place(*loaded);
  place.size *= wish.larger;
  std::ofstream(beside(".json"))
      << job_at(place, model, image, image_size, json::parse(wish.members)).dump(1);
  row.bake_status =
      run(fmt::format("'{0}' -q bake '{1}.json' -o '{1}.glb' --preview '{1}.png' --report '{1}.report.json'",
                      command, stem.string()),
          beside(".log"), said);
  row.sentence = row.solved() ? "" : sentence_of(said);
  if (!row.solved()) return row;
  row.output = beside(".glb");
  read_report(beside(".report.json"), row);
  return row;
}

}  // namespace

std::vector<ModelRow> bake_every_model(const std::filesystem::path& command,
                                       const std::filesystem::path& data, const std::filesystem::path& folder,
                                       const DecalWish& wish) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path image = std::filesystem::absolute(folder) / "decal.png";
  const auto png = encode_png(make_chequers()).value();
  std::ofstream(image, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  std::vector<ModelRow> rows;
  std::size_t number = 0;
  for (const char* below : {"gltf", "derived/gltf"})
    for (const auto& path : models_below(data / below)) {
      if (number++ % wish.every != 0) continue;
      const std::string name = path.lexically_relative(data).string();
      std::string stem = name.substr(0, name.find_last_of('.'));
      std::replace(stem.begin(), stem.end(), '/', '-');
      rows.push_back(bake_model(command.string(), path, image, folder / stem, wish));
      rows.back().model = name;
    }
  return rows;
}

std::string table_of(const std::vector<ModelRow>& rows) {
  std::string table =
      "| model | triangles | outcome | coverage | L2 stretch | residual px | seconds | said |\n"
      "|---|--:|---|---|--:|--:|--:|---|\n";
  for (const ModelRow& row : rows) {
    if (!row.solved()) {
      table += fmt::format("| {} | {} | {} | | | | | {} |\n", row.model, row.triangles,
                           row.bake_status < 0 ? "crashed" : fmt::format("turned down ({})", row.bake_status),
                           row.sentence);
      continue;
    }
    table +=
        fmt::format("| {} | {} | solved | {} | {:.3f} | {:.1e} | {:.2f} | {} |\n", row.model, row.triangles,
                    row.coverage, row.l2, row.residual_px, row.seconds, fmt::join(row.warnings, ", "));
  }
  return table;
}

}  // namespace applique
