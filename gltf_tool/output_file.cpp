#include "output_file.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace applique {
namespace {

// What a signal handler may touch: the name of the temporary file, and whether there is one.
std::array<char, 4096> temporary_name = {};
volatile std::sig_atomic_t temporary_exists = 0;

void handle_interrupt(int signal) {
  if (temporary_exists != 0) unlink(temporary_name.data());
  _exit(128 + signal);
}

/// Removes the file when it goes, unless it was renamed before.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {
    const std::string name = path_.string();
    if (name.size() >= temporary_name.size()) return;
    std::memcpy(temporary_name.data(), name.c_str(), name.size() + 1);
    temporary_exists = 1;
  }
  ~TemporaryFile() {
    temporary_exists = 0;
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  bool rename_to(const std::filesystem::path& target) {
    renamed_ = std::rename(path_.c_str(), target.c_str()) == 0;
    return renamed_;
  }

 private:
  std::filesystem::path path_;
  bool renamed_ = false;
};

tl::unexpected<Error> unwritable(const std::filesystem::path& path, const std::string& reason) {
  return fail(ErrorCode::output_unwritable, fmt::format("{}: cannot be written: {}", path.string(), reason));
}

bool write_all(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return false;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  return (std::fclose(file) == 0) && written;
}

}  // namespace

std::filesystem::path full_path(const std::filesystem::path& path) {
  std::error_code failed;
  // Of a relative path whose first name is not there, weakly_canonical would make nothing.
  const std::filesystem::path canonical =
      std::filesystem::weakly_canonical(std::filesystem::absolute(path, failed), failed);
  return failed ? path : canonical;
}

Result<void> check_distinct(const std::vector<std::filesystem::path>& outputs,
                            const std::vector<std::filesystem::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (full_path(outputs[i]) == full_path(outputs[j]))
        return fail(ErrorCode::output_unwritable,
                    fmt::format("'{}' would be written twice; give each output a name of its own",
                                outputs[i].string()));
    for (const std::filesystem::path& input : inputs)
      if (full_path(outputs[i]) == full_path(input))
        return fail(ErrorCode::output_unwritable,
                    fmt::format("'{}' is an input; choose another name for the output", outputs[i].string()));
  }
  return {};
}

Result<void> check_writable(const std::filesystem::path& path) {
  std::error_code error;
  if (path.filename().empty() || std::filesystem::is_directory(path, error))
    return unwritable(path, "it is a folder; name a file");
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error))
    return unwritable(path, fmt::format("the folder {} does not exist; create it first", folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    return unwritable(
        path, fmt::format("the folder {} does not allow it: {}", folder.string(), std::strerror(errno)));
  return {};
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  APPLIQUE_CHECK(check_writable(path));
  TemporaryFile temporary(path.parent_path() / fmt::format(".{}.{}.tmp", path.filename().string(), getpid()));
  if (!write_all(temporary.path(), bytes) || !temporary.rename_to(path))
    return unwritable(path, std::strerror(errno));
  return {};
}

Result<void> write_file(const std::filesystem::path& path, std::string_view text) {
  return write_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void remove_temporary_on_interrupt() {
  std::signal(SIGINT, handle_interrupt);
  std::signal(SIGTERM, handle_interrupt);
  // A file that grows over the system's limit is a write that fails, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace applique
