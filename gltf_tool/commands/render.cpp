#include "commands/render.h"

#include "model_picture.h"
#include "output_file.h"
#include "progress.h"
#include "solve_job.h"

namespace applique {
namespace {

Result<Camera> find_camera(const RenderArguments& arguments, const std::optional<Job>& job,
                           const Model& model, PictureSize size) {
  if (!job) return camera_around_model(model, arguments.azimuth, arguments.elevation, arguments.zoom, size);
  APPLIQUE_TRY(const Job lone, only_decal(*job, arguments.decal));
  APPLIQUE_TRY(const SolvedJob solved, solve_job(lone));
  return camera_on_decal(solved.decals.front(), size);
}

nlohmann::ordered_json describe(const Camera& camera, PictureSize size) {
  const auto list = [](const Vec3& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
  return {{"eye", list(camera.eye)},
          {"target", list(camera.target)},
          {"up", list(camera.up)},
          {"vertical_fov_degrees", camera.vertical_fov},
          {"size", {size.width, size.height}}};
}

}  // namespace

CLI::App* add_render_command(CLI::App& app, RenderArguments& arguments) {
  CLI::App* command =
      add_subcommand(app, "render", "Render a model with its textures and simple light",
                     "  applique render model.glb -o front.png\n"
                     "  applique render model.glb -o side.png --azimuth 60 --elevation 15 --zoom 2\n"
                     "  applique render out.glb -o decal.png --job job.json --decal tiger");
  command->add_option("MODEL", arguments.model, "The model, .glb or .gltf")->required();
  command->add_option("-o,--output", arguments.output, "The picture to write (PNG)")
      ->required()
      ->check(picture_extension);
  command->add_option("--size", arguments.size, "The picture's size, WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->check(picture_size);
  auto* azimuth =
      command->add_option("--azimuth", arguments.azimuth, "Degrees to the right of the front (+z)")
          ->capture_default_str()
          ->check(number_within(-360, 360));
  auto* elevation = command->add_option("--elevation", arguments.elevation, "Degrees above the horizon")
                        ->capture_default_str()
                        ->check(number_within(-90, 90));
  auto* zoom = command->add_option("--zoom", arguments.zoom, "1 shows the whole model, more comes closer")
                   ->capture_default_str()
                   ->check(number_within(0.01, 1000));
  auto* job =
      command->add_option("--job", arguments.job, "Look straight at a decal of this job, the first one")
          ->excludes(azimuth)
          ->excludes(elevation)
          ->excludes(zoom);
  command->add_option("--decal", arguments.decal, "Look at the decal of this name instead")->needs(job);
  command->add_option("--camera", arguments.camera,
                      "Write where the picture is taken from (JSON), so that other programs can take it too");
  command->add_option("--device", arguments.device, "The Vulkan device, by index or by a part of its name");
  return command;
}

Result<void> run_render(const RenderArguments& arguments, const CommonArguments& common) {
  APPLIQUE_CHECK(check_writable(arguments.output));
  if (arguments.camera) APPLIQUE_CHECK(check_writable(*arguments.camera));
  std::vector<std::filesystem::path> outputs = {arguments.output};
  if (arguments.camera) outputs.push_back(*arguments.camera);
  APPLIQUE_CHECK(check_distinct(outputs, {arguments.model}));
  std::optional<Job> job;
  if (arguments.job) {
    APPLIQUE_TRY(job, load_job(*arguments.job));
    APPLIQUE_CHECK(check_distinct(outputs, inputs_of(*job)));
  }
  const PictureSize size = parse_size(arguments.size);
  Progress progress(!common.quiet);
  progress.show("loading the model", 0);
  APPLIQUE_TRY(const Model model, load_model(arguments.model));
  APPLIQUE_CHECK(check_distinct(outputs, files_of(model.document)));
  log_warnings(model);
  APPLIQUE_TRY(const Camera camera, find_camera(arguments, job, model, size));
  progress.show("rendering", 0.5);
  DeviceRequest request;
  request.selector = arguments.device;
  APPLIQUE_TRY(const Device device, Device::create(request));
  APPLIQUE_TRY(const Image picture, render_model(device, model, camera, size));
  APPLIQUE_TRY(const auto png, encode_png(picture));
  if (arguments.camera) APPLIQUE_CHECK(write_json(*arguments.camera, describe(camera, size)));
  return write_file(arguments.output, png);
}

}  // namespace applique
