#include "gltf/validator.h"

#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

namespace applique {

std::optional<std::vector<ValidatorCounts>> validate(const std::vector<std::filesystem::path>& files) {
  if (!std::filesystem::exists(APPLIQUE_VALIDATOR)) return std::nullopt;
  std::string command = "node '" APPLIQUE_VALIDATE_SCRIPT "' '" APPLIQUE_VALIDATOR "'";
  for (const auto& file : files) command += " '" + file.string() + "'";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) return std::nullopt;
  std::string text;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get()))
    text.push_back(static_cast<char>(c));
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  std::vector<ValidatorCounts> results;
  for (const auto& file : files) results.push_back(json.at(file.string()).get<ValidatorCounts>());
  return results;
}

}  // namespace applique
