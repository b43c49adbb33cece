#pragma once

#include <cstdint>
#include <map>
#include <random>
#include <string>

#include "applique/decal.h"
#include "applique/surface/surface_query.h"

namespace applique::random_decals {

/// A surface to stick random decals on.
struct Ground {
  std::string name;
  const SurfaceMesh* mesh;
  const SurfaceQuery* query;
  double size;  ///< Decals are 0.2 to 1 times as wide, scene units.
};

/// A random region (star-shaped, a bent strip, or a block with notches) with one to nine random features,
/// laid on the ground about a random point by its tangent plane and pulled about.
DecalInput random_decal(const Ground& ground, std::mt19937& random);

/// How a solve ended: "solved" (features exact, nothing turned over), "error: CODE" where it was turned down,
/// or "warned: CODE" for a result that says of itself that it is not sound. Empty: it is not sound and does
/// not say so.
std::string outcome(const Result<DecalMap>& map);

/// Shares by method and cause, for people.
class Tally {
 public:
  void add(const std::string& ground, const std::string& outcome) { ++counts_[ground][outcome]; }
  void print(const std::string& method) const;
  [[nodiscard]] double share_solved() const;

 private:
  std::map<std::string, std::map<std::string, int>> counts_;
};

/// Solves random decals on the ground by RapidCheck, the patch checked after every step, and counts how they
/// end. Whether each is either sound or says that it is not.
bool check(const Ground& ground, Tally& tally);

}  // namespace applique::random_decals
