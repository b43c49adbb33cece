#pragma once

#include "solve_job.h"

namespace applique {

/// Adds to the decals what the materials under the baked ones will do to them, none of which stops a bake:
/// base_color_factor_tints, base_color_factor_fades and factor_scales for factors of textures that are there
/// (a texture that is made takes the factors into its values), vertex_colors_tint, unlit_layers for layers
/// that an unlit material (KHR_materials_unlit) has no use for, specular_glossiness for a material with
/// another colour in viewers that know KHR_materials_pbrSpecularGlossiness, and variants_without_decal.
void warn_of_materials(SolvedJob& job);

}  // namespace applique
