#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "applique/base/error.h"

namespace applique {

/// The JSON Schemas (draft 7) of the job file and of the report: job.schema.json and report.schema.json.
const nlohmann::json& job_schema();
const nlohmann::json& report_schema();

/// Parses JSON text; `file` stands for it in errors. Errors: json_invalid, with line and column.
Result<nlohmann::json> parse_json(const std::string& text, const std::string& file);

/// Validates `document` against `schema`. Errors: schema_violation; one line for each fault (at most eight),
/// of the form "job.json: /decals/0/opacity: found 1.7, expected a number from 0 to 1". What is expected is
/// the schema's own "description" of the place, with the words that it allows.
Result<void> check_schema(const nlohmann::json& document, const nlohmann::json& schema,
                          const std::string& file);

}  // namespace applique
