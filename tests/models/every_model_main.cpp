// Bakes a decal onto every third-party model and writes a table of what became of them.

#include <cstdio>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "models/every_model.h"

int main(int argc, char** argv) {
  CLI::App app("A decal on every third-party model");
  std::string data = APPLIQUE_TEST_DATA;
  std::string output;
  applique::DecalWish wish;
  app.add_option("--data", data, "The folder of the models")->capture_default_str();
  std::string command = APPLIQUE_COMMAND;
  app.add_option("--applique", command, "The program")->capture_default_str();
  app.add_option("-o,--output", output, "The folder to write into")->required();
  app.add_option("--decal", wish.members, "What every decal says besides, JSON")->capture_default_str();
  app.add_option("--larger", wish.larger, "Times the size that fits")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (data.empty()) {
    std::fputs("set APPLIQUE_TEST_DATA to the folder of the models\n", stderr);
    return 1;
  }
  const auto rows = applique::bake_every_model(command, data, output, wish);
  const std::string table = applique::table_of(rows);
  std::ofstream(output + "/table.md") << table;
  fmt::print("{}", table);
}
