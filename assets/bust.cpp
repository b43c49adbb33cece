#include "bust.h"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

#include "applique/base/error.h"

#include "polygonise.h"
#include "sdf.h"

namespace applique::assets {
namespace {

const Vec3 head_origin(0, 3.86, 0.0);   // of the head's frame, in the scene
const Vec3 neck_pivot(0, -0.85, -0.2);  // the head turns about this point of its frame

const Eigen::Matrix3d& head_turn() {
  static const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.17, Vec3::UnitY()) * Eigen::AngleAxisd(-0.05, Vec3::UnitZ()) *
       Eigen::AngleAxisd(0.03, Vec3::UnitX()))
          .toRotationMatrix();
  return turn;
}

/// A skeleton through the given knots, smooth: Catmull-Rom, four pieces between knots.
std::vector<Knot> smooth_curve(const std::vector<Knot>& knots) {
  constexpr int pieces = 4;
  std::vector<Knot> curve;
  const auto last = static_cast<int>(knots.size()) - 1;
  const auto at = [&](int i) { return knots[std::clamp(i, 0, last)]; };
  for (int i = 0; i < last; ++i)
    for (int piece = 0; piece < pieces; ++piece) {
      const double t = static_cast<double>(piece) / pieces;
      const double w[4] = {0.5 * t * (t * (2 - t) - 1), 0.5 * (t * t * (3 * t - 5) + 2),
                           0.5 * t * (t * (4 - 3 * t) + 1), 0.5 * t * t * (t - 1)};
      Knot knot{Vec3::Zero(), 0};
      for (int k = 0; k < 4; ++k) {
        knot.point += w[k] * at(i - 1 + k).point;
        knot.radius += w[k] * at(i - 1 + k).radius;
      }
      curve.push_back(knot);
    }
  curve.push_back(knots.back());
  return curve;
}

enum Chart {
  plinth_foot,
  plinth_front,
  plinth_back,
  chest,
  back,
  left_shoulder,
  right_shoulder,
  throat,
  nape,
  skull,
  face,
  left_temple,
  right_temple
};

/// The right side folded onto the left, rounded over `width` so that no crease runs down the middle.
Vec3 folded(const Vec3& p, double width) {
  return {std::sqrt(p.x() * p.x() + width * width), p.y(), p.z()};
}

// --- The head: dimensions in its own frame, x taken as its absolute value. ---

const Vec3 eye_centre(0.3135, 0.01, 0.635);
constexpr double eye_radius = 0.165;
const Vec3 inner_canthus(0.165, -0.015, 0.75);
const Vec3 outer_canthus(0.462, 0.022, 0.70);

constexpr double upper_lid_rise = 0.076;
constexpr double lower_lid_drop = 0.044;

/// The point of the lid's arc at t (0 inner canthus, 1 outer), `rise` above the chord's middle, on the sphere
/// of `radius` about the eye.
Vec3 lid_point(double t, double rise, double radius) {
  const Vec3 chord = outer_canthus - inner_canthus;
  Vec3 p = inner_canthus + t * chord;
  const double bow = 4 * t * (1 - t);
  p.x() -= bow * rise * chord.y() / chord.x();
  p.y() += bow * rise;
  const double across2 = (p - eye_centre).head<2>().squaredNorm();
  p.z() = eye_centre.z() + std::sqrt(std::max(radius * radius - across2, 0.0004));
  return p;
}

template <std::size_t N>
std::array<Knot, N> lid_tube(double rise, double radius, double thickness, double from, double to) {
  std::array<Knot, N> knots;
  for (std::size_t i = 0; i < N; ++i) {
    const double s = static_cast<double>(i) / (N - 1);
    knots[i] = {lid_point(from + s * (to - from), rise, radius),
                thickness * (0.45 + 0.55 * std::sin(3.14159 * s))};
  }
  return knots;
}

/// The opening between the lids, seen from the front: where two discs overlap.
double lid_opening(const Vec3& p) {
  const Vec2 inner(inner_canthus.x(), inner_canthus.y());
  const Vec2 outer(outer_canthus.x(), outer_canthus.y());
  const double half = 0.5 * std::abs(outer - inner);
  const Vec2 up = Vec2(0, 1) * (outer - inner) / (2 * half);
  const Vec2 middle = 0.5 * (inner + outer);
  const Vec2 z(p.x(), p.y());
  const auto disc = [&](double rise, double side) {
    const double radius = (half * half + rise * rise) / (2 * rise);
    return std::abs(z - (middle - side * up * (radius - rise))) - radius;
  };
  return smooth_intersection(disc(upper_lid_rise, 1), disc(lower_lid_drop, -1), 0.03);
}

double with_eyes(double d, const Vec3& q) {
  static const auto upper_rim = lid_tube<9>(upper_lid_rise, eye_radius + 0.016, 0.021, 0.0, 1.0);
  static const auto lower_rim = lid_tube<9>(-lower_lid_drop, eye_radius + 0.004, 0.016, 0.02, 0.98);
  static const auto crease = lid_tube<9>(0.142, eye_radius + 0.045, 0.018, 0.02, 1.06);
  if (sphere(q, eye_centre, 0.32) > 0) return d;
  d = smooth_union(d, sphere(q, eye_centre, eye_radius + 0.022), 0.05);
  d = smooth_difference(d, tube(q, crease), 0.05);
  d = smooth_union(d, tube(q, upper_rim), 0.035);
  d = smooth_union(d, tube(q, lower_rim), 0.035);
  d = smooth_difference(d, std::max(lid_opening(q), eye_centre.z() - q.z()), 0.03);
  return smooth_union(d, sphere(q, eye_centre, eye_radius), 0.03);
}

double with_nose(double d, const Vec3& q) {
  if (sphere(q, Vec3(0, -0.2, 0.92), 0.55) > 0) return d;
  static const auto ridge =
      smooth_curve({Knot{Vec3(0, 0.22, 0.79), 0.08}, Knot{Vec3(0, 0.03, 0.835), 0.068},
                    Knot{Vec3(0, -0.2, 0.935), 0.06}, Knot{Vec3(0, -0.37, 1.035), 0.066}});
  d = smooth_union(d, tube(q, ridge), 0.10);
  d = smooth_union(d, ellipsoid(q, Vec3(0, -0.33, 0.89), Vec3(0.105, 0.15, 0.13)), 0.10);
  d = smooth_union(d, ellipsoid(q, Vec3(0, -0.385, 1.035), Vec3(0.068, 0.066, 0.085)), 0.06);
  d = smooth_union(d, ellipsoid(q, Vec3(0.108, -0.42, 0.925), Vec3(0.056, 0.056, 0.085)), 0.06);
  d = smooth_union(d, round_cone(q, {Vec3(0, -0.435, 1.03), 0.028}, {Vec3(0, -0.5, 0.9), 0.045}), 0.05);
  d = smooth_difference(d, ellipsoid(q, Vec3(0.062, -0.494, 0.985), Vec3(0.028, 0.03, 0.05)), 0.035);
  // The fold behind the wing.
  static const auto fold =
      smooth_curve({Knot{Vec3(0.15, -0.34, 0.93), 0.008}, Knot{Vec3(0.182, -0.42, 0.90), 0.012},
                    Knot{Vec3(0.155, -0.49, 0.90), 0.008}});
  return smooth_difference(d, tube(q, fold), 0.05);
}

double with_mouth(double d, const Vec3& q) {
  if (sphere(q, Vec3(0, -0.7, 0.85), 0.5) > 0) return d;
  static const auto upper =
      smooth_curve({Knot{Vec3(0, -0.650, 0.945), 0.043}, Knot{Vec3(0.06, -0.638, 0.940), 0.046},
                    Knot{Vec3(0.16, -0.668, 0.880), 0.034}, Knot{Vec3(0.25, -0.70, 0.795), 0.012}});
  static const auto lower =
      smooth_curve({Knot{Vec3(0, -0.758, 0.918), 0.054}, Knot{Vec3(0.07, -0.756, 0.910), 0.055},
                    Knot{Vec3(0.16, -0.737, 0.862), 0.040}, Knot{Vec3(0.24, -0.708, 0.795), 0.012}});
  static const auto line =
      smooth_curve({Knot{Vec3(0, -0.702, 0.985), 0.013}, Knot{Vec3(0.055, -0.694, 0.980), 0.013},
                    Knot{Vec3(0.125, -0.699, 0.945), 0.013}, Knot{Vec3(0.20, -0.704, 0.884), 0.012},
                    Knot{Vec3(0.258, -0.702, 0.832), 0.010}});
  d = smooth_difference(d, round_cone(q, {Vec3(0, -0.52, 0.985), 0.018}, {Vec3(0, -0.585, 0.99), 0.026}),
                        0.06);
  d = smooth_union(d, tube(q, upper), 0.032);
  d = smooth_union(d, tube(q, lower), 0.032);
  return smooth_difference(d, tube(q, line), 0.04);
}

double with_ear(double d, const Vec3& q) {
  static const Vec3 origin(0.735, -0.14, -0.1);
  if (sphere(q, origin, 0.45) > 0) return d;
  static const Eigen::Matrix3d axes = [] {
    Eigen::Matrix3d m;  // rows: towards the back, up, out
    const Vec3 back = Vec3(0.36, -0.12, -0.9).normalized();
    const Vec3 out = back.cross(Vec3(0.06, 1, -0.12)).normalized();
    m.row(0) = back;
    m.row(1) = (out.cross(back)).normalized();
    m.row(2) = out;
    if (m.row(2).x() < 0) m.row(2) *= -1;
    return m;
  }();
  const Vec3 e = axes * (q - origin);
  static const auto helix =
      smooth_curve({Knot{Vec3(0.02, -0.02, 0.0), 0.022}, Knot{Vec3(-0.05, 0.05, 0.02), 0.030},
                    Knot{Vec3(-0.065, 0.14, 0.02), 0.034}, Knot{Vec3(-0.02, 0.205, 0.015), 0.036},
                    Knot{Vec3(0.055, 0.22, 0.01), 0.037}, Knot{Vec3(0.12, 0.165, 0.008), 0.037},
                    Knot{Vec3(0.14, 0.07, 0.005), 0.036}, Knot{Vec3(0.125, -0.04, 0.005), 0.035},
                    Knot{Vec3(0.08, -0.13, 0.008), 0.036}, Knot{Vec3(0.015, -0.195, 0.01), 0.048}});
  static const auto antihelix =
      smooth_curve({Knot{Vec3(0.025, 0.13, -0.005), 0.03}, Knot{Vec3(0.065, 0.06, 0.005), 0.032},
                    Knot{Vec3(0.06, -0.045, 0.005), 0.032}, Knot{Vec3(0.01, -0.11, 0.005), 0.034}});
  double ear = ellipsoid(e, Vec3(0.035, 0.02, -0.045), Vec3(0.13, 0.215, 0.055));
  ear = smooth_union(ear, tube(e, antihelix), 0.04);
  ear = smooth_union(ear, tube(e, helix), 0.035);
  ear = smooth_difference(ear, ellipsoid(e, Vec3(-0.005, -0.04, 0.04), Vec3(0.05, 0.07, 0.06)), 0.03);
  ear = smooth_union(ear, ellipsoid(e, Vec3(-0.07, -0.045, 0.01), Vec3(0.03, 0.045, 0.035)), 0.04);
  return smooth_union(d, ear, 0.06);
}

double head_distance(const Vec3& p) {
  const Vec3 q = folded(p, 0.02);
  double d = ellipsoid(q, Vec3(0, 0.27, -0.10), Vec3(0.72, 0.80, 0.92));
  d = smooth_union(d, ellipsoid(q, Vec3(0, 0.32, 0.20), Vec3(0.59, 0.52, 0.62)), 0.2);  // forehead
  // Face, cheekbones and jaw.
  d = smooth_union(d, ellipsoid(q, Vec3(0, -0.36, 0.38), Vec3(0.50, 0.58, 0.46)), 0.2);
  d = smooth_union(d, ellipsoid(q, Vec3(0, -0.70, 0.36), Vec3(0.41, 0.40, 0.48)), 0.2);
  d = smooth_union(d, ellipsoid(q, Vec3(0.40, -0.22, 0.55), Vec3(0.16, 0.12, 0.17)), 0.24);
  d = smooth_union(d, round_cone(q, {Vec3(0.48, -0.19, 0.48), 0.08}, {Vec3(0.64, -0.1, 0.02), 0.05}), 0.24);
  d = smooth_union(d, ellipsoid(q, Vec3(0.42, -0.46, 0.18), Vec3(0.17, 0.40, 0.30)), 0.24);  // masseter
  static const auto jaw =
      smooth_curve({Knot{Vec3(0.44, -0.70, 0.06), 0.09}, Knot{Vec3(0.30, -0.92, 0.42), 0.11},
                    Knot{Vec3(0.08, -1.02, 0.70), 0.12}});
  d = smooth_union(d, tube(q, jaw), 0.22);
  d = smooth_union(d, ellipsoid(q, Vec3(0.33, -0.52, 0.46), Vec3(0.20, 0.25, 0.26)), 0.2);  // cheek
  d = smooth_union(d, ellipsoid(q, Vec3(0, -0.67, 0.62), Vec3(0.31, 0.24, 0.29)), 0.16);    // round the mouth
  d = smooth_union(d, ellipsoid(q, Vec3(0, -1.0, 0.755), Vec3(0.17, 0.13, 0.15)), 0.14);    // chin
  // Eye sockets under the brow.
  d = smooth_difference(d, ellipsoid(q, Vec3(0.31, 0.04, 0.93), Vec3(0.20, 0.13, 0.2)), 0.16);
  d = smooth_difference(d, ellipsoid(q, Vec3(0.17, -0.02, 0.93), Vec3(0.07, 0.1, 0.12)), 0.12);
  static const auto brow =
      smooth_curve({Knot{Vec3(0.07, 0.15, 0.82), 0.045}, Knot{Vec3(0.18, 0.23, 0.825), 0.048},
                    Knot{Vec3(0.34, 0.262, 0.765), 0.045}, Knot{Vec3(0.49, 0.17, 0.635), 0.036},
                    Knot{Vec3(0.535, 0.0, 0.55), 0.04}, Knot{Vec3(0.50, -0.17, 0.56), 0.04}});
  d = smooth_union(d, tube(q, brow), 0.16);
  d = smooth_difference(d, ellipsoid(q, Vec3(0.85, 0.2, 0.42), Vec3(0.14, 0.26, 0.28)), 0.28);  // temples
  d = with_nose(d, q);
  d = with_mouth(d, q);
  d = with_eyes(d, q);
  return with_ear(d, q);
}

// --- Neck, shoulders and plinth: the head's frame without the head's turn. ---

double torso_distance(const Vec3& p) {
  const Vec3 q = folded(p, 0.1);
  double d = ellipsoid(q, Vec3(0, -2.75, -0.22), Vec3(1.18, 0.95, 0.60));                    // rib cage
  d = smooth_union(d, ellipsoid(q, Vec3(0.48, -2.62, 0.12), Vec3(0.52, 0.42, 0.30)), 0.25);  // chest muscles
  d = smooth_union(d, round_cone(q, {Vec3(0.2, -1.55, -0.42), 0.26}, {Vec3(1.25, -2.0, -0.32), 0.24}), 0.3);
  d = smooth_union(d, ellipsoid(q, Vec3(1.36, -2.32, -0.27), Vec3(0.40, 0.52, 0.42)), 0.25);  // deltoid
  static const auto clavicle =
      smooth_curve({Knot{Vec3(0.13, -2.0, 0.23), 0.075}, Knot{Vec3(0.5, -1.98, 0.22), 0.06},
                    Knot{Vec3(0.9, -1.9, 0.02), 0.06}, Knot{Vec3(1.25, -1.88, -0.2), 0.07}});
  d = smooth_union(d, tube(q, clavicle), 0.16);
  d = smooth_union(d, ellipsoid(q, Vec3(0.72, -2.16, -0.02), Vec3(0.42, 0.3, 0.26)),
                   0.2);                                                  // below the collar bone
  d = smooth_difference(d, sphere(q, Vec3(0, -1.98, 0.42), 0.12), 0.14);  // between the collar bones
  return d;
}

double neck_distance(const Vec3& p) {
  const Vec3 q = folded(p, 0.05);
  double d = round_cone(q, {Vec3(0, -0.55, -0.22), 0.42}, {Vec3(0, -1.9, -0.32), 0.47});
  d = smooth_union(d, round_cone(q, {Vec3(0, -0.9, 0.18), 0.22}, {Vec3(0, -1.7, 0.05), 0.22}), 0.2);
  d = smooth_union(d, sphere(q, Vec3(0, -1.32, 0.30), 0.07), 0.18);  // larynx
  static const auto sternomastoid =
      smooth_curve({Knot{Vec3(0.46, -0.42, -0.28), 0.08}, Knot{Vec3(0.35, -1.2, 0.0), 0.10},
                    Knot{Vec3(0.09, -1.88, 0.22), 0.07}});
  return smooth_union(d, tube(q, sternomastoid), 0.13);
}

double plinth_distance(const Vec3& p) {
  double d = drum(p, 0.74, -3.86, -3.70, 0.045);
  d = smooth_union(d, drum(p, 0.655, -3.72, -3.52, 0.095), 0.05);
  d = smooth_union(d, drum(p, 0.36, -3.6, -2.9, 0.02), 0.25);
  return smooth_union(d, drum(p, 0.46, -3.27, -3.15, 0.058), 0.06);
}

/// How much of the head's turn a height takes part in.
double turn_share(double y) {
  return smooth_step(-1.95, -0.75, y);
}

Vec3 unturned(const Vec3& p) {
  const double share = turn_share(p.y());
  if (share <= 0) return p;
  const Eigen::AngleAxisd turn(head_turn());
  return neck_pivot + Eigen::AngleAxisd(-share * turn.angle(), turn.axis()) * (p - neck_pivot);
}

}  // namespace

Vec3 head_to_scene(const Vec3& p) {
  return head_origin + neck_pivot + head_turn() * (p - neck_pivot);
}

double bust_distance(const Vec3& scene) {
  const Vec3 p = scene - head_origin;
  const Vec3 turned = unturned(p);
  constexpr double blend = 0.16;
  // Head above, body below: where the one is surely farther than the blend reaches, it is left out.
  constexpr double body_top = -0.1;
  constexpr double head_bottom = -1.25;
  double head = 0;
  if (p.y() > body_top) {
    head = head_distance(turned);
    if (p.y() - body_top > head + blend) return head;
  }
  double d = smooth_union(torso_distance(p - Vec3(0, 0.12, 0)), neck_distance(turned), 0.22);
  // The cut of the bust: a rounded lower edge, as of a classical bust.
  d = smooth_intersection(d, ellipsoid(p, Vec3(0, -1.7, -0.2), Vec3(1.62, 1.42, 1.6)), 0.08);
  d = smooth_union(d, plinth_distance(p - Vec3(0, 0, -0.2)), 0.12);
  if (head_bottom - p.y() > d + blend) return d;
  if (p.y() <= body_top) head = head_distance(turned);
  return smooth_union(d, head, blend);
}

std::vector<Landmark> bust_landmarks() {
  // Seen from the head's front: the surface point at this x and y of its frame.
  const auto facing = [](const char* name, double x, double y) {
    const Vec3 direction = head_to_scene(Vec3::UnitZ()) - head_to_scene(Vec3::Zero());
    Vec3 p = head_to_scene(Vec3(x, y, 1.6));
    for (int i = 0; i < 200; ++i) p -= 0.5 * bust_distance(p) * direction;
    return Landmark{name, project_to_surface(bust_distance, p)};
  };
  // On the bust's left chest, seen from the front.
  const auto on_chest = [](const char* name, double x, double y) {
    Vec3 p(x, y, 2);
    for (int i = 0; i < 200; ++i) p.z() -= 0.5 * bust_distance(p);
    return Landmark{name, project_to_surface(bust_distance, p)};
  };
  return {facing("forehead", 0, 0.42),
          facing("nose_root", 0, 0.02),
          facing("nose_tip", 0, -0.38),
          facing("left_eye_inner", inner_canthus.x() - 0.012, inner_canthus.y()),
          facing("left_eye_outer", outer_canthus.x() + 0.02, outer_canthus.y()),
          facing("right_eye_inner", -inner_canthus.x() + 0.012, inner_canthus.y()),
          facing("right_eye_outer", -outer_canthus.x() - 0.02, outer_canthus.y()),
          facing("left_mouth_corner", 0.265, -0.703),
          facing("right_mouth_corner", -0.265, -0.703),
          facing("mouth_middle", 0, -0.695),
          facing("chin", 0, -1.0),
          on_chest("emblem_top", 0.66, 1.86),
          on_chest("emblem_bottom", 0.60, 1.10)};
}

int bust_chart(const Vec3& centre, const Vec3& normal) {
  const Vec3 p = centre - head_origin;
  if (p.y() < -3.80 && normal.y() < -0.7) return plinth_foot;
  if (p.y() < -3.08) return p.z() > -0.2 ? plinth_front : plinth_back;
  const Vec3 q = unturned(p);
  // Where the neck begins: below the jaw in front, at the nape behind.
  const double jaw_line = -0.66 - 0.55 * std::max(q.z(), 0.0) + 0.1 * std::max(-q.z() - 0.3, 0.0);
  const double shoulder_line = -1.72 - 0.3 * q.z();
  if (q.y() < shoulder_line) {
    if (std::abs(p.x()) > 0.85) return p.x() > 0 ? left_shoulder : right_shoulder;
    return p.z() > -0.25 ? chest : back;
  }
  if (q.y() < jaw_line) return q.z() > -0.22 ? throat : nape;
  const Vec3 from_middle = (q - Vec3(0, 0.15, -0.05)).normalized();
  const double around = std::atan2(std::abs(q.x()), q.z() + 0.05);
  if (from_middle.y() > 0.78 || around > 2.0) return skull;
  if (around < 0.95) return face;
  return q.x() > 0 ? left_temple : right_temple;
}

double bust_chart_density(int chart) {
  switch (chart) {
    case face:
      return 1.78;
    case chest:
    case left_shoulder:
      return 1.75;
    case left_temple:
    case right_temple:
      return 1.15;
    default:
      return 0.88;
  }
}

Vec3 bust_landmark(const std::string& name) {
  const auto landmarks = bust_landmarks();
  const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                  [&](const Landmark& landmark) { return landmark.name == name; });
  APPLIQUE_ASSERT(found != landmarks.end());
  return found->position;
}

}  // namespace applique::assets
