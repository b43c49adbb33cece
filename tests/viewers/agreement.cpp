#include "viewers/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/small_model.h"

namespace applique {
namespace {

using nlohmann::json;

constexpr int width = 360, height = 270;
constexpr std::array<const char*, 3> looks = {"plain", "solid", "decal"};
constexpr std::array<const char*, 3> viewers = {"ours", "three", "blender"};

struct DecalCase {
  const char* job;
  bool overlay;
};
constexpr std::array<DecalCase, 5> cases = {{{"bust-mask", false},
                                             {"bottle-label", false},
                                             {"gallery-straight", false},
                                             {"gallery-star", false},
                                             {"ring-emblem", true}}};

Result<void> run(const std::string& command, const std::filesystem::path& log) {
  if (std::system(fmt::format("{} >'{}' 2>&1", command, log.string()).c_str()) == 0) return {};
  return fail(ErrorCode::not_solved, fmt::format("{}\nfailed; its words are in {}", command, log.string()));
}

/// A ring with a smooth skin, and the job of the crest on its front.
void write_ring(const std::filesystem::path& folder) {
  constexpr int around = 96, across = 48;
  SmallMesh ring;
  ring.name = "ring";
  for (int i = 0; i <= around; ++i)
    for (int j = 0; j <= across; ++j) {
      const double u = double(i) / around, v = double(j) / across;
      const double turn = 2 * std::numbers::pi * u, tilt = 2 * std::numbers::pi * v;
      const Vec3 outward(std::sin(turn), 0, std::cos(turn));
      const Vec3 normal = std::cos(tilt) * outward + std::sin(tilt) * Vec3::UnitY();
      ring.positions.emplace_back(outward + 0.45 * normal);
      ring.normals.push_back(normal);
      ring.uvs.push_back({u, 1 - v});
      if (i == around || j == across) continue;
      const auto corner = [&](int a, int b) {
        return static_cast<std::uint32_t>((i + a) * (across + 1) + j + b);
      };
      ring.triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
      ring.triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  write_small_model(folder / "ring.glb", {ring}, {{"stone", std::nullopt, {0.6, 0.62, 0.65, 1}}});
  const json feature = {{"image", {384, 384}}, {"position", {0, 0, 1.45}}};
  const json decal = {
      {"name", "crest"}, {"image", "emblem.png"}, {"size", 0.9}, {"up", {0, 1, 0}}, {"features", {feature}}};
  std::ofstream(folder / "ring-emblem.json")
      << json({{"version", 1}, {"model", "ring.glb"}, {"decals", json::array({decal})}}).dump(1);
}

Result<void> write_picture(const std::filesystem::path& path, const Image& image) {
  APPLIQUE_TRY(const auto png, encode_png(image));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  return {};
}

/// The image's outline in one colour.
Image paint_solid(Image image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      image.pixel(x, y)[0] = image.pixel(x, y)[2] = 0xffff;
      image.pixel(x, y)[1] = 0;
    }
  if (image.channels < 3) image.channels += 2;
  return image;
}

/// Bakes a decal and takes our own pictures; returns the views for the others.
Result<json> take_our_pictures(const ViewerTools& tools, const std::filesystem::path& folder,
                               const DecalCase& item) {
  const std::string name = item.job;
  const auto at = [&](const std::string& suffix) { return (folder / (name + suffix)).string(); };
  json job = json::parse(std::ifstream(at(".json")));
  json& decal = job["decals"][0];
  decal["output"] = item.overlay ? "overlay" : "bake";
  const std::string model = (folder / job["model"].get<std::string>()).string();
  const std::string image = decal["image"];
  APPLIQUE_TRY(const Image picture, read_image(folder / image));
  APPLIQUE_CHECK(write_picture(at("-solid.png"), paint_solid(picture)));
  json views = json::array();
  for (const std::string look : looks) {
    std::string shown = model;
    if (look != "plain") {
      decal["image"] = look == "solid" ? name + "-solid.png" : image;
      shown = at("-" + look + ".glb");
      std::ofstream(at("-" + look + ".json")) << job.dump(1);
      APPLIQUE_CHECK(run(
          fmt::format("'{}' -q bake '{}' -o '{}'", tools.applique.string(), at("-" + look + ".json"), shown),
          at(".log")));
    }
    APPLIQUE_CHECK(run(fmt::format("'{}' -q render '{}' -o '{}' --job '{}' --size {}x{} --camera '{}'",
                                   tools.applique.string(), shown, at("-" + look + "-ours.png"), at(".json"),
                                   width, height, at(".camera.json")),
                       at(".log")));
    views.push_back({{"model", shown},
                     {"camera", json::parse(std::ifstream(at(".camera.json")))},
                     {"output", at("-" + look)}});
  }
  return views;
}

/// The same views, for a viewer.
std::string write_views(const std::filesystem::path& folder, const std::string& viewer, json views) {
  for (json& view : views) view["output"] = view["output"].get<std::string>() + "-" + viewer + ".png";
  const auto path = folder / (viewer + ".json");
  std::ofstream(path) << views.dump(1);
  return path.string();
}

/// A picture over light grey.
Result<Image> read_picture(const std::filesystem::path& path) {
  APPLIQUE_TRY(Image image, read_image(path));
  constexpr double ground = 0xe000;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const double alpha = image.rgba[i + 3] / 65535.0;
    for (std::size_t c = 0; c < 3; ++c)
      image.rgba[i + c] =
          static_cast<std::uint16_t>(std::lround(alpha * image.rgba[i + c] + (1 - alpha) * ground));
    image.rgba[i + 3] = 0xffff;
  }
  image.channels = 3;
  return image;
}

/// What one viewer shows, by look.
using Pictures = std::map<std::string, Image>;

double change(const Pictures& pictures, const char* look, std::size_t i) {
  return double(pictures.at(look).rgba[i]) - pictures.at("plain").rgba[i];
}

std::vector<char> find_decal(const Pictures& pictures) {
  constexpr double clearly = 0.12 * 0xffff;
  std::vector<char> mask(pictures.at("plain").rgba.size() / 4, 0);
  for (std::size_t i = 0; i < mask.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(change(pictures, "solid", 4 * i + c)) > clearly) mask[i] = 1;
  return mask;
}

Agreement compare(const Pictures& ours, const Pictures& theirs) {
  const auto our_mask = find_decal(ours), their_mask = find_decal(theirs);
  double both = 0, either = 0;
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < our_mask.size(); ++i) {
    both += our_mask[i] != 0 && their_mask[i] != 0 ? 1 : 0;
    either += our_mask[i] != 0 || their_mask[i] != 0 ? 1 : 0;
    if (our_mask[i] == 0 || their_mask[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = change(ours, "decal", 4 * i + c), y = change(theirs, "decal", 4 * i + c);
      n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
    }
  }
  Agreement agreement;
  if (either == 0 || n == 0) return agreement;
  agreement.overlap = both / either;
  agreement.correlation = (ab - a * b / n) / std::sqrt(std::max(1.0, (aa - a * a / n) * (bb - b * b / n)));
  return agreement;
}

Result<ViewedDecal> read_pictures(const std::filesystem::path& folder, const std::string& name) {
  std::map<std::string, Pictures> pictures;
  for (const std::string viewer : viewers)
    for (const std::string look : looks) {
      APPLIQUE_TRY(Image picture, read_picture(folder / fmt::format("{}-{}-{}.png", name, look, viewer)));
      if (picture.width != width || picture.height != height)
        return fail(ErrorCode::image_invalid, fmt::format("{}: {}'s picture has another size", name, viewer));
      pictures[viewer][look] = std::move(picture);
    }
  ViewedDecal decal;
  decal.name = name;
  decal.with_three = compare(pictures["ours"], pictures["three"]);
  decal.with_blender = compare(pictures["ours"], pictures["blender"]);
  decal.ours = pictures["ours"]["decal"];
  decal.three = pictures["three"]["decal"];
  decal.blender = pictures["blender"]["decal"];
  return decal;
}

bool runs(const std::string& command) {
  return std::system(fmt::format("command -v '{}' >/dev/null 2>&1", command).c_str()) == 0;
}

}  // namespace

std::string missing_tools(const ViewerTools& tools) {
  std::string missing;
  const auto need = [&](bool there, const std::string& name) {
    if (!there) missing += (missing.empty() ? "" : ", ") + name;
  };
  need(std::filesystem::exists(tools.node_modules / "three"), "three");
  need(std::filesystem::exists(tools.node_modules / "puppeteer-core"), "puppeteer-core");
  need(runs("node"), "node");
  need(runs(tools.chromium), "chromium");
  need(runs(tools.blender), "blender");
  return missing;
}

Result<std::vector<ViewedDecal>> compare_viewers(const ViewerTools& tools,
                                                 const std::filesystem::path& relative_folder) {
  const auto folder = std::filesystem::absolute(relative_folder);
  std::filesystem::create_directories(folder);
  APPLIQUE_CHECK(
      run(fmt::format("'{}' '{}' --gallery", tools.assets.string(), folder.string()), folder / "assets.log"));
  write_ring(folder);
  json views = json::array();
  for (const DecalCase& item : cases) {
    APPLIQUE_TRY(const json added, take_our_pictures(tools, folder, item));
    views.insert(views.end(), added.begin(), added.end());
  }
  APPLIQUE_CHECK(run(
      fmt::format("node '{}' '{}' \"$(command -v '{}')\" '{}'", (tools.scripts / "three_view.mjs").string(),
                  tools.node_modules.string(), tools.chromium, write_views(folder, "three", views)),
      folder / "three.log"));
  APPLIQUE_CHECK(
      run(fmt::format("'{}' -b --python-exit-code 1 -P '{}' -- '{}'", tools.blender,
                      (tools.scripts / "blender_view.py").string(), write_views(folder, "blender", views)),
          folder / "blender.log"));
  std::vector<ViewedDecal> decals;
  for (const DecalCase& item : cases) {
    APPLIQUE_TRY(ViewedDecal decal, read_pictures(folder, item.job));
    decals.push_back(std::move(decal));
  }
  return decals;
}

Image sheet_of(const std::vector<ViewedDecal>& decals) {
  Image sheet =
      make_image(3 * width, static_cast<int>(decals.size()) * height, {0xffff, 0xffff, 0xffff, 0xffff});
  sheet.channels = 3;
  for (std::size_t row = 0; row < decals.size(); ++row) {
    const std::array<const Image*, 3> pictures = {&decals[row].ours, &decals[row].three,
                                                  &decals[row].blender};
    for (int column = 0; column < 3; ++column)
      for (int y = 0; y < height; ++y)
        std::copy_n(pictures[static_cast<std::size_t>(column)]->pixel(0, y), 4 * width,
                    sheet.pixel(column * width, static_cast<int>(row) * height + y));
  }
  return sheet;
}

}  // namespace applique
