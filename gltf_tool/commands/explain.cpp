#include "commands/explain.h"

#include "explain/explain.h"
#include "output_file.h"
#include "progress.h"

namespace applique {
namespace {

std::vector<std::string> names_of_stages() {
  std::vector<std::string> names;
  for (const StageName& name : stage_names()) names.emplace_back(name.name);
  return names;
}

Stage stage_of(const std::string& text) {
  for (const StageName& name : stage_names())
    if (text == name.name) return name.stage;
  APPLIQUE_ASSERT(false && "the command line takes known stages only");
  return Stage::region;
}

}  // namespace

CLI::App* add_explain_command(CLI::App& app, ExplainArguments& arguments) {
  CLI::App* command =
      add_subcommand(app, "explain", "Draw how a decal is solved",
                     "  applique explain job.json --stage region -o region.png\n"
                     "  applique explain job.json --stage growth -o growth.png --size 1800x1200\n"
                     "  applique explain job.json --stage growth --step 3 -o third.png\n"
                     "  applique explain job.json --stage patch --decal tiger -o patch.png");
  command->add_option("JOB", arguments.job, "The job file")->required();
  command->add_option("--stage", arguments.stage, "What to draw")
      ->required()
      ->check(CLI::IsMember(names_of_stages()));
  command->add_option("-o,--output", arguments.output, "The picture to write (PNG)")
      ->required()
      ->check(picture_extension);
  command->add_option("--decal", arguments.decal, "The decal of this name instead of the first one");
  command
      ->add_option("--step", arguments.step,
                   "A step of the growth, from 0; for growth (else several) and warp (else the last)")
      ->check(whole_number_within(0));
  command->add_option("--size", arguments.size, "The picture's size, WIDTHxHEIGHT in pixels")
      ->capture_default_str()
      ->check(picture_size);
  command->add_option("--device", arguments.device, "The Vulkan device, by index or by a part of its name");
  return command;
}

Result<void> run_explain(const ExplainArguments& arguments, const CommonArguments& common) {
  ExplainOptions options;
  options.stage = stage_of(arguments.stage);
  options.size = parse_size(arguments.size);
  if (arguments.step >= 0) {
    if (options.stage != Stage::growth && options.stage != Stage::warp)
      return fail(ErrorCode::option_invalid, "--step: only the stages growth and warp have steps");
    options.step = static_cast<std::size_t>(arguments.step);
  }
  APPLIQUE_CHECK(check_writable(arguments.output));
  APPLIQUE_TRY(Job all, load_job(arguments.job));
  APPLIQUE_CHECK(check_distinct({arguments.output}, inputs_of(all)));
  APPLIQUE_TRY(const Job job, only_decal(std::move(all), arguments.decal));
  Progress progress(!common.quiet);
  constexpr double solve_share = 0.6;
  APPLIQUE_TRY(const SolvedJob solved, solve_job(job, show_stages(progress, 0, solve_share), true));
  APPLIQUE_CHECK(check_distinct({arguments.output}, files_of(solved.model.document)));
  progress.show("drawing", solve_share);
  std::optional<Device> device;
  if (shows_model(options)) {
    DeviceRequest request;
    request.selector = arguments.device;
    APPLIQUE_TRY(device, Device::create(request));
  }
  APPLIQUE_TRY(const Image picture,
               explain_decal(solved.model, solved.decals.front(), device ? &*device : nullptr, options));
  APPLIQUE_TRY(const auto png, encode_png(picture));
  return write_file(arguments.output, png);
}

}  // namespace applique
