// SPDX-License-Identifier: MIT
// A player of a ball game: pushes the ball into the opponents' goal. It finds the ball and its mate among its
// neighbours by their numbers, and knows its own pose. The mate nearer to a good place behind the ball
// attacks; the other waits in front of its own goal. The field is symmetric about its middle at x = y = 0.
#include <algorithm>
#include <cmath>

#include "cpp_controller.h"

namespace {

struct Point {
  double x = 0, y = 0;

  Point operator+(const Point& other) const { return {x + other.x, y + other.y}; }
  Point operator-(const Point& other) const { return {x - other.x, y - other.y}; }
  Point operator*(double factor) const { return {x * factor, y * factor}; }
  double Dot(const Point& other) const { return x * other.x + y * other.y; }
  double Norm() const { return coopdyn_hypot(x, y); }
};

class Soccer {
 public:
  struct State {
    uint32_t attacks;
    double x_m, y_m, stuck_s;   // last position, and time without leaving it
    double back_s, turn_rad_s;  // remaining time to drive back, and the turn rate meanwhile
  };
  State state{};

  static const coopdyn_description* Describe() {
    static const coopdyn_option options[] = {
        {"goal", "where the others' goal is, x in m", 1.5, -100, 100},
        {"width", "of the field, m", 2, 0.5, 100},
        {"ball", "number of the ball", 1, 0, 1e6},
        {"mate", "number of the mate; 0: none", 0, 0, 1e6},
        {"speed", "m/s", 0.6, 0, 5},
        {"near", "how far behind the ball it begins to push, m", 0.22, 0.05, 10},
    };
    static const coopdyn_description description = {"plays ball", COOPDYN_POSE | COOPDYN_NEIGHBOURS,
                                                    sizeof(State), 6, options};
    return &description;
  }

  Soccer(const coopdyn_robot& robot, const double* options)
      : id_(robot.id),
        goal_x_m_(options[0]),
        width_m_(options[1]),
        ball_(options[2]),
        mate_(options[3]),
        speed_m_s_(options[4]),
        near_m_(options[5]) {}

  void Reset(uint64_t /*seed*/) { state = {}; }

  void Step(const coopdyn_readings& readings, coopdyn_command& command) {
    const Point self{readings.x_m, readings.y_m};
    const coopdyn_sighting* ball_seen = Find(readings, ball_);
    if (ball_seen == nullptr) return;
    const Point ball = PlaceOf(*ball_seen, readings);
    // Along a wall first, else straight to the goal.
    const bool is_at_wall = std::abs(ball.y) > width_m_ / 2 - 0.15;
    const Point way = Point{goal_x_m_, is_at_wall ? ball.y : 0} - ball;
    const Point ahead = way * (1 / std::max(1e-3, way.Norm()));
    double mine_m = Cost(self, ball, ahead), mates_m = 1e9;
    if (const coopdyn_sighting* mate = Find(readings, mate_))
      mates_m = Cost(PlaceOf(*mate, readings), ball, ahead);
    if (state.attacks != 0) mine_m -= 0.2;  // hysteresis: keep attacking
    state.attacks = mine_m < mates_m + (mate_ > id_ ? 1e-9 : 0) ? 1 : 0;
    const Point home{-0.6 * goal_x_m_, 0.4 * ball.y};
    if (state.attacks == 0 && (home - self).Norm() < 0.1) {
      state.stuck_s = 0;
      return;
    }
    if (FreesItself(self, readings, command)) return;
    if (state.attacks != 0) return Attack(self, ball, ahead, readings, command);
    GoTo(home, 0.7 * speed_m_s_, readings, command);
  }

 private:
  static const coopdyn_sighting* Find(const coopdyn_readings& readings, double id) {
    for (size_t i = 0; i < readings.neighbour_count; ++i) {
      if (readings.neighbours[i].id == id) return &readings.neighbours[i];
    }
    return nullptr;
  }
  static Point PlaceOf(const coopdyn_sighting& seen, const coopdyn_readings& readings) {
    const double heading_rad = readings.heading_rad + seen.bearing_rad;
    return Point{readings.x_m, readings.y_m} +
           Point{coopdyn_cos(heading_rad), coopdyn_sin(heading_rad)} * seen.distance_m;
  }

  /// The distance to the place behind the ball, including a detour around it.
  double Cost(const Point& from, const Point& ball, const Point& ahead) const {
    const double behind_m = (ball - from).Dot(ahead);
    return (ball - ahead * near_m_ - from).Norm() + (behind_m < 0 ? 0.4 : 0);
  }

  void Attack(const Point& self, const Point& ball, const Point& ahead, const coopdyn_readings& readings,
              coopdyn_command& command) const {
    const Point to_ball = ball - self, left{-ahead.y, ahead.x};
    const double behind_m = to_ball.Dot(ahead), aside_m = -to_ball.Dot(left);
    if (behind_m > 0.05 && std::abs(aside_m) < 0.3 * behind_m + 0.02)
      return GoTo(ball + ahead * 0.2, speed_m_s_, readings, command);
    Point place = ball - ahead * near_m_;
    // Around the ball, not through it.
    if (behind_m < 0.1) place = place + left * (aside_m < 0 ? -near_m_ : near_m_);
    const double edge_m = width_m_ / 2 - 0.11;
    place.y = std::clamp(place.y, -edge_m, edge_m);
    GoTo(place, speed_m_s_, readings, command);
  }

  /// If stuck for a while, backs off for a moment.
  bool FreesItself(const Point& self, const coopdyn_readings& readings, coopdyn_command& command) {
    constexpr double kPatience_s = 1.5, kBack_s = 0.6, kAway_m = 0.08;
    state.stuck_s += readings.step_s;
    if ((self - Point{state.x_m, state.y_m}).Norm() > kAway_m) {
      state.x_m = self.x;
      state.y_m = self.y;
      state.stuck_s = 0;
    }
    if (state.stuck_s > kPatience_s) {
      const double chance = coopdyn::Random(readings.seed, id_, readings.step);
      state.stuck_s = 0;
      state.back_s = kBack_s * (0.5 + chance);
      state.turn_rad_s = 8 * coopdyn::Random(readings.seed, id_, readings.step, 1) - 4;
    }
    if (state.back_s <= 0) return false;
    state.back_s -= readings.step_s;
    command.forward_m_s = -0.6 * speed_m_s_;
    command.turn_rad_s = state.turn_rad_s;
    return true;
  }

  static void GoTo(const Point& place, double speed_m_s, const coopdyn_readings& readings,
                   coopdyn_command& command) {
    constexpr double kTurn_1_s = 6, kPi = 3.14159265358979323846;
    const double off_rad = std::remainder(
        coopdyn_atan2(place.y - readings.y_m, place.x - readings.x_m) - readings.heading_rad, 2 * kPi);
    const double ahead = std::max(0.0, coopdyn_cos(off_rad));
    command.forward_m_s = speed_m_s * ahead * ahead;
    command.turn_rad_s = std::clamp(kTurn_1_s * off_rad, -5.0, 5.0);
  }

  const uint32_t id_;
  const double goal_x_m_, width_m_, ball_, mate_, speed_m_s_, near_m_;
};

}  // namespace

extern "C" const coopdyn_controller* coopdyn_controller_entry() {
  return coopdyn::Entry<Soccer>();
}
