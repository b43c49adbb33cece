#include "compare/methods.h"

namespace applique::compare {
namespace {

/// Faces more nearly along the projection than this would be smeared beyond use: degrees from the anchor's
/// normal.
constexpr double steepest_projected = 75;

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
      contender(
          "planar",
          [](SolveOptions& o) { o.method = Method::planar, o.planar.normal_limit = steepest_projected; }),
      contender("expmap one parent",
                [](SolveOptions& o) { o.method = Method::expmap, o.parents = Parents::one; }),
      contender("expmap upwind",
                [](SolveOptions& o) { o.method = Method::expmap, o.parents = Parents::upwind; }),
      contender("stroke", [](SolveOptions& o) { o.method = Method::stroke; }),
      contender("paper", [](SolveOptions& o) { o.method = Method::paper; }),
  };
}

}  // namespace applique::compare
