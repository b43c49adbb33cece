#include <cstdio>

#include <fmt/format.h>

#include "gallery.h"
#include "glb_writer.h"
#include "images.h"
#include "jobs.h"
#include "models.h"
#include "preview.h"

namespace {

using namespace applique;
using namespace applique::assets;

constexpr int texture_size = 2048;

Result<void> write_image(const std::filesystem::path& path, const Image& image) {
  APPLIQUE_TRY(const std::vector<std::uint8_t> png, encode_png(image));
  return write_file(path, png);
}

/// Three views of the model side by side.
Result<void> write_previews(const std::filesystem::path& path, const Model& model, const View& view) {
  constexpr int width = 560;
  constexpr int height = 720;
  Image sheet = make_image(3 * width, height, {65535, 65535, 65535, 65535});
  for (int i = 0; i < 3; ++i) {
    View turned = view;
    turned.azimuth += 45.0 * i;
    const Image picture = preview(model.mesh, &model.texture, turned, width, height);
    for (int y = 0; y < height; ++y) std::copy_n(picture.pixel(0, y), 4 * width, sheet.pixel(i * width, y));
  }
  return write_image(path, sheet);
}

Result<void> generate(const std::filesystem::path& folder, bool previews, bool gallery) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return fail(ErrorCode::output_unwritable, fmt::format("{}: {}", folder.string(), error.message()));
  APPLIQUE_TRY(const Model bust, make_bust(texture_size));
  APPLIQUE_CHECK(write_glb(folder / "bust.glb", bust.mesh, bust.texture, {"bust", 0.55}));
  APPLIQUE_TRY(const Model bottle, make_bottle(texture_size));
  APPLIQUE_CHECK(write_glb(folder / "bottle.glb", bottle.mesh, bottle.texture, {"bottle", 0.2}));
  APPLIQUE_CHECK(write_image(folder / "mask.png", draw_mask()));
  const Image emblem = draw_emblem();
  APPLIQUE_CHECK(write_image(folder / "emblem.png", emblem));
  APPLIQUE_CHECK(write_image(folder / "emblem-relief.png", draw_relief(emblem)));
  APPLIQUE_CHECK(write_image(folder / "label.png", draw_label()));
  APPLIQUE_CHECK(write_jobs(folder));
  if (gallery) APPLIQUE_CHECK(write_gallery(folder));
  if (previews) {
    APPLIQUE_CHECK(write_previews(folder / "preview-bust.png", bust, {0, 4, Vec3(0, 2.5, 0), 5.4}));
    APPLIQUE_CHECK(write_previews(folder / "preview-head.png", bust, {10, 2, Vec3(0, 3.75, 0), 2.6}));
    APPLIQUE_CHECK(write_previews(folder / "preview-bottle.png", bottle, {0, 8, Vec3(0, 1.6, 0), 3.6}));
    APPLIQUE_CHECK(write_image(folder / "preview-atlas.png", bust.texture));
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view option = argc == 3 ? argv[2] : "";
  const bool previews = option == "--preview", gallery = option == "--gallery";
  if (argc != 2 && !previews && !gallery) {
    fmt::print(
        stderr,
        "usage: applique_assets FOLDER [--preview|--gallery]\nWrites the demo's models, images and jobs "
        "into FOLDER; with pictures of the models, or with what the gallery needs besides.\n");
    return 1;
  }
  if (const auto done = generate(argv[1], previews, gallery); !done) {
    fmt::print(stderr, "applique_assets: {}\n", done.error().message);
    return exit_status(done.error().code);
  }
  return 0;
}
