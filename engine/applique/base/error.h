#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

namespace applique {

/// What went wrong, one name per cause. The name is stable: reports, tests and scripts match on it.
enum class ErrorCode {
  // The command line asks for what is not there.
  option_invalid,
  // The input cannot be read or is invalid.
  file_unreadable,
  json_invalid,
  schema_violation,
  model_invalid,
  model_unsupported,
  image_invalid,
  region_empty,
  contour_self_crossing,
  feature_outside_region,
  features_coincide,
  feature_place_invalid,
  size_missing,
  // This job cannot be solved on this model.
  feature_too_far,
  feature_missed,
  features_disconnected,
  features_mirrored,
  uvs_missing,
  uvs_shared,
  not_solved,
  // The output cannot be written.
  output_unwritable,
  // Vulkan.
  no_device,
  device_failed,
};

/// The stable name of `code`: "contour_self_crossing".
std::string_view name_of(ErrorCode code);

/// Process exit status: 1 wrong usage, 2 invalid input, 3 unsolvable job, 4 output not writable, 5 no usable
/// device.
int exit_status(ErrorCode code);

/// A failure of data, device or solver: a code to match on and a sentence for a person that names the
/// culprit and what to do ("decal 'crest', feature 3 at (120.5, 88.0): outside the contour by 14.2 px").
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value, or the reason why there is none.
template <class T>
using Result = tl::expected<T, Error>;

/// `return fail(ErrorCode::image_invalid, "…")` from any function that returns a Result.
inline tl::unexpected<Error> fail(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

/// Something a person should know that does not stop the work. Goes into the report.
struct Warning {
  std::string code;  ///< Stable, snake_case.
  std::string message;
};

}  // namespace applique

/// A caller's bug, not bad data: stays on in release builds; prints the condition and place, then aborts.
#define APPLIQUE_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::applique::assertion_failed(#condition, __FILE__, __LINE__))

/// Unwraps a Result into `declaration`, or returns its error from the enclosing function.
#define APPLIQUE_TRY(declaration, expression) \
  APPLIQUE_TRY_IMPL(APPLIQUE_CONCAT(applique_result_, __LINE__), declaration, expression)
#define APPLIQUE_TRY_IMPL(result, declaration, expression)                          \
  auto result = (expression);                                                       \
  if (!result) return tl::unexpected<::applique::Error>(std::move(result.error())); \
  declaration = std::move(*result)
#define APPLIQUE_CONCAT(a, b) APPLIQUE_CONCAT_IMPL(a, b)
#define APPLIQUE_CONCAT_IMPL(a, b) a##b

/// The same for Result<void>.
#define APPLIQUE_CHECK(expression)                                                 \
  do {                                                                             \
    if (auto applique_check = (expression); !applique_check)                       \
      return tl::unexpected<::applique::Error>(std::move(applique_check.error())); \
  } while (false)

namespace applique {
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);
}
