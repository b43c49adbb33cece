#include "schema.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "json_error.h"
#include "near_names.h"
#include "schemas.h"

namespace applique {
namespace {

using nlohmann::json;
using Path = std::vector<std::string>;

constexpr std::size_t max_faults = 8;

/// The validator writes a place as "<root>", "[decals]", "[0]".
Path path_of(const std::vector<std::string>& context) {
  Path path;
  for (std::size_t i = 1; i < context.size(); ++i)
    path.push_back(context[i].substr(1, context[i].size() - 2));
  return path;
}

std::string pointer_of(const Path& path) {
  json::json_pointer pointer;
  for (const std::string& token : path) pointer.push_back(token);
  return path.empty() ? "the document" : pointer.to_string();
}

bool starts_with(const Path& path, const Path& prefix) {
  return path.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), path.begin());
}

const json& resolved(const json& schema, const json& root) {
  if (!schema.is_object() || !schema.contains("$ref")) return schema;
  return root.at(json::json_pointer(schema.at("$ref").get<std::string>().substr(1)));
}

/// Of a choice between schemas ("anyOf"), the one that says what the value's parts are; else the schema
/// itself.
const json& narrowed(const json& schema, const json& value, const json& root) {
  const auto choices = schema.find("anyOf");
  if (choices == schema.end()) return schema;
  const char* parts = value.is_object() ? "properties" : "items";
  for (const json& choice : *choices)
    if (const json& one = resolved(choice, root); value.is_structured() && one.contains(parts)) return one;
  return schema;
}

/// A value and the schema for it, some way into a document.
struct Place {
  const json* value;
  const json* schema;
};

Place find_place(const json& document, const json& root, const Path& path) {
  Place place = {&document, &root};
  for (const std::string& token : path) {
    place.schema = &narrowed(*place.schema, *place.value, root);
    if (place.value->is_array()) {
      place.value = &place.value->at(std::stoul(token));
      place.schema = &resolved(place.schema->at("items"), root);
      continue;
    }
    place.value = &place.value->at(token);
    const json& properties = place.schema->at("properties");
    const auto property = properties.find(token);
    place.schema =
        &resolved(property != properties.end() ? *property : place.schema->at("additionalProperties"), root);
  }
  return place;
}

std::string shortened(const json& value) {
  constexpr std::size_t max_length = 60;
  const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() <= max_length ? text : text.substr(0, max_length) + "…";
}

/// The words that the schema, or one of its choices, allows.
std::vector<std::string> allowed_words(const json& schema, const json& root) {
  std::vector<std::string> words;
  for (const json& word : schema.value("enum", json::array()))
    if (word.is_string()) words.push_back(word.get<std::string>());
  for (const json& choice : schema.value("anyOf", json::array()))
    for (std::string& word : allowed_words(resolved(choice, root), root)) words.push_back(std::move(word));
  return words;
}

/// The schema's own words, and those that it allows where it does not name them itself.
std::string description_of(const json& schema, const json& root) {
  const std::string description = schema.value("description", std::string());
  const std::vector<std::string> words = allowed_words(schema, root);
  const bool named = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
    return description.find(word) != std::string::npos;
  });
  if (description.empty() && words.empty()) return "another value";
  if (named) return description;
  return fmt::format("{}{}", description.empty() ? "one of " : description + ": ", fmt::join(words, ", "));
}

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

/// A property that the schema does not know.
std::string explain_unknown(const json& value, const json& schema) {
  if (schema.value("additionalProperties", json(true)) != json(false)) return {};
  const json& properties = schema.at("properties");
  for (const auto& item : value.items())
    if (!properties.contains(item.key()))
      return fmt::format("found the unknown property '{}', expected {}", item.key(),
                         suggest_names(item.key(), keys_of(properties)));
  return {};
}

std::string explain_missing(const json& value, const json& schema, const json& root) {
  for (const json& name : schema.value("required", json::array()))
    if (!value.contains(name.get<std::string>())) {
      const json& property = resolved(schema.at("properties").at(name.get<std::string>()), root);
      return fmt::format("found no '{}', expected {}", name.get<std::string>(),
                         description_of(property, root));
    }
  return {};
}

/// "oneOf": [{"required": ["a"]}, …]: exactly one of these properties.
std::string explain_choice(const json& value, const json& schema) {
  std::vector<std::string> choices;
  std::vector<std::string> found;
  for (const json& choice : schema.value("oneOf", json::array())) {
    const std::string name = choice.at("required").at(0).get<std::string>();
    choices.push_back(name);
    if (value.contains(name)) found.push_back(name);
  }
  if (choices.empty() || found.size() == 1) return {};
  return fmt::format("found {}, expected exactly one of {}",
                     found.empty() ? schema.value("$comment", std::string("none"))
                                   : fmt::to_string(fmt::join(found, " and ")),
                     fmt::join(choices, ", "));
}

std::string explain_dependency(const json& value, const json& schema) {
  const json dependencies = schema.value("dependencies", json::object());
  for (const auto& dependency : dependencies.items())
    for (const json& needed : dependency.value())
      if (value.contains(dependency.key()) && !value.contains(needed.get<std::string>()))
        return fmt::format("found '{0}' without '{1}', expected '{1}' beside it", dependency.key(),
                           needed.get<std::string>());
  return {};
}

std::string explain(Place place, const json& root) {
  if (place.value->is_object()) place.schema = &narrowed(*place.schema, *place.value, root);
  if (place.value->is_object() && place.schema->contains("properties")) {
    for (std::string sentence :
         {explain_unknown(*place.value, *place.schema), explain_choice(*place.value, *place.schema),
          explain_missing(*place.value, *place.schema, root),
          explain_dependency(*place.value, *place.schema)})
      if (!sentence.empty()) return sentence;
  }
  return fmt::format("found {}, expected {}", shortened(*place.value), description_of(*place.schema, root));
}

}  // namespace

const json& job_schema() {
  static const json schema = json::parse(embedded::job_schema);
  return schema;
}

const json& report_schema() {
  static const json schema = json::parse(embedded::report_schema);
  return schema;
}

Result<json> parse_json(const std::string& text, const std::string& file) {
  // The library takes the last of several values of one name, of which the others would be lost without a
  // word.
  std::vector<std::set<std::string>> names;
  std::string twice;
  const auto note_name = [&](int, json::parse_event_t event, const json& parsed) {
    if (event == json::parse_event_t::object_start) names.emplace_back();
    if (event == json::parse_event_t::object_end) names.pop_back();
    if (event == json::parse_event_t::key && !names.back().insert(parsed.get<std::string>()).second)
      twice = parsed.get<std::string>();
    return true;
  };
  try {
    json document = json::parse(text, note_name);
    if (!twice.empty())
      return fail(ErrorCode::json_invalid,
                  fmt::format("{}: \"{}\" is given twice in one object", file, twice));
    return document;
  } catch (const json::exception&) {
    return fail(ErrorCode::json_invalid, fmt::format("{}: {}", file, explain_json_error(text)));
  }
}

Result<void> check_schema(const json& document, const json& schema, const std::string& file) {
  valijson::Schema compiled;
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(schema), compiled);
  valijson::Validator validator(valijson::Validator::kStrongTypes);
  valijson::ValidationResults results;
  if (validator.validate(compiled, valijson::adapters::NlohmannJsonAdapter(document), &results)) return {};

  // A fault shows at its own place and at every place around it: only the innermost ones are told.
  std::vector<Path> paths;
  for (const auto& error : results) paths.push_back(path_of(error.context));
  std::set<std::string> told;
  std::string message;
  for (const Path& path : paths) {
    const bool innermost = std::none_of(paths.begin(), paths.end(), [&](const Path& other) {
      return other.size() > path.size() && starts_with(other, path);
    });
    if (!innermost || told.size() == max_faults || !told.insert(pointer_of(path)).second) continue;
    message += fmt::format("{}{}: {}: {}", message.empty() ? "" : "\n", file, pointer_of(path),
                           explain(find_place(document, schema, path), schema));
  }
  return fail(ErrorCode::schema_violation, message);
}

}  // namespace applique
