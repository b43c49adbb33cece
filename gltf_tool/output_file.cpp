#include "output_file.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace applique {
namespace {

/// Keeps interrupts waiting while it is there.
class InterruptsHeld {
 public:
  InterruptsHeld() {
    sigset_t held;
    sigemptyset(&held);
    sigaddset(&held, SIGINT);
    sigaddset(&held, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &held, &before_);
  }
  ~InterruptsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  InterruptsHeld(const InterruptsHeld&) = delete;
  InterruptsHeld& operator=(const InterruptsHeld&) = delete;

 private:
  sigset_t before_;
};

/// The temporary files that there are. Changed with interrupts held, so that their handler may read it.
std::vector<std::string>& temporaries() {
  static std::vector<std::string> names;
  return names;
}

void handle_interrupt(int signal) {
  for (const std::string& name : temporaries()) unlink(name.c_str());
  _exit(128 + signal);
}

/// Removes the file when it goes, unless it was renamed before.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(full_path(target)),
        path_(target_.parent_path() / fmt::format(".{}.{}.tmp", target_.filename().string(), getpid())) {
    const InterruptsHeld held;
    temporaries().push_back(path_.string());
  }
  ~TemporaryFile() {
    const InterruptsHeld held;
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
    std::erase(temporaries(), path_.string());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  bool put_in_place() {
    renamed_ = std::rename(path_.c_str(), target_.c_str()) == 0;
    return renamed_;
  }

 private:
  std::filesystem::path target_, path_;
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
  // A device or a pipe would be replaced by a file of its name.
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    return unwritable(path, "it is a device or a pipe; name a file");
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error))
    return unwritable(path, fmt::format("the folder {} does not exist; create it first", folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    return unwritable(
        path, fmt::format("the folder {} does not allow it: {}", folder.string(), std::strerror(errno)));
  return {};
}

Result<void> write_files(std::span<const OutputFile> files) {
  for (const OutputFile& file : files) APPLIQUE_CHECK(check_writable(file.path));
  std::deque<TemporaryFile> temporary;
  for (const OutputFile& file : files) {
    temporary.emplace_back(file.path);
    if (!write_all(temporary.back().path(), file.bytes)) return unwritable(file.path, std::strerror(errno));
  }
  for (TemporaryFile& file : temporary)
    if (!file.put_in_place()) return unwritable(file.target(), std::strerror(errno));
  return {};
}

Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  const OutputFile file{path, bytes};
  return write_files({&file, 1});
}

Result<void> write_file(const std::filesystem::path& path, std::string_view text) {
  return write_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void remove_temporary_on_interrupt() {
  temporaries();  // made before a handler may ask for it
  std::signal(SIGINT, handle_interrupt);
  std::signal(SIGTERM, handle_interrupt);
  // A file that grows over the system's limit is a write that fails, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace applique
