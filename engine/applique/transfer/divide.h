#pragma once

#include <optional>

#include "applique/transfer/transfer.h"

namespace applique {

/// A transfer whose large faces that the warp bends are cut into similar ones of some 2000 texels, each of
/// which is then refined, and filtered, as it needs: a strong warp bends a large face much in a few places
/// only. None when there are no such faces. A warp with groups is left alone, and so are faces most of which
/// show nothing.
std::optional<Transfer> divide_faces(const Transfer& transfer);

}  // namespace applique
