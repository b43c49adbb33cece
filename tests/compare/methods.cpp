#include "compare/methods.h"

namespace applique::compare {

std::vector<Contender> contenders() {
  return {
      {"isometric", {.method = Method::applique, .energy = Energy::isometric}},
      {"conformal", {.method = Method::applique, .energy = Energy::conformal}},
      {"paper", {.method = Method::paper, .energy = Energy::conformal}},
  };
}

}  // namespace applique::compare
