#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/text_table.h"

namespace applique::compare {

/// The summary over the rows with two or more pins (summary.h), a line a method.
TextTable summary_table(const std::vector<Row>& rows);

/// All rows with every digit, for programs.
TextTable full_table(const std::vector<Row>& rows);

/// The rows of a site, rounded, for people.
TextTable site_table(const std::vector<Row>& rows, const std::string& site);

/// What the columns say and how the cases were made, a paragraph each.
std::vector<std::string> explanations();

/// The whole comparison in Markdown: the summary first.
std::string to_markdown(const Comparison& comparison, const std::vector<SiteSource>& sources);

}  // namespace applique::compare
