#include "commands/check.h"

#include <future>
#include <set>
#include <utility>

#include <spdlog/spdlog.h>

#include "decal_layers.h"
#include "material.h"
#include "material_warnings.h"
#include "output_file.h"
#include "progress.h"
#include "report.h"
#include "solve_job.h"
#include "uv_conflict.h"

namespace applique {
namespace {

nlohmann::ordered_json regions_of(const SolvedJob& job) {
  nlohmann::ordered_json regions = nlohmann::ordered_json::object();
  for (const SolvedDecal& decal : job.decals) {
    auto contour = nlohmann::ordered_json::array();
    for (const Pixel& corner : decal.region.contour()) contour.push_back({corner.x, corner.y});
    regions[decal.job.name] = {{"contour", std::move(contour)}};
  }
  return regions;
}

/// What a bake would find: of texture coordinates, by decal; what it would fail with, if it would.
struct BakeCheck {
  std::vector<std::vector<UvConflictReport>> conflicts;
  std::optional<Error> error;  ///< The first one.

  void note(Result<void> result) {
    if (!result && !error) error = std::move(result.error());
  }
};

void check_uvs(SolvedJob& job, const std::vector<GroupFindings>& groups, BakeCheck& check) {
  check.conflicts.resize(job.decals.size());
  for (const auto& [group, findings] : groups)
    for (const UvFinding& finding : findings) {
      UvConflictReport report = report_of(job, group, finding);
      if (finding.outcome == UvConflict::error)
        check.note(tl::unexpected<Error>(error_of(job, group, finding)));
      if (finding.outcome == UvConflict::share)
        job.decals[finding.decal].warnings.push_back({"uv_conflict", report.message});
      check.conflicts[finding.decal].push_back(std::move(report));
    }
}

/// Reads the textures that decals are baked into, and the images of the decals' layers.
void check_images(SolvedJob& job, const std::vector<GroupFindings>& groups, BakeCheck& check) {
  std::set<std::size_t> textures;
  for (const auto& [group, findings] : groups)
    for (const MaterialSlot slot : group.written) {
      if (!group.material) continue;
      const auto& material = job.model.document.json["materials"][*group.material];
      if (const auto image = read_texture(job.model.document, material, slot).image) textures.insert(*image);
    }
  std::vector<std::future<Result<void>>> read;
  for (const std::size_t image : textures)
    read.push_back(std::async(std::launch::async, [&job, image]() -> Result<void> {
      APPLIQUE_TRY(const Image unused, load_model_image(job.model, image));
      return {};
    }));
  for (SolvedDecal& decal : job.decals)
    read.push_back(std::async(std::launch::async, [&decal] { return check_layers(decal); }));
  for (auto& result : read) check.note(result.get());
}

Result<BakeCheck> check_bake(SolvedJob& job) {
  BakeCheck check;
  APPLIQUE_TRY(const auto groups, find_uv_conflicts(job));
  warn_of_materials(job);
  check_uvs(job, groups, check);
  check_images(job, groups, check);
  return check;
}

}  // namespace

CLI::App* add_check_command(CLI::App& app, CheckArguments& arguments) {
  CLI::App* command = add_subcommand(
      app, "check", "Solve the geometry of a job and find what is in a bake's way, without baking it",
      "  applique check job.json\n"
      "  applique check job.json --report report.json --dump-region regions.json\n"
      "  applique check job.json --suggest");
  command->add_option("JOB", arguments.job, "The job file")->required();
  command->add_option("--report", arguments.report, "Write a report (JSON)");
  command->add_option("--dump-region", arguments.dump_region,
                      "Write the contour of each decal (JSON), fit for a \"region\" of a job file");
  command->add_flag("--suggest", arguments.suggest,
                    "Name the further feature that would lower the stretch most, and the one too many");
  return command;
}

Result<void> run_check(const CheckArguments& arguments, const CommonArguments& common) {
  const Stopwatch total;
  if (arguments.report) APPLIQUE_CHECK(check_writable(*arguments.report));
  if (arguments.dump_region) APPLIQUE_CHECK(check_writable(*arguments.dump_region));

  APPLIQUE_TRY(const Job job, load_job(arguments.job));
  std::vector<std::filesystem::path> outputs;
  for (const auto& output : {arguments.report, arguments.dump_region})
    if (output) outputs.push_back(*output);
  APPLIQUE_CHECK(check_distinct(outputs, inputs_of(job)));
  SolvedJob solved;
  {
    Progress progress(!common.quiet);
    const double solve_share = arguments.suggest ? 0.1 : 1;
    APPLIQUE_TRY(solved, solve_job(job, show_stages(progress, 0, solve_share)));
    if (arguments.suggest) suggest_features(solved, show_stages(progress, solve_share, 1 - solve_share));
  }
  APPLIQUE_CHECK(check_distinct(outputs, files_of(solved.model.document)));
  APPLIQUE_TRY(BakeCheck bake, check_bake(solved));
  log_warnings(solved);
  log_decals(solved);
  log_separations(bake.conflicts);
  log_suggestions(solved);

  if (arguments.dump_region) APPLIQUE_CHECK(write_json(*arguments.dump_region, regions_of(solved)));
  if (arguments.report) {
    ReportInput input;
    input.command = "check";
    if (arguments.dump_region) input.region_output = arguments.dump_region->string();
    input.times = solved.times;
    input.uv_conflicts = std::move(bake.conflicts);
    input.total_seconds = total.seconds();
    APPLIQUE_CHECK(write_json(*arguments.report, make_report(solved, input)));
  }
  if (bake.error) return tl::unexpected<Error>(std::move(*bake.error));
  return {};
}

}  // namespace applique
