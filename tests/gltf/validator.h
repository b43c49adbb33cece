#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace applique {

/// How often the Khronos validator reported each "SEVERITY CODE" (0 error, 1 warning, 2 information, 3 hint).
using ValidatorCounts = std::map<std::string, int>;

/// Runs the Khronos validator over the files, in one process; none when node or the validator is not
/// installed
/// (`./dev test` installs both).
std::optional<std::vector<ValidatorCounts>> validate(const std::vector<std::filesystem::path>& files);

}  // namespace applique
