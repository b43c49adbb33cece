#include "models/model_jobs.h"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

namespace applique {
namespace {

using nlohmann::json;

json pick(double x, double y, double px, double py, double pz) {
  return {{"image", {x, y}}, {"position", {px, py, pz}}};
}

json ray(double x, double y, const std::array<double, 3>& origin, const std::array<double, 3>& direction) {
  return {{"image", {x, y}}, {"ray", {{"origin", origin}, {"direction", direction}}}};
}

/// The tiger's eyes and nose on those of the scanned head.
json tiger_features() {
  return {pick(502, 635, -0.706728, 1.72963, 1.96093), pick(953, 629, 0.582272, 1.72963, 1.93953),
          pick(720, 1089, -0.1289, 1.0629, 2.57438)};
}

/// The face paint on the landmarks it was drawn for.
json face_paint_features() {
  return {
      pick(286.8, 384.6, -4.445859, 2.663991, 3.173422), pick(429.1, 396.4, -1.856432, 2.585245, 3.757904),
      pick(594.9, 396.5, 1.856432, 2.585245, 3.757904),  pick(737.2, 384.6, 4.445859, 2.663991, 3.173422),
      pick(512.0, 560.6, 0, -1.126865, 7.475604),        pick(391.1, 711.4, -2.456206, -4.342621, 4.283884),
      pick(632.9, 711.4, 2.456206, -4.342621, 4.283884)};
}

/// A label round the bottle's back, where its UV seam is. The bottle's radius there is 0.05.
json bottle_features() {
  json features;
  const double scale = 0.055 / 594;
  for (const auto& [x, y] :
       {std::pair(150, 150), std::pair(350, 150), std::pair(250, 300), std::pair(250, 450)}) {
    const double angle = (x - 250) * scale / 0.05, height = 0.012 + (297 - y) * scale;
    features.push_back(ray(x, y, {-0.2 * std::sin(angle), height, -0.2 * std::cos(angle)},
                           {std::sin(angle), 0, std::cos(angle)}));
  }
  return features;
}

/// A heart on the cow's flank, seen from +x.
json flank_features() {
  json features;
  for (const auto& [x, y] : {std::pair(40, 45), std::pair(96, 45), std::pair(68, 105)})
    features.push_back(ray(x, y, {2, 0.1 - (y - 64) * 0.003, 0.1 - (x - 68) * 0.003}, {-1, 0, 0}));
  return features;
}

/// A star on the forehead, seen from +z.
json forehead_features() {
  json features;
  for (const auto& [x, y] : {std::pair(68, 30), std::pair(48, 75), std::pair(89, 75)})
    features.push_back(ray(x, y, {(x - 68) * 0.004, 0.6 - (y - 64) * 0.004, 3}, {0, 0, -1}));
  return features;
}

/// A star on the helmet's leather, seen from +x.
json helmet_features() {
  json features;
  for (const auto& [x, y] : {std::pair(68, 30), std::pair(48, 75), std::pair(89, 75)})
    features.push_back(ray(x, y, {1, 0.63 - (y - 64) * 0.0006, -0.02 - (x - 68) * 0.0006}, {-1, 0, 0}));
  return features;
}

/// Rays inwards from a helix round an upright axis, starting at the back; later is on top.
class Helix {
 public:
  Helix(std::array<double, 2> axis, double radius, double turns)
      : axis_(axis), radius_(radius), turns_(turns) {}
  /// `t` along the helix, 0 to 1.
  [[nodiscard]] json feature(double x, double y, double t, double height) const {
    const double angle = std::numbers::pi * (1 + 2 * turns_ * t);
    json pin = ray(x, y, {axis_[0] + radius_ * std::sin(angle), height, axis_[1] + radius_ * std::cos(angle)},
                   {-std::sin(angle), 0, -std::cos(angle)});
    pin["depth"] = t;
    return pin;
  }

 private:
  std::array<double, 2> axis_;  // x and z
  double radius_, turns_;
};

/// The belt, 2000 x 200 pixels, by its middle line.
json belt_features(const Helix& helix, double low, double high, int pieces) {
  json features;
  for (int k = 0; k <= pieces; ++k) {
    const double t = double(k) / pieces;
    features.push_back(helix.feature(40 + 1920 * t, 100, t, low + (high - low) * t));
  }
  return features;
}

/// The snake, 1024 x 512 pixels, round the wrist: its waves stay waves.
json snake_features() {
  json features;
  for (const auto& [x, y] :
       {std::pair(105.9, 214.2), std::pair(224.0, 106.0), std::pair(368.0, 256.0), std::pair(512.0, 406.0),
        std::pair(656.0, 256.0), std::pair(800.0, 106.0), std::pair(918.1, 214.2)}) {
    const double t = (x - 105.9) / 812.2;
    features.push_back(
        Helix({-0.03, 0.05}, 0.25, 1.3).feature(x, y, t, 0.14 + 0.00054 * (256 - y) + 0.05 * t));
  }
  return features;
}

}  // namespace

std::vector<ModelJob> write_model_jobs(const std::filesystem::path& data,
                                       const std::filesystem::path& folder) {
  std::vector<ModelJob> jobs;
  const auto add = [&](const std::string& name, const std::string& model, const std::string& image,
                       json features, json decal = json::object(), bool surface_ends = false) {
    // Images of our own are in the folder.
    const auto path = std::filesystem::exists(folder / image) ? folder / image : data / image;
    if (!std::filesystem::exists(data / model) || !std::filesystem::exists(path)) return;
    decal["name"] = name;
    decal["image"] = path.string();
    decal["features"] = std::move(features);
    const json job = {{"version", 1}, {"model", (data / model).string()}, {"decals", {decal}}};
    jobs.push_back({name, folder / (name + ".json"), surface_ends});
    std::ofstream(jobs.back().file) << job.dump(1);
  };
  add("tiger", "gltf/LeePerrySmith/LeePerrySmith.glb", "images/openclipart/tiger_graig_ryan_smith_-_01.png",
      tiger_features());
  add("face-paint", "derived/gltf/canonical_face_model.glb", "images/mediapipe/facepaint.png",
      face_paint_features(), {{"region", {{"alpha", 0.02}}}}, true);
  add("water-bottle", "gltf/WaterBottle/WaterBottle.gltf",
      "images/openclipart/coat_of_arms_of_anglica_01.png", bottle_features());
  add("cow-heart", "derived/gltf/spot.glb", "images/noto/noto_u2764.png", flank_features());
  add("monkey-star", "gltf/Suzanne/Suzanne.gltf", "images/noto/noto_u2b50.png", forehead_features());
  add("helmet-star", "gltf/FlightHelmet/FlightHelmet.gltf", "images/noto/noto_u2b50.png", helmet_features(),
      {{"materials", {"LeatherPartsMat"}}});
  // These lie over themselves.
  add("neck-ribbon", "gltf/LeePerrySmith/LeePerrySmith.glb", "belt.png",
      belt_features(Helix({-0.1, -0.55}, 2.4, 1.3), -1.45, -0.95, 12),
      {{"overlap", "allow"}, {"region", {{"contour", {{0, 55}, {2000, 55}, {2000, 145}, {0, 145}}}}}});
  add("waist-belt", "derived/gltf/human_neutral.glb", "belt.png",
      belt_features(Helix({0, 0}, 0.4, 1.25), 1.03, 1.1, 8), {{"overlap", "allow"}});
  add("wrist-snake", "derived/gltf/hand_closed.glb", "snake.png", snake_features(),
      {{"overlap", "allow"}, {"output", "overlay"}});
  return jobs;
}

}  // namespace applique
