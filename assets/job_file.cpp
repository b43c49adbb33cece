#include "job_file.h"

#include <cmath>

#include "glb_writer.h"

namespace applique::assets {

using nlohmann::ordered_json;

ordered_json feature(Pixel image, const Vec3& position) {
  const auto round = [](double value) { return std::round(value * 1e5) / 1e5; };
  return {{"image", {round(image.x), round(image.y)}},
          {"position", {round(position.x()), round(position.y()), round(position.z())}}};
}

Result<void> write_job(const std::filesystem::path& path, const std::string& model, const std::string& name,
                       const ordered_json& features, const ordered_json& more) {
  ordered_json decal{{"name", name}, {"image", name + ".png"}};
  for (const auto& [key, value] : more.items()) decal[key] = value;
  decal["features"] = features;
  ordered_json job{{"version", 1}, {"model", model}};
  job["decals"] = ordered_json::array({decal});
  const std::string text = job.dump(2) + "\n";
  return write_file(path, std::vector<std::uint8_t>(text.begin(), text.end()));
}

}  // namespace applique::assets
