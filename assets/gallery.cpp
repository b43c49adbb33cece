#include "gallery.h"

#include <cmath>
#include <numbers>

#include "bust.h"
#include "glb_writer.h"
#include "images.h"
#include "job_file.h"
#include "shapes.h"

namespace applique::assets {
namespace {

using nlohmann::ordered_json;

constexpr int texture_size = 2048;
constexpr double pi = std::numbers::pi;

Result<void> write_image(const std::filesystem::path& path, const Image& image) {
  APPLIQUE_TRY(const auto png, encode_png(image));
  return write_file(path, png);
}

/// A place on the drum as on its unrolled side: scene units to the right of the front, and up.
Vec3 on_drum(double along, double y) {
  return drum_point(along / 0.5, y);
}

/// Fig. 1: the mask by more and more features.
Result<void> write_sets(const std::filesystem::path& folder) {
  namespace place = mask_place;
  const auto right = [](Pixel left) { return Pixel{1024 - left.x, left.y}; };
  ordered_json features =
      ordered_json::array({feature(place::left_eye_outer, bust_landmark("left_eye_outer")),
                           feature(right(place::left_eye_outer), bust_landmark("right_eye_outer"))});
  APPLIQUE_CHECK(write_job(folder / "gallery-sets-2.json", "bust.glb", "mask", features));
  features.push_back(feature(place::forehead, bust_landmark("forehead")));
  features.push_back(feature(place::nose_tip, bust_landmark("nose_tip")));
  APPLIQUE_CHECK(write_job(folder / "gallery-sets-4.json", "bust.glb", "mask", features));
  features.push_back(feature(place::left_mouth_corner, bust_landmark("left_mouth_corner")));
  features.push_back(feature(right(place::left_mouth_corner), bust_landmark("right_mouth_corner")));
  features.push_back(feature(place::chin, bust_landmark("chin")));
  return write_job(folder / "gallery-sets-7.json", "bust.glb", "mask", features);
}

/// The snake as it is, and pulled straight: each feature up to a third of the image's height away from where
/// it would lie.
Result<void> write_snakes(const std::filesystem::path& folder) {
  constexpr double scale = 1.15 / 1024;
  ordered_json waves = ordered_json::array(), straight = ordered_json::array();
  for (const double t : {0.03, 1.0 / 6, 1.0 / 3, 0.5, 2.0 / 3, 5.0 / 6, 0.97}) {
    const Pixel p = snake_point(t);
    waves.push_back(feature(p, on_drum(scale * (p.x - 512), scale * (256 - p.y))));
    straight.push_back(feature(p, on_drum(1.2 * (t - 0.5), 0.2 * scale * (256 - p.y))));
  }
  APPLIQUE_CHECK(write_job(folder / "gallery-snake.json", "drum.glb", "snake", waves));
  return write_job(folder / "gallery-straight.json", "drum.glb", "snake", straight);
}

/// Figs. 7, 10, 12: the arms of the horseshoe come near one another, and cross.
Result<void> write_horseshoes(const std::filesystem::path& folder) {
  constexpr double scale = 1.2 / 768;
  const auto at = [](double x, double y) { return on_drum(scale * (x - 384), scale * (350 - y)); };
  const auto mirrored = [](Pixel p) { return Pixel{768 - p.x, p.y}; };
  const Pixel image[] = {{150, 100}, {150, 240}, {150, 380}, {218, 545}};
  const Pixel near[] = {{290, 100}, {270, 240}, {210, 380}, {230, 540}};
  const Pixel crossed[] = {{500, 90}, {350, 215}, {210, 370}, {225, 540}};
  ordered_json closing = ordered_json::array(), crossing = ordered_json::array();
  for (int k = 0; k < 4; ++k) {
    const Pixel other = mirrored(image[k]);
    closing.push_back(feature(image[k], at(near[k].x, near[k].y)));
    closing.push_back(feature(other, at(768 - near[k].x, near[k].y)));
    crossing.push_back(feature(image[k], at(crossed[k].x, crossed[k].y)));
    crossing.back()["depth"] = 0;
    crossing.push_back(feature(other, at(768 - crossed[k].x, crossed[k].y)));
    crossing.back()["depth"] = 1;
  }
  for (ordered_json* features : {&closing, &crossing}) features->push_back(feature({384, 614}, at(384, 600)));
  // With a guide the embedding would leave nothing to the warp that the picture is of.
  APPLIQUE_CHECK(
      write_job(folder / "gallery-closing.json", "drum.glb", "horseshoe", closing, {{"guide", false}}));
  return write_job(folder / "gallery-crossing.json", "drum.glb", "horseshoe", crossing,
                   {{"overlap", "allow"}});
}

/// Fig. 23: the belt goes one and a half times round the drum and rises by its width on the way.
Result<void> write_belt(const std::filesystem::path& folder) {
  constexpr double scale = 1.5 * pi / 1952;
  ordered_json features = ordered_json::array();
  for (int k = 0; k <= 8; ++k) {
    const double x = 60 + 1880.0 * k / 8;
    features.push_back(feature({x, 100}, on_drum(scale * (x - 1000), 0.2 * (k - 4) / 4)));
    features.back()["depth"] = k;
  }
  return write_job(folder / "gallery-belt.json", "drum.glb", "belt", features, {{"overlap", "allow"}});
}

/// Figs. 1 and 23: the star over the stairs' edges, its tips pulled out of shape.
Result<void> write_star(const std::filesystem::path& folder) {
  constexpr double scale = 1.5 / 640;
  ordered_json features = ordered_json::array({feature({320, 330}, stairs_point(1.2, 0))});
  for (int k = 0; k < 5; ++k) {
    const Vec2 tip = std::polar(270.0, 2 * pi * k / 5 - pi / 2);
    const double along = 1.2 - scale * tip.imag() * (k == 0 ? 1.25 : 1);
    features.push_back(
        feature({320 + tip.real(), 330 + tip.imag()}, stairs_point(along, scale * tip.real())));
  }
  return write_job(folder / "gallery-star.json", "stairs.glb", "star", features);
}

}  // namespace

Result<void> write_gallery(const std::filesystem::path& folder) {
  const Model drum = make_drum(texture_size), stairs = make_stairs(texture_size);
  APPLIQUE_CHECK(write_glb(folder / "drum.glb", drum.mesh, drum.texture, {"drum", 0.6}));
  APPLIQUE_CHECK(write_glb(folder / "stairs.glb", stairs.mesh, stairs.texture, {"stairs", 0.6}));
  APPLIQUE_CHECK(write_image(folder / "snake.png", draw_snake()));
  APPLIQUE_CHECK(write_image(folder / "horseshoe.png", draw_horseshoe()));
  APPLIQUE_CHECK(write_image(folder / "belt.png", draw_belt()));
  APPLIQUE_CHECK(write_image(folder / "star.png", draw_star()));
  APPLIQUE_CHECK(write_sets(folder));
  APPLIQUE_CHECK(write_snakes(folder));
  APPLIQUE_CHECK(write_horseshoes(folder));
  APPLIQUE_CHECK(write_belt(folder));
  return write_star(folder);
}

}  // namespace applique::assets
