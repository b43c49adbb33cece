#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "applique/base/error.h"
#include "applique/surface/surface_mesh.h"

namespace applique::compare {

/// A place on a surface to stick images on.
struct Site {
  std::string name;
  SurfaceMesh mesh;
  SurfacePoint anchor;  ///< Where the image's middle lands.
  Vec3 up;              ///< The image's upper edge at the anchor.
  double width;         ///< The image's width at the anchor, scene units.
};

/// A site before its surface is made or read, which may take seconds.
struct SiteSource {
  std::string name;
  std::string about;  ///< One line for people: the surface, the anchor, the size.
  std::function<Result<Site>()> make;
};

/// Surfaces of our own. A "sphere-R" has a disc of the image reach R radians from the anchor: R is the cap's
/// radius along the surface, as in §10 of the design, so that 2.6 is 93 % of the sphere.
std::vector<SiteSource> own_sites();

/// Third-party models under `data`, one after another by its file; none where there is no such folder.
std::vector<SiteSource> model_sites(const std::filesystem::path& data);

}  // namespace applique::compare
