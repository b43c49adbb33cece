#include "commands/bake.h"

#include <future>
#include <memory>
#include <utility>

#include <spdlog/spdlog.h>

#include "bake_job.h"
#include "model_picture.h"
#include "output_file.h"
#include "progress.h"
#include "report.h"
#include "save_document.h"
#include "solve_job.h"

namespace applique {
namespace {

// Shares of the whole work, for the progress bar.
constexpr double solve_share = 0.4;
constexpr double bake_share = 0.4;

constexpr int preview_width = 1200;
constexpr int preview_height = 900;

/// The decals as they look on the model: the whole of a lone decal fills the picture.
Result<void> write_preview(const std::filesystem::path& path, Device& device, const Document& document,
                           const SolvedDecal& decal) {
  APPLIQUE_TRY(const Model model, decode_model(document));
  PictureSize size = {preview_width, preview_height};
  APPLIQUE_TRY(const Image picture, render_model(device, model, camera_on_decal(decal, size), size));
  APPLIQUE_TRY(const auto png, encode_png(picture));
  return write_file(path, png);
}

}  // namespace

CLI::App* add_bake_command(CLI::App& app, BakeArguments& arguments) {
  CLI::App* command =
      add_subcommand(app, "bake", "Solve a job and write the model with its decals",
                     "  applique bake job.json -o out.glb\n"
                     "  applique bake job.json -o out.glb --preview preview.png --report report.json\n"
                     "  applique bake job.json -o out.gltf --device llvmpipe --verbose");
  command->add_option("JOB", arguments.job, "The job file")->required();
  command->add_option("-o,--output", arguments.output, "The model to write, .glb or .gltf")
      ->required()
      ->check(model_extension);
  command->add_option("--report", arguments.report, "Write a report (JSON)");
  command->add_option("--preview", arguments.preview, "Write a picture that frames the first decal (PNG)")
      ->check(picture_extension);
  command->add_option("--device", arguments.device, "The Vulkan device, by index or by a part of its name");
  return command;
}

namespace {

/// Nothing that the job reads may be written over: a model baked in place would get the decals twice the next
/// time.
Result<void> check_outputs(const BakeArguments& arguments, const Job& job) {
  std::vector<std::filesystem::path> inputs = {job.path, job.model};
  for (const DecalJob& decal : job.decals)
    for (std::filesystem::path& image : images_of(decal)) inputs.push_back(std::move(image));
  std::vector<std::filesystem::path> outputs = {arguments.output};
  for (const auto& output : {arguments.report, arguments.preview})
    if (output) outputs.push_back(*output);
  return check_distinct(outputs, inputs);
}

}  // namespace

Result<void> run_bake(const BakeArguments& arguments, const CommonArguments& common) {
  const Stopwatch total;
  APPLIQUE_CHECK(check_writable(arguments.output));
  if (arguments.report) APPLIQUE_CHECK(check_writable(*arguments.report));
  if (arguments.preview) APPLIQUE_CHECK(check_writable(*arguments.preview));
  APPLIQUE_TRY(const Job job, load_job(arguments.job));
  APPLIQUE_CHECK(check_outputs(arguments, job));

  // A device that is not there is told before the work; the baker's pipelines are made while the geometry is
  // solved.
  DeviceRequest request;
  request.selector = arguments.device;
  APPLIQUE_TRY(Device device, Device::create(request));
  auto baker_ready = std::async(std::launch::async, [&] { return create_baker(std::move(device)); });
  std::optional<Progress> progress(std::in_place, !common.quiet);
  APPLIQUE_TRY(SolvedJob solved, solve_job(job, show_stages(*progress, 0, solve_share)));
  ReportInput input;
  input.command = "bake";
  input.times = solved.times;
  Stopwatch watch;
  APPLIQUE_TRY(const std::unique_ptr<GpuBaker> baker, baker_ready.get());
  input.times.add("wait_for_device", watch.lap());
  spdlog::debug("Vulkan device: {}", baker->device.name());

  APPLIQUE_TRY(BakedJob baked, bake_job(solved, *baker, show_stages(*progress, solve_share, bake_share)));
  for (const auto& [stage, seconds] : baked.times.stages()) input.times.add(stage, seconds);
  watch.lap();
  show_stages(*progress, solve_share + bake_share, 0)("saving", 0);
  APPLIQUE_CHECK(save_document(baked.document, arguments.output));
  input.times.add("save", watch.lap());
  if (arguments.preview) {
    APPLIQUE_CHECK(write_preview(*arguments.preview, baker->device, baked.document, solved.decals.front()));
    input.times.add("preview", watch.lap());
  }
  progress.reset();

  input.device = baker->device.name();
  input.model_output = arguments.output.string();
  if (arguments.preview) input.preview_output = arguments.preview->string();
  input.textures = std::move(baked.textures);
  input.densities = std::move(baked.densities);
  input.total_seconds = total.seconds();
  if (arguments.report) APPLIQUE_CHECK(write_json(*arguments.report, make_report(solved, input)));
  log_warnings(solved);
  log_decals(solved);
  for (const auto& [stage, seconds] : input.times.stages()) spdlog::debug("{}: {:.3f} s", stage, seconds);
  spdlog::info("{} written in {:.2f} s", arguments.output.string(), total.seconds());
  return {};
}

}  // namespace applique
