#pragma once

#include <cstdlib>

namespace applique {

/// Whether the environment asks for every case of the tests that have very many (APPLIQUE_THOROUGH=1), which
/// takes some ten minutes more.
inline bool thorough() {
  return std::getenv("APPLIQUE_THOROUGH") != nullptr;
}

}  // namespace applique
