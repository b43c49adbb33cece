#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace applique {

/// What a run of the program left behind.
struct CommandResult {
  int status = -1;  ///< Exit code; -1 if it died by a signal.
  std::string out;
  std::string err;
};

/// A temporary folder that goes away with the object, to run the program in. Vulkan's validation layers are
/// on.
class CommandFolder {
 public:
  CommandFolder();
  ~CommandFolder();
  CommandFolder(const CommandFolder&) = delete;
  CommandFolder& operator=(const CommandFolder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Runs `applique ARGUMENTS` with the folder as its working folder; the shell sees the arguments.
  [[nodiscard]] CommandResult run(const std::string& arguments) const;
  void write(const std::string& name, const nlohmann::json& document) const;
  [[nodiscard]] std::string read(const std::string& name) const;
  /// The names in the folder, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

}  // namespace applique
