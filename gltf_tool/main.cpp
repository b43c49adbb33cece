

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "commands/bake.h"
#include "commands/check.h"
#include "commands/common.h"
#include "commands/explain.h"
#include "commands/inspect.h"
#include "commands/render.h"
#include "near_names.h"
#include "output_file.h"
#include "version.h"

namespace {

constexpr int wrong_usage = 1;

constexpr const char* epilogue = R"(Examples:
  applique bake job.json -o out.glb --preview preview.png --report report.json
  applique check job.json
  applique explain job.json --stage growth -o growth.png
  applique inspect model.glb
  applique render out.glb -o picture.png --azimuth 30

Exit codes: 0 done, 1 wrong usage, 2 input cannot be read or is invalid, 3 the job cannot be solved,
4 output cannot be written, 5 no usable Vulkan device.)";

/// What is wrong with the arguments; without a command, which ones there are.
std::string explain(const CLI::App& app, const CLI::Error& error) {
  if (!app.get_subcommands().empty() ||
      error.get_exit_code() != static_cast<int>(CLI::ExitCodes::RequiredError))
    return error.what();
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  const std::vector<std::string> words = app.remaining();
  return words.empty() ? fmt::format("a command is needed: {}", fmt::join(commands, ", "))
                       : fmt::format("there is no command '{}', expected {}", words.front(),
                                     applique::suggest_names(words.front(), commands));
}

void start_log(const applique::CommonArguments& common) {
  auto log = spdlog::stderr_color_mt("applique");
  log->set_pattern("%n: %^%l%$: %v");
  log->set_level(common.quiet     ? spdlog::level::err
                 : common.verbose ? spdlog::level::debug
                                  : spdlog::level::info);
  spdlog::set_default_logger(std::move(log));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Appliqué sticks images on 3D models, with chosen image points exactly on chosen surface points.",
      "applique");
  app.footer(epilogue);
  app.set_version_flag("--version", std::string("applique ") + applique::version);
  app.require_subcommand(1);
  app.failure_message([&app](const CLI::App*, const CLI::Error& error) {
    return fmt::format("applique: error: {}\nRun with --help for the usage.\n", explain(app, error));
  });

  applique::CommonArguments common;
  auto* quiet = app.add_flag("-q,--quiet", common.quiet, "Tell errors only");
  app.add_flag("-v,--verbose", common.verbose, "Tell every stage")->excludes(quiet);

  applique::BakeArguments bake;
  applique::CheckArguments check;
  applique::ExplainArguments explain;
  applique::InspectArguments inspect;
  applique::RenderArguments render;
  const CLI::App* bake_command = applique::add_bake_command(app, bake);
  const CLI::App* check_command = applique::add_check_command(app, check);
  const CLI::App* explain_command = applique::add_explain_command(app, explain);
  const CLI::App* inspect_command = applique::add_inspect_command(app, inspect);
  applique::add_render_command(app, render);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : wrong_usage;
  }

  start_log(common);
  applique::remove_temporary_on_interrupt();
  const applique::Result<void> done = bake_command->parsed()      ? applique::run_bake(bake, common)
                                      : check_command->parsed()   ? applique::run_check(check, common)
                                      : explain_command->parsed() ? applique::run_explain(explain, common)
                                      : inspect_command->parsed() ? applique::run_inspect(inspect, common)
                                                                  : applique::run_render(render, common);
  if (done && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  if (done) {
    spdlog::error("the output cannot be written: {}", std::strerror(errno));
    return applique::exit_status(applique::ErrorCode::output_unwritable);
  }
  spdlog::error("{}", done.error().message);
  return applique::exit_status(done.error().code);
}
