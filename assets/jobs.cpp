#include "jobs.h"

#include "bottle.h"
#include "bust.h"
#include "images.h"
#include "job_file.h"

namespace applique::assets {

using nlohmann::ordered_json;

Result<void> write_jobs(const std::filesystem::path& folder) {
  const auto at = bust_landmark;
  const auto right = [](Pixel left) { return Pixel{1024 - left.x, left.y}; };
  namespace place = mask_place;
  const ordered_json mask = ordered_json::array({
      feature(place::forehead, at("forehead")),
      feature(place::nose_root, at("nose_root")),
      feature(place::nose_tip, at("nose_tip")),
      feature(place::left_eye_inner, at("left_eye_inner")),
      feature(place::left_eye_outer, at("left_eye_outer")),
      feature(right(place::left_eye_inner), at("right_eye_inner")),
      feature(right(place::left_eye_outer), at("right_eye_outer")),
      feature(place::left_mouth_corner, at("left_mouth_corner")),
      feature(right(place::left_mouth_corner), at("right_mouth_corner")),
      feature(place::chin, at("chin")),
  });
  APPLIQUE_CHECK(write_job(folder / "bust-mask.json", "bust.glb", "mask", mask));

  const ordered_json emblem = ordered_json::array({
      feature({384, 60}, at("emblem_top")),
      feature({384, 692}, at("emblem_bottom")),
  });
  APPLIQUE_CHECK(
      write_job(folder / "bust-emblem.json", "bust.glb", "emblem", emblem,
                {{"layers", {{"normal", "emblem-relief.png"}, {"metallic", 0.4}, {"roughness", 0.35}}}}));

  // The label goes on without stretch: 1024 pixels are 1.4 units along the body.
  constexpr double scale = 1.4 / 1024;
  constexpr double middle = 0.5 * (bottle_label_low + bottle_label_high);
  ordered_json label = ordered_json::array();
  for (const Pixel p : {Pixel{112, 106}, Pixel{912, 106}, Pixel{512, 256}, Pixel{112, 406}, Pixel{912, 406}})
    label.push_back(feature(p, bottle_point(scale * (p.x - 512), middle - scale * (p.y - 256))));
  return write_job(folder / "bottle-label.json", "bottle.glb", "label", label);
}

}  // namespace applique::assets
