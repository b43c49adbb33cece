#include "bottle.h"

#include <cmath>
#include <numbers>

namespace applique::assets {
namespace {

constexpr int sides = 64;

enum Chart { foot, body, shoulder, neck, cork };

struct ProfilePoint {
  double radius;
  double height;
};

void append_arc(std::vector<ProfilePoint>& profile, ProfilePoint centre, double radius, double from,
                double to, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const double angle = (from + (to - from) * i / steps) * std::numbers::pi / 180;
    profile.push_back({centre.radius + radius * std::cos(angle), centre.height + radius * std::sin(angle)});
  }
}

/// From the foot's middle up and over to the cork's.
std::vector<ProfilePoint> profile_points() {
  std::vector<ProfilePoint> profile{{0.12, 0.10}, {0.24, 0.075}, {0.35, 0.02}};
  append_arc(profile, {0.42, 0.08}, 0.08, -90, 0, 4);
  for (int i = 1; i < 8; ++i) profile.push_back({bottle_radius, 0.08 + 1.72 * i / 8});
  append_arc(profile, {0.14, 1.80}, 0.36, 0, 52, 6);
  append_arc(profile, {0.62, 2.4144}, 0.42, 232, 180, 6);
  for (int i = 1; i < 3; ++i) profile.push_back({0.20 - 0.02 * i, 2.4144 + 0.2 * i});
  append_arc(profile, {0.165, 2.98}, 0.05, -75, 75, 5);
  profile.insert(profile.end(), {{0.15, 3.055}, {0.145, 3.07}});
  append_arc(profile, {0.115, 3.19}, 0.03, 0, 90, 2);
  return profile;
}

}  // namespace

Mesh bottle_mesh() {
  const std::vector<ProfilePoint> profile = profile_points();
  const auto rings = static_cast<int>(profile.size());
  Mesh mesh;
  const auto add = [&](const Vec3& position, const Vec3& normal) {
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  for (int ring = 0; ring < rings; ++ring) {
    const ProfilePoint& below = profile[std::max(ring - 1, 0)];
    const ProfilePoint& above = profile[std::min(ring + 1, rings - 1)];
    const Vec2 tangent(above.radius - below.radius, above.height - below.height);
    const Vec2 outward = tangent / std::abs(tangent) * Vec2(0, -1);
    for (int side = 0; side <= sides; ++side) {
      // Both ends of a ring are the seam, bit for bit.
      const double angle = 2 * std::numbers::pi * (side % sides) / sides;
      const double s = std::sin(angle);
      const double c = std::cos(angle);
      add({profile[ring].radius * s, profile[ring].height, profile[ring].radius * c},
          Vec3(outward.real() * s, outward.imag(), outward.real() * c));
    }
  }
  const auto at = [&](int ring, int side) { return static_cast<std::uint32_t>(ring * (sides + 1) + side); };
  for (int ring = 0; ring + 1 < rings; ++ring)
    for (int side = 0; side < sides; ++side) {
      mesh.triangles.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side + 1)});
      mesh.triangles.push_back({at(ring, side), at(ring + 1, side + 1), at(ring + 1, side)});
    }
  const std::uint32_t foot = add(Vec3(0, 0.11, 0), -Vec3::UnitY());
  const std::uint32_t top = add(Vec3(0, profile.back().height, 0), Vec3::UnitY());
  for (int side = 0; side < sides; ++side) {
    mesh.triangles.push_back({foot, at(0, side + 1), at(0, side)});
    mesh.triangles.push_back({top, at(rings - 1, side), at(rings - 1, side + 1)});
  }
  return mesh;
}

int bottle_chart(const Vec3& centre, const Vec3&) {
  const double radius = std::hypot(centre.x(), centre.z());
  if (centre.y() < 0.12 && radius < 0.4) return foot;
  if (centre.y() < 1.81) return body;
  if (centre.y() < 2.2) return shoulder;
  return centre.y() > 3.0 && radius < 0.14 ? cork : neck;
}

double bottle_chart_density(int chart) {
  return chart == body ? 2.2 : 1;
}

Vec3 bottle_point(double along, double y) {
  const double angle = along / bottle_radius;
  return {bottle_radius * std::sin(angle), y, bottle_radius * std::cos(angle)};
}

}  // namespace applique::assets
