#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "applique/base/error.h"

namespace applique {

struct OutputFile {
  std::filesystem::path path;
  std::span<const std::uint8_t> bytes;
};

/// Writes files that belong together: all to temporary files beside them first, then all renamed, so that a
/// failed write leaves what was there before. Links are followed. Errors: those of write_file.
Result<void> write_files(std::span<const OutputFile> files);

/// Writes a file so that nobody ever sees half of it: to a temporary file beside it (".NAME.PID.tmp"), then
/// renamed. The temporary file is removed on failure. Errors: output_unwritable, with the system's reason.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
Result<void> write_file(const std::filesystem::path& path, std::string_view text);

/// Whether `path` could be written: its folder exists and allows it, and it is no folder, device or pipe
/// itself. For asking before the work rather than after it. Errors: output_unwritable.
Result<void> check_writable(const std::filesystem::path& path);

/// The one name of a file, which need not be there: absolute, links followed.
std::filesystem::path full_path(const std::filesystem::path& path);

/// Whether the outputs are different files, none of which is an input. Errors: output_unwritable, naming the
/// file.
Result<void> check_distinct(const std::vector<std::filesystem::path>& outputs,
                            const std::vector<std::filesystem::path>& inputs);

/// From here on an interrupt (SIGINT, SIGTERM) removes the temporary files that are being written, and ends
/// the process. A file over the system's size limit is an error of the write.
void remove_temporary_on_interrupt();

}  // namespace applique
