#include "cli/sheet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "save_document.h"
#include "schema.h"

namespace applique {

using nlohmann::json;

void SheetTest::SetUp() {
  write_small_model(folder_ / "model.glb", {make_plane("Sheet", 8)}, {{"paint", noise_, {1, 1, 1, 1}}});
  write_png(folder_ / "image.png", make_quarters());
}

SheetTest::Colour SheetTest::quarter_at(double x, double y) {
  const std::uint16_t on = 0xffff;
  if (y > 0) return x < 0 ? Colour{on, 0, 0, on} : Colour{0, on, 0, on};
  return x < 0 ? Colour{0, 0, on, on} : Colour{on, on, on, on};
}

Image SheetTest::make_quarters() {
  Image image = make_image(image_size, image_size, {0, 0, 0, 0xffff});
  image.channels = 3;
  for (int y = 0; y < image_size; ++y)
    for (int x = 0; x < image_size; ++x) {
      const Colour colour = quarter_at(x + 0.5 - image_size / 2.0, image_size / 2.0 - y - 0.5);
      std::copy(colour.begin(), colour.end(), image.pixel(x, y));
    }
  return image;
}

void SheetTest::edit_model(const std::function<void(Document&)>& edit) {
  Document document = load_document(folder_ / "model.glb").value();
  edit(document);
  const auto saved = save_document(document, folder_ / "model.glb");
  ASSERT_TRUE(saved) << saved.error().message;
}

json SheetTest::job_at(double x, double y, double z) {
  return {{"version", 1},
          {"model", "model.glb"},
          {"texture_size", texture_size},
          {"decals", json::array({{{"name", "crest"},
                                   {"image", "image.png"},
                                   {"features",
                                    {{{"image", {16, 32}}, {"position", {x - 0.25, y, z}}},
                                     {{"image", {48, 32}}, {"position", {x + 0.25, y, z}}}}}}})}};
}

CommandResult SheetTest::bake(const json& job, const std::string& arguments) {
  folder_.write("job.json", job);
  return folder_.run("bake job.json " + arguments);
}

Model SheetTest::output(const std::string& name) const {
  auto model = load_model(folder_ / name);
  if (!model) throw std::runtime_error(model.error().message);
  return std::move(*model);
}

json SheetTest::report() {
  const json report = json::parse(folder_.read("report.json"));
  const auto valid = check_schema(report, report_schema(), "report.json");
  EXPECT_TRUE(valid) << valid.error().message;
  return report;
}

const ModelPart& SheetTest::part_named(const Model& model, const std::string& name) {
  for (const ModelPart& part : model.parts)
    if (model.document.json["nodes"][part.node].value("name", "") == name) return part;
  throw std::runtime_error("no part " + name);
}

Image SheetTest::texture_of(const Model& model, const std::string& node) {
  const ModelMaterial& material = model.materials[part_named(model, node).material.value()];
  return load_model_image(model, material.image.value()).value();
}

int SheetTest::count_wrong(const Image& texture, const Sampler& sampler, int tolerance) {
  int wrong = 0;
  for (int j = -9; j <= 9; ++j)
    for (int i = -9; i <= 9; ++i) {
      const double x = 0.05 * i, y = 0.05 * j;
      if (std::min(std::abs(x), std::abs(y)) < 0.04 || std::max(std::abs(x), std::abs(y)) > 0.46) continue;
      const auto [u, v] = sampler(0.5 + 0.5 * x, 0.5 - 0.5 * y);
      const auto texel = [](double t, int size) {
        return std::clamp(static_cast<int>(std::floor(t * size)), 0, size - 1);
      };
      const std::uint16_t* shown = texture.pixel(texel(u, texture.width), texel(v, texture.height));
      const Colour expected = quarter_at(x, y);
      for (std::size_t c = 0; c < 3; ++c)
        if (std::abs(shown[c] - expected[c]) > 257 * tolerance) {
          ++wrong;
          break;
        }
    }
  return wrong;
}

}  // namespace applique
