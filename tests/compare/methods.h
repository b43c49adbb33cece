#pragma once

#include <string>
#include <vector>

#include "applique/decal.h"

namespace applique::compare {

/// A method that takes part: a row of its name for each case.
struct Contender {
  std::string name;
  SolveOptions options;
};

/// Every method of the program, the default first.
std::vector<Contender> contenders();

}  // namespace applique::compare
