#pragma once

#include <string>
#include <vector>

namespace applique {

/// For messages about a name that is not among `known`: "'opacity'" if that is at most two edits or a change
/// of case away from `name`, else "one of a, b, c, …" (at most twelve); "none, there are none" when `known`
/// is empty.
std::string suggest_names(const std::string& name, const std::vector<std::string>& known);

}  // namespace applique
