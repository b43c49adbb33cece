#include "cli/command.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/wait.h>

namespace applique {
namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

CommandFolder::CommandFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "applique_cli_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

CommandFolder::~CommandFolder() {
  std::filesystem::remove_all(path_);
}

CommandResult CommandFolder::run(const std::string& arguments) const {
  const std::filesystem::path out = path_.string() + ".out";
  const std::filesystem::path err = path_.string() + ".err";
  const int status =
      std::system(fmt::format("cd '{}' && APPLIQUE_VALIDATION=1 '{}' {} >'{}' 2>'{}'", path_.string(),
                              APPLIQUE_COMMAND, arguments, out.string(), err.string())
                      .c_str());
  CommandResult result;
  if (WIFEXITED(status)) result.status = WEXITSTATUS(status);
  result.out = read_text(out);
  result.err = read_text(err);
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return result;
}

void CommandFolder::write(const std::string& name, const nlohmann::json& document) const {
  std::ofstream(path_ / name) << document.dump(1);
}

std::string CommandFolder::read(const std::string& name) const {
  return read_text(path_ / name);
}

std::vector<std::string> CommandFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace applique
