#pragma once

#include <string>
#include <vector>

#include "applique/base/types.h"

namespace applique::assets {

/// A named point of the bust's anatomy, on the surface.
struct Landmark {
  std::string name;
  Vec3 position;
};

/// The bust as a signed distance function: a classical head, turned a little, on shoulders and a round
/// plinth. One unit is half a head's height; y is up, the plinth stands on y = 0, the chest faces +z.
double bust_distance(const Vec3& p);

/// The landmarks that the jobs pin images to: the left side is the bust's own (+x).
std::vector<Landmark> bust_landmarks();

/// The place of the landmark of this name, which is one of them.
Vec3 bust_landmark(const std::string& name);

/// The chart of the bust's atlas that a piece of surface belongs to: plinth, chest, shoulders, back, neck,
/// face, sides and back of the head. The mask crosses from the face to the sides, the emblem from chest to
/// shoulder.
int bust_chart(const Vec3& centre, const Vec3& normal);

/// Texels a unit of length that a chart gets, relative to the others: most in the face.
double bust_chart_density(int chart);

/// A point given in the head's own frame (origin between the ears at eye level, face towards +z), in the
/// scene.
Vec3 head_to_scene(const Vec3& p);

}  // namespace applique::assets
