#include "commands/bake.h"

#include <future>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
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

/// How the textures are stored. Options that do not go together are wrong usage.
void add_texture_options(CLI::App& command, TextureEncoding& textures) {
  static const std::map<std::string, TextureFormat> formats = {
      {"png", TextureFormat::png}, {"jpeg", TextureFormat::jpeg}, {"webp", TextureFormat::webp}};
  command
      .add_option_function<std::string>(
          "--texture-format", [&textures](const std::string& name) { textures.format = formats.at(name); },
          "How textures are stored: png (default), jpeg or webp; a texture with transparency stays a PNG "
          "instead of a JPEG")
      ->check(CLI::IsMember(formats).description(""))
      ->option_text("FORMAT");
  const auto* quality = command
                            .add_option("--texture-quality", textures.quality,
                                        "Of JPEG and WebP, 1 to 100 (default 90); 100 makes WebP lossless")
                            ->check(whole_number_within(1, 100))
                            ->option_text("QUALITY");
  const auto* bits =
      command
          .add_option("--texture-bits", textures.bits,
                      "Of PNG, bits a channel, 8 or 16 (default: as the texture had, 8 for new ones)")
          ->check(CLI::IsMember(std::set<int>{8, 16}).description(""))
          ->option_text("BITS");
  command.parse_complete_callback([quality, bits, &textures] {
    if (quality->count() != 0 && textures.format == TextureFormat::png)
      throw CLI::ValidationError("--texture-quality",
                                 "PNG has no quality; name jpeg or webp by --texture-format");
    if (bits->count() != 0 && *textures.bits == 16 && textures.format != TextureFormat::png)
      throw CLI::ValidationError("--texture-bits", fmt::format("{} has 8 bits; 16 need --texture-format png",
                                                               name_of(textures.format)));
  });
}

}  // namespace

CLI::App* add_bake_command(CLI::App& app, BakeArguments& arguments) {
  CLI::App* command =
      add_subcommand(app, "bake", "Solve a job and write the model with its decals",
                     "  applique bake job.json -o out.glb\n"
                     "  applique bake job.json -o out.glb --preview preview.png --report report.json\n"
                     "  applique bake job.json -o out.gltf --device llvmpipe --verbose\n"
                     "  applique bake job.json -o out.glb --texture-format webp --texture-quality 80");
  command->add_option("JOB", arguments.job, "The job file")->required();
  command->add_option("-o,--output", arguments.output, "The model to write, .glb or .gltf")
      ->required()
      ->check(model_extension);
  command->add_option("--report", arguments.report, "Write a report (JSON)");
  command->add_option("--preview", arguments.preview, "Write a picture that frames the first decal (PNG)")
      ->check(picture_extension);
  command->add_option("--device", arguments.device, "The Vulkan device, by index or by a part of its name");
  add_texture_options(*command, arguments.textures);
  return command;
}

namespace {

std::vector<std::filesystem::path> outputs_of(const BakeArguments& arguments) {
  std::vector<std::filesystem::path> outputs = {arguments.output};
  for (const auto& output : {arguments.report, arguments.preview})
    if (output) outputs.push_back(*output);
  return outputs;
}

/// What the files of a .gltf must not take the place of.
std::vector<std::filesystem::path> files_to_keep(const BakeArguments& arguments, const SolvedJob& job) {
  std::vector<std::filesystem::path> keep = outputs_of(arguments);
  for (const auto& files : {inputs_of(job.job), files_of(job.model.document)})
    keep.insert(keep.end(), files.begin(), files.end());
  return keep;
}

}  // namespace

Result<void> run_bake(const BakeArguments& arguments, const CommonArguments& common) {
  const Stopwatch total;
  APPLIQUE_CHECK(check_writable(arguments.output));
  if (arguments.report) APPLIQUE_CHECK(check_writable(*arguments.report));
  if (arguments.preview) APPLIQUE_CHECK(check_writable(*arguments.preview));
  APPLIQUE_TRY(const Job job, load_job(arguments.job));
  // Nothing that the job reads may be written over: a model baked in place would get the decals twice the
  // next time.
  APPLIQUE_CHECK(check_distinct(outputs_of(arguments), inputs_of(job)));

  // A device that is not there is told before the work; the baker's pipelines are made while the geometry is
  // solved.
  DeviceRequest request;
  request.selector = arguments.device;
  APPLIQUE_TRY(Device device, Device::create(request));
  auto baker_ready = std::async(std::launch::async, [&] { return create_baker(std::move(device)); });
  std::optional<Progress> progress(std::in_place, !common.quiet);
  APPLIQUE_TRY(SolvedJob solved, solve_job(job, show_stages(*progress, 0, solve_share)));
  APPLIQUE_CHECK(check_distinct(outputs_of(arguments), files_of(solved.model.document)));
  ReportInput input;
  input.command = "bake";
  input.times = solved.times;
  Stopwatch watch;
  APPLIQUE_TRY(const std::unique_ptr<GpuBaker> baker, baker_ready.get());
  input.times.add("wait_for_device", watch.lap());
  spdlog::debug("Vulkan device: {}", baker->device.name());

  APPLIQUE_TRY(BakedJob baked,
               bake_job(solved, *baker, show_stages(*progress, solve_share, bake_share), arguments.textures));
  for (const auto& [stage, seconds] : baked.times.stages()) input.times.add(stage, seconds);
  watch.lap();
  show_stages(*progress, solve_share + bake_share, 0)("saving", 0);
  APPLIQUE_CHECK(save_document(baked.document, arguments.output, files_to_keep(arguments, solved)));
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
  input.uv_conflicts = std::move(baked.uv_conflicts);
  input.warnings = std::move(baked.warnings);
  input.total_seconds = total.seconds();
  if (arguments.report) APPLIQUE_CHECK(write_json(*arguments.report, make_report(solved, input)));
  log_warnings(solved);
  for (const Warning& warning : input.warnings) spdlog::warn("{}", warning.message);
  log_decals(solved);
  log_separations(input.uv_conflicts);
  for (const auto& [stage, seconds] : input.times.stages()) spdlog::debug("{}: {:.3f} s", stage, seconds);
  spdlog::info("{} written in {:.2f} s", arguments.output.string(), total.seconds());
  return {};
}

}  // namespace applique
