#include "compare/methods.h"

namespace applique::compare {
namespace {

/// The default options with what `choose` changes of them.
template <class Choose>
Contender contender(const char* name, const Choose& choose) {
  Contender made{name, {}};
  choose(made.options);
  return made;
}

}  // namespace

std::vector<Contender> contenders() {
  return {
      contender("isometric", [](SolveOptions& o) { o.energy = Energy::isometric; }),
      contender("conformal", [](SolveOptions& o) { o.energy = Energy::conformal; }),
      contender("paper", [](SolveOptions& o) { o.method = Method::paper; }),
  };
}

}  // namespace applique::compare
