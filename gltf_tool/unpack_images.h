#pragma once

#include "document.h"

namespace applique {

/// Gives the images in the document's chunk new files of their own, named after them. Where an extension may
/// refer to buffer views in a way that is not known here, all stay in the chunk; so does an image whose kind
/// is unknown, and one whose view something else uses too.
void unpack_images(Document& document);

}  // namespace applique
