#include "applique/base/error.h"

#include <cstdio>
#include <cstdlib>

namespace applique {
namespace {

struct CodeEntry {
  ErrorCode code;
  std::string_view name;
  int exit_status;
};

constexpr CodeEntry code_table[] = {
    {ErrorCode::option_invalid, "option_invalid", 1},
    {ErrorCode::file_unreadable, "file_unreadable", 2},
    {ErrorCode::json_invalid, "json_invalid", 2},
    {ErrorCode::schema_violation, "schema_violation", 2},
    {ErrorCode::model_invalid, "model_invalid", 2},
    {ErrorCode::model_unsupported, "model_unsupported", 2},
    {ErrorCode::image_invalid, "image_invalid", 2},
    {ErrorCode::region_empty, "region_empty", 2},
    {ErrorCode::contour_self_crossing, "contour_self_crossing", 2},
    {ErrorCode::feature_outside_region, "feature_outside_region", 2},
    {ErrorCode::features_coincide, "features_coincide", 2},
    {ErrorCode::feature_place_invalid, "feature_place_invalid", 2},
    {ErrorCode::size_missing, "size_missing", 2},
    {ErrorCode::feature_too_far, "feature_too_far", 3},
    {ErrorCode::feature_missed, "feature_missed", 3},
    {ErrorCode::features_disconnected, "features_disconnected", 3},
    {ErrorCode::features_mirrored, "features_mirrored", 3},
    {ErrorCode::uvs_missing, "uvs_missing", 3},
    {ErrorCode::uvs_shared, "uvs_shared", 3},
    {ErrorCode::not_solved, "not_solved", 3},
    {ErrorCode::output_unwritable, "output_unwritable", 4},
    {ErrorCode::no_device, "no_device", 5},
    {ErrorCode::device_failed, "device_failed", 5},
};

const CodeEntry& entry_of(ErrorCode code) {
  for (const CodeEntry& entry : code_table)
    if (entry.code == code) return entry;
  APPLIQUE_ASSERT(false && "every error code has an entry");
  return code_table[0];
}

}  // namespace

std::string_view name_of(ErrorCode code) {
  return entry_of(code).name;
}

int exit_status(ErrorCode code) {
  return entry_of(code).exit_status;
}

void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace applique
