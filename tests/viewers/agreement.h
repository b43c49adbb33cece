#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "applique/base/error.h"
#include "applique/image/image.h"

namespace applique {

/// How well a viewer's picture of a decal agrees with ours.
struct Agreement {
  double overlap = 0;  ///< Pixels where both show the decal, per pixel where either does.
  /// Of what the decal changes, pixel by pixel, where both show it: 1 is the same up to the light's strength.
  double correlation = 0;
};

/// A decal on a model of our own, as our preview, three.js and Blender show it.
struct ViewedDecal {
  std::string name;
  Image ours, three, blender;
  Agreement with_three, with_blender;
};

/// The programs that take part, and the scripts that drive them.
struct ViewerTools {
  std::filesystem::path applique, assets;  ///< The project's own programs.
  std::filesystem::path node_modules;      ///< With three and puppeteer-core.
  std::string chromium = "chromium";       ///< Command or path.
  std::string blender = "blender";         ///< Likewise.
  std::filesystem::path scripts;           ///< The folder of three_view.mjs and blender_view.py.
};

/// What is not there of what is needed, in words; empty if nothing.
std::string missing_tools(const ViewerTools& tools);

/// Bakes five decals (one an overlay), and has each viewer take three pictures from the same place: of the
/// model, of it with the decal, and of it with a decal of the same outline in one loud colour, which tells
/// where it is. All files go into `folder`.
Result<std::vector<ViewedDecal>> compare_viewers(const ViewerTools& tools,
                                                 const std::filesystem::path& folder);

/// The pictures, a row for each decal: ours, by three.js, by Blender.
Image sheet_of(const std::vector<ViewedDecal>& decals);

}  // namespace applique
