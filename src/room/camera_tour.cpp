#include "room/camera_tour.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angles.h"
#include "core/median.h"

namespace aligngs {
namespace {

constexpr size_t kAround = 72;       // keys of an orbit: one every five degrees
constexpr size_t kBend = 4;          // of them before and after a narrow place give way to it
constexpr double kFarShare = 0.7;    // of the way to the wall: from nearer the wall fills the picture
constexpr double kNearShare = 0.15;  // of the diagonal, at least, where walls allow: nearer the middle is too large
constexpr size_t kMostPlaces = 12;   // of a walk
constexpr size_t kStep = 8;          // keys between two places of a walk
constexpr double kTurnCost = 0.3;    // of the diagonal, for a turn by 180 degrees
constexpr double kView = 0.3;        // of the diagonal from the eye to what a walk looks at
constexpr double kLowest = 0.25, kHighest = 0.85;  // of the room's height, of the eye
constexpr double kTargetLow = 0.2, kTargetHigh = 0.6;
constexpr double kFieldOfView = 62;  // degrees, as on the page
constexpr int kSmoothing = 3;        // times that corners of a walk are rounded

Vec3d at_height(const Vec2d& p, double z) { return {p.x, p.y, z}; }
Vec2d seen_from_above(const Vec3d& p) { return {p.x, p.y}; }
double distance(const Vec2d& a, const Vec2d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Place and direction of a photo in the room's frame.
struct Place {
  Vec3d eye, forward;
};

std::vector<Place> places_of(const RoomInside& room, const std::vector<Camera>& photos) {
  std::vector<Place> out;
  for (const Camera& c : photos)
    out.push_back({room.to_room() * c.centre(), normalized(room.to_room().rotation * c.forward())});
  return out;
}

/// The point nearest to all viewing rays; the ends of short rays hold it where the rays are parallel.
Vec3d looked_at(const std::vector<Place>& places, double reach) {
  constexpr double kHold = 0.05;  // weight of a ray's end against its distance
  double a[3][4] = {};
  for (const Place& p : places) {
    const Vec3d end = p.eye + p.forward * reach;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const double m = (r == c ? 1.0 : 0.0) - p.forward[r] * p.forward[c];
        a[r][c] += m;
        a[r][3] += m * p.eye[c];
      }
      a[r][r] += kHold;
      a[r][3] += kHold * end[r];
    }
  }
  for (int k = 0; k < 3; ++k) {  // the matrix is positive definite: no pivots
    for (int r = k + 1; r < 3; ++r) {
      const double f = a[r][k] / a[k][k];
      for (int c = k; c < 4; ++c) a[r][c] -= f * a[k][c];
    }
  }
  Vec3d x;
  for (int r = 2; r >= 0; --r) {
    double sum = a[r][3];
    for (int c = r + 1; c < 3; ++c) sum -= a[r][c] * x[c];
    x[r] = sum / a[r][r];
  }
  return x;
}

/// Radii that give way smoothly to narrow places: none is larger than it was.
std::vector<double> smoothed_below(const std::vector<double>& radii) {
  const size_t n = radii.size();
  std::vector<double> least(n), out(n, 0);
  for (size_t i = 0; i < n; ++i) {
    least[i] = radii[i];
    for (size_t k = 1; k <= kBend; ++k) least[i] = std::min({least[i], radii[(i + k) % n], radii[(i + n - k) % n]});
  }
  for (size_t i = 0; i < n; ++i) {
    out[i] = least[i];
    for (size_t k = 1; k <= kBend; ++k) out[i] += least[(i + k) % n] + least[(i + n - k) % n];
    out[i] /= 2 * kBend + 1;
  }
  return out;
}

/// Places along a way, off the walls and without corners. `loop`: the last one is followed by the first.
std::vector<Vec2d> rounded(const RoomInside& room, std::vector<Vec2d> eyes, bool loop) {
  const size_t n = eyes.size();
  for (Vec2d& eye : eyes) eye = room.inside(eye);
  for (int pass = 0; pass < kSmoothing; ++pass) {
    std::vector<Vec2d> smooth = eyes;
    for (size_t i = 0; i < n; ++i) {
      if (!loop && (i == 0 || i + 1 == n)) continue;
      const Vec2d &a = eyes[(i + n - 1) % n], &b = eyes[i], &c = eyes[(i + 1) % n];
      smooth[i] = room.inside({(a.x + 2 * b.x + c.x) / 4, (a.y + 2 * b.y + c.y) / 4});
    }
    eyes = std::move(smooth);
  }
  return eyes;
}

CameraPath in_world(const RoomInside& room, CameraPath path) {
  const Similarity back = room.to_room().inverse();
  for (CameraKey& key : path.keys) key.eye = back * key.eye, key.target = back * key.target;
  return path;
}

/// Those that lie farthest from each other, in the order of the photos.
std::vector<Place> spread_out(const std::vector<Place>& all) {
  std::vector<size_t> chosen = {0};
  while (chosen.size() < std::min(kMostPlaces, all.size())) {
    size_t best = 0;
    double most = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      for (const size_t c : chosen) least = std::min(least, norm(all[i].eye - all[c].eye));
      if (least > most) most = least, best = i;
    }
    if (most == 0) break;
    chosen.push_back(best);
  }
  std::sort(chosen.begin(), chosen.end());
  std::vector<Place> out;
  for (const size_t c : chosen) out.push_back(all[c]);
  return out;
}

/// An order with a short way and small turns: pieces of it are turned round for as long as that helps.
void order(std::vector<Place>& places, double diagonal) {
  const auto cost = [&](const Place& a, const Place& b) {
    const double turn = std::acos(std::clamp(dot(a.forward, b.forward), -1.0, 1.0)) / kPi;
    return norm(a.eye - b.eye) + kTurnCost * diagonal * turn;
  };
  for (bool better = true; better;) {
    better = false;
    for (size_t i = 0; i < places.size(); ++i) {
      for (size_t j = i + 1; j < places.size(); ++j) {
        double change = 0;
        if (i > 0) change += cost(places[i - 1], places[j]) - cost(places[i - 1], places[i]);
        if (j + 1 < places.size()) change += cost(places[i], places[j + 1]) - cost(places[j], places[j + 1]);
        if (change >= -1e-9) continue;
        std::reverse(places.begin() + static_cast<std::ptrdiff_t>(i),
                     places.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        better = true;
      }
    }
  }
}

/// From one direction to another by the shorter turn, `s` in [0, 1], evenly in yaw and pitch.
Vec3d between(const Vec3d& a, const Vec3d& b, double s) {
  const double yaw = std::atan2(a.y, a.x), turn = std::remainder(std::atan2(b.y, b.x) - yaw, 2 * kPi);
  const double low = std::asin(std::clamp(a.z, -1.0, 1.0)), high = std::asin(std::clamp(b.z, -1.0, 1.0));
  const double y = yaw + s * turn, p = low + s * (high - low);
  return {std::cos(p) * std::cos(y), std::cos(p) * std::sin(y), std::sin(p)};
}

}  // namespace

double tour_height(const RoomInside& room, const std::vector<Camera>& photos) {
  std::vector<double> heights;
  for (const Place& p : places_of(room, photos)) heights.push_back(p.eye.z);
  return std::clamp(median_of(std::move(heights)), kLowest * room.height(), kHighest * room.height());
}

CameraPath orbit_path(const RoomInside& room, const std::vector<Camera>& photos, double seconds) {
  const Vec3d seen = looked_at(places_of(room, photos), kView * room.diagonal());
  const Vec2d middle = room.inside(seen_from_above(seen));
  const double height = tour_height(room, photos);
  const Vec3d target = at_height(middle, std::clamp(seen.z, kTargetLow * room.height(), kTargetHigh * room.height()));
  std::vector<double> radii;
  for (size_t i = 0; i < kAround; ++i) {
    const double a = 2 * kPi * static_cast<double>(i) / kAround;
    const Vec2d d{std::cos(a), std::sin(a)};
    const double wall = room.wall_distance(middle, d), least = std::min(kNearShare * room.diagonal(), 0.5 * wall);
    radii.push_back(std::max(least, std::min(kFarShare * wall, room.free_distance(middle, d) - room.margin())));
  }
  radii = smoothed_below(radii);
  std::vector<Vec2d> eyes;
  for (size_t i = 0; i < kAround; ++i) {
    const double a = 2 * kPi * static_cast<double>(i) / kAround;
    eyes.push_back({middle.x + radii[i] * std::cos(a), middle.y + radii[i] * std::sin(a)});
  }
  eyes = rounded(room, std::move(eyes), true);
  CameraPath path;
  for (size_t i = 0; i <= kAround; ++i) {
    path.keys.push_back(
        {seconds * static_cast<double>(i) / kAround, at_height(eyes[i % kAround], height), target, kFieldOfView});
  }
  return in_world(room, std::move(path));
}

CameraPath walk_path(const RoomInside& room, const std::vector<Camera>& photos, double seconds) {
  std::vector<Place> places = spread_out(places_of(room, photos));
  order(places, room.diagonal());
  const double height = tour_height(room, photos);
  std::vector<Vec2d> eyes;
  std::vector<Vec3d> views;
  for (size_t i = 0; i < places.size(); ++i) {
    const Place &a = places[i], &b = places[std::min(i + 1, places.size() - 1)];
    for (size_t k = 0; k < (i + 1 < places.size() ? kStep : 1); ++k) {
      const double s = static_cast<double>(k) / kStep;
      eyes.push_back({a.eye.x + s * (b.eye.x - a.eye.x), a.eye.y + s * (b.eye.y - a.eye.y)});
      views.push_back(between(a.forward, b.forward, s * s * (3 - 2 * s)));
    }
  }
  eyes = rounded(room, std::move(eyes), false);
  // Time follows the way and the turns, so that neither is hasty.
  std::vector<double> times = {0};
  for (size_t i = 1; i < eyes.size(); ++i) {
    const double turn = std::acos(std::clamp(dot(views[i - 1], views[i]), -1.0, 1.0)) / kPi;
    times.push_back(times.back() + distance(eyes[i - 1], eyes[i]) + kTurnCost * room.diagonal() * turn +
                    1e-6 * room.diagonal());
  }
  CameraPath path;
  for (size_t i = 0; i < eyes.size(); ++i) {
    const Vec3d eye = at_height(eyes[i], height);
    path.keys.push_back({times.back() > 0 ? seconds * times[i] / times.back() : 0, eye,
                         eye + views[i] * (kView * room.diagonal()), kFieldOfView});
  }
  return in_world(room, std::move(path));
}

}  // namespace aligngs
